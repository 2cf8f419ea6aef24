// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "decoder/transform/level_quads.h"

namespace hybrid_mesh {

// What a level's refined quads are made into: rows, numbered from 0 on, for their corners, then for midpoints of their sides, then for their centres,
// each in the order of the level's quads. The children of refined quads are a mesh whose vertices are these rows.
class RefinedRows {
 public:
  RefinedRows(const QuadForest& forest, const LevelQuads& quads);
  // All quads are refined.
  explicit RefinedRows(const LevelQuads& quads)
      : quads_(&quads), corners_(quads.vertex_count()), midpoints_(quads.edge_count()), centres_(quads.quad_count()) {}

  const LevelQuads& quads() const { return *quads_; }
  int corners() const { return corners_; }
  int midpoints() const { return midpoints_; }
  int size() const { return corners_ + midpoints_ + centres_; }
  bool is_corner(int row) const { return row < corners_; }
  bool is_midpoint(int row) const { return row >= corners_ && row < corners_ + midpoints_; }

  // -1: not of a refined quad.
  int vertex_row(int v) const { return whole_ ? v : vertex_row_[v]; }
  int edge_row(int e) const { return whole_ ? corners_ + e : edge_row_[e]; }
  int quad_row(int q) const { return whole_ ? corners_ + midpoints_ + q : quad_row_[q]; }
  bool is_refined(int q) const { return whole_ || quad_row_[q] >= 0; }
  bool is_whole() const { return whole_; }  // all quads are refined
  // What a row is made of: a vertex, an edge or a quad of the level.
  int source(int row) const {
    return whole_ ? (row < corners_ ? row : is_midpoint(row) ? row - corners_ : row - corners_ - midpoints_) : source_[row];
  }
  VertexId name(const QuadForest& forest, int row) const;

  // Among the children: of a vertex of the level, how many there are around it, and how many edges that are sharp or have a child on one side only;
  // of an edge, whether its halves are such.
  int valence(int v) const { return whole_ ? quads_->valence[v] : valence_[v]; }
  int creases(int v) const { return whole_ ? quads_->creases[v] : creases_[v]; }
  bool is_crease(int e) const { return quads_->sharp[e] || refined_sides(e) < 2; }

 private:
  int refined_sides(int e) const {
    int count = 0;
    for (const int side : quads_->side[e]) count += side >= 0 && is_refined(side / 4);
    return count;
  }

  const LevelQuads* quads_;
  int corners_ = 0, midpoints_ = 0, centres_ = 0;
  bool whole_ = true;
  std::vector<int> vertex_row_, edge_row_, quad_row_, source_, valence_, creases_;  // empty if all quads are refined
};

}  // namespace hybrid_mesh
