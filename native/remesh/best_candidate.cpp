// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/best_candidate.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "remesh/error_search.h"
#include "remesh/level_fits.h"
#include "remesh/need.h"
#include "remesh/protrusion.h"
#include "remesh/quality.h"
#include "remesh/verdict.h"

namespace hybrid_mesh {

Candidate fitted(const RemeshTask& task, Candidate c, bool may_change_base) {
  const RemeshOptions& options = task.options;
  if (options.refinement == Refinement::Adaptive)
    fit_adaptive(task, c, options.vertices > 0 ? options.vertices : task.source.points);
  else if (options.error > 0)
    c = meet_error(task, std::move(c), may_change_base);
  else
    fit_uniform(task, c, c.levels);
  finish_levels(task, c);
  return c;
}

namespace {

// Above so many widths of a quad that the surface sticks out of the mesh, the base has missed a limb.
constexpr double kMissed = 1.25;
// Where another base may be no minimal one, or there are handles, around which a minimal base follows little more (three buddhas: L2 3 % better in
// one, none in two), only what sticks out by this is worth its time. (Scans with limbs that are lost: 2.4 and 8.8; all others with handles:
// below 1.9; a buddha of 1.6 million rough triangles, of which the second base takes as long as the first: 2.01.)
constexpr double kMissedByFar = 2.25;

bool may_be_minimal(const RemeshTask& task) { return task.options.base == BaseSize::Auto && !task.options.semi_regular; }

// Does the surface stick out of the final mesh by so many widths of its quads?
bool sticks_out(const RemeshTask& task, const Candidate& c, double widths) {
  const double most = widths * mean_width(c.final_mesh);
  return c.distance.hausdorff >= most && protrusion(task.source.repaired, task.source.placement, c.final_mesh) >= most;
}

bool misses_a_limb(const RemeshTask& task, const Candidate& c) {
  const bool likely = may_be_minimal(task) && task.source.topology.genus <= static_cast<double>(task.source.topology.components);
  return sticks_out(task, c, likely ? kMissed : kMissedByFar);
}

// Of the requests for a minimal base where it is only one of the ways that are tried: the first ones are the cheapest.
constexpr std::size_t kMinimalRequests = 2;

// What is tried where the first remesh has missed something: a minimal base, which has few quads and grows skin on a finer level, keeps limbs that a
// fitted one loses; else a base of which near-ties are decided in another way.
Found<Candidate> another_candidate(const RemeshTask& task) {
  RemeshOptions options = task.options;
  const bool minimal = may_be_minimal(task);
  if (minimal) options.base = BaseSize::Minimal;
  const RemeshTask other{options, task.source, task.base, task.progress, task.watch};
  std::vector<BaseRequest> requests = base_requests(options, !minimal);
  if (minimal) requests.resize(kMinimalRequests);
  Found<Candidate> c = search_candidate(other, {.features = false}, requests).candidate;
  if (c) c = {fitted(other, std::move(*c), true), {}};
  return c;
}

bool may_be_finer(const RemeshTask& task) {
  const RemeshOptions& options = task.options;
  return options.base == BaseSize::Auto && options.refinement == Refinement::Uniform && plan_budget(options, task.source, {}).levels > 1;
}

// A base of four times the quads, one level lower: it goes out into limbs in which every quad of a smaller one has another limb beside it, and has
// more to lay along folds.
Found<Candidate> finer_candidate(const RemeshTask& task, const Candidate& than) {
  const int planned = plan_budget(task.options, task.source, {.features = false}).levels;
  const int levels = std::min(planned, than.levels) - 1;
  if (levels < 1) return {std::nullopt, "no level is left for it"};
  Found<Candidate> c = search_candidate(task, {.levels_less = planned - levels, .features = false}, base_requests(task.options, false)).candidate;
  if (c) c = {fitted(task, std::move(*c), true), {}};
  return c;
}

void keep_better(Candidate& best, Found<Candidate> other) {
  if (other && other->distance.hausdorff < best.distance.hausdorff && other->distance.l2 <= best.distance.l2) best = std::move(*other);
}

// Between sharp sides quads may have no room. A mesh of which so many quads are inverted is compared with one without sharp sides.
constexpr double kManyInverted = 0.005;
// ... and of so many no other base between the same sides is tried.
constexpr double kHopeless = 0.05;

double inverted(const Candidate& c) { return quad_quality(c.final_mesh).inverted; }

// Is so much inverted where the maps put it, between sharp sides? No fit unfolds that.
bool is_hopeless(const RemeshTask& task, Candidate& c) {
  if (!c.keeps_features || task.options.refinement != Refinement::Uniform || task.options.error > 0) return false;
  c.hierarchy.refine_uniform(std::max(c.levels, c.finest));
  return quad_quality(c.hierarchy.level_mesh(c.levels)).inverted > kHopeless;
}

// Above so many widths of a quad by which the surface sticks out of the mesh where the map puts it, no fit brings it there.
constexpr double kUncovered = 3;
constexpr int kMostLevelsLess = 2;

// Do the maps put the final mesh's vertices where the surface is reached? A limb whose tip is in the middle of a base's quad has none there.
bool is_covered(const RemeshTask& task, Candidate& c) {
  c.hierarchy.refine_uniform(std::max(c.levels, c.finest));
  const QuadMesh mesh = c.hierarchy.level_mesh(c.levels);
  return protrusion(task.source.repaired, task.source.placement, mesh) < kUncovered * mean_width(mesh);
}

// Of the least base with which all of the surface is covered; of the target's if there is none.
CandidateSearch covering_candidate(const RemeshTask& task, const Target& target, bool another) {
  const RemeshOptions& options = task.options;
  CandidateSearch first = search_candidate(task, target, base_requests(options, another));
  const bool may_change =
      options.effort != Effort::Quick && options.error == 0 && options.levels < 0 && may_be_finer(task) && !(target.features && keeps_features(task));
  if (!may_change || !first.candidate || is_covered(task, *first.candidate)) return first;
  for (Target finer = target; ++finer.levels_less <= kMostLevelsLess;) {
    CandidateSearch search = search_candidate(task, finer, base_requests(options, another));
    if (!search.candidate) break;
    if (is_covered(task, *search.candidate)) return search;
  }
  return first;
}

// The best of what is tried for a target. `another`: with near-ties decided in another way. Not fitted where some of the topology finds no room to
// open.
CandidateSearch best_for(const RemeshTask& task, const Target& target, bool another) {
  CandidateSearch search = covering_candidate(task, target, another);
  if (!search.candidate || !search.candidate->unopened.empty()) return search;
  Candidate& best = *search.candidate;
  if (target.features && is_hopeless(task, best)) {
    search.candidate = {std::nullopt, "the quads between them would be distorted"};
    return search;
  }
  best = fitted(task, std::move(best), true);
  if (best.keeps_features || task.options.error > 0 || task.options.effort == Effort::Quick || !misses_a_limb(task, best)) return search;
  keep_better(best, another_candidate(task));
  return search;
}

// What counts against a mesh: how bad what makes it poor is, then distance, and a good deal more of it where quads are inverted.
struct Badness {
  double severity = std::numeric_limits<double>::infinity(), distance = 0;  // of what was not found
  bool quads_are_too_large = false;                                         // somewhere
  bool operator<(const Badness& o) const { return std::tie(severity, distance) < std::tie(o.severity, o.distance); }
};
Badness badness(const RemeshTask& task, const Candidate& c) {
  constexpr double all_inverted = 100;  // times the distance
  constexpr double unseen = 1e-4;       // a distance that no one sees: what comes nearer may not have more inverted quads for it
  Badness b{0, (c.distance.l2 + unseen) * (1 + all_inverted * inverted(c))};
  for (const Reason& reason : reasons_against(measured(task, c, task.progress.part(1, 1)))) {
    b.severity += reason.severity;
    b.quads_are_too_large |= reason.what == "hausdorff" || reason.what == "inverted" || reason.what == "self_intersections";
  }
  return b;
}

// How often a mesh is made anew by what the one before shows that quads need, and of which surfaces and bases.
struct NeedBounds {
  int tries;
  std::int64_t base_quads;
  std::size_t faces;
};
NeedBounds need_bounds(Effort effort) {
  if (effort == Effort::Quick) return {0, 0, 0};
  if (effort == Effort::Normal) return {2, 1500, 500000};
  return {4, std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::size_t>::max()};
}

// Without sharp edges. Where quads are too large for the shape somewhere and that makes a uniform mesh poor, a finer base is tried; then, on the base
// that comes nearer, smaller quads there, and again with what that mesh shows.
CandidateSearch best_without_features(const RemeshTask& task) {
  CandidateSearch search = best_for(task, {.features = false}, false);
  const RemeshOptions& options = task.options;
  const NeedBounds bounds = need_bounds(options.effort);
  const bool may_change = options.refinement == Refinement::Uniform && options.error == 0 && options.levels < 0 && options.base != BaseSize::Given &&
                          !task.source.density.sizes && !task.source.mirror && !task.base.series && task.source.repaired.faces.size() <= bounds.faces;
  if (!search.candidate || !may_change) return search;
  Candidate& best = *search.candidate;
  Badness least = badness(task, best);
  Target target{.features = false};
  Found<Candidate> finer;  // as long as it is not the best
  const Candidate* shows = &best;
  if (least.quads_are_too_large && may_be_finer(task)) finer = finer_candidate(task, best);
  if (finer) {
    const Badness counts = badness(task, *finer);
    if (counts.distance < least.distance) {
      target.levels_less = plan_budget(options, task.source, target).levels - finer->levels;
      shows = &*finer;
    }
    if (counts < least) {
      best = std::move(*finer), least = counts;
      shows = &best;
    }
  }
  if (!least.quads_are_too_large || shows->hierarchy.base_count() > bounds.base_quads) return search;
  const TriangleSurface placed = task.source.placement.to_unit(task.source.repaired);
  Need need(placed);
  for (int k = 0; k < bounds.tries && least.quads_are_too_large && need.learn_from(shows->final_mesh, task.progress.part(1, 1)); ++k) {
    const RemeshTask sized{options, task.source, task.base, task.progress, task.watch, gradual_sizes(placed, need.size())};
    Found<Candidate> found = search_candidate(sized, target, base_requests(options, false)).candidate;
    if (!found) break;
    found = {fitted(sized, std::move(*found), true), {}};
    found->by_need = true;
    const Badness counts = badness(task, *found);
    if (!(counts < least)) break;
    best = std::move(*found), least = counts;
    shows = &best;
  }
  return search;
}

// With the sharp edges of the surface, or, where these cannot be kept or make it worse, without.
CandidateSearch best_with_features(const RemeshTask& task) {
  // While something makes the mesh poor: a base of which near-ties are decided in another way, then one of four times the quads, which is slower.
  struct Way {
    Target target;
    bool another;
  };
  std::vector<Way> ways{{{}, false}};
  if (may_be_finer(task) && task.options.effort != Effort::Quick) ways.insert(ways.end(), {{{}, true}, {{.levels_less = 1}, false}});
  std::optional<CandidateSearch> best;
  Badness least;
  for (const Way& way : ways) {
    CandidateSearch found = best_for(task, way.target, way.another);
    const Badness counts = found.candidate ? badness(task, *found.candidate) : Badness();
    if (!best || counts < least) best = std::move(found), least = counts;
    if (least.severity == 0) return std::move(*best);
    if (best->candidate && inverted(*best->candidate) > kHopeless) break;
  }
  CandidateSearch with = std::move(*best);
  if (with.candidate && inverted(*with.candidate) < kManyInverted) return with;
  CandidateSearch without = best_for(task, {.features = false}, false);
  if (!without.candidate || (with.candidate && least.distance <= badness(task, *without.candidate).distance))
    return with.candidate ? std::move(with) : without;
  without.candidate->lost_features = with.candidate ? "the quads between them would be distorted" : with.candidate.reason;
  return without;
}

}  // namespace

Found<Candidate> best_candidate(const RemeshTask& task) {
  CandidateSearch best = keeps_features(task) ? best_with_features(task) : best_without_features(task);
  // What opens late is tried in the base next.
  if (!best.candidate && !task.base.series) throw Error(best.too_many > 0 ? ErrorCode::InvalidInput : ErrorCode::Unsupported, best.candidate.reason);
  return std::move(best.candidate);
}

}  // namespace hybrid_mesh
