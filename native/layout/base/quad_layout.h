// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "layout/base/decimation.h"

namespace hybrid_mesh {

// The connectivity of a base domain: quads over a decimated mesh, whose interior sides are edges of that mesh.
struct QuadLayout {
  struct Curve {
    int start = -1, end = -1;  // vertices of the mesh
    int edge = -1;             // the mesh's edge name that the curve lies on
  };
  struct Side {
    int curve = -1;       // -1: on the surface's boundary
    bool forward = true;  // the side runs from the curve's start to its end
  };
  struct Quad {
    std::array<int, 4> nodes{};  // counter-clockwise; side i runs from node i to node i + 1
    std::array<Side, 4> sides{};
  };
  std::vector<int> node_vertex;  // the mesh's vertex, or -1 for a node between the two ends of a boundary edge
  std::vector<Curve> curves;
  std::vector<Quad> quads;
  int lacking = 0;  // between features: corners at which there are fewer quads than the angle has room for, so that one has a straight angle
};

struct QuadLayoutOptions {
  double size = 300;  // quads, plus `boundary_side` for each side on the boundary; not exceeded where the topology allows
  double boundary_side = 0;
  int least = 0;  // coarsening stops before there are fewer quads
  std::uint64_t seed = 1;
  std::vector<int> boundary_quads;  // per vertex on the boundary: how many quads are to meet there; the boundary stays as it is. Empty: two, and
                                    // nodes may be added between
  std::vector<double> fineness;     // as in DecimationOptions
  const MeshFeatures* features = nullptr;  // curves that stay as they are: quads lie between them
  std::vector<char> on_mirror;             // see DecimationOptions; sides there do not count as the boundary's
};

// Pairs the triangles of a decimated mesh to quads and cleans their connectivity up (doublets removed, edges rotated, diagonals collapsed) until the
// size asked for is reached. All is done by flips and collapses of `mesh`, appended to `log`. Every triangle finds a mate: on a closed mesh the dual
// is cubic and bridgeless (Petersen); one with boundary is doubled along it, and a triangle whose mate is its own double becomes a quad by a node on
// its boundary edge.
QuadLayout make_quad_layout(EditMesh& mesh, const std::vector<Vec3>& points, std::vector<VertexQuadric> quadrics, const QuadLayoutOptions& options,
                            std::vector<MeshEdit>& log, const Progress& progress);

}  // namespace hybrid_mesh
