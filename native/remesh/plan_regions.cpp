// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/plan_regions.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "base/found.h"
#include "layout/operations/region_repatch.h"

namespace hybrid_mesh {
namespace {

// Does the regions one after another.
class RegionRepatcher {
 public:
  RegionRepatcher(Construction& made, const Placement& placement, const Progress& progress)
      : made_(made), placement_(placement), progress_(progress), finest_(made.level()) {}

  // Whether it was done.
  bool operator()(const Plan::Region& region, std::size_t number) {
    const std::string place = "the plan's operations[" + std::to_string(number) + "]: ";
    try {
      const auto done = found([&] { repatch(region); });
      // On another surface caps may lie elsewhere: what opens there is found anew.
      if (!done && !region.opens.empty()) return false;
      if (!done) throw Error(ErrorCode::Unsupported, place + "no map to its new quads is found: " + done.reason);
      return true;
    } catch (LayoutError& e) {
      for (LayoutProblem& p : e.problems)
        for (Vec3& w : p.where) w = placement_.from_unit(w);
      throw;
    } catch (const Error& e) {
      if (e.code() == ErrorCode::InvalidInput) throw Error(ErrorCode::InvalidInput, place + e.what());
      throw;
    }
  }

 private:
  void repatch(const Plan::Region& region) {
    if (region.level < finest_)
      throw Error(ErrorCode::InvalidInput,
                  "level " + std::to_string(region.level) + " cannot be laid out anew: level " + std::to_string(finest_) + " has operations already");
    while (made_.level() < region.level) {
      if (4 * static_cast<std::int64_t>(made_.quads().graph().patch_count()) > kMostPlanQuads)
        throw Error(ErrorCode::InvalidInput,
                    "level " + std::to_string(region.level) + " would have more than " + std::to_string(kMostPlanQuads) + " quads");
      made_.refine();
    }
    RegionRepatch repatch = resolved(region, made_.quads());
    move_pattern(repatch.pattern, [&](const Vec3& p) { return placement_.to_unit(p); });
    made_.apply(repatch_region(made_.state(), repatch, progress_));
    finest_ = made_.level();
  }

  Construction& made_;
  const Placement& placement_;
  const Progress& progress_;
  int finest_;  // level with operations
};

}  // namespace

RegionRepatch resolved(const Plan::Region& region, const AddressedGraph& level) {
  const auto find = [&](const std::string& address) {
    const int q = level.find(address);
    if (q < 0) throw Error(ErrorCode::InvalidInput, "level " + std::to_string(region.level) + " has no quad " + address);
    return q;
  };
  RegionRepatch repatch;
  for (const std::string& address : region.quads) {
    const int q = find(address);
    if (std::find(repatch.patches.begin(), repatch.patches.end(), q) != repatch.patches.end())
      throw Error(ErrorCode::InvalidInput, "it has quad " + address + " twice");
    repatch.patches.push_back(q);
  }
  for (const auto& [quad, side] : region.starts) repatch.starts.push_back({find(quad), side});
  repatch.pattern = region.pattern;
  repatch.opens = region.opens;
  repatch.buffer_rings = region.buffer_rings;
  return repatch;
}

Plan::Region region_of(const RegionRepatch& repatch, const Construction& made) {
  Plan::Region region;
  region.level = made.level();
  for (const int q : repatch.patches) region.quads.push_back(to_string(made.quads().address(q)));
  region.pattern = repatch.pattern;
  for (const PatchSide& start : repatch.starts) region.starts.push_back({to_string(made.quads().address(start.patch)), start.side});
  region.opens = repatch.opens;
  region.buffer_rings = repatch.buffer_rings;
  return region;
}

std::vector<Plan::Region> repatch_regions(Construction& made, const std::vector<Plan::Region>& regions, const Placement& placement,
                                          const Progress& progress) {
  std::vector<std::size_t> order(regions.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return regions[i].level < regions[j].level; });
  RegionRepatcher repatch(made, placement, progress);
  std::vector<Plan::Region> done;
  for (const std::size_t k : order)
    if (repatch(regions[k], k)) done.push_back(regions[k]);
  return done;
}

}  // namespace hybrid_mesh
