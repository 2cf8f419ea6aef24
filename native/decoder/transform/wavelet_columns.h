// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "decoder/transform/refined_rows.h"

namespace hybrid_mesh {

// W of a step: what a detail of a midpoint or of a centre adds to the rows around it. Where subdivision is that of tensor-product cubic splines, the
// columns are orthogonal to those of S.
class WaveletColumns {
 public:
  struct Entry {
    int row;
    double value;
  };
  // `inside`: far_inside() of the level's quads.
  WaveletColumns(const RefinedRows& rows, const std::vector<char>& inside);

  // Calls body(row, value), each row once, in no order. A column is the row of its midpoint or centre.
  template <class Body>
  void for_entries(int column, const Body& body) {
    if (is_regular(column)) {
      std::array<int, 25> row;
      if (rows_->is_midpoint(column)) {
        midpoint_rows(rows_->source(column), row);
        for (int i = 0; i < 25; ++i) body(row[i], midpoint_values[i]);
      } else {
        centre_rows(rows_->source(column), row);
        for (int i = 0; i < 25; ++i) body(row[i], centre_values[i]);
      }
    } else {
      for (const Entry& entry : irregular(column)) body(entry.row, entry.value);
    }
  }

 private:
  // In the order of midpoint_rows() and centre_rows().
  static const std::array<double, 25> midpoint_values, centre_values;
  struct Child {
    std::array<int, 4> row;  // corners
    int place;               // of the row that was asked for
  };

  bool is_regular(int column) const;
  void midpoint_rows(int e, std::array<int, 25>& row) const;
  void centre_rows(int q, std::array<int, 25>& row) const;
  // Of any column; valid until the next one.
  const std::vector<Entry>& irregular(int column);
  // A row's mean_entries(), made once.
  std::span<const Entry> mean_column(int column);
  void mean_entries(int column);
  template <class Body>
  void for_children(int row, const Body& body) const;
  Child child(int quad, int k, int place) const;
  int creases(int row) const;
  int valence(int row) const;
  bool is_crossing(int row, int column) const;
  void add(int row, double value);

  const RefinedRows* rows_;
  std::vector<char>
      regular_;             // #V of the level: the quads around are four, refined, and where nothing can be met twice, without creases between them
  std::vector<int> place_;  // of rows in the list that is being made, -1
  std::vector<Entry> entries_;
  // Means that have been asked for, one after the other, and where a row's begins and ends; -1: not yet.
  std::vector<Entry> means_;
  std::vector<std::array<std::int32_t, 2>> mean_at_;
};

// Of a level's vertices: whether all quads around them are so far inside their trees that within two edges nothing is met on two ways around.
std::vector<char> far_inside(const QuadForest& forest, const LevelQuads& quads);
// Where all trees have the base's quads as roots.
std::vector<char> far_inside(int level, const LevelQuads& quads);

}  // namespace hybrid_mesh
