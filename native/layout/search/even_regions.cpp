// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/even_regions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <utility>

#include "layout/operations/region_outline.h"
#include "layout/regions/patch_sets.h"

namespace hybrid_mesh {
namespace {

// Share of the surface's area, a patch.
std::vector<double> area_shares(const PatchedSurface& s) {
  std::vector<double> share(s.patch_count(), 0);
  double all = 0;
  for (std::size_t f = 0; f < s.mesh.faces.size(); ++f) {
    const auto& c = s.mesh.faces[f];
    const double area = 0.5 * (s.mesh.points[c[1]] - s.mesh.points[c[0]]).cross(s.mesh.points[c[2]] - s.mesh.points[c[0]]).norm();
    share[s.patch[f]] += area;
    all += area;
  }
  for (double& x : share) x /= all;
  return share;
}

double sum_over(const PatchRegion& region, const std::vector<double>& of) {
  double sum = 0;
  for (const int q : region.patches) sum += of[q];
  return sum;
}

// Regions of patches of more energy than `least`, the smallest first.
std::vector<PatchRegion> uneven_regions(const QuadGraph& s, const std::vector<double>& energy, const std::vector<double>& share, double least) {
  std::vector<char> uneven(s.patch_count(), 0);
  for (int q = 0; q < s.patch_count(); ++q) uneven[q] = energy[q] > least || energy[q] > least * share[q] * s.patch_count();
  std::vector<char> wide = dilated(s, uneven);
  // A region has a boundary: where all is uneven, the best stays.
  if (std::find(wide.begin(), wide.end(), 0) == wide.end()) wide[std::min_element(energy.begin(), energy.end()) - energy.begin()] = 0;
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

EvenRegions find_even_regions(const TrialMap& map, const EvenRegionsOptions& options, const Progress& progress) {
  const PatchedSurface& s = map.mapped().surface;
  const std::vector<double> share = area_shares(s);
  std::vector<PatchRegion> regions;
  // How many new quads a region gets where there are `count` in all. The last one makes up for what those that stay are more or fewer than even
  // ones, as far as its own may differ.
  const auto wanted = [&](std::size_t i, double count) {
    const double even = std::max(1.0, sum_over(regions[i], share) * options.quads);
    if (i + 1 < regions.size()) return even;
    return std::clamp(options.quads - (count - static_cast<double>(regions[i].patches.size())), 0.7 * even, 1.3 * even);
  };
  // Quads that would do stay, unless there would be too many in all.
  for (const double part : {1.0, 0.5, 0.25, 0.0}) {
    regions = uneven_regions(s, map.energy(), share, part * options.uneven);
    double count = s.patch_count();
    for (std::size_t i = 0; i < regions.size(); ++i) count += wanted(i, count) - static_cast<double>(regions[i].patches.size());
    if (count <= options.most_quads) break;
  }
  double count = s.patch_count();
  EvenRegions found;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const double quads = wanted(i, count);
    std::optional<DrawnEdit> edit = even_edit(s, regions[i], surface_of(s, regions[i]), quads, 1, progress);
    if (!edit) continue;
    found.edits.push_back({edit->edit, 0, true, quads, outline_of(*edit, regions[i]), {}, {}});
    count += edit->edit.growth();
    found.drawn.push_back(std::move(*edit));
  }
  return found;
}

}  // namespace hybrid_mesh
