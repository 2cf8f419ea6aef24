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

// The mean of a vertex (1/4), its neighbours along edges (1/2) and those across its quads (1/4); on a crease or boundary, of the vertex and its
// neighbours along that; where more than two of these meet, the vertex alone.
SparseRows neighbour_mean(const FineMesh& mesh, int size) {
  std::vector<int> valence(size, 0), hard(size, 0);
  for (const auto& corners : mesh.corners)
    for (const int v : corners) ++valence[v];
  for (std::size_t e = 0; e < mesh.ends.size(); ++e)
    for (const int v : mesh.ends[e]) hard[v] += mesh.hard[e];
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(16 * mesh.corners.size());
  for (int v = 0; v < size; ++v) entries.emplace_back(v, v, hard[v] < 2 ? 0.25 : hard[v] == 2 ? 0.5 : 1.0);
  for (const auto& corners : mesh.corners)
    for (int i = 0; i < 4; ++i) {
      const int v = corners[i];
      // An edge between two quads counts twice.
      for (int k = 1; k < 4 && hard[v] < 2; ++k) entries.emplace_back(v, corners[(i + k) % 4], 0.25 / valence[v]);
    }
  for (std::size_t e = 0; e < mesh.ends.size(); ++e)
    for (int i = 0; i < 2 && mesh.hard[e]; ++i)
      if (const int v = mesh.ends[e][i]; hard[v] == 2) entries.emplace_back(v, mesh.ends[e][1 - i], 0.25);
  SparseRows mean(size, size);
  mean.setFromTriplets(entries.begin(), entries.end());
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

SparseRows wavelet_filters(const HybridMesh& hierarchy, const StepMatrix& step) {
  const auto size = static_cast<int>(step.fine.size());
  const int first_centre = step.corners + step.midpoints;
  const SparseRows mean = neighbour_mean(fine_mesh(hierarchy, step), size);
  SparseRows filters = (mean * mean).pruned();
  const CrossingSides crossing(hierarchy, step);
  for (int row = 0; row < size; ++row)
    for (SparseRows::InnerIterator entry(filters, row); entry; ++entry) {
      const auto column = static_cast<int>(entry.col());
      const bool at_midpoint = row >= step.corners && row < first_centre;
      bool turned = at_midpoint;  // of a centre
      if (column < first_centre) turned = row < step.corners || (at_midpoint && crossing(row, column));
      entry.valueRef() *= turned ? -filter_scale : filter_scale;
    }
  filters.prune([&](Eigen::Index, Eigen::Index column, double) { return column >= step.corners; });
  return filters;
}

}  // namespace hybrid_mesh
