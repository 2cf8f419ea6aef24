// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/level_prediction.h"

#include <utility>

#include "decoder/error.h"

namespace hybrid_mesh {

LevelPrediction::Mean vertices_closed(const QuadForest& forest, const VertexIndex& find, VertexId closing, int vertex) {
  LevelPrediction::Mean result;
  result.vertex = vertex;
  if (closing.kind() == VertexId::Kind::Edge)
    for (int h = 0; h < 2; ++h) result.of[result.count++] = find(forest.from(2 * closing.index() + h));
  if (closing.kind() == VertexId::Kind::Node)
    for (int i = 0; i < 4; ++i) result.of[result.count++] = find(forest.corner(closing.index(), i));
  bool all = result.count > 0;
  for (int i = 0; i < result.count; ++i) all = all && result.of[i] >= 0;
  if (!all) throw Error(ErrorCode::Internal, "a vertex of a level that nothing has made");
  return result;
}

Point3 mean_of(const Point3* points, const LevelPrediction::Mean& mean) {
  Point3 sum;
  for (int i = 0; i < mean.count; ++i) sum += points[mean.of[i]];
  return sum / static_cast<double>(mean.count);
}

LevelPrediction::LevelPrediction(const QuadForest& forest, const MeshNames& coarse, const MeshNames& mesh, int level, BoundaryRule boundary)
    : quads_(level_quads(forest, coarse.node, coarse.vertex, level - 1)),
      rows_(forest, quads_),
      boundary_(boundary),
      coarse_count_(coarse.vertex.size()),
      count_(mesh.vertex.size()) {
  const VertexIndex find(mesh.vertex);
  std::vector<char> refined(count_, 0);
  vertex_at.reserve(rows_.size());
  for (int row = 0; row < rows_.size(); ++row) {
    const VertexId name = rows_.is_corner(row) ? coarse.vertex[quads_.in_mesh[rows_.source(row)]] : rows_.name(forest, row);
    vertex_at.push_back(find(name));
    if (vertex_at.back() >= 0) refined[vertex_at.back()] = 1;
  }
  std::vector<int> others;
  for (int v = 0; v < static_cast<int>(count_); ++v)
    if (!refined[v]) others.push_back(v);
  if (others.empty()) return;
  const VertexIndex find_coarse(coarse.vertex);
  for (const int v : others) {
    const VertexId vertex = mesh.vertex[v];
    if (const int c = find_coarse(vertex); c >= 0)
      stays.push_back({c, v});
    else if (vertex.kind() == VertexId::Kind::Free)
      inserted.push_back(v);
    else
      closing.push_back(vertices_closed(forest, find, vertex, v));
  }
}

LevelPrediction::LevelPrediction(LevelQuads quads, std::vector<int> rows)
    : vertex_at(std::move(rows)),
      quads_(std::move(quads)),
      rows_(quads_),
      boundary_(BoundaryRule::EdgesOnly),
      coarse_count_(quads_.in_mesh.size()),
      count_(vertex_at.size()) {}

void LevelPrediction::regular(const Point3* coarse, Point3* points) const {
  SubdivisionMasks masks(quads_, coarse_count_, boundary_);
  for (const int v : inserted) points[v] = {};
  for (const Mean& mean : closing) points[mean.vertex] = {};
  for (const auto& [c, v] : stays) points[v] = coarse[c];
  const int centres = rows_.corners() + rows_.midpoints();
  for (int row = 0; row < rows_.corners(); ++row)
    if (const int v = vertex_at[row]; v >= 0) points[v] = masks.vertex_point(rows_.source(row), coarse);
  for (int row = rows_.corners(); row < centres; ++row)
    if (const int v = vertex_at[row]; v >= 0) points[v] = masks.edge_point(rows_.source(row), coarse);
  for (int row = centres; row < rows_.size(); ++row)
    if (const int v = vertex_at[row]; v >= 0) points[v] = masks.quad_point(rows_.source(row), coarse);
}

void LevelPrediction::close(Point3* points) const {
  for (const Mean& mean : closing) points[mean.vertex] = mean_of(points, mean);
}

}  // namespace hybrid_mesh
