// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/self_intersections.h"

#include <algorithm>
#include <cstdint>

#include "base/parallel.h"
#include "surface/closest_point.h"
#include "surface/triangle_intersection.h"

namespace hybrid_mesh {

std::vector<SelfIntersection> find_self_intersections(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& faces,
                                                      const Progress& progress) {
  std::vector<SelfIntersection> found;
  if (faces.empty()) {
    progress(1);
    return found;
  }
  const SurfaceDistanceQuery query(points, faces);
  const auto corners = [&](int f) { return TriangleCorners{&points[faces[f][0]], &points[faces[f][1]], &points[faces[f][2]]}; };
  constexpr std::int64_t block_size = 1024;
  const auto count = static_cast<std::int64_t>(faces.size());
  std::vector<std::vector<SelfIntersection>> blocks((count + block_size - 1) / block_size);
  parallel_for_each_index(static_cast<std::int64_t>(blocks.size()), [&](std::int64_t block) {
    std::vector<int> near;
    for (std::int64_t i = block * block_size; i < std::min(count, (block + 1) * block_size); ++i) {
      progress.check();
      const int f = static_cast<int>(i);
      const TriangleCorners t = corners(f);
      query.faces_in_box(t[0]->cwiseMin(*t[1]).cwiseMin(*t[2]), t[0]->cwiseMax(*t[1]).cwiseMax(*t[2]), faces.size(), near);
      std::sort(near.begin(), near.end());
      for (const int g : near)
        if (g > f && triangles_meet(t, corners(g))) blocks[block].push_back({{f, g}, common_polygon(t, corners(g))});
    }
  });
  for (const auto& block : blocks) found.insert(found.end(), block.begin(), block.end());
  progress(1);
  return found;
}

}  // namespace hybrid_mesh
