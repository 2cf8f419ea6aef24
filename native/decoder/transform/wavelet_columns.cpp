// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Khodakovsky, Schroeder, Sweldens, Progressive geometry compression, 2000; Guskov, Khodakovsky, Schroeder, Sweldens, Hybrid Meshes, 2002,
// section 4.2. In one dimension a quadrature-mirror wavelet is the scaling function's mask (1, 4, 6, 4, 1), moved by one and with the signs of every
// other entry turned. That mask is the square of (1, 2, 1), a mean over neighbours, which has a meaning on any mesh: W are columns of this
// mean's square, with the signs that the tensor product gives them.
//
// The mean of a vertex (1/4), its neighbours along edges (1/2) and those across its quads (1/4); on a crease or boundary, of the vertex and its
// neighbours along that; where more than two of these meet, the vertex alone.
#include "decoder/transform/wavelet_columns.h"

#include <algorithm>

namespace hybrid_mesh {

namespace {

// Columns of the squared mean times this are as long as those of S.
constexpr double filter_scale = 4;

}  // namespace

const std::array<double, 25> WaveletColumns::midpoint_values = [] {
  std::array<double, 25> value{};
  const std::array<double, 25> in_64ths = {36, -24, -24, 6, 6, 24, 24, -16, -16, -16, -16, 6, 6, -4, -4, -4, -4, 4, 4, 4, 4, 1, 1, 1, 1};
  for (int i = 0; i < 25; ++i) value[i] = in_64ths[i] / 64;
  return value;
}();
const std::array<double, 25> WaveletColumns::centre_values = [] {
  std::array<double, 25> value{};
  const std::array<double, 25> in_64ths = {36, -24, 16, 6, -4, -4, 1, -24, 16, 6, -4, -4, 1, -24, 16, 6, -4, -4, 1, -24, 16, 6, -4, -4, 1};
  for (int i = 0; i < 25; ++i) value[i] = in_64ths[i] / 64;
  return value;
}();

namespace {

// Four quads on every side of a tree, and no turning around a vertex of two quads or one: then no way of up to four edges comes back to where it
// started. Boundaries make no difference.
constexpr int levels_inside = 2;

bool turns_sharply(const LevelQuads& quads) {
  for (int v = 0; v < quads.vertex_count(); ++v)
    if (quads.valence[v] < 3 && quads.across[quads.start[v]] >= 0) return true;
  return false;
}

}  // namespace

std::vector<char> far_inside(int level, const LevelQuads& quads) {
  return std::vector<char>(quads.vertex_count(), level >= levels_inside && !turns_sharply(quads));
}

std::vector<char> far_inside(const QuadForest& forest, const LevelQuads& quads) {
  std::vector<char> inside(quads.vertex_count(), !turns_sharply(quads));
  for (int q = 0; q < quads.quad_count(); ++q) {
    if (forest.level(quads.node[q]) - forest.level(forest.root(quads.node[q])) >= levels_inside) continue;
    for (int i = 0; i < 4; ++i) inside[quads.vertex[4 * q + i]] = 0;
  }
  return inside;
}

WaveletColumns::WaveletColumns(const RefinedRows& rows, const std::vector<char>& inside)
    : rows_(&rows), regular_(inside), place_(rows.size(), -1), mean_at_(rows.size(), {-1, -1}) {
  const LevelQuads& quads = rows.quads();
  for (int v = 0; v < quads.vertex_count(); ++v) regular_[v] = regular_[v] && quads.valence[v] == 4 && rows.valence(v) == 4 && rows.creases(v) == 0;
}

bool WaveletColumns::is_regular(int column) const {
  const LevelQuads& quads = rows_->quads();
  const int of = rows_->source(column);
  const auto all_regular = [&](int q) {
    return regular_[quads.vertex[4 * q]] && regular_[quads.vertex[4 * q + 1]] && regular_[quads.vertex[4 * q + 2]] &&
           regular_[quads.vertex[4 * q + 3]];
  };
  if (!rows_->is_midpoint(column)) return all_regular(of);
  const auto& [left, right] = quads.side[of];
  return left >= 0 && right >= 0 && all_regular(left / 4) && all_regular(right / 4);
}

void WaveletColumns::midpoint_rows(int e, std::array<int, 25>& row) const {
  const LevelQuads& quads = rows_->quads();
  const auto edge = [&](int side) { return rows_->edge_row(quads.edge_at(side)); };
  row[0] = rows_->edge_row(e);
  for (int i = 0; i < 2; ++i) {
    const int side = quads.side[e][i], next = LevelQuads::next(side), opposite = LevelQuads::next(next), last = LevelQuads::next(opposite);
    const int after = quads.across[next], before = quads.across[last];
    row[1 + i] = rows_->vertex_row(quads.vertex[side]);
    row[3 + i] = i == 0 ? edge(LevelQuads::next(after)) : edge(LevelQuads::next(quads.across[LevelQuads::next(quads.side[e][1])]));
    row[5 + i] = rows_->quad_row(side / 4);
    row[7 + 2 * i] = edge(next);
    row[8 + 2 * i] = edge(last);
    row[11 + i] = edge(opposite);
    row[13 + 2 * i] = rows_->vertex_row(quads.vertex[opposite]);
    row[14 + 2 * i] = rows_->vertex_row(quads.vertex[last]);
    row[17 + 2 * i] = rows_->quad_row(after / 4);
    row[18 + 2 * i] = rows_->quad_row(before / 4);
    row[21 + 2 * i] = edge(LevelQuads::previous(after));
    row[22 + 2 * i] = edge(LevelQuads::next(before));
  }
}

void WaveletColumns::centre_rows(int q, std::array<int, 25>& row) const {
  const LevelQuads& quads = rows_->quads();
  row[0] = rows_->quad_row(q);
  for (int i = 0; i < 4; ++i) {
    const int side = 4 * q + i, across = quads.across[side], next = LevelQuads::next(across);
    int* const at = &row[1 + 6 * i];
    at[0] = rows_->edge_row(quads.edge_at(side));
    at[1] = rows_->vertex_row(quads.vertex[side]);
    at[2] = rows_->quad_row(across / 4);
    at[3] = rows_->edge_row(quads.edge_at(next));
    at[4] = rows_->edge_row(quads.edge_at(LevelQuads::previous(across)));
    at[5] = rows_->quad_row(quads.across[next] / 4);
  }
}

// Child k of a refined quad is at its corner k; its corners are that, the middle of side k, the centre, the middle of the side before.
WaveletColumns::Child WaveletColumns::child(int quad, int k, int place) const {
  const LevelQuads& quads = rows_->quads();
  const int side = 4 * quad + k;
  return {{rows_->vertex_row(quads.vertex[side]), rows_->edge_row(quads.edge_at(side)), rows_->quad_row(quad),
           rows_->edge_row(quads.edge_at(LevelQuads::previous(side)))},
          place};
}

template <class Body>
void WaveletColumns::for_children(int row, const Body& body) const {
  const LevelQuads& quads = rows_->quads();
  const int of = rows_->source(row);
  if (rows_->is_midpoint(row)) {
    for (const int side : quads.side[of]) {
      if (side < 0 || !rows_->is_refined(side / 4)) continue;
      body(child(side / 4, side % 4, 1));
      body(child(side / 4, LevelQuads::next(side) % 4, 3));
    }
  } else if (rows_->is_corner(row)) {
    for (int c = quads.start[of];;) {
      if (rows_->is_refined(c / 4)) body(child(c / 4, c % 4, 0));
      c = quads.turned(c);
      if (c < 0 || c == quads.start[of]) break;
    }
  } else {
    for (int k = 0; k < 4; ++k) body(child(of, k, 2));
  }
}

int WaveletColumns::creases(int row) const {
  if (rows_->is_corner(row)) return rows_->creases(rows_->source(row));
  return rows_->is_midpoint(row) && rows_->is_crease(rows_->source(row)) ? 2 : 0;
}

int WaveletColumns::valence(int row) const {
  if (rows_->is_corner(row)) return rows_->valence(rows_->source(row));
  if (!rows_->is_midpoint(row)) return 4;
  int count = 0;
  for (const int side : rows_->quads().side[rows_->source(row)])
    if (side >= 0 && rows_->is_refined(side / 4)) count += 2;
  return count;
}

void WaveletColumns::add(int row, double value) {
  int& place = place_[row];
  if (place < 0) {
    place = static_cast<int>(entries_.size());
    entries_.push_back({row, value});
  } else {
    entries_[place].value += value;
  }
}

// Of whose means a row is a part, and how much of them: by ascending number.
std::span<const WaveletColumns::Entry> WaveletColumns::mean_column(int column) {
  auto& [begin, end] = mean_at_[column];
  if (begin < 0) {
    mean_entries(column);
    begin = static_cast<std::int32_t>(means_.size());
    means_.insert(means_.end(), entries_.begin(), entries_.end());
    end = static_cast<std::int32_t>(means_.size());
  }
  return {means_.data() + begin, static_cast<std::size_t>(end - begin)};
}

void WaveletColumns::mean_entries(int column) {
  const LevelQuads& quads = rows_->quads();
  entries_.clear();
  const auto counted = [](int creases) { return std::min(creases, 3); };
  const int own = counted(creases(column));
  add(column, own < 2 ? 0.25 : own == 2 ? 0.5 : 1.0);
  for_children(column, [&](const Child& child) {
    for (int k = 0; k < 4; ++k)
      // An edge between two quads counts twice.
      if (k != child.place && creases(child.row[k]) < 2) add(child.row[k], 0.25 / valence(child.row[k]));
  });
  const auto along = [&](int row) {
    if (creases(row) == 2) add(row, 0.25);
  };
  if (rows_->is_midpoint(column)) {
    const int e = rows_->source(column);
    for (int i = 0; i < 2 && rows_->is_crease(e); ++i) along(rows_->vertex_row(quads.end(e, i)));
  } else if (rows_->is_corner(column)) {
    const int start = quads.start[rows_->source(column)];
    for (int c = start;;) {
      const int last = LevelQuads::previous(c), turned = quads.across[last];
      for (const int side : {c, last}) {
        if (side == last && turned >= 0) continue;
        const int e = quads.edge_at(side);
        if (rows_->edge_row(e) >= 0 && rows_->is_crease(e)) along(rows_->edge_row(e));
      }
      c = turned;
      if (c < 0 || c == start) break;
    }
  }
  for (const Entry& entry : entries_) place_[entry.row] = -1;
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.row < b.row; });
}

// Whether two midpoints are of sides that share both a quad and an end point.
bool WaveletColumns::is_crossing(int row, int column) const {
  const LevelQuads& quads = rows_->quads();
  const int e = rows_->source(row);
  if (row == column) return false;
  for (const int side : quads.side[rows_->source(column)])
    if (side >= 0 && rows_->is_refined(side / 4) && (quads.edge_at(LevelQuads::next(side)) == e || quads.edge_at(LevelQuads::previous(side)) == e))
      return true;
  return false;
}

const std::vector<WaveletColumns::Entry>& WaveletColumns::irregular(int column) {
  const auto count = static_cast<std::ptrdiff_t>(mean_column(column).size());
  const std::ptrdiff_t first = mean_at_[column][0];
  // Making one mean moves the others.
  for (std::ptrdiff_t i = first; i < first + count; ++i) mean_column(means_[i].row);
  entries_.clear();
  // Each sum goes by ascending rows in the middle.
  for (const Entry& by : mean_column(column))
    for (const Entry& entry : mean_column(by.row)) add(entry.row, entry.value * by.value);
  for (Entry& entry : entries_) {
    place_[entry.row] = -1;
    const bool at_midpoint = rows_->is_midpoint(entry.row);
    bool turned = at_midpoint;  // of a centre
    if (rows_->is_midpoint(column)) turned = rows_->is_corner(entry.row) || (at_midpoint && is_crossing(entry.row, column));
    entry.value *= turned ? -filter_scale : filter_scale;
  }
  return entries_;
}

}  // namespace hybrid_mesh
