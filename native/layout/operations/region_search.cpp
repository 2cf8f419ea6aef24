// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/region_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/found.h"
#include "base/parallel.h"
#include "layout/operations/quad_measures.h"
#include "layout/regions/region_layout.h"
#include "layout/regions/region_pattern.h"
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

int tower_height_of(const LevelState& state, const PatchRegion& region) {
  GluedMaps glued = glue_patch_maps(maps_of(state, region.patches), part_of(state.quads, region.patches));
  glued.mapped.surface.mesh.sizes = state.sizes;
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

std::vector<RegionRepatch> find_regions(const LevelState& state, const EditCandidateOptions& options, const Progress& progress) {
  const std::vector<double> energy = quad_energies(state);
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
