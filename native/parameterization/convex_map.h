// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A side of a disk that is mapped to a convex polygon: the points along it, both ends included, and optionally where they lie between the side's ends
// (0 .. 1, strictly increasing; by arc length if empty).
struct DiskSide {
  std::vector<int> points;
  std::vector<double> fractions;
};

// Maps disk-shaped parts of one mesh to convex polygons by convex combinations. Keeps a reference to the mesh, which may grow between calls.
class ConvexMap {
 public:
  explicit ConvexMap(const TriangleSurface& mesh) : mesh_(mesh) {}

  // `faces`: the disk. `sides`: of the polygon, counter-clockwise. `polygon`: its corners, side i from corner i to i + 1.
  // No inner edge of the disk may join two points of one side (Tutte's condition). Writes the plane positions of the faces' corners to `corners`, a
  // face. False if no choice of weights gives a map whose triangles are all counter-clockwise in double precision.
  bool operator()(const std::vector<int>& faces, const std::vector<DiskSide>& sides, const std::vector<Vec2>& polygon,
                  std::vector<std::array<Vec2, 3>>& corners);

  // Inner half-edges of the disk that join two points of one side, one an edge and at most one a face: to be split before the disk can be mapped,
  // until there are none.
  std::vector<int> side_chords(const std::vector<int>& faces, const std::vector<DiskSide>& sides);

 private:
  class Embedding;
  std::vector<double> arc_fractions(const std::vector<int>& side) const;

  const TriangleSurface& mesh_;
  std::vector<int> index_;               // per point of the mesh: its row while a disk is mapped, else -1
  std::vector<std::uint64_t> on_sides_;  // per point of the mesh: the sides of the disk at hand that hold it, as bits. Beyond 64 some share one:
                                         // edges are split that need not be
  std::vector<char> in_disk_;            // per face of the mesh
};

}  // namespace hybrid_mesh
