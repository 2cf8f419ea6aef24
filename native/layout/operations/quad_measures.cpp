// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/quad_measures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "base/parallel.h"
#include "parameterization/global_map.h"
#include "parameterization/patch_energy.h"

namespace hybrid_mesh {
namespace {

// A value for every quad of a level, of its map.
template <class Value>
std::vector<double> of_quads(const LevelState& state, const Value& value) {
  std::vector<int> all(state.maps.size());
  std::iota(all.begin(), all.end(), 0);
  const std::vector<std::vector<int>> groups = grouped_by_map(state, all);
  std::vector<double> out(state.maps.size());
  parallel_for_each_index(static_cast<std::int64_t>(groups.size()), [&](std::int64_t g) {
    const std::vector<PatchMap> maps = maps_of(state, groups[g]);
    for (std::size_t k = 0; k < maps.size(); ++k) out[groups[g][k]] = value(maps[k]);
  });
  return out;
}

}  // namespace

std::vector<double> quad_energies(const LevelState& state) {
  const double scale = std::sqrt(static_cast<double>(state.quads.patch_count()) / state.area), theta = GlobalMapOptions().theta;
  return of_quads(state, [&](const PatchMap& map) { return map_energy(map, scale, theta, state.sizes.get()); });
}

std::vector<double> quad_areas(const LevelState& state) {
  return of_quads(state, [&](const PatchMap& map) { return map_area(map, state.sizes.get()); });
}

double largest_area_ratio(const LevelState& state) {
  const std::vector<double> areas = quad_areas(state);
  return *std::max_element(areas.begin(), areas.end()) * static_cast<double>(areas.size()) / state.area;
}

}  // namespace hybrid_mesh
