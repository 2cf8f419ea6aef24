// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/planes/plane_coder.h"

#include <algorithm>
#include <cmath>

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

std::uint32_t bin_of(std::uint32_t size) { return bins_of_sizes[std::min(size, bin_starts.back())]; }

constexpr std::uint32_t largest_size = 1u << 20;  // in 1/16
// A size near, in steps, from which on all bins that it decides are the last ones, whatever else: 13/20 of it are beyond the start of these.
constexpr std::uint32_t saturated = 18;
static_assert(13 * 16 * saturated / 20 >= bin_starts.back());
// The same of a size above, of which 7/20 count.
constexpr std::uint32_t largest_above = 520;
static_assert(7 * largest_above / 20 >= bin_starts.back());
// What neighbours count together where all quads around are whole, and four at every vertex.
constexpr std::uint32_t usual_weight = 16;
// Sums around an item grow no further: beyond it they are saturated whatever they count.
constexpr std::uint32_t largest_sum = 1u << 30;

}  // namespace

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
std::vector<std::array<std::uint32_t, 2>> sizes_at_vertices(const CoefficientLayout& layout, const Coefficients& known, std::size_t vertices,
                                                            int plane) {
  std::vector<std::array<std::uint32_t, 2>> sizes(vertices, {0, 0});
  if (known.plane < known.first_plane) return sizes;
  const int up = std::clamp(plane - known.plane, 0, 20);
  const auto scaled = [&](std::size_t i) {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(static_cast<std::uint64_t>(known.size[i]) << up, 1u << 24));
  };
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
      if (sum[c] > 0) sizes[layout.bare[b]][c] = std::max(sizes[layout.bare[b]][c], static_cast<std::uint32_t>(sum[c] / count));
  }
  return sizes;
}

}  // namespace

inline PlaneCoder::Context PlaneCoder::context(std::uint32_t around, std::uint32_t weight, std::uint32_t along, std::uint32_t above) {
  if ((around | above) == 0) return {};
  std::uint32_t near = 0;
  if (weight == usual_weight) {
    near = std::min(around >> along, 16 * saturated);
  } else if (around > 0) {
    const std::uint64_t count = std::uint64_t{weight} << along;
    near = around >= saturated * count ? 16 * saturated : static_cast<std::uint32_t>(16 * std::uint64_t{around} / count);
  }
  return {bin_of(near), bin_of(above), bin_of((13 * near + 7 * above) / 20)};
}

void PlaneCoder::find_above(const CoefficientLayout& layout, const std::vector<Pair>& at_vertices) {
  above_.assign(layout.items.size(), {0, 0});
  if (at_vertices.empty()) return;
  for (std::size_t item = 0; item < layout.items.size(); ++item) {
    Pair sum{0, 0};
    std::uint32_t count = 0;
    for (const int p : layout.parents[item])
      if (p >= 0) {
        sum[0] += at_vertices[p][0];
        sum[1] += at_vertices[p][1];
        ++count;
      }
    if ((sum[0] | sum[1]) == 0) continue;
    for (std::size_t c = 0; c < 2; ++c) above_[item][c] = static_cast<std::uint16_t>(std::min(sum[c] / count, largest_above));
  }
}

template <bool reading>
bool PlaneCoder::code_significance(BitCoder& coder, Significance& models, const Context& context, std::uint32_t own, int level, bool bit) {
  const auto& [near, above, mean] = context;
  const std::array<BitModel*, 5> opinions = {&models.near[near], &models.above[above], &models.joint[mean * 3 + own],
                                             &models.both[near * bins + above], &models.level[level]};
  return models.mixer.code_as<reading>(coder, bit, opinions);
}

template <bool reading>
BitCoder PlaneCoder::code_items(BitCoder coder, const CoefficientLayout& layout, Coefficients& known, int level, const Coefficients* all) {
  Pair* const around = around_[level].data();
  const int shift = all ? all->last_plane - known.plane : 0;
  const std::size_t count = layout.items.size();
  for (std::size_t item = 0; item < count; ++item) {
    std::uint32_t* const size = &known.size[components * item];
    const Pair before{size[0], size[1] + size[2]};
    Significance* const models = &significance_[layout.items[item].kind];
    const std::uint32_t weight = layout.weight[item];
    const Context across = context(around[item][0], weight, 0, above_[item][0]), along = context(around[item][1], weight, 1, above_[item][1]);
    std::uint32_t own = 0;
    for (std::size_t c = 0; c < components; ++c) {
      const std::uint32_t target = all ? all->size[components * item + c] >> shift : 0;
      if (size[c] > 0) [[unlikely]] {
        size[c] |= refinement_[c * 4 + std::min<std::uint32_t>(size[c] / 2 - 1, 3)].code_as<reading>(coder, target & 1);
        own = 2;
      } else if (code_significance<reading>(coder, models[c * kinds], c == 0 ? across : along, own, level, target != 0)) [[unlikely]] {
        known.negative[components * item + c] = coder.code_as<reading>(all && all->negative[components * item + c], 1u << 15);
        size[c] = 1;
        if (own == 0) own = 1;
      }
      ++known.coded;
    }
    // What was twice as much as before the plane has grown by this much more.
    const Pair more{size[0] - before[0], size[1] + size[2] - before[1]};
    if ((more[0] | more[1]) == 0) continue;
    for (std::size_t k = layout.first_neighbour[item]; k < layout.first_neighbour[item + 1]; ++k) {
      const auto [other, twice] = layout.neighbours[k];
      around[other][0] += more[0] << twice;
      around[other][1] += more[1] << twice;
    }
  }
  return coder;
}

void PlaneCoder::code(const CoefficientLayout& layout, Coefficients& known, const CoefficientLayout* coarser_layout, const Coefficients* coarser,
                      std::size_t coarser_vertices, int level, int plane, const Coefficients* all) {
  known.plane = plane;
  known.coded = 0;
  std::vector<Pair>& around = around_[level];
  around.resize(layout.items.size(), {0, 0});
  for (std::uint32_t& size : known.size) size *= 2;
  for (Pair& sum : around)
    for (std::uint32_t& s : sum) s = 2 * std::min(s, largest_sum / 2);
  find_above(layout, coarser ? sizes_at_vertices(*coarser_layout, *coarser, coarser_vertices, plane) : std::vector<Pair>());
  // A copy of the coder can be in registers.
  coder_ = coder_.reads() ? code_items<true>(coder_, layout, known, level, all) : code_items<false>(coder_, layout, known, level, all);
}

}  // namespace hybrid_mesh
