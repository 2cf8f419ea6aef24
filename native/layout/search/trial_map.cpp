// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/trial_map.h"

#include <utility>

#include "parameterization/initial_map.h"
#include "parameterization/patch_energy.h"

namespace hybrid_mesh {

void TrialMap::map_patches_and_keep(const GlobalMapOptions& options, const Progress& progress) {
  mapped_.corners = map_patches(best_.layout, progress.part(0, 0.1));
  mapped_.surface = best_.layout;
  smooth(options, progress.part(0.1, 1));
  keep();
}

void TrialMap::begin(double theta, const Progress& progress) {
  scale_ = best_.charts.scale;
  mapped_ = best_.cut(progress);
  energy_ = patch_energies(mapped_, scale_, theta);
}

void TrialMap::change(const LayoutEdit& edit, const Progress& progress) {
  const LayoutChange change = apply_edit(mapped_, edit);
  map_patches(mapped_.surface, change.added, mapped_.corners, progress);
}

void TrialMap::smooth(const GlobalMapOptions& options, const Progress& progress) {
  fresh_.emplace(mapped_.surface, mapped_.corners);
  excess_ = (smooth_map_surely(*fresh_, mapped_.surface, options, progress).energy - 1) * mapped_.surface.patch_count();
}

void TrialMap::keep() {
  least_ = excess_;
  best_.replace(mapped_.surface, std::move(*fresh_));
}

void apply_edits(TrialMap& map, const std::vector<LayoutEdit>& edits, GlobalMapOptions options, const Progress& progress) {
  // Edits that do not shrink leave other patches' numbers alone.
  for (const LayoutEdit& edit : edits) map.change(edit, progress.part(0, 0));
  options.newton_steps /= 2;
  options.cone_rounds /= 2;
  map.smooth(options, progress);
}

}  // namespace hybrid_mesh
