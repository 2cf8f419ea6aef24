// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/insertion_merging.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>

#include "parameterization/cone_motion.h"

namespace hybrid_mesh {
namespace {

double cross(const Complex& a, const Complex& b) { return a.real() * b.imag() - a.imag() * b.real(); }

constexpr const char* kCutStays = "a cut of the surface cannot be undone in the map";

// Where the vertices of a region are that only grows, each noted before it can have moved: to come back to.
class KeptPositions {
 public:
  explicit KeptPositions(ChartMesh& charts) : charts_(charts) {}
  void note(const std::vector<int>& region) {
    while (kept_.size() < region.size()) kept_.push_back(charts_.uv[region[kept_.size()]]);
  }
  void restore(const std::vector<int>& region) const {
    for (std::size_t i = 0; i < kept_.size(); ++i) charts_.uv[region[i]] = kept_[i];
  }

 private:
  ChartMesh& charts_;
  std::vector<Complex> kept_;
};

}  // namespace

InsertionMerging::InsertionMerging(ChartMesh& charts, const Distortion& density, const PatchedSurface& surface)
    : c_(charts), density_(density), stars_(charts, density), corners_(charts, density), source_(surface.source) {
  original_.resize(source_.size());
  for (std::size_t v = 0; v < original_.size(); ++v)
    original_[v] = !is_inserted(static_cast<int>(v)) && (surface.inserted.empty() || !surface.inserted[v]);
}

// A point inside an edge or a face of the surface that was cut goes to a neighbour on the same edge or face: the surface stays the same set of
// points.
bool InsertionMerging::merges_in_place(int h) const {
  const PointSource& p = source_[c_.mesh.from(h)];
  const PointSource& q = source_[c_.mesh.to(h)];
  for (const int w : q.vertices)
    if (w >= 0 && std::find(p.vertices.begin(), p.vertices.end(), w) == p.vertices.end()) return false;
  return true;
}

double InsertionMerging::least_determinant_after(int h) const {
  const int v = c_.mesh.from(h), u = c_.mesh.to(h);
  const Complex target = c_.corner[h].back(c_.at(EditMesh::next(h)));
  double least = 1e300;
  c_.for_star(v, [&](int g, const Complex& a, const Complex& b) {
    if (c_.mesh.to(g) != u && c_.mesh.apex(g) != u) least = std::min(least, cross(b - a, target - a));
  });
  return least;
}

void InsertionMerging::merge(double least_determinant, double least_shape) {
  std::vector<int> inserted;
  for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
    if (c_.mesh.vertex_alive(v) && is_inserted(v)) inserted.push_back(v);
  for (int pass = 0; pass < 6 && !inserted.empty(); ++pass) {
    std::vector<int> left;
    for (const int v : inserted) {
      int best = -1;
      double shortest = 1e300;
      int h = c_.mesh.out[v];
      do {
        const double l = (c_.points[c_.mesh.to(h)] - c_.points[v]).squaredNorm();
        if (l < shortest && merges_in_place(h) && c_.can_collapse(h) && c_.collapse_keeps_map(h, least_determinant, least_shape) &&
            (least_shape < 0 || c_.collapse_keeps_area(h)))
          shortest = l, best = h;
        if (c_.mesh.is_boundary(v)) break;
        h = c_.mesh.ccw(h);
      } while (h >= 0 && h != c_.mesh.out[v]);
      if (best >= 0)
        c_.collapse(best);
      else
        left.push_back(v);
    }
    if (left.size() == inserted.size()) break;
    inserted = std::move(left);
  }
}

std::vector<int> InsertionMerging::merge_all(const Progress& progress) {
  progress.check();
  merge(0.01);
  for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
    if (c_.mesh.vertex_alive(v) && c_.kind[v] == ChartMesh::Kind::Cone && is_inserted(v)) settle(v);
  for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
    if (c_.mesh.vertex_alive(v) && c_.kind[v] == ChartMesh::Kind::Pinned && is_inserted(v)) settle_corner(v);
  // Triangles without area may come in between: what is left in the end are the triangles that were cut.
  merge(0.01);
  merge(1e-4, -1);
  merge_by_force(progress);
  stars_.relax_squeezed(0.02, 10, progress);
  progress(1);
  std::vector<int> point(c_.points.size(), -1);
  for (std::size_t v = 0; v < point.size(); ++v)
    if (c_.mesh.vertex_alive(static_cast<int>(v))) point[v] = source_[v].vertices[0];
  return point;
}

// A cone at an inserted point takes the place of a neighbour, a point of the surface: that is merged into it, and its name and place on the surface
// go over.
void InsertionMerging::settle(int cone) {
  if (!is_inserted(cone)) return;
  std::vector<std::pair<double, int>> halves;
  int h = c_.mesh.out[cone];
  do {
    const int to_cone = c_.mesh.opposite[h];
    const int w = c_.mesh.to(h);
    if (to_cone >= 0 && !is_inserted(w) && c_.kind[w] == ChartMesh::Kind::Free && merges_in_place(h) && c_.can_collapse(to_cone))
      halves.push_back({-least_determinant_after(to_cone), to_cone});
    h = c_.mesh.ccw(h);
  } while (h != c_.mesh.out[cone]);
  std::sort(halves.begin(), halves.end());
  for (const auto& [cost, half] : halves) {
    const int w = c_.mesh.from(half);
    std::vector<int> region{cone};
    KeptPositions kept(c_);
    const int seen_from = EditMesh::prev(half);
    const Complex place = c_.corner[seen_from].back(c_.at(half));
    c_.collapse(half);
    c_.mesh.grow(region, 1);
    for (int rings = 0; rings < 3; ++rings) {
      if (rings > 0) c_.mesh.grow(region, 1);
      kept.note(region);
      if (!stars_.unfold(region)) continue;
      c_.move_point(cone, c_.points[w]);
      source_[cone] = source_[w];
      original_[cone] = 1;
      return;
    }
    kept.restore(region);
    c_.undo_collapse(half);
    if (c_.kind[c_.mesh.origin[seen_from]] == ChartMesh::Kind::Cone) break;
    c_.uv[w] = c_.corner[seen_from](place);
  }
  const int next = evict_cone(c_, density_, cone, original_);
  if (next < 0) throw NoMap("an irregular node of the base cannot be moved to a vertex");
}

// A corner of the base on the boundary that is inside an edge of the surface goes to one of the edge's ends, the nearer one if the map unfolds
// there.
void InsertionMerging::settle_corner(int corner) {
  const auto length_to = [&](int v) { return (c_.points[v] - c_.points[corner]).norm(); };
  const bool onward = length_to(corners_.next(corner, true)) < length_to(corners_.next(corner, false));
  for (const bool forward : {onward, !onward}) {
    int at = corner;
    while (at >= 0 && is_inserted(at)) at = corners_.move(at, forward);
    if (at >= 0) return;
  }
  throw NoMap("a corner of the base on the boundary cannot be moved to a vertex");
}

// Merges what is left whatever becomes of the map, and unfolds it there. What does not unfold is tried again when others have gone; cones and
// corners of the boundary near it, which may ask a triangle for an angle that none can have, give way.
void InsertionMerging::merge_by_force(const Progress& progress) {
  // Where it can be done at all, it has taken up to 60 relaxations a vertex. Where triangles are too long for the map to be linear on them,
  // thousands of points resist.
  const std::int64_t most = stars_.relaxed_folded() + 100 * static_cast<std::int64_t>(c_.mesh.vertex_count);
  for (int pass = 0; pass < 8; ++pass) {
    progress.check();
    std::vector<int> left;
    for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
      if (c_.mesh.vertex_alive(v) && is_inserted(v) && !unfolds_when_merged(v, pass)) {
        left.push_back(v);
        if (stars_.relaxed_folded() > most) throw NoMap(kCutStays);
      }
    if (left.empty()) return;
    for (const int v : left) {
      if (corners_.move_near(v, [&](int corner) { return !is_inserted(corner) && unfolds_when_merged(v, pass); })) continue;
      std::vector<int> region{v};
      c_.mesh.grow(region, pass < 2 ? 1 : 2);
      for (const int w : region)
        if (c_.kind[w] == ChartMesh::Kind::Cone) evict_cone(c_, density_, w, original_);
      c_.mesh.grow(region, 1);
      for (int sweep = 0; sweep < 6; ++sweep)
        for (const int w : region)
          if (c_.movable(w)) stars_.relax(w, true);
    }
    merge(1e-4, -1);
  }
  throw NoMap(kCutStays);
}

bool InsertionMerging::unfolds_when_merged(int v, int pass) {
  std::vector<std::pair<double, int>> halves;
  int h = c_.mesh.out[v];
  do {
    if (merges_in_place(h) && c_.can_collapse(h)) halves.push_back({-least_determinant_after(h), h});
    if (c_.mesh.is_boundary(v)) break;
    h = c_.mesh.ccw(h);
  } while (h >= 0 && h != c_.mesh.out[v]);
  std::sort(halves.begin(), halves.end());
  for (const auto& [cost, half] : halves) {
    std::vector<int> region{v};
    c_.mesh.grow(region, 1);
    region.erase(region.begin());
    KeptPositions kept(c_);
    // Where v is, seen from another corner of its face: its own frame is lost.
    const int seen_from = c_.kind[c_.mesh.to(half)] != ChartMesh::Kind::Cone ? EditMesh::next(half) : EditMesh::prev(half);
    const Complex place = c_.corner[seen_from].back(c_.at(half));
    const bool known = c_.kind[c_.mesh.origin[seen_from]] != ChartMesh::Kind::Cone;
    c_.collapse(half);
    // More room and patience with those that resist.
    for (int rings = 0; rings < (pass < 3 ? 3 : 6); ++rings) {
      if (rings > 0) c_.mesh.grow(region, 1);
      kept.note(region);
      if (stars_.unfold(region, pass < 3 ? 24 : 120)) return true;
    }
    kept.restore(region);
    const bool placed = c_.undo_collapse(half);
    if (known && !c_.mesh.is_boundary(v)) c_.uv[v] = c_.corner[seen_from](place);
    if (!placed && !known) break;
  }
  return false;
}

}  // namespace hybrid_mesh
