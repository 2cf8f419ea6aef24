// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Khodakovsky, Schroeder, Sweldens, Progressive geometry compression, 2000; Guskov, Khodakovsky, Schroeder, Sweldens, Hybrid Meshes, 2002,
// section 4.2. In one dimension a quadrature-mirror wavelet is the scaling function's mask (1, 4, 6, 4, 1), moved by one and with the signs of every
// other entry turned. That mask is the square of (1, 2, 1), a mean over neighbours, which has a meaning on any mesh: W are columns of this
// mean's square, with the signs that the tensor product gives them.
#include "wavelets/wavelet_filters.h"

#include <algorithm>
#include <array>

#include "hierarchy/vertex_index.h"

namespace hybrid_mesh {

namespace {

// Columns of the squared mean times this are as long as those of S.
constexpr double filter_scale = 4;

// The children of a step's refined quads, vertices being rows of the step.
struct FineMesh {
  std::vector<std::array<int, 4>> corners;  // #quads
  std::vector<std::array<int, 2>> ends;     // #E
  std::vector<char> hard;                   // #E: a crease or a boundary
};

FineMesh fine_mesh(const HybridMesh& hierarchy, const StepMatrix& step) {
  const VertexIndex row(step.fine);
  PlaceIndex find;
  FineMesh mesh;
  for (const int node : step.refined)
    for (int k = 0; k < 4; ++k) {
      const int child = hierarchy.first_child(node) + k;
      std::array<int, 4>& corners = mesh.corners.emplace_back();
      for (int i = 0; i < 4; ++i) corners[i] = row(hierarchy.corner(child, i));
      for (int i = 0; i < 4; ++i) {
        const int edge = hierarchy.half_edge(child, i) >> 1;
        const int e = find(edge);
        if (e >= 0) {
          mesh.hard[e] = hierarchy.is_sharp(child, i);
          continue;
        }
        find.set(edge, static_cast<int>(mesh.ends.size()));
        mesh.ends.push_back({corners[i], corners[(i + 1) % 4]});
        mesh.hard.push_back(1);  // until a second quad has it
      }
    }
  return mesh;
}

// A matrix of a few entries a row, those of row r from first[r] on.
struct ShortRows {
  std::vector<int> first, count, column;
  std::vector<double> value;

  explicit ShortRows(const std::vector<int>& most) : first(most.size() + 1, 0), count(most.size(), 0) {
    for (std::size_t r = 0; r < most.size(); ++r) first[r + 1] = first[r] + most[r];
    column.resize(first.back());
    value.resize(first.back());
  }
  void append(int row, int at, double weight) {
    const int place = first[row] + count[row]++;
    column[place] = at;
    value[place] = weight;
  }
  void add(int row, int at, double weight) {
    for (int i = first[row]; i < first[row] + count[row]; ++i)
      if (column[i] == at) {
        value[i] += weight;
        return;
      }
    append(row, at, weight);
  }
  // With entries by ascending column.
  ShortRows transposed() const {
    std::vector<int> counts(count.size(), 0);
    for (std::size_t r = 0; r < count.size(); ++r)
      for (int i = first[r]; i < first[r] + count[r]; ++i) ++counts[column[i]];
    ShortRows result(counts);
    for (std::size_t r = 0; r < count.size(); ++r)
      for (int i = first[r]; i < first[r] + count[r]; ++i) result.append(column[i], static_cast<int>(r), value[i]);
    return result;
  }
};

// The mean of a vertex (1/4), its neighbours along edges (1/2) and those across its quads (1/4); on a crease or boundary, of the vertex and its
// neighbours along that; where more than two of these meet, the vertex alone.
ShortRows neighbour_mean(const FineMesh& mesh, int size) {
  std::vector<int> valence(size, 0), hard(size, 0), most(size, 3);
  for (const auto& corners : mesh.corners)
    for (const int v : corners) ++valence[v];
  for (std::size_t e = 0; e < mesh.ends.size(); ++e)
    for (const int v : mesh.ends[e]) hard[v] += mesh.hard[e];
  for (int v = 0; v < size; ++v)
    if (hard[v] < 2) most[v] = 1 + 3 * valence[v];
  ShortRows mean(most);
  for (int v = 0; v < size; ++v) mean.add(v, v, hard[v] < 2 ? 0.25 : hard[v] == 2 ? 0.5 : 1.0);
  for (const auto& corners : mesh.corners)
    for (int i = 0; i < 4; ++i) {
      const int v = corners[i];
      // An edge between two quads counts twice.
      for (int k = 1; k < 4 && hard[v] < 2; ++k) mean.add(v, corners[(i + k) % 4], 0.25 / valence[v]);
    }
  for (std::size_t e = 0; e < mesh.ends.size(); ++e)
    for (int i = 0; i < 2 && mesh.hard[e]; ++i)
      if (const int v = mesh.ends[e][i]; hard[v] == 2) mean.add(v, mesh.ends[e][1 - i], 0.25);
  return mean;
}

// Sides of refined quads that share both a quad and an end point, by their midpoints' rows.
class CrossingSides {
 public:
  CrossingSides(const HybridMesh& hierarchy, const StepMatrix& step) : first_(step.corners), crossing_(step.midpoints, {-1, -1, -1, -1}) {
    const VertexIndex row(step.fine);
    for (const int node : step.refined)
      for (int i = 0; i < 4; ++i) {
        const int a = side(hierarchy, row, node, i), b = side(hierarchy, row, node, (i + 1) % 4);
        add(a, b);
        add(b, a);
      }
  }
  bool operator()(int row, int column) const {
    const auto& list = crossing_[row - first_];
    return std::find(list.begin(), list.end(), column) != list.end();
  }

 private:
  static int side(const HybridMesh& hierarchy, const VertexIndex& row, int node, int i) {
    return row(VertexId(VertexId::Kind::Edge, hierarchy.half_edge(node, i) >> 1));
  }
  void add(int row, int column) {
    if (row != column) *std::find(crossing_[row - first_].begin(), crossing_[row - first_].end(), -1) = column;
  }

  int first_;
  std::vector<std::array<int, 4>> crossing_;
};

}  // namespace

WaveletFilters wavelet_filters(const HybridMesh& hierarchy, const StepMatrix& step) {
  const auto size = static_cast<int>(step.fine.size());
  const int first_centre = step.corners + step.midpoints;
  const ShortRows mean = neighbour_mean(fine_mesh(hierarchy, step), size).transposed();
  const CrossingSides crossing(hierarchy, step);
  WaveletFilters filters;
  filters.first.assign(step.corners + 1, 0);
  filters.entries.reserve(25 * static_cast<std::size_t>(size - step.corners));
  std::vector<int> place(size, -1);  // of a row in the column, from its first entry
  for (int column = step.corners; column < size; ++column) {
    const std::size_t first = filters.entries.size();
    for (int i = mean.first[column]; i < mean.first[column + 1]; ++i)
      for (int k = mean.first[mean.column[i]]; k < mean.first[mean.column[i] + 1]; ++k) {
        const int row = mean.column[k];
        if (place[row] < 0) {
          place[row] = static_cast<int>(filters.entries.size() - first);
          filters.entries.push_back({row, 0});
        }
        filters.entries[first + place[row]].value += mean.value[k] * mean.value[i];
      }
    for (std::size_t e = first; e < filters.entries.size(); ++e) {
      WaveletFilters::Entry& entry = filters.entries[e];
      const bool at_midpoint = entry.row >= step.corners && entry.row < first_centre;
      bool turned = at_midpoint;  // of a centre
      if (column < first_centre) turned = entry.row < step.corners || (at_midpoint && crossing(entry.row, column));
      entry.value *= turned ? -filter_scale : filter_scale;
      place[entry.row] = -1;
    }
    filters.first.push_back(filters.entries.size());
  }
  return filters;
}

}  // namespace hybrid_mesh
