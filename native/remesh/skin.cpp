// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/skin.h"

#include <cmath>
#include <utility>

#include "layout/operations/region_search.h"
#include "remesh/layout_search_options.h"
#include "remesh/plan_regions.h"

namespace hybrid_mesh {
namespace {

constexpr int kLevel = 2;    // above the base: towers there take a sixteenth of what they would take on the base
constexpr int kRounds = 2;   // of operations: what sticks out of the first ones' quads grows skin in the second
constexpr int kTrials = 30;  // regions that are tried out in a round

bool has_skin(const RemeshOptions& options, const Budget& budget) {
  // Not for adaptive meshes: they would begin with all quads of that level.
  return !options.semi_regular && options.base == BaseSize::Auto && options.refinement == Refinement::Uniform && budget.levels > kLevel;
}

}  // namespace

std::vector<Plan::Region> grow_skin(Construction& made, const RemeshTask& task, const Budget& budget, const BaseDomain& base) {
  if (!has_skin(task.options, budget)) return {};
  LevelState level = made.state();
  for (int k = 0; k < kLevel; ++k) level = quadrisected(level);
  // The quads that come of a stretched one are stretched where it is: a level further up shows it.
  if (!(largest_area_ratio(quadrisected(level)) > task.options.stretch_threshold)) return {};
  const LevelSearchOptions prices;
  EditCandidateOptions options;
  options.most = static_cast<int>(std::pow(4.0, kLevel) * (budget.base_size - budget.boundary_side * base.boundary_sides()));
  options.price = prices.price;
  options.irregular_price = prices.irregular_price;
  options.trials = kTrials;
  options.threshold = excess_of_stretch(task.options.stretch_threshold);
  std::vector<Plan::Region> done;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<RegionRepatch> found = find_regions(level, options, task.progress.part(0.55, 0.55));
    if (found.empty()) break;
    while (made.level() < kLevel) made.refine();
    std::vector<Plan::Region> regions;
    for (const RegionRepatch& repatch : found) regions.push_back(region_of(repatch, made));
    for (Plan::Region& region : regions) {
      try {
        repatch_regions(made, {region}, task.source.placement, task.progress.part(0.55, 0.55));
        done.push_back(std::move(region));
      } catch (const Error& e) {
        if (e.code() != ErrorCode::Unsupported) throw;  // no map: the region stays as it is
      }
    }
    level = made.state();
  }
  return done;
}

}  // namespace hybrid_mesh
