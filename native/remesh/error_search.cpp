// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/error_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/limits.h"
#include "remesh/figures.h"
#include "remesh/level_fits.h"
#include "remesh/mirror_sides.h"

namespace hybrid_mesh {
namespace {

constexpr int kMostSteps = 4;                    // to bases of other sizes
constexpr std::int64_t kMostVertices = 1000000;  // unless a number is given, or the surface has more

struct Attempt {
  std::int64_t vertices = 0;  // 0: none was made
  double l2 = 0;
};

class ErrorSearch {
 public:
  ErrorSearch(const RemeshTask& task, Candidate first, bool any_base)
      : task_(task), best_(std::move(first)), any_base_(any_base && task.options.base == BaseSize::Auto) {}

  // The levels of a base differ fourfold in vertices, so that the first one that meets the bound may have four times too many; the size of the base,
  // though, can be chosen almost freely. The error falls about as 1 / vertices (fitted quads follow a smooth surface to second order in their size),
  // by which the meshes made so far tell the size of the next. A base costs as much as all its levels, and bases of about one size differ by some per
  // cent in their errors: hence a few steps, each of which promises to save some vertices, and not a search to the end.
  Candidate run() {
    const Attempt first = climb();
    (first.l2 <= options().error ? enough_ : too_few_) = first;
    const bool one_level = options().levels >= 0, may_grow = options().vertices == 0 && one_level;
    for (int step = 0; step < kMostSteps && any_base_ && (enough_.vertices > 0 || may_grow); ++step) {
      target_.vertices = next_aim();
      if (target_.vertices > most_vertices() ||
          (enough_.vertices > 0 && (target_.vertices > 0.93 * enough_.vertices || target_.vertices < 1.03 * too_few_.vertices)))
        break;
      Attempt made;
      std::optional<Candidate> candidate = try_target(made);
      const bool met = made.vertices > 0 && made.l2 <= options().error;
      const bool better = enough_.vertices == 0 ? made.vertices > 0 : met && made.vertices < enough_.vertices;
      if (better) best_ = std::move(*candidate);
      if (made.vertices == 0 || (met && !better)) break;
      (met ? enough_ : too_few_) = made;
    }
    if (enough_.vertices == 0 && options().vertices == 0 && (any_base_ || !one_level))
      throw Error(ErrorCode::InvalidInput, "the error bound " + scientific(options().error) +
                                               " is out of reach: " + std::to_string(too_few_.vertices) + " vertices have an L2 distance of " +
                                               scientific(too_few_.l2) + ", and " + std::to_string(most_vertices()) +
                                               ", the most that are tried unless a number is given, would not do");
    return std::move(best_);
  }

 private:
  const RemeshOptions& options() const { return task_.options; }

  std::int64_t most_vertices() const { return options().vertices > 0 ? options().vertices : std::max(kMostVertices, task_.source.points); }

  double measured_l2(const QuadMesh& mesh, std::int64_t samples) const {
    DistanceOptions distance;
    distance.samples = samples;
    return task_.source.reference->distance(to_soup(mesh), distance, task_.progress.part(0.6, 0.6)).l2;
  }

  // Measured as the report does, so that it says the same; fewer samples are enough to see that a mesh is far off.
  Attempt measured(const Candidate& c) const {
    double l2 = measured_l2(c.final_mesh, 20000);
    if (l2 <= 1.1 * options().error) l2 = measured_l2(c.final_mesh, DistanceOptions().samples);
    return {whole_vertices(c.final_mesh, task_.source), l2};
  }

  // The first of the base's levels that meets the error bound, else the last one that the other bounds allow.
  Attempt climb() {
    const bool one_level = options().levels >= 0;
    const int last = options().vertices > 0 || one_level ? best_.levels : limits::most_levels;
    for (int level = one_level ? last : 0;; ++level) {
      fit_uniform(task_, best_, level);
      const Attempt made = measured(best_);
      if (made.l2 <= options().error || level == last || 4 * made.vertices > most_vertices()) return made;
      // Not worth the wait if even errors that fall faster than they do would not fall enough.
      if (options().vertices == 0 &&
          made.l2 * std::pow(static_cast<double>(made.vertices) / static_cast<double>(most_vertices()), 1.2) > options().error)
        return made;
    }
  }

  std::int64_t next_aim() const {
    double vertices = 0;
    if (enough_.vertices == 0 || too_few_.vertices == 0) {
      const Attempt& known = enough_.vertices > 0 ? enough_ : too_few_;
      // Too far rather than not far enough when it is to grow: from above it comes closer, from below it is in danger of never arriving.
      vertices = static_cast<double>(known.vertices) * std::pow(known.l2 / options().error, enough_.vertices > 0 ? 1.0 : 1.3);
    } else {
      const double part = std::log(too_few_.l2 / options().error) / std::log(too_few_.l2 / enough_.l2);
      vertices =
          static_cast<double>(too_few_.vertices) * std::pow(static_cast<double>(enough_.vertices) / static_cast<double>(too_few_.vertices), part);
    }
    return static_cast<std::int64_t>(1.03 * vertices);  // rather met than just missed
  }

  // A mesh on a base that is planned for the target; nothing if no base of that size can be made. Where the error is far above what the size
  // promises, the base is too coarse for the shape and has lost a tip: then the same on a base of four times as many quads, from now on.
  std::optional<Candidate> try_target(Attempt& made) {
    for (;;) {
      std::optional<Candidate> c = search_candidate(task_, target_, base_requests(options(), false)).candidate.value;
      made = {};
      if (!c) return c;
      fit_uniform(task_, *c, c->levels);
      made = measured(*c);
      if (made.l2 < 1.3 * options().error || options().levels >= 0 || c->levels == 0 || target_.levels_less == 1) return c;
      target_.levels_less = 1;
    }
  }

  const RemeshTask& task_;
  Candidate best_;
  const bool any_base_;
  Target target_;
  Attempt enough_, too_few_;  // the fewest vertices that met the bound and the most that did not
};

}  // namespace

Candidate meet_error(const RemeshTask& task, Candidate candidate, bool any_base) { return ErrorSearch(task, std::move(candidate), any_base).run(); }

}  // namespace hybrid_mesh
