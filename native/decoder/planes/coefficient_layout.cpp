// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/planes/coefficient_layout.h"

#include <algorithm>
#include <span>

#include "decoder/planes/coefficient_scale.h"

namespace hybrid_mesh {

namespace {

// The vertices one edge away from each, as the mesh's faces have them.
class FaceStars {
 public:
  explicit FaceStars(const LevelMesh& mesh) : first_(mesh.vertex_count() + 1, 0), count_(mesh.vertex_count(), 0) {
    for (const int v : mesh.indices) first_[v + 1] += 2;
    for (std::size_t v = 0; v < count_.size(); ++v) first_[v + 1] += first_[v];
    other_.resize(first_.back());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      for (std::int64_t c = mesh.offsets[f]; c < mesh.offsets[f + 1]; ++c) {
        const int a = mesh.indices[c], b = mesh.indices[c + 1 < mesh.offsets[f + 1] ? c + 1 : mesh.offsets[f]];
        add(a, b);
        add(b, a);
      }
  }
  std::span<const int> operator()(int v) const { return {other_.data() + first_[v], static_cast<std::size_t>(count_[v])}; }

 private:
  void add(int a, int b) {
    const auto begin = other_.begin() + first_[a], end = begin + count_[a];
    if (a == b || std::find(begin, end, b) != end) return;
    *end = b;
    ++count_[a];
  }

  std::vector<std::size_t> first_;
  std::vector<int> count_, other_;
};

// The same where the mesh is the children of a level's quads and nothing else: as these have them. Vertices are rows.
class RowStars {
 public:
  explicit RowStars(const RefinedRows& rows) : rows_(rows) {}
  std::vector<int> operator()(int row) const {
    const LevelQuads& quads = rows_.quads();
    const int of = rows_.source(row);
    std::vector<int> star;
    const auto add = [&](int other) {
      if (std::find(star.begin(), star.end(), other) == star.end()) star.push_back(other);
    };
    if (rows_.is_corner(row)) {
      for_spokes(quads, of, [&](int e) { add(rows_.edge_row(e)); });
    } else if (rows_.is_midpoint(row)) {
      for (int i = 0; i < 2; ++i) add(rows_.vertex_row(quads.end(of, i)));
      for (const int side : quads.side[of])
        if (side >= 0) add(rows_.quad_row(side / 4));
    } else {
      for (int i = 0; i < 4; ++i) add(rows_.edge_row(quads.edge_at(4 * of + i)));
    }
    return star;
  }
  // Calls body(edge) for the edges around a vertex.
  template <class Body>
  static void for_spokes(const LevelQuads& quads, int v, const Body& body) {
    const int start = quads.start[v];
    for (int c = start;;) {
      body(quads.edge_at(c));
      const int last = LevelQuads::previous(c);
      c = quads.across[last];
      if (c < 0) body(quads.edge_at(last));
      if (c < 0 || c == start) return;
    }
  }

 private:
  const RefinedRows& rows_;
};

// Finds the neighbours of items. Those one edge away count twice, and so do those that one way of two edges leads to; where there are several such
// ways, once. A vertex's star is what `stars` has of it, its item what `item_at` has.
template <class Stars>
class NeighbourSearch {
 public:
  NeighbourSearch(const Stars& stars, const std::vector<int>& item_at) : stars_(stars), item_at_(item_at), place_(item_at.size(), -1) {}
  void add(CoefficientLayout& layout, int vertex) {
    const auto star = stars_(vertex);
    for (const int v : star)
      for (const int w : stars_(v)) add(layout, vertex, w, false);
    for (const int v : star) add(layout, vertex, v, true);
    for (const int v : found_) place_[v] = -1;
    found_.clear();
  }

 private:
  void add(CoefficientLayout& layout, int vertex, int v, bool again) {
    if (v == vertex || item_at_[v] < 0) return;
    if (place_[v] >= 0) {
      layout.neighbours[place_[v]].twice = again;
      return;
    }
    place_[v] = static_cast<std::ptrdiff_t>(layout.neighbours.size());
    found_.push_back(v);
    layout.neighbours.push_back({static_cast<std::uint32_t>(item_at_[v]), 1});
  }

  const Stars& stars_;
  const std::vector<int>& item_at_;
  std::vector<std::ptrdiff_t> place_;  // #vertices: in the layout's neighbours, of those that are found
  std::vector<int> found_;
};

void end_neighbours(CoefficientLayout& layout) {
  std::uint32_t weight = 0;
  for (std::size_t k = layout.first_neighbour.back(); k < layout.neighbours.size(); ++k) weight += 1 + layout.neighbours[k].twice;
  layout.weight.push_back(weight);
  layout.first_neighbour.push_back(layout.neighbours.size());
}

// Of a mesh that is the children of a level's quads and nothing else.
class RegularLayout {
 public:
  RegularLayout(const LevelStep& step, CoefficientLayout& layout)
      : step_(step),
        rows_(step.prediction().rows()),
        quads_(step.prediction().quads()),
        layout_(layout),
        inside_(step.inside()),
        row_at_(step.prediction().count(), -1),
        stars_(rows_),
        search_(stars_, step.detail_of()) {
    for (int row = 0; row < rows_.size(); ++row) row_at_[step.prediction().vertex_at[row]] = row;
  }
  void make() {
    layout_.neighbours.reserve(10 * layout_.items.size());
    layout_.first_neighbour.reserve(layout_.items.size() + 1);
    layout_.weight.reserve(layout_.items.size());
    layout_.parents.reserve(layout_.items.size());
    for (const CoefficientLayout::Item& item : layout_.items) {
      const int row = row_at_[item.vertex], of = rows_.source(row);
      if (rows_.is_midpoint(row))
        add_midpoint(row, of);
      else
        add_centre(row, of);
      end_neighbours(layout_);
    }
    layout_.bare.reserve(rows_.corners());
    layout_.first_beside.reserve(rows_.corners() + 1);
    layout_.beside.reserve(2 * static_cast<std::size_t>(rows_.midpoints()));
    for (int v = 0; v < static_cast<int>(row_at_.size()); ++v) {
      if (!rows_.is_corner(row_at_[v])) continue;
      layout_.bare.push_back(v);
      const int corner = rows_.source(row_at_[v]);
      if (inside_[corner])
        RowStars::for_spokes(quads_, corner, [&](int e) { layout_.beside.push_back(step_.detail_of()[rows_.edge_row(e)]); });
      else
        for (const int row : stars_(row_at_[v])) layout_.beside.push_back(step_.detail_of()[row]);
      layout_.first_beside.push_back(layout_.beside.size());
    }
  }

 private:
  void add(int row, bool twice) { layout_.neighbours.push_back({static_cast<std::uint32_t>(step_.detail_of()[row]), twice}); }
  void add_midpoint(int row, int e) {
    layout_.parents.push_back({quads_.in_mesh[quads_.end(e, 0)], quads_.in_mesh[quads_.end(e, 1)], -1, -1});
    if (!inside_[quads_.end(e, 0)] || !inside_[quads_.end(e, 1)]) return search_.add(layout_, row);
    // Two ways lead to the sides beside it in its quads: over its end and over the centre.
    const auto& [left, right] = quads_.side[e];
    for (const int side : {left, right}) {
      if (side < 0) continue;
      const int next = LevelQuads::next(side);
      add(rows_.quad_row(side / 4), true);
      add(rows_.edge_row(quads_.edge_at(LevelQuads::next(next))), true);
      add(rows_.edge_row(quads_.edge_at(next)), false);
      add(rows_.edge_row(quads_.edge_at(LevelQuads::previous(side))), false);
    }
    // The other edges at its ends.
    for (int i = 0; i < 2; ++i) {
      const int v = quads_.end(e, i), side = quads_.side[e][i];
      if (quads_.valence[v] == 4 && left >= 0 && right >= 0 && quads_.across[quads_.start[v]] >= 0) {
        add(rows_.edge_row(quads_.edge_at(LevelQuads::previous(quads_.across[LevelQuads::previous(side)]))), true);
        continue;
      }
      std::array<int, 4> beside{-1, -1, -1, -1};
      for (int k = 0; k < 2; ++k)
        if (const int s = quads_.side[e][k]; s >= 0) {
          beside[2 * k] = quads_.edge_at(LevelQuads::next(s));
          beside[2 * k + 1] = quads_.edge_at(LevelQuads::previous(s));
        }
      RowStars::for_spokes(quads_, v, [&](int spoke) {
        if (spoke != e && std::find(beside.begin(), beside.end(), spoke) == beside.end()) add(rows_.edge_row(spoke), true);
      });
    }
  }
  void add_centre(int row, int q) {
    std::array<int, 4> parents;
    bool inside = true;
    for (int i = 0; i < 4; ++i) {
      const int v = quads_.vertex[4 * q + i];
      parents[i] = quads_.in_mesh[v];
      inside = inside && inside_[v];
    }
    layout_.parents.push_back(parents);
    if (!inside) return search_.add(layout_, row);
    for (int side = 4 * q; side < 4 * q + 4; ++side) {
      add(rows_.edge_row(quads_.edge_at(side)), true);
      if (const int across = quads_.across[side]; across >= 0) add(rows_.quad_row(across / 4), true);
    }
  }

  const LevelStep& step_;
  const RefinedRows& rows_;
  const LevelQuads& quads_;
  CoefficientLayout& layout_;
  const std::vector<char>& inside_;
  std::vector<int> row_at_;  // #vertices
  RowStars stars_;
  NeighbourSearch<RowStars> search_;
};

std::array<int, 4> parents_of(const QuadForest& forest, const VertexIndex& coarse, VertexId vertex) {
  std::array<int, 4> parents{-1, -1, -1, -1};
  if (vertex.kind() == VertexId::Kind::Edge)
    for (int h = 0; h < 2; ++h) parents[h] = coarse(forest.from(2 * vertex.index() + h));
  if (vertex.kind() == VertexId::Kind::Node)
    for (int i = 0; i < 4; ++i) parents[i] = coarse(forest.corner(vertex.index(), i));
  return parents;
}

void lay_out_any(const QuadForest& forest, const MeshNames& coarse, const LevelMesh& fine, CoefficientLayout& layout) {
  std::vector<int> item_at(fine.vertex_count(), -1);
  for (std::size_t i = 0; i < layout.items.size(); ++i) item_at[layout.items[i].vertex] = static_cast<int>(i);
  const FaceStars stars(fine);
  for (int v = 0; v < static_cast<int>(fine.vertex_count()); ++v) {
    if (item_at[v] >= 0) continue;
    layout.bare.push_back(v);
    for (const int w : stars(v))
      if (item_at[w] >= 0) layout.beside.push_back(item_at[w]);
    layout.first_beside.push_back(layout.beside.size());
  }
  const VertexIndex find(coarse.vertex);
  NeighbourSearch<FaceStars> neighbours(stars, item_at);
  for (const CoefficientLayout::Item& item : layout.items) {
    neighbours.add(layout, item.vertex);
    end_neighbours(layout);
    layout.parents.push_back(parents_of(forest, find, fine.vertex[item.vertex]));
  }
}

}  // namespace

CoefficientLayout coefficient_layout(const QuadForest& forest, const LevelStep& step, const MeshNames& coarse, const LevelMesh& fine,
                                     bool remainder) {
  CoefficientLayout layout;
  layout.items.reserve(step.details().size());
  for (const DetailVertex& detail : step.details())
    layout.items.push_back({detail.vertex, static_cast<std::uint8_t>(coefficient_kind(detail.kind)), detail.kind == DetailKind::Inserted});
  if (step.is_regular())
    RegularLayout(step, layout).make();
  else
    lay_out_any(forest, coarse, fine, layout);
  for (int v = 0; v < static_cast<int>(fine.vertex_count()) && remainder; ++v) {
    layout.items.push_back({v, 2, true});
    layout.weight.push_back(0);
    layout.first_neighbour.push_back(layout.neighbours.size());
    layout.parents.push_back({-1, -1, -1, -1});
  }
  return layout;
}

}  // namespace hybrid_mesh
