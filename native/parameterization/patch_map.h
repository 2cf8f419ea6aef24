// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A piecewise linear, bijective map from the unit square to a disk-shaped part of a surface: a triangulation of the square whose
// vertices carry where they lie. Corner 0 of the patch is (0, 0), then counter-clockwise (1, 0), (1, 1), (0, 1); side i runs from
// corner i to corner i + 1. Sides are exact: their vertices have u or v equal to exactly 0 or 1, and appear in strictly monotone order.
struct PatchMap {
  std::vector<Vec2> uv;                       // #V
  std::vector<Vec3> positions;                // #V
  std::vector<std::array<int, 3>> triangles;  // #T, counter-clockwise in uv
  std::vector<int> source_face;               // #T: face of the repaired surface that the triangle lies on
  std::vector<std::array<float, 9>> source;   // #T: barycentrics of the three corners in that face, corner by corner
  std::vector<char> inserted;                 // #V: is it one that cutting the surface has put in, so that it may go? Empty: none is known to be

  bool is_inserted(std::size_t v) const { return !inserted.empty() && inserted[v]; }
  // Gives back the room that was kept for growing.
  void compact() {
    uv.shrink_to_fit();
    positions.shrink_to_fit();
    triangles.shrink_to_fit();
    source_face.shrink_to_fit();
    source.shrink_to_fit();
  }
  bool is_on_side(std::size_t v, int side) const { return (side % 2 == 0 ? uv[v].y() : uv[v].x()) == (side == 0 || side == 3 ? 0.0 : 1.0); }
};

// Where its corners lie.
std::array<Vec3, 4> corner_positions(const PatchMap& map);

// What a map gives at a point of the square.
struct PatchSample {
  Vec3 position;
  SurfacePoint source;
  int triangle = -1;
};

// Finds the triangle that holds (u, v) in [0, 1]^2 by walking from a bucket's triangle. The answer depends on (u, v) alone, and any thread may
// ask. Keeps a pointer to the map.
class PatchSampler {
 public:
  explicit PatchSampler(const PatchMap& map);
  PatchSample operator()(double u, double v) const;

 private:
  const PatchMap* map_;
  std::vector<std::array<int, 3>> neighbours_;  // across the edge opposite to corner i, -1 on a side
  std::vector<int> start_;                      // triangle to start from, per bucket of a buckets_ x buckets_ grid
  int buckets_ = 1;

  int locate(double u, double v, std::array<double, 3>& weights) const;
  int search_all(double u, double v, std::array<double, 3>& weights) const;
};

// Area of the surface under each of the n x n equal cells of the square, row by row (v outer). Exact up to rounding: the triangles are clipped.
std::vector<double> cell_areas(const PatchMap& map, int n);

// Checks with exact orientation predicates that the triangles tile the square: every triangle counter-clockwise, manifold disk connectivity, one
// boundary loop whose vertices lie on the four sides in strictly monotone order. Returns an empty string or what is wrong.
const char* find_map_defect(const PatchMap& map);

}  // namespace hybrid_mesh
