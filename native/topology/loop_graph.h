// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/context.h"
#include "base/progress_steps.h"
#include "topology/cohomology.h"

namespace hybrid_mesh {

// What the lengths of edges are while loops are looked for.
enum class EdgeMeasure {
  Length,
  Count,  // loops of few points, which leave room for others
  Random  // between half and twice as much as in Count, by a seed
};

// The points and edges of a surface whose boundary loops are capped, and which loops along them are taken already: walls that no other loop may
// touch.
class LoopGraph {
 public:
  struct Arc {
    int to;
    int chain;  // of the cohomology; -1: crossed by none
    double length;
  };

  LoopGraph(const TriangleSurface& surface, const Progress& progress);

  void measure(EdgeMeasure by, std::uint64_t seed);
  int point_count() const { return static_cast<int>(first_.size()) - 1; }
  const Vec3& at(int point) const { return points_[point]; }
  const Arc* begin(int point) const { return arcs_.data() + first_[point]; }
  const Arc* end(int point) const { return arcs_.data() + first_[point + 1]; }
  const Arc* arc(int from, int to) const;  // null if there is no such edge; one at a boundary may be found in one direction only
  // Of the whole surface, less those of loops longer than any that is looked for.
  int genus() const { return cohomology_.dimension() / 2; }
  bool wall(int point) const { return wall_[point]; }
  // Of a component of genus 0: no loop is there.
  bool plain(int point) const { return !curved_component_[component_[point]]; }
  int component(int point) const { return component_[point]; }
  int component_count() const { return static_cast<int>(curved_component_.size()); }
  // A number that a step along an edge of this chain adds (exclusively) to that of a path. That of a loop is 0 if it separates the surface, alone or
  // together with walls. (With more than 64 dimensions, a loop that does not may be missed, once in 10^19 times.)
  std::uint64_t key(int chain) const { return chain < 0 ? 0 : keys_[chain]; }

  BitVector bits_of(const std::vector<int>& loop) const;
  const BitSpace& taken() const { return taken_; }
  bool touches_wall(const std::vector<int>& loop) const;
  // Makes walls of a loop; false, and nothing is changed, if it separates the surface together with those before it.
  bool take(const std::vector<int>& loop);
  void renew_keys();  // after loops were taken
  void forget_taken();

 private:
  void find_components();

  std::vector<Vec3> points_;
  std::vector<int> first_;
  std::vector<Arc> arcs_;
  std::vector<int> component_;
  std::vector<char> curved_component_, wall_, boundary_;
  Cohomology cohomology_;
  BitSpace taken_;
  std::vector<std::uint64_t> keys_;
};

// Shortest paths and loops in a graph. Not for several threads at once.
class LoopSearch {
 public:
  explicit LoopSearch(const LoopGraph& graph) : graph_(graph), nodes_(graph.point_count()) {}

  // The shortest loop through `base` that neither touches a wall nor separates, alone or with walls, if it is shorter than `bound`. Else empty.
  // With a key other than 0: of those along the tree of shortest paths from `base` that have this key.
  std::vector<int> shortest(int base, double bound, const Progress& progress, std::uint64_t key = 0);
  // The shortest path off walls, both ends included, if it is shorter than `bound`. Else empty.
  std::vector<int> path(int from, int to, double bound, const Progress& progress);
  // A basis of such loops, each of which runs along the tree of shortest paths from a root but for one edge; `roots` has a point a component.
  // Takes at most basis_steps() steps.
  std::vector<std::vector<int>> basis(const std::vector<int>& roots, ProgressSteps& steps);
  static std::int64_t basis_steps(const LoopGraph& graph);

  double length_of(const std::vector<int>& loop) const;
  std::uint64_t key_of(const std::vector<int>& loop) const;

 private:
  struct Node {
    double distance = 0;
    std::uint64_t key = 0;
    int parent = -1;
    int stamp = 0;  // 2 r - 1: reached in run r; 2 r: settled
    int order = 0;  // in which points are settled: a parent before its children, also where an edge is too short to change a distance
  };
  struct Chord {
    double length = 0;
    std::uint64_t key = 0;
    int from = -1, to = -1;
  };

  void reach(int point, int parent, double distance, std::uint64_t key);
  int settle_next();
  void grow_tree(int root, ProgressSteps& steps);
  std::vector<Chord> closing_edges(ProgressSteps& steps) const;
  std::vector<int> loop_of(int a, int b) const;
  int common_stem(int a, int b) const;

  const LoopGraph& graph_;
  std::vector<Node> nodes_;
  std::vector<std::pair<double, int>> heap_;
  std::vector<int> settled_;  // in their order
  int run_ = 0;
};

}  // namespace hybrid_mesh
