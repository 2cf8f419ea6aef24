// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "layout/regions/region_pattern.h"
#include "layout/search/layout_search.h"
#include "layout/search/trial_map.h"

namespace hybrid_mesh {
namespace {

// An edit must be of a region of the layout: a script may have been made for another one.
void check_fit(const QuadGraph& s, const LayoutEdit& edit) {
  const auto fails = [] [[noreturn]] { throw NoMap("an edit does not fit its layout"); };
  const bool known = std::all_of(edit.patches.begin(), edit.patches.end(), [&](int q) { return q >= 0 && q < s.patch_count(); });
  if (!known || edit.starts.empty()) fails();
  const std::optional<PatchRegion> region = make_region(s, edit.patches, edit.starts, FreeLoops::Open);
  if (!region || region->rim_count() != static_cast<int>(edit.starts.size())) fails();
  const int corners = static_cast<int>(region->corners.size());
  if (!find_filling_defect(edit.quads, *region).empty()) fails();
  int nodes = corners;
  for (const auto& quad : edit.quads) nodes = std::max(nodes, *std::max_element(quad.begin(), quad.end()) + 1);
  if (nodes - corners != edit.inner_nodes || edit.rings < 0 || static_cast<std::int64_t>(corners) * edit.rings > edit.inner_nodes) fails();
}

}  // namespace

CarriedMap replay_layout(CarriedMap map, const LayoutScript& script, const Progress& progress) {
  GlobalMapOptions options;
  if (script.vertices_a_quad > 0) options.vertices_a_quad = script.vertices_a_quad;
  TrialMap trial(std::move(map));
  trial.map_patches_and_keep(options, progress.part(0, 0.4));
  for (const std::vector<LayoutEdit>& edits : rounds_of(script)) {
    trial.begin(options.theta, progress);
    for (const LayoutEdit& edit : edits) check_fit(trial.mapped().surface, edit);
    apply_edits(trial, edits, options, progress.part(0.4, 1));
    trial.keep();
  }
  return trial.take();
}

}  // namespace hybrid_mesh
