// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/plan_regions.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "layout/search/region_repatch.h"

namespace hybrid_mesh {
namespace {

// Does the regions one after another.
class RegionRepatcher {
 public:
  RegionRepatcher(const TriangleSurface& surface, BaseMap& map, const Placement& placement, const Progress& progress)
      : surface_(surface), map_(map), placement_(placement), progress_(progress), layout_(map.levels.front().layout) {}

  RegionEdit operator()(const Plan::Region& region, std::size_t number) {
    const std::string place = "the plan's operations[" + std::to_string(number) + "]: ";
    try {
      return repatch(region);
    } catch (LayoutError& e) {
      for (LayoutProblem& p : e.problems)
        for (Vec3& w : p.where) w = placement_.from_unit(w);
      throw;
    } catch (const Error& e) {
      if (e.code() == ErrorCode::Internal) throw Error(ErrorCode::Unsupported, place + "no map to its new quads is found: " + e.what());
      if (e.code() == ErrorCode::InvalidInput) throw Error(ErrorCode::InvalidInput, place + e.what());
      throw;
    }
  }

 private:
  int find(const std::string& address) const {
    const int q = layout_.find(address);
    if (q < 0) throw Error(ErrorCode::InvalidInput, "level " + std::to_string(level_) + " has no quad " + address);
    return q;
  }

  RegionEdit repatch(const Plan::Region& region) {
    if (const int finest = map_.levels.back().level; region.level < finest)
      throw Error(ErrorCode::InvalidInput,
                  "level " + std::to_string(region.level) + " cannot be laid out anew: level " + std::to_string(finest) + " has operations already");
    while (level_ < region.level) {
      if (4 * static_cast<std::int64_t>(layout_.addresses().size()) > kMostPlanQuads)
        throw Error(ErrorCode::InvalidInput,
                    "level " + std::to_string(region.level) + " would have more than " + std::to_string(kMostPlanQuads) + " quads");
      layout_.quadrisect();
      if (++level_ < static_cast<int>(map_.script.levels.size())) layout_.apply(map_.script.levels[level_]);
    }
    RegionRepatch repatch;
    for (const std::string& address : region.quads) repatch.patches.push_back(find(address));
    if (!region.start_quad.empty()) repatch.start = {find(region.start_quad), region.start_side};
    repatch.pattern = region.pattern;
    for (DrawnStroke& s : repatch.pattern.strokes)
      for (Vec3& p : s.points) p = placement_.to_unit(p);
    repatch.buffer_rings = region.buffer_rings;
    LevelMap level = map_.levels.back();
    const bool fresh = level.level < region.level;
    for (; level.level < region.level; ++level.level) {
      level.charts.quadrisect();
      level.layout = quadrisected(std::move(level.layout));
    }
    if (fresh) level.changed.assign(level.layout.patch_count(), 0);
    RegionEdit made{region.level, repatch_region(surface_, level, repatch, progress_)};
    if (fresh)
      map_.levels.push_back(std::move(level));
    else
      map_.levels.back() = std::move(level);
    if (static_cast<int>(map_.edits.size()) <= region.level) map_.edits.resize(region.level + 1);
    map_.edits[region.level].push_back(made.edit);
    layout_.apply({made.edit});
    return made;
  }

  const TriangleSurface& surface_;
  BaseMap& map_;
  const Placement& placement_;
  const Progress& progress_;
  PlanLayout layout_;  // of the level at hand
  int level_ = 0;
};

}  // namespace

std::vector<RegionEdit> repatch_regions(const TriangleSurface& surface, BaseMap& map, const std::vector<Plan::Region>& regions,
                                        const Placement& placement, const Progress& progress) {
  std::vector<std::size_t> order(regions.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return regions[i].level < regions[j].level; });
  std::vector<RegionEdit> made;
  RegionRepatcher repatch(surface, map, placement, progress);
  for (const std::size_t k : order) made.push_back(repatch(regions[k], k));
  return made;
}

}  // namespace hybrid_mesh
