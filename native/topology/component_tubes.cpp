// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/component_tubes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <numeric>
#include <set>
#include <tuple>

#include "surface/triangle_intersection.h"
#include "topology/patch_hits.h"

namespace hybrid_mesh {
namespace {

// Points tried, of all components together and of each: pairs of them are compared all with all.
constexpr std::size_t most_samples = 6000, most_samples_each = 400, fewest_samples_each = 12;
constexpr std::size_t pairs_tried = 400;  // of two components
constexpr double facing = 0.3;            // cosine: how well normals face the other point

struct Pair {
  double cost = 0;
  int a = -1, b = -1;
};
bool operator<(const Pair& x, const Pair& y) { return std::tie(x.cost, x.a, x.b) < std::tie(y.cost, y.a, y.b); }

class TubeFinder {
 public:
  TubeFinder(const TriangleSurface& surface, const std::vector<TopologyEvent>& others, const Progress& progress);
  std::vector<TopologyEvent> find(const Progress& progress);

 private:
  struct Tube {
    TopologyEvent event;
    RimPatch patch;
    std::array<int, 2> ends{-1, -1};
    int hits = 0;
  };
  void find_components();
  void take_samples();
  std::vector<std::pair<Pair, std::array<int, 2>>> component_pairs(const Progress& progress) const;
  double cost(int a, int b) const;
  Pair descended(Pair pair) const;
  std::vector<int> ring(int v) const;  // in the direction of the faces around
  bool usable(int v) const;
  Tube tube_at(const Pair& pair) const;
  int hits_of(const Tube& tube) const;
  enum class Hits { None, Fewest };
  bool join(const std::array<int, 2>& components, Hits hits, const Progress& progress);
  void accept(const Tube& tube);

  const TriangleSurface& surface_;
  PatchHits hits_;
  std::vector<int> out_, component_;
  std::vector<Vec3> normal_;
  std::vector<char> taken_;  // per point: boundaries and other events
  std::vector<std::vector<int>> samples_;
  std::vector<Tube> tubes_;
};

TubeFinder::TubeFinder(const TriangleSurface& surface, const std::vector<TopologyEvent>& others, const Progress& progress)
    : surface_(surface),
      hits_(surface, progress),
      out_(surface.points.size(), -1),
      normal_(surface.points.size(), Vec3::Zero()),
      taken_(surface.points.size(), 0) {
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
    out_[surface.from(h)] = h;
    if (surface.opposite[h] < 0) taken_[surface.from(h)] = taken_[surface.to(h)] = 1;
  }
  for (const auto& [a, b, c] : surface.faces) {
    const Vec3 normal = (surface.points[b] - surface.points[a]).cross(surface.points[c] - surface.points[a]);
    for (const int v : {a, b, c}) normal_[v] += normal;
  }
  for (Vec3& n : normal_) n.normalize();
  for (const TopologyEvent& event : others)
    for (const auto& loop : event.loops)
      for (const int v : loop) taken_[v] = 1;
  progress.check();
  find_components();
  take_samples();
}

void TubeFinder::find_components() {
  component_.assign(surface_.points.size(), -1);
  std::vector<int> rank(surface_.points.size(), 0), parent(surface_.points.size());
  std::iota(parent.begin(), parent.end(), 0);
  boost::disjoint_sets<int*, int*> sets(rank.data(), parent.data());
  for (const auto& [a, b, c] : surface_.faces) {
    sets.union_set(a, b);
    sets.union_set(b, c);
  }
  std::vector<int> name(surface_.points.size(), -1);
  int count = 0;
  for (int v = 0; v < static_cast<int>(component_.size()); ++v) {
    int& n = name[sets.find_set(v)];
    if (n < 0) n = count++;
    component_[v] = n;
  }
  samples_.resize(count);
}

bool TubeFinder::usable(int v) const {
  if (taken_[v]) return false;
  for (const int w : ring(v))
    if (taken_[w]) return false;
  return true;
}

void TubeFinder::take_samples() {
  std::vector<std::vector<int>> points(samples_.size());
  for (int v = 0; v < static_cast<int>(component_.size()); ++v)
    if (usable(v)) points[component_[v]].push_back(v);
  const std::size_t each = std::clamp(most_samples / samples_.size(), fewest_samples_each, most_samples_each);
  for (std::size_t c = 0; c < points.size(); ++c)
    for (std::size_t i = 0, n = std::min(each, points[c].size()); i < n; ++i) samples_[c].push_back(points[c][i * points[c].size() / n]);
}

std::vector<int> TubeFinder::ring(int v) const {
  std::vector<int> points;
  int h = out_[v];
  do {
    points.push_back(surface_.to(h));
    h = surface_.opposite[TriangleSurface::previous(h)];
  } while (h >= 0 && h != out_[v]);
  return points;
}

double TubeFinder::cost(int a, int b) const {
  const Vec3 way = surface_.points[b] - surface_.points[a];
  const double distance = way.norm();
  if (!(distance > 0)) return std::numeric_limits<double>::infinity();
  const double cosine = std::min(normal_[a].dot(way), -normal_[b].dot(way)) / distance;
  // What does not face is taken last.
  return distance * (1 + 2 * (1 - cosine)) + (cosine > facing ? 0 : 1e6 * distance);
}

// To the best pair of points nearby.
Pair TubeFinder::descended(Pair pair) const {
  constexpr int most_steps = 200;
  for (int step = 0; step < most_steps; ++step) {
    Pair best = pair;
    const auto consider = [&](int a, int b) {
      if (const Pair other{cost(a, b), a, b}; other < best && usable(a) && usable(b)) best = other;
    };
    for (const int a : ring(pair.a)) consider(a, pair.b);
    for (const int b : ring(pair.b)) consider(pair.a, b);
    if (!(best < pair)) break;
    pair = best;
  }
  return pair;
}

// By the cost of their best pair of points.
std::vector<std::pair<Pair, std::array<int, 2>>> TubeFinder::component_pairs(const Progress& progress) const {
  std::vector<std::pair<Pair, std::array<int, 2>>> pairs;
  const int count = static_cast<int>(samples_.size());
  for (int c = 0; c < count; ++c)
    for (int d = c + 1; d < count; ++d) {
      progress.check();
      Pair best{std::numeric_limits<double>::infinity(), -1, -1};
      for (const int a : samples_[c])
        for (const int b : samples_[d])
          if (const Pair pair{cost(a, b), a, b}; pair < best) best = pair;
      if (best.a >= 0) pairs.push_back({descended(best), {c, d}});
    }
  std::sort(pairs.begin(), pairs.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  return pairs;
}

TubeFinder::Tube TubeFinder::tube_at(const Pair& pair) const {
  Tube tube;
  tube.ends = {pair.a, pair.b};
  tube.event.kind = EventKind::Tube;
  std::array<std::vector<Vec3>, 2> rims;
  for (const int end : {0, 1}) {
    // The faces around a point run along its ring, those of the tube do as well: they take their place.
    tube.event.loops[end] = ring(tube.ends[end]);
    for (const int v : tube.event.loops[end]) rims[end].push_back(surface_.points[v]);
    tube.event.length += cycle_length(surface_, tube.event.loops[end]) / 2;
  }
  tube.patch = tube_between(rims[0], rims[1], 2);
  return tube;
}

int TubeFinder::hits_of(const Tube& tube) const {
  std::vector<int> rim = tube.event.loops[0], hidden;
  rim.insert(rim.end(), tube.event.loops[1].begin(), tube.event.loops[1].end());
  for (const int end : tube.ends) {
    int h = out_[end];
    do {
      hidden.push_back(h / 3);
      h = surface_.opposite[TriangleSurface::previous(h)];
    } while (h != out_[end]);
  }
  std::sort(hidden.begin(), hidden.end());
  int hits = hits_.count(rim, tube.patch, hidden, 1 << 20);
  const auto corners = [&](const Tube& of, const std::array<int, 3>& face) {
    std::array<const Vec3*, 3> places{};
    const std::size_t first = of.event.loops[0].size(), both = first + of.event.loops[1].size();
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(face[k]);
      places[k] = v < first  ? &surface_.points[of.event.loops[0][v]]
                  : v < both ? &surface_.points[of.event.loops[1][v - first]]
                             : &of.patch.points[v - both];
    }
    return places;
  };
  for (const Tube& other : tubes_)
    for (const auto& f : tube.patch.faces)
      for (const auto& g : other.patch.faces) hits += triangles_meet(corners(tube, f), corners(other, g));
  return hits;
}

// By the first tube that hits nothing, or else, if that is allowed, by the one that hits least.
bool TubeFinder::join(const std::array<int, 2>& components, Hits hits, const Progress& progress) {
  std::vector<Pair> pairs;
  for (const int c : components) std::erase_if(samples_[c], [&](int v) { return !usable(v); });
  for (const int a : samples_[components[0]])
    for (const int b : samples_[components[1]]) pairs.push_back({cost(a, b), a, b});
  const std::size_t count = std::min(pairs_tried, pairs.size());
  std::partial_sort(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(count), pairs.end());
  pairs.resize(count);
  std::set<std::array<int, 2>> tried;
  Tube best;
  for (const Pair& start : pairs)
    for (const Pair& pair : {descended(start), start}) {
      progress.check();
      if (!tried.insert({pair.a, pair.b}).second) continue;
      Tube tube = tube_at(pair);
      tube.hits = hits_of(tube);
      if (best.ends[0] < 0 || tube.hits < best.hits) best = std::move(tube);
      if (best.hits == 0) {
        accept(best);
        return true;
      }
    }
  if (best.ends[0] < 0 || hits == Hits::None) return false;
  accept(best);
  return true;
}

void TubeFinder::accept(const Tube& tube) {
  for (const int end : {0, 1}) {
    taken_[tube.ends[end]] = 1;
    for (const int v : tube.event.loops[end]) taken_[v] = 1;
  }
  tubes_.push_back(tube);
}

std::vector<TopologyEvent> TubeFinder::find(const Progress& progress) {
  const int count = static_cast<int>(samples_.size());
  std::vector<int> rank(count, 0), parent(count);
  std::iota(parent.begin(), parent.end(), 0);
  boost::disjoint_sets<int*, int*> sets(rank.data(), parent.data());
  const auto pairs = component_pairs(progress);
  // Components that no clean tube joins directly may be joined through others.
  std::size_t done = 0;
  for (const Hits hits : {Hits::None, Hits::Fewest})
    for (const auto& [pair, components] : pairs) {
      progress(static_cast<double>(done++) / (2 * static_cast<double>(pairs.size())));
      const auto [c, d] = components;
      if (sets.find_set(c) != sets.find_set(d) && join(components, hits, progress)) sets.union_set(c, d);
    }
  std::vector<TopologyEvent> events;
  for (Tube& tube : tubes_) events.push_back(std::move(tube.event));
  progress(1);
  return events;
}

}  // namespace

std::vector<TopologyEvent> find_tubes(const TriangleSurface& surface, const std::vector<TopologyEvent>& others, const Progress& progress) {
  progress.stage("joining components");
  return TubeFinder(surface, others, progress.part(0, 0)).find(progress);
}

}  // namespace hybrid_mesh
