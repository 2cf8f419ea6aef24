// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/plane_coder.h"

#include <algorithm>
#include <cmath>

#include "codec/coefficient_scale.h"
#include "hierarchy/vertex_index.h"

namespace hybrid_mesh {

namespace {

// Sizes in 1/16: the bins that contexts tell apart begin at these.
constexpr std::array<std::uint32_t, 11> bin_starts = {1, 3, 5, 8, 12, 18, 28, 44, 70, 110, 180};
// Of the steps beyond the last known one, where a coefficient is put in its interval.
constexpr double centroid = 0.4;

int bin_of(std::uint32_t size) { return static_cast<int>(std::upper_bound(bin_starts.begin(), bin_starts.end(), size) - bin_starts.begin()); }

// Each edge of a mesh once at either end, in order.
std::vector<std::vector<int>> edges_around(const QuadMesh& mesh) {
  std::vector<std::vector<int>> around(mesh.vertex_count());
  const auto add = [&](int a, int b) {
    if (a != b && std::find(around[a].begin(), around[a].end(), b) == around[a].end()) around[a].push_back(b);
  };
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t c = mesh.offsets[f]; c < mesh.offsets[f + 1]; ++c) {
      const int a = mesh.indices[c], b = mesh.indices[c + 1 < mesh.offsets[f + 1] ? c + 1 : mesh.offsets[f]];
      add(a, b);
      add(b, a);
    }
  return around;
}

// Items one edge away count twice, and so do those that one way of two edges leads to; where there are several such ways, once.
void add_neighbours(CoefficientLayout& layout, const std::vector<std::vector<int>>& around, const std::vector<int>& item_at, int item) {
  const int vertex = layout.items[item].vertex;
  const auto first = static_cast<std::ptrdiff_t>(layout.neighbours.size());
  const auto add = [&](int v, int again) {
    if (v == vertex || item_at[v] < 0) return;
    const auto at = std::find_if(layout.neighbours.begin() + first, layout.neighbours.end(), [&](const auto& n) { return n.first == item_at[v]; });
    if (at == layout.neighbours.end())
      layout.neighbours.emplace_back(item_at[v], 2);
    else
      at->second = again;
  };
  for (const int v : around[vertex])
    for (const int w : around[v]) add(w, 1);
  for (const int v : around[vertex]) add(v, 2);
}

std::array<int, 4> parents_of(const HybridMesh& hierarchy, const VertexIndex& coarse, VertexId vertex) {
  std::array<int, 4> parents{-1, -1, -1, -1};
  if (vertex.kind() == VertexId::Kind::Edge)
    for (int h = 0; h < 2; ++h) parents[h] = coarse(hierarchy.from(2 * vertex.index() + h));
  if (vertex.kind() == VertexId::Kind::Node)
    for (int i = 0; i < 4; ++i) parents[i] = coarse(hierarchy.corner(vertex.index(), i));
  return parents;
}

// Of vertices: what their items' components are together, in 1/16; of a vertex without one, the mean of its neighbours that have one.
using Sizes = std::vector<std::array<std::uint32_t, 2>>;

std::uint32_t sixteenths(std::uint64_t sum, std::uint64_t parts) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(16 * sum / parts, 1u << 20));
}

}  // namespace

CoefficientLayout coefficient_layout(const HybridMesh& hierarchy, const WaveletStep& step, bool remainder) {
  CoefficientLayout layout;
  const QuadMesh& fine = step.fine();
  const VertexIndex coarse(step.coarse().vertex);
  const std::vector<std::vector<int>> around = edges_around(fine);
  std::vector<int> item_at(fine.vertex_count(), -1);
  for (const DetailVertex& detail : step.details()) {
    item_at[detail.vertex] = static_cast<int>(layout.items.size());
    layout.items.push_back({detail.vertex, coefficient_kind(detail.kind), detail.kind == DetailKind::Inserted});
  }
  for (int v = 0; v < static_cast<int>(fine.vertex_count()); ++v) {
    if (item_at[v] >= 0) continue;
    layout.bare.push_back({v, {}});
    for (const int w : around[v])
      if (item_at[w] >= 0) layout.bare.back().second.push_back(item_at[w]);
  }
  const auto details = static_cast<int>(layout.items.size());
  for (int v = 0; v < static_cast<int>(fine.vertex_count()) && remainder; ++v) layout.items.push_back({v, 2, true});
  for (int i = 0; i < static_cast<int>(layout.items.size()); ++i) {
    if (i < details) add_neighbours(layout, around, item_at, i);
    layout.first_neighbour.push_back(layout.neighbours.size());
    layout.parents.push_back(i < details ? parents_of(hierarchy, coarse, fine.vertex[layout.items[i].vertex]) : std::array<int, 4>{-1, -1, -1, -1});
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

// The sizes of a level's items at its mesh's vertices, in steps of a plane.
Sizes sizes_at_vertices(const CoefficientLayout& layout, const Coefficients& known, std::size_t vertices, int plane) {
  Sizes sizes(vertices, {0, 0});
  if (known.plane < known.first_plane) return sizes;
  const int up = std::clamp(plane - known.plane, 0, 20);
  const auto scaled = [&](std::size_t i) { return std::min<std::uint64_t>(static_cast<std::uint64_t>(known.size[i]) << up, 1u << 24); };
  for (std::size_t i = 0; i < layout.items.size(); ++i) {
    auto& size = sizes[layout.items[i].vertex];
    size[0] = std::max(size[0], sixteenths(scaled(components * i), 1));
    size[1] = std::max(size[1], sixteenths(scaled(components * i + 1) + scaled(components * i + 2), 2));
  }
  for (const auto& [vertex, items] : layout.bare) {
    std::array<std::uint64_t, 2> sum{0, 0};
    for (const int i : items)
      for (int c = 0; c < 2; ++c) sum[c] += sizes[layout.items[i].vertex][c];
    for (int c = 0; c < 2 && !items.empty(); ++c) sizes[vertex][c] = std::max(sizes[vertex][c], static_cast<std::uint32_t>(sum[c] / items.size()));
  }
  return sizes;
}

}  // namespace

void PlaneCoder::code_coefficient(Coefficients& known, std::size_t i, int kind, int level, std::uint32_t near, std::uint32_t above,
                                  const Coefficients* all) {
  const auto component = static_cast<int>(i % components);
  const std::uint32_t before = known.size[i];
  const std::uint32_t target = all ? all->size[i] >> (all->last_plane - known.plane) : 0;
  if (before > 0) {
    known.size[i] |= refinement_[component * 4 + std::min<std::uint32_t>(before / 2 - 1, 3)].code(coder_, target & 1);
    return;
  }
  std::uint32_t own = 0;
  for (int c = 1; c <= component; ++c) own = std::max(own, std::min<std::uint32_t>(known.size[i - c], 2));
  Significance& models = significance_[component * kinds + kind];
  const int n = bin_of(near), a = bin_of(above), mean = bin_of((13 * near + 7 * above) / 20);
  const std::array<BitModel*, Mixer::most> opinions = {&models.near[n], &models.above[a], &models.joint[mean * 3 + own], &models.both[n * bins + a],
                                                       &models.level[level]};
  if (!models.mixer.code(coder_, target != 0, opinions, Mixer::most)) return;
  known.negative[i] = coder_.code_raw(all && all->negative[i]);
  known.size[i] = 1;
}

void PlaneCoder::code(const CoefficientLayout& layout, Coefficients& known, const CoefficientLayout* coarser_layout, const Coefficients* coarser,
                      std::size_t coarser_vertices, int level, int plane, const Coefficients* all) {
  known.plane = plane;
  known.coded = 0;
  for (std::uint32_t& size : known.size) size *= 2;
  Sizes above;
  if (coarser) above = sizes_at_vertices(*coarser_layout, *coarser, coarser_vertices, plane);
  for (std::size_t item = 0; item < layout.items.size(); ++item) {
    std::array<std::uint64_t, 2> sum{0, 0};
    std::uint64_t weights = 0;
    for (std::size_t k = layout.first_neighbour[item]; k < layout.first_neighbour[item + 1]; ++k) {
      const auto [other, weight] = layout.neighbours[k];
      const std::uint32_t* size = &known.size[components * static_cast<std::size_t>(other)];
      sum[0] += static_cast<std::uint64_t>(weight) * size[0];
      sum[1] += static_cast<std::uint64_t>(weight) * (static_cast<std::uint64_t>(size[1]) + size[2]);
      weights += weight;
    }
    std::array<std::uint64_t, 2> up{0, 0};
    std::uint64_t parents = 0;
    for (const int p : layout.parents[item])
      if (p >= 0 && coarser) {
        for (int c = 0; c < 2; ++c) up[c] += above[p][c];
        ++parents;
      }
    for (std::size_t c = 0; c < components; ++c) {
      const std::size_t along = c > 0;
      const std::uint32_t near = weights ? sixteenths(sum[along], weights * (along + 1)) : 0;
      const std::uint32_t over = parents ? static_cast<std::uint32_t>(up[along] / parents) : 0;
      code_coefficient(known, components * item + c, layout.items[item].kind, level, near, over, all);
      ++known.coded;
    }
  }
}

}  // namespace hybrid_mesh
