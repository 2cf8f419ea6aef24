// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Erickson, Har-Peled, Optimally cutting a surface into a disk, 2004 (the shortest non-separating loop through a point).
#include "topology/loop_graph.h"

#include <algorithm>
#include <functional>
#include <tuple>

#include "topology/surface_loops.h"

namespace hybrid_mesh {
namespace {

constexpr int steps_between_checks = 4096;

// Its boundary loops are closed by fans around points of their own, numbered after the surface's.
TriangleSurface with_fans(const TriangleSurface& surface) {
  TriangleSurface closed;
  closed.points = surface.points;
  closed.faces = surface.faces;
  closed.opposite = surface.opposite;
  for (const std::vector<int>& loop : boundary_cycles(surface)) {
    const int apex = static_cast<int>(closed.points.size());
    closed.points.push_back(surface.points[loop[0]]);
    for (std::size_t i = 0; i < loop.size(); ++i) closed.faces.push_back({loop[(i + 1) % loop.size()], loop[i], apex});
  }
  if (closed.faces.size() > surface.faces.size()) connect_half_edges(closed);
  return closed;
}

std::uint64_t scrambled(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

constexpr std::greater<std::pair<double, int>> later;

}  // namespace

LoopGraph::LoopGraph(const TriangleSurface& surface, const Progress& progress)
    : points_(surface.points), cohomology_(with_fans(surface), progress.part(0.2, 0.6)), taken_(cohomology_.dimension()) {
  const int half_edges = 3 * static_cast<int>(surface.faces.size());
  first_.assign(points_.size() + 1, 0);
  boundary_.assign(points_.size(), 0);
  // Every edge of a face gives an arc from its first point; a boundary edge, whose points are walls, gives none back.
  for (int h = 0; h < half_edges; ++h) {
    ++first_[surface.from(h) + 1];
    if (surface.opposite[h] < 0) boundary_[surface.from(h)] = boundary_[surface.to(h)] = 1;
  }
  for (std::size_t v = 0; v < points_.size(); ++v) first_[v + 1] += first_[v];
  arcs_.resize(half_edges);
  std::vector<int> fill(first_.begin(), first_.end() - 1);
  for (int h = 0; h < half_edges; ++h) arcs_[fill[surface.from(h)]++] = {surface.to(h), cohomology_.chain(h), 0};
  progress(0.8);
  measure(EdgeMeasure::Length, 0);
  find_components();
  forget_taken();
  progress(1);
}

void LoopGraph::measure(EdgeMeasure by, std::uint64_t seed) {
  for (int v = 0; v < point_count(); ++v)
    for (int i = first_[v]; i < first_[v + 1]; ++i) {
      Arc& arc = arcs_[i];
      const auto a = static_cast<std::uint64_t>(std::min(v, arc.to)), b = static_cast<std::uint64_t>(std::max(v, arc.to));
      if (by == EdgeMeasure::Length)
        arc.length = (points_[v] - points_[arc.to]).norm();
      else
        arc.length = by == EdgeMeasure::Count ? 1 : 0.5 + 1.5 * static_cast<double>(scrambled(scrambled(a + (b << 32)) + seed) >> 11) * 0x1p-53;
    }
}

void LoopGraph::find_components() {
  component_.assign(points_.size(), -1);
  std::vector<int> queue;
  for (int root = 0; root < point_count(); ++root) {
    if (component_[root] >= 0) continue;
    const int name = component_count();
    curved_component_.push_back(0);
    component_[root] = name;
    queue.assign(1, root);
    while (!queue.empty()) {
      const int v = queue.back();
      queue.pop_back();
      for (const Arc* arc = begin(v); arc != end(v); ++arc) {
        if (arc->chain >= 0) curved_component_[name] = 1;
        if (component_[arc->to] >= 0) continue;
        component_[arc->to] = name;
        queue.push_back(arc->to);
      }
    }
  }
}

const LoopGraph::Arc* LoopGraph::arc(int from, int to) const {
  const Arc* found = std::find_if(begin(from), end(from), [&](const Arc& arc) { return arc.to == to; });
  return found == end(from) ? nullptr : found;
}

BitVector LoopGraph::bits_of(const std::vector<int>& loop) const {
  BitVector bits((cohomology_.dimension() + 63) / 64, 0);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Arc* step = arc(loop[i], loop[(i + 1) % loop.size()]);
    if (!step || step->chain < 0) continue;
    const BitVector& chain = cohomology_.chains()[step->chain];
    for (std::size_t w = 0; w < bits.size(); ++w) bits[w] ^= chain[w];
  }
  return bits;
}

bool LoopGraph::touches_wall(const std::vector<int>& loop) const {
  return std::any_of(loop.begin(), loop.end(), [&](int v) { return wall(v); });
}

bool LoopGraph::take(const std::vector<int>& loop) {
  if (!taken_.add(bits_of(loop))) return false;
  for (const int v : loop) wall_[v] = 1;
  return true;
}

void LoopGraph::forget_taken() {
  taken_ = BitSpace(cohomology_.dimension());
  wall_ = boundary_;
  renew_keys();
}

void LoopGraph::renew_keys() {
  keys_.resize(cohomology_.chains().size());
  for (std::size_t c = 0; c < keys_.size(); ++c) {
    BitVector bits = cohomology_.chains()[c];
    taken_.reduce(bits);
    keys_[c] = 0;
    if (bits.size() == 1) {
      keys_[c] = bits[0];
      continue;
    }
    for (int i = 0; i < cohomology_.dimension(); ++i)
      if (bits[i / 64] >> (i % 64) & 1) keys_[c] ^= scrambled(static_cast<std::uint64_t>(i));
  }
}

void LoopSearch::reach(int point, int parent, double distance, std::uint64_t key) {
  nodes_[point] = {distance, key, parent, 2 * run_ - 1, 0};
  heap_.emplace_back(distance, point);
  std::push_heap(heap_.begin(), heap_.end(), later);
}

// The nearest point that is not settled yet, now settled; -1 if a nearer way to what comes next is known.
int LoopSearch::settle_next() {
  const int v = heap_.front().second;
  std::pop_heap(heap_.begin(), heap_.end(), later);
  heap_.pop_back();
  Node& node = nodes_[v];
  if (node.stamp == 2 * run_) return -1;
  node.stamp = 2 * run_;
  node.order = static_cast<int>(settled_.size());
  settled_.push_back(v);
  return v;
}

std::vector<int> LoopSearch::shortest(int base, double bound, const Progress& progress, std::uint64_t wanted) {
  if (graph_.wall(base)) return {};
  ++run_;
  heap_.clear();
  settled_.clear();
  reach(base, -1, 0, 0);
  std::array<int, 2> closing{-1, -1};
  for (int steps = 1; !heap_.empty(); ++steps) {
    if (steps % steps_between_checks == 0) progress.check();
    const double distance = heap_.front().first;
    // A loop that this point closes is at least twice as long.
    if (2 * distance >= bound) break;
    const int v = settle_next();
    if (v < 0) continue;
    const Node& node = nodes_[v];
    for (const LoopGraph::Arc* arc = graph_.begin(v); arc != graph_.end(v); ++arc) {
      if (graph_.wall(arc->to)) continue;
      const Node& other = nodes_[arc->to];
      const std::uint64_t key = node.key ^ graph_.key(arc->chain);
      const double beyond = distance + arc->length;
      if (other.stamp == 2 * run_) {
        if (key != other.key && beyond + other.distance < bound && (wanted == 0 || (key ^ other.key) == wanted)) {
          bound = beyond + other.distance;
          closing = {v, arc->to};
        }
      } else if (2 * beyond < bound && (other.stamp != 2 * run_ - 1 || beyond < other.distance)) {
        reach(arc->to, v, beyond, key);
      }
    }
  }
  return closing[0] < 0 ? std::vector<int>() : loop_of(closing[0], closing[1]);
}

std::vector<int> LoopSearch::path(int from, int to, double bound, const Progress& progress) {
  if (graph_.wall(from) || graph_.wall(to)) return {};
  ++run_;
  heap_.clear();
  settled_.clear();
  reach(from, -1, 0, 0);
  for (int steps = 1; !heap_.empty() && nodes_[to].stamp != 2 * run_; ++steps) {
    if (steps % steps_between_checks == 0) progress.check();
    const double distance = heap_.front().first;
    const int v = settle_next();
    if (v < 0) continue;
    for (const LoopGraph::Arc* arc = graph_.begin(v); arc != graph_.end(v); ++arc) {
      const Node& other = nodes_[arc->to];
      const double beyond = distance + arc->length;
      if (graph_.wall(arc->to) || other.stamp == 2 * run_ || !(beyond < bound)) continue;
      if (other.stamp != 2 * run_ - 1 || beyond < other.distance) reach(arc->to, v, beyond, 0);
    }
  }
  std::vector<int> points;
  if (nodes_[to].stamp != 2 * run_) return points;
  for (int v = to; v >= 0; v = nodes_[v].parent) points.push_back(v);
  std::reverse(points.begin(), points.end());
  return points;
}

void LoopSearch::grow_tree(int root, ProgressSteps& steps) {
  reach(root, -1, 0, 0);
  for (int passes = 1; !heap_.empty(); ++passes) {
    if (passes % steps_between_checks == 0) steps.progress().check();
    const double distance = heap_.front().first;
    const int v = settle_next();
    if (v < 0) continue;
    if (settled_.size() % steps_between_checks == 0) steps();
    const Node& node = nodes_[v];
    for (const LoopGraph::Arc* arc = graph_.begin(v); arc != graph_.end(v); ++arc) {
      const Node& other = nodes_[arc->to];
      if (graph_.wall(arc->to) || other.stamp == 2 * run_) continue;
      const double beyond = distance + arc->length;
      if (other.stamp != 2 * run_ - 1 || beyond < other.distance) reach(arc->to, v, beyond, node.key ^ graph_.key(arc->chain));
    }
  }
}

int LoopSearch::common_stem(int a, int b) const {
  while (a != b) {
    int& farther = nodes_[a].order > nodes_[b].order ? a : b;
    farther = nodes_[farther].parent;
  }
  return a;
}

std::vector<int> LoopSearch::loop_of(int a, int b) const {
  const int stem = common_stem(a, b);
  std::vector<int> loop, back;
  for (int v = a; v != stem; v = nodes_[v].parent) loop.push_back(v);
  loop.push_back(stem);
  for (int v = b; v != stem; v = nodes_[v].parent) back.push_back(v);
  loop.insert(loop.end(), back.rbegin(), back.rend());
  return loop;
}

std::vector<LoopSearch::Chord> LoopSearch::closing_edges(ProgressSteps& steps) const {
  std::vector<Chord> chords;
  for (std::size_t i = 0; i < settled_.size(); ++i) {
    if ((i + 1) % steps_between_checks == 0) steps();
    const int v = settled_[i];
    const Node& node = nodes_[v];
    for (const LoopGraph::Arc* arc = graph_.begin(v); arc != graph_.end(v); ++arc) {
      if (arc->to < v || nodes_[arc->to].stamp != 2 * run_) continue;
      const Node& other = nodes_[arc->to];
      const std::uint64_t key = node.key ^ other.key ^ graph_.key(arc->chain);
      if (key == 0) continue;
      const double stem = nodes_[common_stem(v, arc->to)].distance;
      chords.push_back({node.distance + other.distance + arc->length - 2 * stem, key, v, arc->to});
    }
  }
  return chords;
}

// Points are settled, and then looked at.
std::int64_t LoopSearch::basis_steps(const LoopGraph& graph) { return 2 * (graph.point_count() / steps_between_checks); }

std::vector<std::vector<int>> LoopSearch::basis(const std::vector<int>& roots, ProgressSteps& steps) {
  ++run_;
  heap_.clear();
  settled_.clear();
  const auto grow = [&](int root) {
    if (!graph_.wall(root) && !graph_.plain(root) && nodes_[root].stamp != 2 * run_) grow_tree(root, steps);
  };
  for (const int root : roots) grow(root);
  // Walls may have cut edges of a component apart.
  for (int v = 0; v < graph_.point_count(); ++v) grow(v);
  std::vector<Chord> chords = closing_edges(steps);
  const auto order = [](const Chord& a) { return std::tuple(a.length, a.from, a.to); };
  // Loops of the same key stand for each other: the shortest of each.
  std::sort(chords.begin(), chords.end(), [&](const Chord& a, const Chord& b) { return std::tuple(a.key, order(a)) < std::tuple(b.key, order(b)); });
  chords.erase(std::unique(chords.begin(), chords.end(), [](const Chord& a, const Chord& b) { return a.key == b.key; }), chords.end());
  std::sort(chords.begin(), chords.end(), [&](const Chord& a, const Chord& b) { return order(a) < order(b); });
  std::vector<std::vector<int>> loops;
  BitSpace space = graph_.taken();
  for (const Chord& chord : chords) {
    steps.progress().check();
    std::vector<int> loop = loop_of(chord.from, chord.to);
    if (space.add(graph_.bits_of(loop))) loops.push_back(std::move(loop));
  }
  return loops;
}

double LoopSearch::length_of(const std::vector<int>& loop) const {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const LoopGraph::Arc* step = graph_.arc(loop[i], loop[(i + 1) % loop.size()]);
    if (step) length += step->length;
  }
  return length;
}

std::uint64_t LoopSearch::key_of(const std::vector<int>& loop) const {
  std::uint64_t key = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const LoopGraph::Arc* step = graph_.arc(loop[i], loop[(i + 1) % loop.size()]);
    if (step) key ^= graph_.key(step->chain);
  }
  return key;
}

}  // namespace hybrid_mesh
