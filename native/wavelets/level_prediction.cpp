// SPDX-License-Identifier: GPL-3.0-or-later
#include "wavelets/level_prediction.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "hierarchy/vertex_index.h"

namespace hybrid_mesh {

std::vector<int> vertices_closed(const HybridMesh& hierarchy, const VertexIndex& find, VertexId closing) {
  std::vector<int> result;
  if (closing.kind() == VertexId::Kind::Edge)
    for (int h = 0; h < 2; ++h) result.push_back(find(hierarchy.from(2 * closing.index() + h)));
  if (closing.kind() == VertexId::Kind::Node)
    for (int i = 0; i < 4; ++i) result.push_back(find(hierarchy.corner(closing.index(), i)));
  bool all = !result.empty();
  for (const int v : result) all = all && v >= 0;
  if (!all) throw Error(ErrorCode::Internal, "a vertex of a level that nothing has made");
  return result;
}

Vec3 mean_of(const std::vector<Vec3>& points, const std::vector<int>& vertices) {
  Vec3 sum = Vec3::Zero();
  for (const int v : vertices) sum += points[v];
  return sum / static_cast<double>(vertices.size());
}

LevelPrediction::LevelPrediction(const HybridMesh& hierarchy, const QuadMesh& coarse, const QuadMesh& mesh, int level, BoundaryRule boundary)
    : step(step_matrix(hierarchy, coarse, level, boundary)), count_(mesh.vertex_count()) {
  const VertexIndex find(mesh.vertex), find_coarse(coarse.vertex);
  std::vector<char> refined(count_, 0);
  for (const VertexId vertex : step.fine) {
    vertex_at.push_back(find(vertex));
    if (vertex_at.back() >= 0) refined[vertex_at.back()] = 1;
  }
  for (int v = 0; v < static_cast<int>(count_); ++v) {
    if (refined[v]) continue;
    const VertexId vertex = mesh.vertex[v];
    if (const int c = find_coarse(vertex); c >= 0)
      stays.push_back({c, v});
    else if (vertex.kind() == VertexId::Kind::Free)
      inserted.push_back(v);
    else
      closing.push_back({v, vertices_closed(hierarchy, find, vertex)});
  }
}

std::vector<Vec3> LevelPrediction::regular(const std::vector<Vec3>& coarse) const {
  std::vector<Vec3> points(count_, Vec3::Zero());
  for (const auto& [c, v] : stays) points[v] = coarse[c];
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertex_at.size(), 2048), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t r = range.begin(); r < range.end(); ++r) {
      if (vertex_at[r] < 0) continue;
      Vec3 sum = Vec3::Zero();
      for (decltype(step.weights)::InnerIterator entry(step.weights, static_cast<Eigen::Index>(r)); entry; ++entry)
        sum += entry.value() * coarse[entry.col()];
      points[vertex_at[r]] = sum;
    }
  });
  return points;
}

void LevelPrediction::close(std::vector<Vec3>& points) const {
  for (const Mean& mean : closing) points[mean.vertex] = mean_of(points, mean.of);
}

}  // namespace hybrid_mesh
