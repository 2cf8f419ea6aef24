// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "decoder/transform/point.h"

namespace hybrid_mesh {

// Normal and two tangents of a vertex, orthonormal.
using Frame = std::array<Point3, 3>;

inline constexpr Frame coordinate_axes = {Point3{1, 0, 0}, Point3{0, 1, 0}, Point3{0, 0, 1}};

// Of a mesh's vertices. Additions, products, quotients and roots in an order that the mesh gives: wherever doubles are those of IEEE 754 and no two
// operations are made one, the same bits.
class SurfaceFrames {
 public:
  // `offsets`: #F + 1, `indices` of the faces' corners; `points`: `count` of them, which must outlast this. `wanted`: of which vertices frames are
  // asked for; null: of any.
  SurfaceFrames(const std::vector<std::int64_t>& offsets, const std::vector<std::int32_t>& indices, const Point3* points, std::size_t count,
                const char* wanted = nullptr);
  Frame operator()(int vertex) const;

 private:
  const Point3* points_;
  std::vector<Point3> normal_;
  std::vector<std::int32_t> next_;  // of each vertex: the next corner in its first face, -1
};

}  // namespace hybrid_mesh
