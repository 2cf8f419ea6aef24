// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/context.h"
#include "layout/base/mesh_features.h"
#include "layout/base/quadric.h"
#include "surface/edit_mesh.h"

namespace hybrid_mesh {

// One operation of a decimation, in the order of the log: a half-edge collapse or an edge flip.
struct MeshEdit {
  enum class Kind : std::uint8_t { Collapse, Flip };
  Kind kind;
  int half_edge;
};

struct DecimationOptions {
  int target_faces = 600;
  double evenness = 0.005;  // weight of the longest new edge squared against the squared distance to the surface
  std::uint64_t seed = 1;   // breaks near-ties only
  std::vector<char> fixed;  // per vertex: stays; all other boundary vertices go, whatever the number of faces. Empty: none is fixed, and the boundary
                            // is simplified with the rest
  const MeshFeatures* features = nullptr;  // curves that stay, the boundary among them; the faces between them stay even in number
  double curve_edge = 0;                   // how long the edges of curves are to be
  std::vector<double> fineness;            // per vertex, by how much lengths count more there; empty: the same everywhere
  // Per vertex: it is on a boundary along which the surface is to be joined with its mirror image. No edge but the boundary's joins two of them, or
  // there would be two edges between the same vertices. Empty: none is.
  std::vector<char> on_mirror;
};

// Collapses `mesh`, whose vertices lie at `points` (scaled to a unit bounding-box diagonal), until at most `target_faces` are left or nothing can be
// collapsed, and flips a few edges where a curve or a mirror could not be made even otherwise; closed components keep enough for the quads of a cube;
// every operation is appended to `log`. Vertices stay where they are, so that those left are points of the input. Refuses an operation for topology
// alone; shape, evenness, valence and the distance to the surface enter through its cost. Returns what each vertex left stands for.
std::vector<VertexQuadric> decimate(EditMesh& mesh, const std::vector<Vec3>& points, const DecimationOptions& options, std::vector<MeshEdit>& log,
                                    const Progress& progress);

}  // namespace hybrid_mesh
