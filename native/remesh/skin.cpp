// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/skin.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "layout/operations/even_regions.h"
#include "layout/operations/quad_measures.h"
#include "layout/operations/region_search.h"
#include "layout/search/layout_search.h"
#include "remesh/plan_regions.h"

namespace hybrid_mesh {
namespace {

constexpr int kTrials = 30;  // regions that are tried out in a round

// On a fitted base two levels up: towers there take a sixteenth of what they would take on the base.
constexpr int kFittedLevel = 2, kFittedRounds = 2;

// On a minimal one they are on the first level with enough quads to follow the shape's features, or the last that is wanted, unless that has too few
// to choose from. Two levels with operations (towers on one of some hundred quads, even quads on the next) were tried: quads are inserted twice, and
// neither the distances nor the angles are better.
constexpr double kLeastQuads = 60, kEnoughQuads = 250;

// The number near `quads`, with so many sides on the boundary, of which a whole number of levels makes a mesh of the size asked for.
double quads_for_budget(const Budget& budget, double euler, double quads, double boundary_sides) {
  const double vertices = static_cast<double>(budget.vertices) - euler;
  for (double parts = 1;; parts *= 2) {
    const double size = vertices / (parts * parts) - 0.5 * boundary_sides / parts;
    if (size <= 1.6 * quads) return size;
  }
}

// Energy of a quad that is stretched so many times in one direction, beyond an isometry's.
double excess_of_stretch(double stretch) { return 0.5 * GlobalMapOptions().theta * (stretch + 1 / stretch - 2); }

SkinOptions minimal_options(const RemeshTask& task, const Budget& budget, const BaseDomain& base) {
  SkinOptions out;
  double quads = base.quads(), sides = base.boundary_sides();
  for (; quads < kEnoughQuads && out.level != task.options.levels; ++out.level) quads *= 4, sides *= 2;
  if (quads < kLeastQuads) return {};
  // A half's mirror image shares the vertices between them.
  const double euler = task.source.mirror ? static_cast<double>(task.source.made.euler) / 2 : static_cast<double>(task.base.topology.euler);
  // Quads of even size first, which are to be refined regularly from there on, then what sticks out of them.
  const double size = budget.shrink * quads_for_budget(budget, euler, quads, sides);
  out.even_quads = size - kRoomForARing;
  out.uneven = excess_of_stretch(std::pow(task.options.stretch_threshold, 0.45));
  out.rounds = 1;
  out.skin.most = static_cast<int>(task.options.refinement == Refinement::Uniform ? size : 1.3 * quads);
  return out;
}

class Skin {
 public:
  Skin(Construction& made, const RemeshTask& task, const SkinOptions& options)
      : made_(made), options_(options), placement_(task.source.placement), progress_(task.progress.part(0.55, 0.55)) {}

  std::vector<Plan::Region> run() {
    while (made_.level() < options_.level) made_.refine();
    if (options_.even_quads > 0) lay_out_evenly();
    for (int round = 0; round < options_.rounds; ++round) {
      const std::vector<Plan::Region> regions = named(find_regions(made_.state(), options_.skin, progress_));
      if (regions.empty()) break;
      for (const Plan::Region& region : regions) repatch(region);
    }
    return std::move(done_);
  }

 private:
  // By addresses, which stay as they are while other regions are laid out anew.
  std::vector<Plan::Region> named(const std::vector<RegionRepatch>& found) const {
    std::vector<Plan::Region> regions;
    for (const RegionRepatch& repatch : found) regions.push_back(region_of(repatch, made_));
    return regions;
  }

  void lay_out_evenly() {
    for (const Plan::Region& region : named(find_even_regions(made_.state(), {options_.even_quads, 1.0 * options_.skin.most, options_.uneven}))) {
      const bool most = 2 * static_cast<int>(region.quads.size()) > made_.quads().graph().patch_count();
      const std::string failure = repatch(region);
      if (!failure.empty() && most) throw NoMap(failure);
    }
  }

  // Returns why it is not done; empty if it is.
  std::string repatch(Plan::Region region) {
    const RegionRepatch repatch = resolved(region, made_.quads());
    Found<MappedEdit> mapped;
    try {
      mapped = found([&] { return repatch_region(made_.state(), repatch, progress_); });
    } catch (const Error& e) {
      if (e.code() != ErrorCode::InvalidInput) throw;
      mapped = {std::nullopt, e.what()};  // there are no even quads with its boundary
    }
    if (!mapped) return mapped.reason;
    if (!(mapped->energy_after < mapped->energy_before)) return "its quads would be no better";
    if (region.pattern.kind == RegionPattern::Kind::Even) {
      region.pattern.outline = mapped->outline;
      move_pattern(region.pattern, [&](const Vec3& p) { return placement_.from_unit(p); });
    }
    made_.apply(std::move(*mapped));
    done_.push_back(std::move(region));
    return {};
  }

  Construction& made_;
  const SkinOptions& options_;
  const Placement& placement_;
  Progress progress_;
  std::vector<Plan::Region> done_;
};

}  // namespace

bool has_finer_operations(const RemeshOptions& options, const BaseDomain& base, const BaseRequest& request) {
  return options.base == BaseSize::Minimal && !options.semi_regular && request.operations && base.quads() < kEnoughQuads && options.levels != 0;
}

SkinOptions skin_options(const RemeshTask& task, const Budget& budget, const BaseDomain& base, const BaseRequest& request) {
  const RemeshOptions& options = task.options;
  SkinOptions out;
  if (has_finer_operations(options, base, request)) {
    out = minimal_options(task, budget, base);
  } else if (!options.semi_regular && options.base == BaseSize::Auto && options.refinement == Refinement::Uniform && budget.levels > kFittedLevel) {
    // Not for adaptive meshes: they would begin with all quads of that level.
    out.level = kFittedLevel;
    out.rounds = kFittedRounds;
    out.skin.most = static_cast<int>(std::pow(4.0, kFittedLevel) * (budget.base_size - budget.boundary_side * base.boundary_sides()));
  }
  const LayoutSearchOptions prices;
  out.skin.price = prices.price;
  out.skin.irregular_price = prices.irregular_price;
  out.skin.trials = kTrials;
  out.skin.threshold = excess_of_stretch(options.stretch_threshold);
  return out;
}

std::vector<Plan::Region> grow_skin(Construction& made, const RemeshTask& task, const SkinOptions& options) {
  if (options.level == 0) return {};
  if (options.even_quads == 0) {
    // Even quads of the base need nothing. Those that come of a stretched one are stretched where it is: a level further up shows it.
    LevelState level = made.state();
    for (int k = 0; k <= options.level; ++k) level = quadrisected(level);
    if (!(largest_area_ratio(level) > task.options.stretch_threshold)) return {};
  }
  return Skin(made, task, options).run();
}

}  // namespace hybrid_mesh
