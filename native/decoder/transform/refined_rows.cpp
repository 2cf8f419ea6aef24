// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/refined_rows.h"

#include <algorithm>

namespace hybrid_mesh {

RefinedRows::RefinedRows(const QuadForest& forest, const LevelQuads& quads) : quads_(&quads) {
  whole_ = std::all_of(quads.node.begin(), quads.node.end(), [&](int node) { return forest.first_child(node) >= 0; });
  if (whole_) {
    corners_ = quads.vertex_count();
    midpoints_ = quads.edge_count();
    centres_ = quads.quad_count();
    return;
  }
  vertex_row_.assign(quads.vertex_count(), -1);
  edge_row_.assign(quads.edge_count(), -1);
  quad_row_.assign(quads.quad_count(), -1);
  valence_.assign(quads.vertex_count(), 0);
  creases_.assign(quads.vertex_count(), 0);
  for (int q = 0; q < quads.quad_count(); ++q) {
    if (forest.first_child(quads.node[q]) < 0) continue;
    quad_row_[q] = 0;
    for (int i = 0; i < 4; ++i) {
      vertex_row_[quads.vertex[4 * q + i]] = edge_row_[quads.edge_at(4 * q + i)] = 0;
      ++valence_[quads.vertex[4 * q + i]];
    }
  }
  const auto number = [&](std::vector<int>& rows, int& count) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i] < 0) continue;
      rows[i] = static_cast<int>(source_.size());
      source_.push_back(static_cast<int>(i));
      ++count;
    }
  };
  number(vertex_row_, corners_);
  number(edge_row_, midpoints_);
  number(quad_row_, centres_);
  for (int e = 0; e < quads.edge_count(); ++e)
    if (edge_row_[e] >= 0 && is_crease(e))
      for (int i = 0; i < 2; ++i) ++creases_[quads.end(e, i)];
}

VertexId RefinedRows::name(const QuadForest& forest, int row) const {
  const int of = source(row);
  if (is_midpoint(row)) return {VertexId::Kind::Edge, quads_->edge[of]};
  if (!is_corner(row)) return {VertexId::Kind::Node, quads_->node[of]};
  const int corner = quads_->start[of];
  return forest.corner(quads_->node[corner / 4], corner % 4);
}

}  // namespace hybrid_mesh
