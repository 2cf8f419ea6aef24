// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/even_regions.h"

#include <algorithm>
#include <cmath>

#include "layout/operations/quad_measures.h"
#include "layout/regions/patch_sets.h"

namespace hybrid_mesh {
namespace {

double sum_over(const PatchRegion& region, const std::vector<double>& of) {
  double sum = 0;
  for (const int q : region.patches) sum += of[q];
  return sum;
}

constexpr double kFewQuads = 12;  // of even size: with fewer a component has no better layout than that of its base

// Regions of quads of more energy than `least`, or than so much for the area that they cover; the smallest first. `quads`: that even ones would be in
// all.
std::vector<PatchRegion> uneven_regions(const QuadGraph& s, const std::vector<double>& energy, const std::vector<double>& share, double least,
                                        double quads) {
  std::vector<char> uneven(s.patch_count(), 0);
  for (int q = 0; q < s.patch_count(); ++q) uneven[q] = energy[q] > least || energy[q] > least * share[q] * s.patch_count();
  std::vector<char> wide = dilated(s, uneven);
  for (const std::vector<int>& component : components(s, std::vector<char>(s.patch_count(), 1), 1)) {
    double part = 0;
    for (const int q : component) part += share[q];
    if (part * quads < kFewQuads) {
      for (const int q : component) wide[q] = 0;
      continue;
    }
    // A region has a boundary: where all is uneven, the best stays.
    if (std::all_of(component.begin(), component.end(), [&](int q) { return wide[q] == 1; }))
      wide[*std::min_element(component.begin(), component.end(), [&](int a, int b) { return energy[a] < energy[b]; })] = 0;
  }
  if (const std::vector<char> rim = boundary_nodes(s); std::find(rim.begin(), rim.end(), 1) != rim.end()) {
    open_to_loops(s, wide, energy);
    part_at_nodes(s, wide);
  }
  std::vector<PatchRegion> regions = regions_around(s, wide);
  std::stable_sort(regions.begin(), regions.end(),
                   [&](const PatchRegion& a, const PatchRegion& b) { return sum_over(a, share) < sum_over(b, share); });
  return regions;
}

}  // namespace

std::vector<RegionRepatch> find_even_regions(const LevelState& state, const EvenRegionsOptions& options) {
  const QuadGraph& s = state.quads;
  const std::vector<double> energy = quad_energies(state);
  std::vector<double> share = quad_areas(state);
  for (double& x : share) x /= state.area;
  std::vector<PatchRegion> regions;
  // How many new quads a region gets where there are `count` in all. The last one makes up for what those that stay are more or fewer than even
  // ones, as far as its own may differ.
  const auto wanted = [&](std::size_t i, double count) {
    const double even = std::max(1.0, sum_over(regions[i], share) * options.quads);
    if (i + 1 < regions.size()) return even;
    return std::clamp(options.quads - (count - static_cast<double>(regions[i].patches.size())), 0.7 * even, 1.3 * even);
  };
  std::vector<double> quads;
  // Quads that would do stay, unless there would be too many in all.
  for (const double part : {1.0, 0.5, 0.25, 0.0}) {
    regions = uneven_regions(s, energy, share, part * options.uneven, options.quads);
    quads.clear();
    double count = s.patch_count();
    for (std::size_t i = 0; i < regions.size(); ++i) {
      quads.push_back(wanted(i, count));
      count += quads[i] - static_cast<double>(regions[i].patches.size());
    }
    if (count <= options.most_quads) break;
  }
  std::vector<RegionRepatch> found;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    RegionRepatch& repatch = found.emplace_back();
    repatch.patches = regions[i].patches;
    repatch.starts = regions[i].starts();
    repatch.pattern.kind = RegionPattern::Kind::Even;
    repatch.pattern.even_quads = static_cast<int>(std::lround(quads[i]));
  }
  return found;
}

}  // namespace hybrid_mesh
