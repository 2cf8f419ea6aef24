// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/late_topology.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "base/found.h"
#include "layout/operations/topology_opening.h"
#include "remesh/plan_regions.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

constexpr double kQuadsAround = 4;  // of a loop that opens: with fewer the tube is a pinch
constexpr double kMostRise = 0.3;   // of energy a new quad: above it they are far from square, and a finer level may have better ones
constexpr double kWorstRise = 10;   // ... above which the mesh would be a wreck there: it is not opened
constexpr int kMostMargin = 2;      // rings of quads beside what covers it

class LateOpening {
 public:
  LateOpening(Construction& made, const RemeshTask& task, std::int64_t most_quads)
      : made_(made), task_(task), most_quads_(most_quads), reasons_(made.surface().open.size()) {}

  LateTopology run() {
    if (!closed().empty() && made_.level() == 0) made_.refine();  // root quads stay
    for (const int e : closed())
      if (task_.base.levels[e] < made_.level())
        reasons_[e] = "nothing opens below level " + std::to_string(made_.level()) + ", on which quads are laid out anew";
    for (bool last = false; !last;) {
      last = 4 * static_cast<std::int64_t>(made_.quads().graph().patch_count()) > most_quads_;
      open_level(last);
      if (closed().empty()) break;
      if (last) continue;
      made_.refine();
      covering_ = std::move(finer_covering_);
      finer_covering_ = {};
    }
    for (const int e : closed()) out_.unopened.push_back({e, reasons_[e]});
    out_.waited = std::move(reasons_);
    return std::move(out_);
  }

 private:
  std::vector<int> closed() const {
    std::vector<int> out;
    for (std::size_t e = 0; e < made_.surface().open.size(); ++e)
      if (!made_.surface().open[e]) out.push_back(static_cast<int>(e));
    return out;
  }

  // Of the event's loop in unit size, as the level's quads count it.
  double length_of(const LevelState& state, int e) const {
    const SurfaceSeries& series = *state.surface.series;
    const double length = series.events[e].length / task_.source.placement.diagonal;
    return state.sizes ? length * state.sizes->fineness(series.input.points[series.events[e].loops[0].front()]) : length;
  }

  // `last`: what is too small to be shown may open as well.
  void open_level(bool last) {
    const LevelState first = made_.state();
    const double width = std::sqrt(first.area / first.quads.patch_count());
    for (const int e : closed()) {
      task_.progress.check();
      const int level = task_.base.levels[e];
      const double length = length_of(first, e);
      if (made_.level() < level) {
        reasons_[e] = "the mesh does not have the level on which it is to open";
        continue;
      }
      if (level < 0 && length < kQuadsAround * width && !last) {
        reasons_[e] = "its quads are too large to go around it";
        continue;
      }
      try_to_open(e, last || level >= 0, last);
    }
  }

  // An event that has been laid out and mapped.
  struct Opening {
    RegionRepatch region;
    MappedEdit mapped;
    double rise() const { return (mapped.energy_after - mapped.energy_before) / static_cast<double>(mapped.edit.quads.size()); }
  };

  // Opens it where that leaves good quads, close to its caps or with more room around; `anyhow`: also where it does not, in the best way; `last`:
  // there is no finer level.
  void try_to_open(int e, bool anyhow, bool last) {
    const LevelState state = made_.state();
    std::optional<Opening> best = best_opening(state, covering_, e, false);
    if (!best && last) best = best_opening(state, covering_, e, true);
    if (!best) return;
    if (best->rise() > kWorstRise || (best->rise() > kMostRise && !anyhow && is_better_finer(state, e, best->rise()))) {
      reasons_[e] = "its quads would be distorted";
      return;
    }
    Plan::Region planned = region_of(best->region, made_);
    // As many rows as they have become: on another surface they are as many.
    if (planned.pattern.kind == RegionPattern::Kind::Rows)
      planned.pattern.height = static_cast<int>(best->mapped.edit.quads.size() / rim_of(state, best->region));
    out_.regions.push_back(std::move(planned));
    made_.apply(std::move(best->mapped));
  }

  std::optional<Opening> best_opening(const LevelState& state, CoveringSearch& search, int e, bool together) {
    const CoveringQuads covering = search.quads_of(state);
    std::optional<Opening> best;
    for (int margin = 0; margin <= kMostMargin && !(best && best->rise() <= kMostRise); ++margin) {
      std::optional<Opening> found = find(state, covering, e, {margin, together});
      if (!found) continue;
      if (best && found->rise() >= best->rise()) break;  // more room makes it no better
      best = std::move(found);
    }
    return best;
  }

  // Would it leave better quads on the next level? Where what opens is wide beside its quads a finer level has more of them to distort.
  bool is_better_finer(const LevelState& state, int e, double rise) {
    const std::optional<Opening> finer = best_opening(quadrisected(state), finer_covering_, e, false);
    return finer && finer->rise() < rise;
  }

  std::optional<Opening> find(const LevelState& state, const CoveringQuads& covering, int e, const OpeningRoom& room) {
    const Found<RegionRepatch> region = find_opening(state, covering, e, room);
    if (!region) {
      reasons_[e] = region.reason;
      return std::nullopt;
    }
    try {
      Found<MappedEdit> mapped = found([&] { return repatch_region(state, *region, task_.progress.part(0.55, 0.55)); });
      if (mapped) return Opening{*region, std::move(*mapped)};
      reasons_[e] = mapped.reason;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::InvalidInput) throw;
      reasons_[e] = error.what();  // the quads around have no room for such a layout
    }
    return std::nullopt;
  }

  // Sides of the region's first rim.
  static std::size_t rim_of(const LevelState& state, const RegionRepatch& region) {
    return make_region(state.quads, region.patches, region.starts)->rims[1];
  }

  Construction& made_;
  const RemeshTask& task_;
  std::int64_t most_quads_;
  std::vector<std::string> reasons_;
  CoveringSearch covering_, finer_covering_;  // of the level, and of its quads' quadrants
  LateTopology out_;
};

}  // namespace

std::int64_t most_quads_to_open(const RemeshOptions& options, std::int64_t vertices) {
  constexpr std::int64_t deeper = 4;
  return options.refinement == Refinement::Adaptive ? deeper * vertices : vertices;
}

LateTopology open_late(Construction& made, const RemeshTask& task, std::int64_t most_quads) { return LateOpening(made, task, most_quads).run(); }

}  // namespace hybrid_mesh
