// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/late_topology.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "base/found.h"
#include "layout/operations/topology_opening.h"
#include "remesh/plan_regions.h"
#include "remesh/quality.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

constexpr double kQuadsAround = 4;    // of a loop that opens: with fewer the tube is a pinch
constexpr double kMostRise = 0.3;     // of energy a new quad: above it they are far from square, and a finer level may have better ones
constexpr double kLeastShape = 0.58;  // of the new quads' scaled Jacobians, the 5th percentile: below it likewise; the fit takes a little of it
constexpr double kShare = 0.15;       // of the vertices, among all that opens: for more of them nothing waits for better shaped quads
constexpr int kFewQuads = 24;         // of an opening: where not even they have room in its share, shape does not count
// Of an adaptive mesh a quad that opens on a fine level: around it are as many again, and all of them are split where hanging nodes are closed.
constexpr double kVerticesAQuad = 8;
constexpr double kWorstRise = 10;  // ... above which the mesh would be a wreck there: it is not opened
constexpr int kMostMargin = 2;     // rings of quads beside what covers it

class LateOpening {
 public:
  LateOpening(Construction& made, const RemeshTask& task, const OpeningBounds& bounds)
      : made_(made), task_(task), bounds_(bounds), reasons_(made.surface().open.size()) {}

  LateTopology run() {
    if (!closed().empty() && made_.level() == 0) made_.refine();  // root quads stay
    for (const int e : closed())
      if (task_.base.levels[e] < made_.level())
        reasons_[e] = "nothing opens below level " + std::to_string(made_.level()) + ", on which quads are laid out anew";
    for (bool last = false; !last;) {
      last = 4 * static_cast<std::int64_t>(made_.quads().graph().patch_count()) > bounds_.quads;
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
    double rise = 0;   // of energy a new quad
    double shape = 1;  // 5th percentile of the new quads' scaled Jacobians, by their corners on the surface; 1 where they do not count
    bool is_even() const { return rise <= kMostRise; }
    // Beside what is wanted: above 1 a finer level is looked at.
    double severity() const { return std::max(rise / kMostRise, (1 - shape) / (1 - kLeastShape)); }
  };

  // Opens it where that leaves good quads, close to its caps or with more room around; `anyhow`: also where it does not, in the best way; `last`:
  // there is no finer level.
  void try_to_open(int e, bool anyhow, bool last) {
    const LevelState state = made_.state();
    std::optional<Opening> best = best_opening(state, covering_, e, false);
    if (!best && last) best = best_opening(state, covering_, e, true);
    if (!best) return;
    if (best->rise > kWorstRise || (best->severity() > 1 && !anyhow && is_better_finer(state, e, *best))) {
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

  // `even`: there is one already whose quads are even, if not well shaped.
  std::optional<Opening> best_opening(const LevelState& state, CoveringSearch& search, int e, bool together, bool even = false) {
    const CoveringQuads covering = search.quads_of(state);
    std::optional<Opening> best;
    for (int margin = 0; margin <= kMostMargin && !(best && best->severity() <= 1); ++margin) {
      const Found<RegionRepatch> region = find_opening(state, covering, e, {margin, together});
      if (!region) {
        reasons_[e] = region.reason;
        continue;
      }
      if ((even || (best && best->is_even())) && !is_affordable(region->patches.size())) break;
      std::optional<Opening> found = laid_out(state, *region, e);
      if (!found) continue;
      if (best && found->severity() >= best->severity()) break;  // more room makes it no better
      best = std::move(found);
    }
    return best;
  }

  // Does the mesh have the vertices for what opens to have as many quads each, for the sake of their shape alone? In a uniform one they are refined
  // with all others, and a few too many cost a whole level.
  bool is_affordable(std::size_t quads) const {
    if (task_.options.refinement == Refinement::Uniform) return false;
    const double share = kShare * static_cast<double>(bounds_.vertices) / static_cast<double>(made_.surface().open.size());
    return kVerticesAQuad * static_cast<double>(quads) <= share;
  }

  // Would it leave better quads on the next level? Where what opens is wide beside its quads a finer level has more of them to distort.
  bool is_better_finer(const LevelState& state, int e, const Opening& here) {
    const std::optional<Opening> finer = best_opening(quadrisected(state), finer_covering_, e, false, here.is_even());
    return finer && finer->severity() < here.severity();
  }

  std::optional<Opening> laid_out(const LevelState& state, const RegionRepatch& region, int e) {
    try {
      Found<MappedEdit> mapped = found([&] { return repatch_region(state, region, task_.progress.part(0.55, 0.55)); });
      if (mapped) return opening(state, region, std::move(*mapped));
      reasons_[e] = mapped.reason;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::InvalidInput) throw;
      reasons_[e] = error.what();  // the quads around have no room for such a layout
    }
    return std::nullopt;
  }

  Opening opening(const LevelState& state, const RegionRepatch& region, MappedEdit mapped) const {
    const double rise = (mapped.energy_after - mapped.energy_before) / static_cast<double>(mapped.edit.quads.size());
    // The disks that close a tube's ends are no better shaped with more room or on a finer level: they take in what it had hidden.
    const bool is_tube = made_.surface().series->events[region.opens.front()].kind == EventKind::Tube;
    if (is_tube || !is_affordable(kFewQuads)) return {region, std::move(mapped), rise};
    LevelState after = state;
    std::vector<double> shapes;
    for (const int q : apply(after, mapped).added) shapes.push_back(scaled_jacobian(corner_positions(*after.maps[q].map)));
    std::sort(shapes.begin(), shapes.end());
    return {region, std::move(mapped), rise, shapes[shapes.size() / 20]};
  }

  // Sides of the region's first rim.
  static std::size_t rim_of(const LevelState& state, const RegionRepatch& region) {
    return make_region(state.quads, region.patches, region.starts)->rims[1];
  }

  Construction& made_;
  const RemeshTask& task_;
  OpeningBounds bounds_;
  std::vector<std::string> reasons_;
  CoveringSearch covering_, finer_covering_;  // of the level, and of its quads' quadrants
  LateTopology out_;
};

}  // namespace

OpeningBounds opening_bounds(const RemeshOptions& options, std::int64_t vertices) {
  constexpr std::int64_t deeper = 4;
  return {vertices, options.refinement == Refinement::Adaptive ? deeper * vertices : vertices};
}

LateTopology open_late(Construction& made, const RemeshTask& task, const OpeningBounds& bounds) { return LateOpening(made, task, bounds).run(); }

}  // namespace hybrid_mesh
