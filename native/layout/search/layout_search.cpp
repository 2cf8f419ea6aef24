// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/layout_search.h"

#include <utility>

#include "base/found.h"
#include "layout/search/edit_search.h"
#include "layout/search/trial_map.h"

namespace hybrid_mesh {
namespace {

// One round of edits; returns them if the map is better for them.
std::vector<LayoutEdit> improve_once(TrialMap& map, const EditSearchOptions& options, const Progress& progress) {
  Found<std::vector<LayoutEdit>> made = found([&]() -> std::vector<LayoutEdit> {
    map.begin(options.map.theta, progress.part(0, 0.1));
    std::vector<LayoutEdit> edits = find_edits(map, options, progress.part(0.1, 0.6));
    if (edits.empty()) return {};
    apply_edits(map, edits, options.map, progress.part(0.6, 1));
    if (!map.is_better()) return {};
    map.keep();
    return edits;
  });
  // Without a map what was found before stays.
  return made ? std::move(*made) : std::vector<LayoutEdit>();
}

}  // namespace

SearchedLayout search_layout(CarriedMap map, const LayoutSearchOptions& options, const Progress& progress) {
  TrialMap trial(std::move(map));
  trial.map_patches_and_keep(options.map, progress.part(0, 0.4));
  LayoutScript script{options.vertices, options.map.vertices_a_quad, {}};
  const EditSearchOptions search{options.map, {options.quads, options.price, options.irregular_price, options.trials, 0}};
  for (int round = 0; round < options.rounds; ++round) {
    const double first = 0.4 + 0.6 * round / options.rounds, last = 0.4 + 0.6 * (round + 1) / options.rounds;
    const std::vector<LayoutEdit> edits = improve_once(trial, search, progress.part(first, last));
    if (edits.empty()) break;
    for (const LayoutEdit& edit : edits) script.edits.push_back({edit, round + 1});
  }
  progress(1);
  return {trial.take(), std::move(script)};
}

}  // namespace hybrid_mesh
