// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/region_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/found.h"
#include "base/parallel.h"
#include "layout/regions/region_layout.h"
#include "layout/regions/region_pattern.h"
#include "parameterization/patch_energy.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {
namespace {

// What is done for the map of a trial: enough to tell good from bad.
GlobalMapOptions trial_map_options() {
  GlobalMapOptions options;
  options.newton_steps = 3;
  options.cone_rounds = 1;
  options.sweeps = 1;
  return options;
}

// A value for every quad of a level, of its map.
template <class Value>
std::vector<double> of_quads(const LevelState& state, const Value& value) {
  // A map at a time: its quads are cut out of it together.
  std::vector<std::vector<int>> groups;
  std::vector<int> order(state.maps.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return state.maps[a].map < state.maps[b].map; });
  for (const int q : order) {
    if (groups.empty() || state.maps[groups.back().front()].map != state.maps[q].map) groups.emplace_back();
    groups.back().push_back(q);
  }
  std::vector<double> out(state.maps.size());
  parallel_for_each_index(static_cast<std::int64_t>(groups.size()), [&](std::int64_t g) {
    const std::vector<PatchMap> maps = maps_of(state, groups[g]);
    for (std::size_t k = 0; k < maps.size(); ++k) out[groups[g][k]] = value(maps[k]);
  });
  return out;
}

int tower_height_of(const LevelState& state, const PatchRegion& region) {
  const GluedMaps glued = glue_patch_maps(maps_of(state, region.patches), part_of(state.quads, region.patches));
  std::vector<int> all(region.patches.size());
  std::iota(all.begin(), all.end(), 0);
  const std::optional<PatchRegion> local = make_disk(glued.mapped.surface, all);
  return local ? tower_height(surface_of(glued.mapped.surface, *local)) : 0;
}

RegionRepatch repatch_by(const LayoutEdit& edit) {
  RegionRepatch repatch;
  repatch.patches = edit.patches;
  repatch.starts = edit.starts;
  if (edit.rings > 0) {
    repatch.pattern.kind = RegionPattern::Kind::Cubes;
    repatch.pattern.height = edit.rings;
  } else {
    repatch.pattern.kind = RegionPattern::Kind::Template;
    repatch.pattern.quads = edit.quads;
  }
  return repatch;
}

}  // namespace

double largest_area_ratio(const LevelState& state) {
  const std::vector<double> areas = of_quads(state, [](const PatchMap& map) { return map_area(map); });
  return *std::max_element(areas.begin(), areas.end()) * static_cast<double>(areas.size()) / state.area;
}

std::vector<RegionRepatch> find_regions(const LevelState& state, const EditCandidateOptions& options, const Progress& progress) {
  const double scale = std::sqrt(static_cast<double>(state.quads.patch_count()) / state.area), theta = GlobalMapOptions().theta;
  const std::vector<double> energy = of_quads(state, [&](const PatchMap& map) { return map_energy(map, scale, theta); });
  std::vector<EditCandidate> candidates =
      find_edit_candidates(state.quads, energy, options, [&](const PatchRegion& region) { return tower_height_of(state, region); });
  parallel_for_each_index(static_cast<std::int64_t>(candidates.size()), [&](std::int64_t i) {
    progress.check();
    RegionRepatch trial = repatch_by(candidates[i].edit);
    trial.map = trial_map_options();
    candidates[i].gain = -std::numeric_limits<double>::max();
    if (!find_edit_defect(state.quads, candidates[i].region, candidates[i].edit).empty()) return;
    const Found<MappedEdit> made = found([&] { return repatch_region(state, trial, progress.part(0, 0)); });
    if (made) candidates[i].gain = made->energy_before - made->energy_after;
  });
  std::vector<RegionRepatch> found;
  for (const EditCandidate& c : choose_edits(state.quads, std::move(candidates), options)) found.push_back(repatch_by(c.edit));
  return found;
}

}  // namespace hybrid_mesh
