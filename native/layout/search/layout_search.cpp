// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/layout_search.h"

#include <utility>

#include "base/found.h"
#include "layout/search/edit_search.h"
#include "layout/search/even_regions.h"

namespace hybrid_mesh {
namespace {

using Edits = std::vector<LayoutScript::Edit>;

// Lays out the uneven regions anew; returns the edits if the map is better for them.
Edits lay_out_evenly(TrialMap& map, const LevelSearchOptions& options, const Progress& progress) {
  Found<Edits> made = found([&]() -> Edits {
    map.begin(options.map.theta, progress);
    EvenRegions even = find_even_regions(map, {options.even_quads, static_cast<double>(options.quads), options.uneven}, progress);
    if (even.edits.empty()) return {};
    apply_drawn_edits(map, std::move(even.drawn), options.map, progress);
    if (!map.is_better()) return {};
    map.keep();
    return std::move(even.edits);
  });
  return made ? std::move(*made) : Edits();
}

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

// For as long as that gains.
Edits improve(TrialMap& map, const LevelSearchOptions& options, const Progress& progress) {
  const int now = map.best().layout.patch_count();
  const int most = now <= options.quads ? options.quads : now + now / 3;
  const EditSearchOptions search{options.map, {most, options.price, options.irregular_price, options.trials, options.threshold}};
  Edits made;
  for (int round = 0; round < options.rounds; ++round) {
    const Progress part = progress.part(static_cast<double>(round) / options.rounds, (round + 1.0) / options.rounds);
    const std::vector<LayoutEdit> edits = improve_once(map, search, part);
    if (edits.empty()) break;
    for (const LayoutEdit& edit : edits) made.push_back({edit, round + 1, false, 0, {}, {}, {}});
    part(1);
  }
  return made;
}

}  // namespace

MappedLayouts search_layout(CarriedMap map, const LayoutSearchOptions& options, const Progress& progress) {
  std::vector<LevelVersion> versions;
  for (const LevelSearchOptions& level : options.levels) versions.push_back({level.vertices, level.map});
  const LevelWork search = [&](TrialMap& trial, std::size_t level, const Progress& part) {
    const LevelSearchOptions& of = options.levels[level];
    Edits made;
    if (of.even_quads > 0) made = lay_out_evenly(trial, of, part.part(0, 0.3));
    const Edits further = improve(trial, of, part.part(0.3, 1));
    made.insert(made.end(), further.begin(), further.end());
    return made;
  };
  return map_levels(std::move(map), versions, search, progress);
}

}  // namespace hybrid_mesh
