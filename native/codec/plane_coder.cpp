// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/plane_coder.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "codec/coefficient_scale.h"
#include "hierarchy/vertex_index.h"

namespace hybrid_mesh {

namespace {

// Sizes in 1/16: the bins that contexts tell apart begin at these.
constexpr std::array<std::uint32_t, 11> bin_starts = {1, 3, 5, 8, 12, 18, 28, 44, 70, 110, 180};
// Of the steps beyond the last known one, where a coefficient is put in its interval.
constexpr double centroid = 0.4;

// The bins of all sizes up to the start of the last one.
constexpr auto bins_of_sizes = [] {
  std::array<std::uint8_t, bin_starts.back() + 1> result{};
  for (std::size_t size = 0; size < result.size(); ++size)
    for (const std::uint32_t start : bin_starts) result[size] += size >= start;
  return result;
}();

int bin_of(std::uint32_t size) { return bins_of_sizes[std::min(size, bin_starts.back())]; }

// The vertices one edge away from each.
struct Stars {
  std::vector<int> first, count, other;

  explicit Stars(const QuadMesh& mesh) : first(mesh.vertex_count() + 1, 0), count(mesh.vertex_count(), 0) {
    for (const int v : mesh.indices) first[v + 1] += 2;
    for (std::size_t v = 0; v < count.size(); ++v) first[v + 1] += first[v];
    other.resize(first.back());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      for (std::int64_t c = mesh.offsets[f]; c < mesh.offsets[f + 1]; ++c) {
        const int a = mesh.indices[c], b = mesh.indices[c + 1 < mesh.offsets[f + 1] ? c + 1 : mesh.offsets[f]];
        add(a, b);
        add(b, a);
      }
  }
  std::span<const int> operator[](int v) const { return {&other[0] + first[v], static_cast<std::size_t>(count[v])}; }

 private:
  void add(int a, int b) {
    const auto begin = other.begin() + first[a], end = begin + count[a];
    if (a == b || std::find(begin, end, b) != end) return;
    *end = b;
    ++count[a];
  }
};

// Finds the neighbours of items. Those one edge away count twice, and so do those that one way of two edges leads to; where there are several such
// ways, once.
class NeighbourSearch {
 public:
  NeighbourSearch(const Stars& stars, const std::vector<int>& item_at) : stars_(stars), item_at_(item_at), place_(item_at.size(), -1) {}
  void add(CoefficientLayout& layout, int vertex) {
    const std::size_t first = layout.neighbours.size();
    for (const int v : stars_[vertex])
      for (const int w : stars_[v]) add(layout, vertex, w, false);
    for (const int v : stars_[vertex]) add(layout, vertex, v, true);
    std::uint32_t weight = 0;
    for (std::size_t k = first; k < layout.neighbours.size(); ++k) weight += 1 + layout.neighbours[k].twice;
    layout.weight.push_back(weight);
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

std::array<int, 4> parents_of(const HybridMesh& hierarchy, const VertexIndex& coarse, VertexId vertex) {
  std::array<int, 4> parents{-1, -1, -1, -1};
  if (vertex.kind() == VertexId::Kind::Edge)
    for (int h = 0; h < 2; ++h) parents[h] = coarse(hierarchy.from(2 * vertex.index() + h));
  if (vertex.kind() == VertexId::Kind::Node)
    for (int i = 0; i < 4; ++i) parents[i] = coarse(hierarchy.corner(vertex.index(), i));
  return parents;
}

constexpr std::uint64_t largest_size = 1u << 20;  // in 1/16

}  // namespace

CoefficientLayout coefficient_layout(const HybridMesh& hierarchy, const WaveletStep& step, bool remainder) {
  CoefficientLayout layout;
  const QuadMesh& fine = step.fine();
  const VertexIndex coarse(step.coarse().vertex);
  const Stars stars(fine);
  std::vector<int> item_at(fine.vertex_count(), -1);
  for (const DetailVertex& detail : step.details()) {
    item_at[detail.vertex] = static_cast<int>(layout.items.size());
    layout.items.push_back({detail.vertex, coefficient_kind(detail.kind), detail.kind == DetailKind::Inserted});
  }
  for (int v = 0; v < static_cast<int>(fine.vertex_count()); ++v) {
    if (item_at[v] >= 0) continue;
    layout.bare.push_back(v);
    for (const int w : stars[v])
      if (item_at[w] >= 0) layout.beside.push_back(item_at[w]);
    layout.first_beside.push_back(layout.beside.size());
  }
  NeighbourSearch neighbours(stars, item_at);
  for (const CoefficientLayout::Item& item : layout.items) {
    neighbours.add(layout, item.vertex);
    layout.first_neighbour.push_back(layout.neighbours.size());
    layout.parents.push_back(parents_of(hierarchy, coarse, fine.vertex[item.vertex]));
  }
  for (int v = 0; v < static_cast<int>(fine.vertex_count()) && remainder; ++v) {
    layout.items.push_back({v, 2, true});
    layout.weight.push_back(0);
    layout.first_neighbour.push_back(layout.neighbours.size());
    layout.parents.push_back({-1, -1, -1, -1});
  }
  return layout;
}

double Coefficients::value(std::size_t i) const {
  if (size[i] == 0) return 0;
  // What has no bit of this plane yet is known to be in an interval of twice its steps.
  const double rest = i < coded ? centroid : 2 * centroid;
  const double steps = static_cast<double>(size[i]) + rest;
  return std::ldexp(negative[i] ? -steps : steps, -plane);
}

namespace {

// Of vertices: what their items' components are together, in 1/16 of a step of a plane; of a vertex without one, the mean of its neighbours that have
// one.
std::vector<std::array<std::uint64_t, 2>> sizes_at_vertices(const CoefficientLayout& layout, const Coefficients& known, std::size_t vertices,
                                                            int plane) {
  std::vector<std::array<std::uint64_t, 2>> sizes(vertices, {0, 0});
  if (known.plane < known.first_plane) return sizes;
  const int up = std::clamp(plane - known.plane, 0, 20);
  const auto scaled = [&](std::size_t i) { return std::min<std::uint64_t>(static_cast<std::uint64_t>(known.size[i]) << up, 1u << 24); };
  for (std::size_t i = 0; i < layout.items.size(); ++i) {
    if (known.is_zero(i)) continue;
    auto& size = sizes[layout.items[i].vertex];
    size[0] = std::max(size[0], std::min(16 * scaled(components * i), largest_size));
    size[1] = std::max(size[1], std::min(8 * (scaled(components * i + 1) + scaled(components * i + 2)), largest_size));
  }
  for (std::size_t b = 0; b < layout.bare.size(); ++b) {
    std::array<std::uint64_t, 2> sum{0, 0};
    for (std::size_t k = layout.first_beside[b]; k < layout.first_beside[b + 1]; ++k)
      for (int c = 0; c < 2; ++c) sum[c] += sizes[layout.items[layout.beside[k]].vertex][c];
    const std::size_t count = layout.first_beside[b + 1] - layout.first_beside[b];
    for (int c = 0; c < 2; ++c)
      if (sum[c] > 0) sizes[layout.bare[b]][c] = std::max(sizes[layout.bare[b]][c], sum[c] / count);
  }
  return sizes;
}

}  // namespace

PlaneCoder::Context PlaneCoder::context(const CoefficientLayout& layout, std::size_t item, std::size_t along, const Pair& around,
                                        const std::vector<Pair>& above) {
  std::uint64_t near = 0, over = 0, parents = 0;
  if (around[along] > 0) near = std::min(16 * around[along] / (layout.weight[item] * (along + 1)), largest_size);
  if (!above.empty())
    for (const int p : layout.parents[item])
      if (p >= 0) {
        over += above[p][along];
        ++parents;
      }
  if (over > 0) over /= parents;
  return {bin_of(static_cast<std::uint32_t>(near)), bin_of(static_cast<std::uint32_t>(over)),
          bin_of(static_cast<std::uint32_t>((13 * near + 7 * over) / 20))};
}

bool PlaneCoder::code_significance(Significance& models, const Context& context, int own, int level, bool bit) {
  const auto& [near, above, mean] = context;
  const std::array<BitModel*, 5> opinions = {&models.near[near], &models.above[above], &models.joint[mean * 3 + own],
                                             &models.both[near * bins + above], &models.level[level]};
  return models.mixer.code(coder_, bit, opinions);
}

void PlaneCoder::code_item(const CoefficientLayout& layout, Coefficients& known, std::size_t item, int level, const Pair& around,
                           const std::vector<Pair>& above, const Coefficients* all) {
  std::uint32_t own = 0;
  std::array<Context, 2> contexts;
  std::array<bool, 2> found{false, false};
  for (std::size_t c = 0; c < components; ++c, ++known.coded) {
    const std::size_t i = components * item + c, along = c > 0;
    std::uint32_t& size = known.size[i];
    const std::uint32_t target = all ? all->size[i] >> (all->last_plane - known.plane) : 0;
    if (size > 0) {
      size |= refinement_[c * 4 + std::min<std::uint32_t>(size / 2 - 1, 3)].code(coder_, target & 1);
    } else {
      if (!found[along]) contexts[along] = context(layout, item, along, around, above);
      found[along] = true;
      Significance& models = significance_[c * kinds + layout.items[item].kind];
      if (code_significance(models, contexts[along], static_cast<int>(own), level, target != 0)) {
        known.negative[i] = coder_.code_raw(all && all->negative[i]);
        size = 1;
      }
    }
    own = std::max(own, std::min<std::uint32_t>(size, 2));
  }
}

void PlaneCoder::code(const CoefficientLayout& layout, Coefficients& known, const CoefficientLayout* coarser_layout, const Coefficients* coarser,
                      std::size_t coarser_vertices, int level, int plane, const Coefficients* all) {
  known.plane = plane;
  known.coded = 0;
  std::vector<Pair>& around = around_[level];
  around.resize(layout.items.size(), {0, 0});
  for (std::uint32_t& size : known.size) size *= 2;
  for (Pair& sum : around) sum = {2 * sum[0], 2 * sum[1]};
  std::vector<Pair> above;
  if (coarser) above = sizes_at_vertices(*coarser_layout, *coarser, coarser_vertices, plane);
  for (std::size_t item = 0; item < layout.items.size(); ++item) {
    const std::uint32_t* size = &known.size[components * item];
    const auto sizes = [&] { return Pair{size[0], static_cast<std::uint64_t>(size[1]) + size[2]}; };
    const Pair before = sizes();
    code_item(layout, known, item, level, around[item], above, all);
    const Pair after = sizes();
    if (after == before) continue;
    for (std::size_t k = layout.first_neighbour[item]; k < layout.first_neighbour[item + 1]; ++k) {
      const auto [other, twice] = layout.neighbours[k];
      for (int c = 0; c < 2; ++c) around[other][c] += (after[c] - before[c]) << twice;
    }
  }
}

}  // namespace hybrid_mesh
