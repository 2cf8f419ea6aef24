// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/level_step.h"

#include <utility>

namespace hybrid_mesh {

LevelStep::LevelStep(const QuadForest& forest, const MeshNames& coarse, const MeshNames& fine, int level, BoundaryRule boundary)
    : prediction_(forest, coarse, fine, level, boundary), inside_(far_inside(forest, prediction_.quads())) {
  find_details();
  find_operations(forest, fine, level);
  is_regular_ = prediction_.rows().is_whole() && coarse.node.size() == prediction_.quads().node.size() && fine.node.size() == 4 * coarse.node.size();
  for (int o = 0; o < forest.operation_count(); ++o) is_regular_ &= !forest.operation(o).enabled || forest.operation(o).repatch.level != level;
}

LevelStep::LevelStep(LevelQuads quads, std::vector<int> rows, int level)
    : prediction_(std::move(quads), std::move(rows)), inside_(far_inside(level - 1, prediction_.quads())), is_regular_(true) {
  find_details();
}

void LevelStep::find_details() {
  const RefinedRows& rows = prediction_.rows();
  constexpr int none = -1;
  std::vector<signed char> kind(prediction_.count(), none);
  for (int row = rows.corners(); row < rows.size(); ++row)
    if (const int v = prediction_.vertex_at[row]; v >= 0)
      kind[v] = static_cast<signed char>(rows.is_midpoint(row) ? DetailKind::Edge : DetailKind::Face);
  for (const int v : prediction_.inserted) kind[v] = static_cast<signed char>(DetailKind::Inserted);
  for (const LevelPrediction::Mean& mean : prediction_.closing) kind[mean.vertex] = static_cast<signed char>(DetailKind::Closing);
  std::vector<int> at(prediction_.count(), -1);
  details_.reserve(prediction_.count());
  for (int v = 0; v < static_cast<int>(kind.size()); ++v) {
    if (kind[v] == none) continue;
    at[v] = static_cast<int>(details_.size());
    details_.push_back({v, static_cast<DetailKind>(kind[v])});
  }
  detail_of_.reserve(prediction_.vertex_at.size());
  for (const int v : prediction_.vertex_at) detail_of_.push_back(v < 0 ? -1 : at[v]);
}

void LevelStep::find_operations(const QuadForest& forest, const MeshNames& fine, int level) {
  if (prediction_.inserted.empty()) return;
  std::vector<Known> known(prediction_.count(), Known::Yes);
  for (const int v : prediction_.inserted) known[v] = Known::No;
  const VertexIndex find(fine.vertex);
  std::vector<std::array<int, 2>> edges;
  for (int o = 0; o < forest.operation_count(); ++o) {
    const QuadForest::Operation& operation = forest.operation(o);
    if (!operation.enabled || operation.repatch.level != level) continue;
    for (const int root : operation.roots)
      for (int i = 0; i < 4; ++i) edges.push_back({find(forest.corner(root, i)), find(forest.corner(root, (i + 1) % 4))});
  }
  extension_.emplace(edges, known);
}

void LevelStep::extend(Point3* points) const {
  if (!extension_) return;
  for (const int v : prediction_.inserted) points[v] = {};
  extension_->extend(points);
}

void LevelStep::subdivided(const Point3* coarse, Point3* fine) const {
  prediction_.regular(coarse, fine);
  extend(fine);
  prediction_.close(fine);
}

void LevelStep::add_details(Point3* fine, const Point3* details, const Point3* remainder) const {
  const RefinedRows& rows = prediction_.rows();
  WaveletColumns wavelets = columns();
  // Each vertex has its sum in the order of the columns.
  for (int column = rows.corners(); column < rows.size(); ++column) {
    const int d = detail_of_[column];
    if (d < 0 || details[d].is_zero()) continue;
    const Point3 detail = details[d];
    wavelets.for_entries(column, [&](int row, double value) {
      if (const int v = prediction_.vertex_at[row]; v >= 0) fine[v] += value * detail;
    });
  }
  if (remainder)
    for (std::size_t v = 0; v < prediction_.count(); ++v) fine[v] += remainder[v];
  extend(fine);
  const auto add = [&](DetailKind kind) {
    for (std::size_t d = 0; d < details_.size(); ++d)
      if (details_[d].kind == kind) fine[details_[d].vertex] += details[d];
  };
  add(DetailKind::Inserted);
  prediction_.close(fine);
  add(DetailKind::Closing);
}

}  // namespace hybrid_mesh
