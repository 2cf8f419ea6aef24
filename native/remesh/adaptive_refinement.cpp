// SPDX-License-Identifier: GPL-3.0-or-later
// Greedy by the leaves' squared distances, measured anew on a fitted mesh in every round. To look ahead, and to split where the squared distance
// would fall most, was tried with fitted and with unfitted children and finds no better leaves: a split takes nearly all of a leaf's error with it.
#include "remesh/adaptive_refinement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <string>

#include "hierarchy/mirrored.h"
#include "remesh/surface_fit.h"
#include "remesh/surface_samples.h"

namespace hybrid_mesh {
namespace {

constexpr std::int64_t most_vertices = 4000000;  // at which an error bound alone is given up
constexpr double full = 0.98;                    // of a budget: enough
// What a child keeps of its parent's squared distance, as far as one can tell before it is fitted: the four together a tenth (on a smooth surface it
// would be a sixteenth, on a crease an eighth).
constexpr double kept_by_child = 1.0 / 40;

std::int64_t split_vertices(const HybridMesh& hierarchy) {
  const HybridMesh::LeafCounts c = hierarchy.leaf_counts();
  return hierarchy.closure() == FaceClosure::Quads ? 2 * (c.vertices + c.faces) - c.euler : c.vertices;
}

// A forest whose leaves, closed, are the mesh that is meant.
//
// Where closure splits every leaf (FaceClosure::Quads), it does so only if there are hanging nodes. Leaves without any stand for their children here:
// else the first split would quadruple the mesh, and what was measured before would say little about it.
class LeafMesh {
 public:
  LeafMesh(const HybridMesh& hierarchy, const AdaptiveOptions& options)
      : hierarchy_(hierarchy), deepest_(options.deepest), cut_euler_(options.cut_euler) {
    count_mirror();
  }

  const HybridMesh& hierarchy() const { return hierarchy_; }
  std::int64_t vertices() const {
    const std::int64_t own = splits_all() ? split_vertices(hierarchy_) : closed_vertices(hierarchy_);
    if (!cut_euler_) return own;
    const bool splits = splits_all() || (!hierarchy_.conforming() && hierarchy_.closure() == FaceClosure::Quads);
    return vertices_with_image(own, mirror_sides_, splits, *cut_euler_);
  }
  // The vertices with every leaf refined.
  std::int64_t vertices_of_next_level() const {
    LeafMesh next = *this;
    next.refine_all();
    return next.vertices();
  }
  // The hierarchy whose final mesh is meant.
  HybridMesh closed() const {
    HybridMesh result = hierarchy_;
    if (splits_all())
      for (const int leaf : hierarchy_.leaves()) result.refine(leaf);
    return result;
  }
  bool may_refine(int leaf) const { return hierarchy_.level(leaf) < deepest_; }
  // The nodes that are refined, in order.
  std::vector<int> refine(int leaf) {
    std::vector<int> refined;
    hierarchy_.refine_balanced(leaf, &refined);
    if (cut_euler_)
      for (const int n : refined)
        for (int s = 0; s < 4; ++s) mirror_sides_ += hierarchy_.is_on_mirror(n, s);
    return refined;
  }
  void refine_all() {
    hierarchy_.refine_uniform(hierarchy_.depth() + 1);
    count_mirror();
  }

 private:
  bool splits_all() const { return hierarchy_.closure() == FaceClosure::Quads && hierarchy_.conforming() && hierarchy_.depth() < deepest_; }

  void count_mirror() {
    if (cut_euler_) mirror_sides_ = count_mirror_sides(hierarchy_);
  }

  HybridMesh hierarchy_;
  int deepest_;
  std::optional<int> cut_euler_;
  std::int64_t mirror_sides_ = 0;  // of leaves
};

bool uses(const LeafMesh& mesh, std::int64_t budget) { return static_cast<double>(mesh.vertices()) >= full * static_cast<double>(budget); }

struct LeafErrors {
  std::vector<double> squared;  // by node: squared distance, summed over the surface under a leaf
  double l2 = 0;                // of all, from the surface to the mesh
};

// Splits leaves, those with the largest error first, up to a number of vertices.
class Splitter {
 public:
  Splitter(const LeafMesh& mesh, const LeafErrors& errors, std::int64_t budget, const Progress& progress)
      : mesh_(mesh), errors_(errors.squared), budget_(budget), progress_(progress) {}

  // Until there are `target` vertices, at most `budget`. If it is the budget that is aimed at, splits are chosen so that it is used.
  LeafMesh split_to(std::int64_t target) {
    // A split that drags others along adds more vertices than one would think: from here on, each is tried first.
    const std::int64_t near = budget_ - std::max<std::int64_t>(400, budget_ / 50);
    fill_queue();
    while (mesh_.vertices() < std::min(target, near) && !queue_.empty()) split(next());
    if (target > near) fill(target);
    return std::move(mesh_);
  }

 private:
  struct Entry {
    double error;
    int node;
    bool operator<(const Entry& o) const { return error != o.error ? error < o.error : node > o.node; }
  };

  void fill_queue() {
    queue_ = {};
    for (const int leaf : mesh_.hierarchy().leaves()) push(leaf);
  }
  void push(int leaf) {
    if (mesh_.may_refine(leaf)) queue_.push({errors_[leaf], leaf});
  }
  int next() {
    const int node = queue_.top().node;
    queue_.pop();
    return node;
  }
  void split(int leaf) {
    progress_.check();
    if (!mesh_.hierarchy().is_leaf(leaf)) return;
    const std::vector<int> refined = mesh_.refine(leaf);
    errors_.resize(mesh_.hierarchy().node_count(), 0.0);
    for (const int node : refined)
      for (int k = 0; k < 4; ++k) {
        errors_[mesh_.hierarchy().first_child(node) + k] = errors_[node] * kept_by_child;
        push(mesh_.hierarchy().first_child(node) + k);
      }
  }

  // Splits what fits into the budget. A split adds a dozen vertices or so, more with what it drags along: where a small budget is not used by then,
  // the last splits are taken back, one after the other, and others are made instead.
  void fill(std::int64_t target) {
    const LeafMesh start = mesh_;
    const std::vector<double> start_errors = errors_;
    const std::vector<int> first = split_what_fits(target, 0);
    if (target < budget_) return;
    LeafMesh best = mesh_;
    for (std::size_t back = 1; back <= std::min<std::size_t>(first.size(), 24); ++back)
      for (int skip = 1; skip <= 6; ++skip) {
        if (uses(best, budget_)) break;
        mesh_ = start;
        errors_ = start_errors;
        for (std::size_t i = 0; i + back < first.size(); ++i) split(first[i]);
        fill_queue();
        split_what_fits(target, skip);
        if (mesh_.vertices() > best.vertices()) best = mesh_;
      }
    mesh_ = std::move(best);
  }

  // Passes over the first leaves that fit, as many as `skip` says. Returns the leaves split.
  std::vector<int> split_what_fits(std::int64_t target, int skip) {
    std::vector<int> splits;
    int refused = 0;
    while (mesh_.vertices() < target && !queue_.empty() && (refused < 40 || !uses(mesh_, budget_))) {
      const int leaf = next();
      if (!mesh_.hierarchy().is_leaf(leaf)) continue;
      LeafMesh trial = mesh_;
      trial.refine(leaf);
      if (trial.vertices() > budget_) {
        ++refused;
      } else if (skip > 0) {
        --skip;
      } else {
        split(leaf);
        splits.push_back(leaf);
      }
    }
    return splits;
  }

  LeafMesh mesh_;
  std::vector<double> errors_;  // by node; of new leaves, what is expected
  const std::int64_t budget_;
  const Progress& progress_;
  std::priority_queue<Entry> queue_;
};

class AdaptiveRefinement {
 public:
  AdaptiveRefinement(const HybridMesh& base, const DistanceReference& surface, const AdaptiveOptions& options)
      : surface_(surface), options_(options), budget_(options.vertices > 0 ? options.vertices : most_vertices), base_(base) {}

  QuadMesh run(HybridMesh& result, const Progress& progress) {
    const std::int64_t least = base_vertices();
    if (least > budget_)
      throw Error(ErrorCode::InvalidInput,
                  "the surface needs at least " + std::to_string(least) + " vertices, more than the " + std::to_string(budget_) + " allowed");
    Fitted best = options_.error > 0 ? refine_to_error(progress) : refine_to_budget(progress);
    result = std::move(best.hierarchy);
    return std::move(best.mesh);
  }

 private:
  struct Fitted {
    HybridMesh hierarchy;
    QuadMesh mesh;
  };

  // --- fits and errors -----------------------------------------------------------------------------------------------------------------
  // Of the final mesh. Where the shape needs small quads, distance comes before evenness: vertices may slide further than in a uniform mesh.
  static SurfaceFitOptions final_fit() {
    SurfaceFitOptions options;
    options.apart = true;
    options.first.rounds = 2;
    options.first.square_smoothness = options.first.smoothness / 3;
    return options;
  }

  Fitted fitted(HybridMesh hierarchy, const Progress& progress) const {
    Fitted result{std::move(hierarchy), {}};
    result.mesh = result.hierarchy.final_mesh();
    SurfaceFitOptions options = final_fit();
    options.sizes = options_.sizes;
    options.surface = options_.surface;
    fit_to_surface(result.mesh, result.hierarchy, options, progress);
    return result;
  }

  // By how much the error at a sample counts more. A leaf's squared distances, summed over its area, fall with the sixth power of its size where the
  // surface is smooth: so leaves get the sizes that are wanted where the shape asks for equal ones.
  std::vector<double> importance_of(const std::vector<FitSample>& samples) const {
    if (!options_.sizes) return {};
    std::vector<Vec3> at;
    for (const FitSample& s : samples) at.push_back(s.position);
    std::vector<double> importance = options_.sizes->fineness(at);
    for (double& x : importance) x = std::pow(x, 6);
    return importance;
  }

  // Of the base as it is: where every leaf is split later on, it is not yet.
  std::int64_t base_vertices() const {
    AdaptiveOptions as_it_is = options_;
    as_it_is.deepest = 0;
    return LeafMesh(base_, as_it_is).vertices();
  }

  double distance(const QuadMesh& mesh, const Progress& progress) const { return surface_.distance(to_soup(mesh), DistanceOptions(), progress).l2; }

  LeafErrors errors_of(const LeafMesh& leaves, const Progress& progress) const {
    const HybridMesh closed = leaves.closed();
    QuadMesh mesh = closed.final_mesh();
    const SurfaceSamples samples(closed, fit_sample_count(mesh.points.size()), HybridMesh::max_level, options_.sizes);
    std::vector<FitSample> on = samples.on(closed, mesh);
    fit_mesh(mesh, held_vertices(mesh), parameter_shares(closed, mesh, options_.sizes), on, final_fit().first, progress);
    const std::vector<double> squared = squared_distances(mesh, on);
    LeafErrors errors;
    errors.squared.assign(leaves.hierarchy().node_count(), 0);
    const std::vector<double> importance = importance_of(on);
    double weight = 0;
    for (std::size_t i = 0; i < on.size(); ++i) {
      int node = mesh.node[on[i].face];
      if (node >= leaves.hierarchy().node_count()) node = closed.parent(node);
      errors.squared[node] += on[i].weight * squared[i] * (importance.empty() ? 1.0 : importance[i]);
      errors.l2 += on[i].weight * squared[i];
      weight += on[i].weight;
    }
    errors.l2 = weight > 0 ? std::sqrt(errors.l2 / weight) : 0.0;
    return errors;
  }

  // --- up to a number of vertices ----------------------------------------------------------------------------------------------------------
  Fitted refine_to_budget(const Progress& progress) const {
    LeafMesh leaves(base_, options_);
    if (leaves.vertices() > budget_) return fitted(base_, progress);
    const auto allowed = static_cast<double>(budget_);
    while (leaves.hierarchy().depth() < options_.deepest && static_cast<double>(leaves.vertices_of_next_level()) < 0.35 * allowed)
      leaves.refine_all();
    const double start = std::max(0.3, static_cast<double>(leaves.vertices()) / allowed);
    constexpr int rounds = 4;  // more find no better leaves
    std::vector<std::pair<LeafMesh, LeafErrors>> rounds_done;
    for (int round = 0; round < rounds; ++round) {
      const Progress part = progress.part(0.6 * round / rounds, 0.6 * (round + 1) / rounds);
      const double fraction = start + (1 - start) * (round + 1) / rounds;
      const std::int64_t target = round + 1 < rounds ? static_cast<std::int64_t>(fraction * allowed) : budget_;
      rounds_done.emplace_back(leaves, errors_of(leaves, part));
      leaves = Splitter(leaves, rounds_done.back().second, budget_, part).split_to(target);
    }
    // A small budget may be out of reach from where the last round began, but not from an earlier one.
    for (auto r = rounds_done.rbegin() + 1; r != rounds_done.rend() && !uses(leaves, budget_); ++r) {
      LeafMesh other = Splitter(r->first, r->second, budget_, progress).split_to(budget_);
      if (other.vertices() > leaves.vertices()) leaves = std::move(other);
    }
    return fitted(leaves.closed(), progress.part(0.6, 1));
  }

  // --- down to an error ---------------------------------------------------------------------------------------------------------------------
  struct Missing {  // the error
    LeafMesh leaves;
    LeafErrors errors;
    double distance;
  };
  struct Meeting {
    LeafMesh leaves;
    Fitted fitted;
    double distance;
  };
  // Each step has a part of what remains: how many there are is not known beforehand.
  class Steps {
   public:
    explicit Steps(const Progress& progress) : progress_(progress) {}
    Progress next() {
      const double from = done_;
      done_ += 0.15 * (1 - done_);
      return progress_.part(from, done_);
    }

   private:
    const Progress& progress_;
    double done_ = 0;
  };

  Fitted refine_to_error(const Progress& progress) const {
    Steps steps(progress);
    LeafMesh leaves(base_, options_);
    Fitted base = fitted(base_, steps.next());
    if (leaves.vertices() > budget_ || distance(base.mesh, steps.next()) <= options_.error) return base;
    std::optional<Missing> low;
    for (;;) {
      Missing state{leaves, errors_of(leaves, steps.next()), 0};
      state.distance = state.errors.l2;
      std::optional<Meeting> high;
      // The distance from the surface to a mesh that was fitted less carefully tells where the bound begins to be in reach.
      if (state.distance <= 1.3 * options_.error || uses(leaves, budget_)) {
        high = measured(leaves, steps.next());
        state.distance = high->distance;
      }
      if (high && high->distance <= options_.error) {
        if (low) tighten(*low, *high, steps);
        return std::move(high->fitted);
      }
      const auto n = static_cast<double>(leaves.vertices());
      // Distances fall about as the number of vertices rises.
      const double wanted = n * std::clamp(state.distance / options_.error, 1.1, 2.5);
      const std::int64_t target = std::min(static_cast<std::int64_t>(wanted), budget_);
      leaves = Splitter(leaves, state.errors, budget_, progress).split_to(target);
      if (leaves.vertices() <= state.leaves.vertices()) return high ? std::move(high->fitted) : fitted(leaves.closed(), steps.next());
      low = std::move(state);
    }
  }

  Meeting measured(const LeafMesh& leaves, const Progress& progress) const {
    Fitted f = fitted(leaves.closed(), progress);
    const double d = distance(f.mesh, progress);
    return {leaves, std::move(f), d};
  }

  // Narrows the gap between a mesh that misses the error and one that meets it.
  void tighten(Missing& low, Meeting& high, Steps& steps) const {
    for (int turn = 0; turn < 6; ++turn) {
      const auto few = static_cast<double>(low.leaves.vertices()), many = static_cast<double>(high.leaves.vertices());
      if (many <= 1.03 * few || high.distance >= 0.98 * options_.error) break;
      const double power = std::log(low.distance / high.distance) / std::log(many / few);
      const double guess = few * std::pow(low.distance / (0.99 * options_.error), 1 / std::max(power, 0.1));
      const double target = std::clamp(guess, few + 0.1 * (many - few), many - 0.1 * (many - few));
      const Progress part = steps.next();
      const LeafMesh between = Splitter(low.leaves, low.errors, budget_, part).split_to(static_cast<std::int64_t>(target));
      if (between.vertices() >= high.leaves.vertices() || between.vertices() <= low.leaves.vertices()) break;
      Meeting state = measured(between, part);
      if (state.distance <= options_.error)
        high = std::move(state);
      else
        low = {between, errors_of(between, part), state.distance};
    }
  }

  const DistanceReference& surface_;
  const AdaptiveOptions& options_;
  const std::int64_t budget_;
  const HybridMesh& base_;
};

}  // namespace

std::int64_t closed_vertices(const HybridMesh& hierarchy) {
  return hierarchy.conforming() ? hierarchy.leaf_counts().vertices : split_vertices(hierarchy);
}

QuadMesh refine_adaptively(HybridMesh& hierarchy, const DistanceReference& surface, const AdaptiveOptions& options, const Progress& progress) {
  return AdaptiveRefinement(hierarchy, surface, options).run(hierarchy, progress);
}

}  // namespace hybrid_mesh
