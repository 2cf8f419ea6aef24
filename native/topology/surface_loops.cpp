// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Erickson, Whittlesey, Greedy optimal homotopy and homology generators, 2005 (loops through one point, shortest first); each is then
// tightened around several points, and of all of them disjoint ones are taken, shortest first.
#include "topology/surface_loops.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <unordered_map>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress_steps.h"
#include "topology/loop_cap.h"
#include "topology/loop_graph.h"
#include "topology/loop_kind.h"
#include "topology/patch_hits.h"

namespace hybrid_mesh {
namespace {

// Where there are more loops, they are noise: each is good enough.
constexpr std::size_t most_loops_improved = 64;

struct Candidate {
  std::vector<int> points;
  double length = 0;
};

// The same for every point to start from and both directions.
std::vector<int> canonical(std::vector<int> loop) {
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  if (loop.back() < loop[1]) std::reverse(loop.begin() + 1, loop.end());
  return loop;
}

// Shortest first, each once.
void sort_candidates(std::vector<Candidate>& all) {
  std::sort(all.begin(), all.end(),
            [](const Candidate& a, const Candidate& b) { return std::tie(a.length, a.points) < std::tie(b.length, b.points); });
  all.erase(std::unique(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.points == b.points; }), all.end());
}

class LoopFinder {
 public:
  LoopFinder(const TriangleSurface& surface, const LoopOptions& options, const Progress& progress)
      : surface_(surface), options_(options), graph_(surface, progress) {}

  // The loops, and in kept() which of those given are the first ones.
  std::vector<std::vector<int>> find(const std::vector<GivenLoop>& given, const Progress& progress);
  const std::vector<int>& kept() const { return kept_; }

 private:
  void take_given(const std::vector<GivenLoop>& given);
  std::string obstacle(const std::vector<int>& loop) const;
  void find_roots();
  bool take_all(const Progress& progress);
  bool take_some(const Progress& progress);
  void polish(const Progress& progress);
  void clear_caps(const Progress& progress);
  std::vector<int> points_near(const std::vector<int>& loop, double distance) const;
  void stand_alone(std::size_t loop);
  std::vector<Candidate> around_points(const std::vector<int>& points, double bound, const Progress& progress);
  std::vector<Candidate> candidates(const Progress& progress);
  Candidate tightened(LoopSearch& search, std::vector<int> loop, ProgressSteps& steps) const;

  const TriangleSurface& surface_;
  const LoopOptions& options_;
  LoopGraph graph_;
  std::vector<std::vector<int>> roots_;  // per start: one point a component
  std::vector<std::vector<int>> taken_;
  std::vector<int> kept_;  // the given loops that the first ones of taken_ are
  tbb::enumerable_thread_specific<LoopSearch> searches_{[this] { return LoopSearch(graph_); }};
};

std::vector<std::vector<int>> LoopFinder::find(const std::vector<GivenLoop>& given, const Progress& progress) {
  take_given(given);
  if (static_cast<int>(taken_.size()) == graph_.genus() || options_.longest <= 0) return taken_;
  find_roots();
  // Short loops may leave no room for others where triangles are large: then those of few points are taken, then others.
  constexpr std::uint64_t attempts = 8;
  constexpr double first = 0.6;  // of the time, where the first attempt succeeds
  for (std::uint64_t attempt = 0; attempt < attempts; ++attempt) {
    graph_.measure(attempt == 0 ? EdgeMeasure::Length : attempt == 1 ? EdgeMeasure::Count : EdgeMeasure::Random, attempt);
    const auto later = [&](std::uint64_t number) { return first + (1 - first) * static_cast<double>(number - 1) / (attempts - 1); };
    if (take_all(attempt == 0 ? progress.part(0, first) : progress.part(later(attempt), later(attempt + 1)))) {
      if (attempt == 0) {
        polish(progress.part(first, 0.85));
        clear_caps(progress.part(0.85, 1));
      }
      return taken_;
    }
    graph_.forget_taken();
    take_given(given);
  }
  throw NoMap("the triangles leave no room for " + std::to_string(graph_.genus()) + " loops that do not touch each other: subdivide the surface");
}

void LoopFinder::take_given(const std::vector<GivenLoop>& given) {
  taken_.clear();
  kept_.clear();
  for (std::size_t i = 0; i < given.size(); ++i) {
    std::string why = obstacle(given[i].points);
    if (why.empty() && !graph_.take(given[i].points)) why = "separates the surface, alone or together with loops before it";
    if (why.empty()) {
      taken_.push_back(given[i].points);
      kept_.push_back(static_cast<int>(i));
    } else if (!given[i].name.empty()) {
      throw Error(ErrorCode::InvalidInput, given[i].name + " " + why);
    }
  }
  graph_.renew_keys();
}

// Why it is no simple cycle of edges off the walls; empty if it is one.
std::string LoopFinder::obstacle(const std::vector<int>& loop) const {
  if (loop.size() < 3) return "has fewer than three points";
  for (const int v : loop)
    if (v < 0 || v >= graph_.point_count()) return "has the point " + std::to_string(v) + ", which does not exist";
  std::vector<int> sorted = loop;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return "passes through a point twice";
  if (graph_.touches_wall(loop)) return "touches a boundary or a loop before it";
  for (std::size_t k = 0; k < loop.size(); ++k)
    if (const int v = loop[k], next = loop[(k + 1) % loop.size()]; !graph_.arc(v, next))
      return "has no edge between its points " + std::to_string(v) + " and " + std::to_string(next);
  return "";
}

// Points far from each other, each as far from the middle of its component or from those before it as can be.
void LoopFinder::find_roots() {
  const int components = graph_.component_count(), count = graph_.point_count();
  std::vector<Vec3> middle(components, Vec3::Zero());
  std::vector<double> weight(components, 0);
  for (int v = 0; v < count; ++v) {
    middle[graph_.component(v)] += graph_.at(v);
    weight[graph_.component(v)] += 1;
  }
  for (int c = 0; c < components; ++c) middle[c] /= weight[c];
  std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
  std::vector<Vec3> from = middle;
  const int starts = options_.starts > 0 ? options_.starts : std::clamp(100000 / std::max(count, 1), 3, 12);
  for (int start = 0; start < starts; ++start) {
    std::vector<int> farthest(components, -1);
    for (int v = 0; v < count; ++v) {
      const int c = graph_.component(v);
      const double distance = (graph_.at(v) - from[c]).squaredNorm();
      nearest[v] = start < 2 ? distance : std::min(nearest[v], distance);
      if (!graph_.wall(v) && (farthest[c] < 0 || nearest[v] > nearest[farthest[c]])) farthest[c] = v;
    }
    std::vector<int> roots;
    for (int c = 0; c < components; ++c)
      if (farthest[c] >= 0) {
        roots.push_back(farthest[c]);
        from[c] = graph_.at(farthest[c]);
      }
    roots_.push_back(roots);
  }
}

// False if the loops left have no room.
bool LoopFinder::take_all(const Progress& progress) {
  const int genus = graph_.genus();
  const auto first = taken_.size();
  while (static_cast<int>(taken_.size()) < genus) {
    // How many rounds there will be is not known: most loops are found in the first one.
    constexpr double most = 0.8;
    const double done = static_cast<double>(taken_.size() - first) / (genus - static_cast<double>(first));
    if (!take_some(progress.part(done, done + most * (1 - done)))) return std::isfinite(options_.longest);
  }
  progress(1);
  return true;
}

// Those of one round that do not touch each other, shortest first.
bool LoopFinder::take_some(const Progress& progress) {
  bool any = false;
  for (const Candidate& candidate : candidates(progress)) {
    if (candidate.length > options_.longest || graph_.touches_wall(candidate.points) || !graph_.take(candidate.points)) continue;
    taken_.push_back(candidate.points);
    any = true;
  }
  graph_.renew_keys();
  return any;
}

std::vector<Candidate> LoopFinder::candidates(const Progress& progress) {
  std::vector<std::vector<std::vector<int>>> found(roots_.size());
  ProgressSteps growing(progress.part(0, 0.4), static_cast<std::int64_t>(roots_.size()) * LoopSearch::basis_steps(graph_));
  parallel_for_each_index(static_cast<std::int64_t>(roots_.size()), [&](std::int64_t s) { found[s] = searches_.local().basis(roots_[s], growing); });
  std::vector<std::vector<int>> loops;
  for (const auto& some : found) loops.insert(loops.end(), some.begin(), some.end());
  std::vector<Candidate> all(loops.size());
  ProgressSteps tightening(progress.part(0.4, 1), static_cast<std::int64_t>(loops.size()) * options_.tightenings);
  parallel_for_each_index(static_cast<std::int64_t>(loops.size()),
                          [&](std::int64_t i) { all[i] = tightened(searches_.local(), loops[i], tightening); });
  sort_candidates(all);
  return all;
}

// The loop replaced by the shortest through one of its points, as long as that is shorter. Points are taken from all around it, far from each other.
// Takes as many steps as the options have tightenings.
Candidate LoopFinder::tightened(LoopSearch& search, std::vector<int> loop, ProgressSteps& steps) const {
  double length = search.length_of(loop);
  // As often in vain, around other points each time, and it is tight.
  constexpr int enough = 6;
  // Fractions of the way round, every two neighbours far apart, and any few of them spread evenly.
  constexpr double step = 0.381966011250105;
  double at = 0;
  int searches = 0;
  for (int vain = 0; searches < options_.tightenings && vain < enough; ++searches) {
    at += step;
    at -= std::floor(at);
    // Sums in another order give other last digits: not shorter by more than that is as long.
    const auto base = static_cast<std::size_t>(at * static_cast<double>(loop.size()));
    std::vector<int> other = search.shortest(loop[base], length * (1 - 1e-9), steps.progress());
    steps();
    ++vain;
    if (other.empty()) continue;
    const double before = length;
    length = search.length_of(other);
    loop = std::move(other);
    if (length < 0.999 * before) vain = 0;
  }
  steps(options_.tightenings - searches);
  return {canonical(std::move(loop)), length};
}

// Each loop found is looked for once more between the others, around many of its points.
void LoopFinder::polish(const Progress& progress) {
  constexpr int most_rounds = 8;
  // Searches of a large surface take longer, and find less that the first ones did not.
  const auto bases = static_cast<std::size_t>(std::clamp(1000000 / graph_.point_count(), 8, 64));
  if (taken_.size() > most_loops_improved) return;
  ProgressSteps rounds(progress, most_rounds * static_cast<std::int64_t>(taken_.size() - kept_.size()));
  for (std::size_t i = kept_.size(); i < taken_.size(); ++i) {
    stand_alone(i);
    int round = 0;
    for (; round < most_rounds; ++round, rounds()) {
      const std::vector<int> loop = taken_[i];
      std::vector<int> around;
      for (std::size_t k = 0, n = std::min(bases, loop.size()); k < n; ++k) around.push_back(loop[k * loop.size() / n]);
      const double bound = searches_.local().length_of(loop) * (1 - 1e-9);
      std::vector<Candidate> found = around_points(around, bound, progress);
      if (found.empty()) break;
      taken_[i] = std::move(found[0].points);
    }
    rounds(most_rounds - round);
  }
}

// Of loops whose caps meet the surface, others nearby whose caps do so less.
void LoopFinder::clear_caps(const Progress& progress) {
  if (options_.detour <= 1 || taken_.size() > most_loops_improved) return;
  const PatchHits hits(surface_, progress);
  const auto hits_of = [&](const std::vector<int>& loop, int most) {
    std::vector<Vec3> rim;
    for (const int v : loop) rim.push_back(surface_.points[v]);
    return hits.count(loop, cap_loop(rim), {}, most);
  };
  ProgressSteps done(progress, static_cast<std::int64_t>(taken_.size() - kept_.size()));
  for (std::size_t i = kept_.size(); i < taken_.size(); ++i, done()) {
    int fewest = hits_of(taken_[i], std::numeric_limits<int>::max());
    if (fewest == 0) continue;
    stand_alone(i);
    const std::vector<int> shortest = taken_[i];
    const double length = searches_.local().length_of(shortest);
    // A little longer and close by first.
    for (const double part : {0.125, 0.25, 0.5, 1.0}) {
      if (fewest == 0) break;
      const double bound = (1 + part * (options_.detour - 1)) * length;
      const std::vector<Candidate> others = around_points(points_near(shortest, part * length / 2), bound, progress);
      std::vector<int> counts(others.size());
      parallel_for_each_index(static_cast<std::int64_t>(others.size()), [&](std::int64_t k) {
        progress.check();
        counts[k] = hits_of(others[k].points, fewest);
      });
      // The shortest of those with the fewest.
      for (std::size_t k = 0; k < others.size(); ++k)
        if (counts[k] < fewest) {
          fewest = counts[k];
          taken_[i] = others[k].points;
        }
    }
  }
}

// Some points of the graph within a distance of a loop, in steps as even as their numbers are.
std::vector<int> LoopFinder::points_near(const std::vector<int>& loop, double distance) const {
  std::unordered_map<int, double> reached;
  std::vector<int> queue = loop;
  for (const int v : loop) reached[v] = 0;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const double here = reached[queue[i]];
    for (const LoopGraph::Arc* arc = graph_.begin(queue[i]); arc != graph_.end(queue[i]); ++arc)
      if (here + arc->length < distance && !graph_.wall(arc->to) && reached.emplace(arc->to, here + arc->length).second) queue.push_back(arc->to);
  }
  const auto most = static_cast<std::size_t>(std::clamp(1000000 / graph_.point_count(), 12, 48));
  std::vector<int> some;
  for (std::size_t k = 0, n = std::min(most, queue.size()); k < n; ++k) some.push_back(queue[k * queue.size() / n]);
  return some;
}

// All loops but one are walls.
void LoopFinder::stand_alone(std::size_t loop) {
  graph_.forget_taken();
  for (std::size_t k = 0; k < taken_.size(); ++k)
    if (k != loop) graph_.take(taken_[k]);
  graph_.renew_keys();
}

// The shortest loops through some points, if they are shorter than a bound, shortest first.
std::vector<Candidate> LoopFinder::around_points(const std::vector<int>& points, double bound, const Progress& progress) {
  std::vector<Candidate> all(points.size());
  parallel_for_each_index(static_cast<std::int64_t>(points.size()), [&](std::int64_t k) {
    LoopSearch& search = searches_.local();
    std::vector<int> loop = search.shortest(points[k], bound, progress);
    if (!loop.empty()) all[k] = {canonical(std::move(loop)), 0};
    all[k].length = search.length_of(all[k].points);
  });
  std::erase_if(all, [](const Candidate& candidate) { return candidate.points.empty(); });
  sort_candidates(all);
  return all;
}

}  // namespace

std::vector<std::vector<int>> boundary_cycles(const TriangleSurface& surface) {
  std::vector<std::vector<int>> loops;
  std::vector<char> done(surface.opposite.size(), 0);
  for (std::size_t start = 0; start < done.size(); ++start) {
    if (surface.opposite[start] >= 0 || done[start]) continue;
    loops.emplace_back();
    for (int h = static_cast<int>(start); !done[h];) {
      done[h] = 1;
      loops.back().push_back(surface.from(h));
      h = TriangleSurface::next(h);
      while (surface.opposite[h] >= 0) h = TriangleSurface::next(surface.opposite[h]);
    }
  }
  return loops;
}

double cycle_length(const TriangleSurface& surface, const std::vector<int>& loop) {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) length += (surface.points[loop[i]] - surface.points[loop[(i + 1) % loop.size()]]).norm();
  return length;
}

std::vector<SurfaceLoop> find_loops(const TriangleSurface& surface, const std::vector<GivenLoop>& given, const LoopOptions& options,
                                    const Progress& progress) {
  progress.stage("finding loops");
  progress.check();
  LoopFinder finder(surface, options, progress.part(0, 0.1));
  std::vector<SurfaceLoop> loops;
  for (std::vector<int>& points : finder.find(given, progress.part(0.1, 0.8))) {
    const double length = cycle_length(surface, points);
    const std::size_t i = loops.size();
    loops.push_back({std::move(points), length, LoopKind::Handle, i < finder.kept().size() ? finder.kept()[i] : -1});
  }
  std::stable_sort(loops.begin() + static_cast<std::ptrdiff_t>(finder.kept().size()), loops.end(),
                   [](const SurfaceLoop& a, const SurfaceLoop& b) { return a.length < b.length; });
  progress(0.8);
  ProgressSteps told(progress.part(0.8, 1), 2 * static_cast<std::int64_t>(loops.size()));
  tell_kinds(surface, loops, told);
  progress(1);
  return loops;
}

}  // namespace hybrid_mesh
