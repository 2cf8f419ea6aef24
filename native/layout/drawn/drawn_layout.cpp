// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/drawn_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "base/error.h"
#include "base/limits.h"
#include "base/tolerances.h"
#include "layout/curves/curve_tightening.h"
#include "layout/curves/surface_paths.h"
#include "layout/curves/vertex_placing.h"
#include "layout/drawn/boundary_corners.h"
#include "layout/drawn/curve_cleaning.h"
#include "layout/drawn/detours.h"
#include "layout/drawn/point_grid.h"
#include "layout/drawn/stroke_path.h"
#include "layout/drawn/stroke_projection.h"
#include "surface/placement.h"

namespace hybrid_mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFinest = 0.0025;          // edges near strokes are not split below this length
constexpr std::size_t kMostFaces = 400000;  // made by splitting

class LayoutMaker {
 public:
  LayoutMaker(const TriangleSurface& surface, const std::vector<DrawnStroke>& strokes, const DrawnLayoutOptions& options, const Progress& progress)
      : surface_(surface),
        strokes_(strokes),
        options_(options),
        progress_(progress),
        frame_(placement_of(surface.points)),
        snap_(options.snap),
        unit_(frame_.to_unit(surface)),
        curves_(unit_, unit_.points),
        paths_on_(curves_.mesh(), curves_.points()) {}

  DrawnLayout run() {
    project();
    refine();
    progress_(0.3);
    drop_overlaps();
    find_boundary_nodes();
    join_ends();
    attach_ends();
    place_junctions();
    progress_(0.5);
    draw();
    curves_.resolve_crossings(progress_);
    clean_curves(surface_, curves_, {snap_, boundary_nodes(), vertices()}, progress_);
    progress_(0.7);
    tighten();
    progress_(0.9);
    return finish();
  }

 private:
  using Kind = LayoutProblem::Kind;

  void report(Kind kind, const char* message, std::vector<Vec3> where, int stroke) {
    problems_.push_back({kind, message, std::move(where), stroke, -1});
  }

  Vec3 normal(int face) const {
    const std::array<Vec3, 3> c = paths_on_.corners(face);
    return (c[1] - c[0]).cross(c[2] - c[0]).normalized();
  }

  // --- strokes on the surface ----------------------------------------------------------------------------------------------------
  double edge_length() const { return std::max(0.5 * snap_, kFinest); }

  void project() {
    const StrokeProjection projection(unit_, {0.5 * edge_length(), snap_, options_.reach});
    for (int s = 0; s < static_cast<int>(strokes_.size()); ++s) {
      progress_.check();
      std::vector<Vec3> points;
      for (const Vec3& p : strokes_[s].points) points.push_back(frame_.to_unit(p));
      for (ProjectedStroke& piece : projection(s, points, problems_)) {
        StrokePath path;
        path.stroke = s;
        path.fit = strokes_[s].fit;
        path.at_boundary = piece.at_boundary;
        path.points = std::move(piece.points);
        path.at.push_back(0);
        for (std::size_t i = 1; i < path.points.size(); ++i) path.at.push_back(path.at.back() + (path.points[i].at - path.points[i - 1].at).norm());
        paths_.push_back(std::move(path));
      }
    }
  }

  // Splits faces under strokes until curves can follow them: within a face, a curve is straight.
  void refine() {
    const std::size_t most = curves_.face_count() + kMostFaces;
    std::vector<std::pair<double, int>> edges;
    do {
      progress_.check();
      edges.clear();
      std::vector<char> seen(curves_.face_count(), 0);
      const EditMesh& mesh = curves_.mesh();
      for (StrokePath& path : paths_)
        for (FacePoint& p : path.points) {
          p = paths_on_.locate(p.at, p.face);
          if (seen[p.face]) continue;
          seen[p.face] = 1;
          int longest = -1;
          double length = edge_length();
          const auto length_of = [&](int h) { return (curves_.points()[mesh.to(h)] - curves_.points()[mesh.from(h)]).norm(); };
          // A region's boundary stays as it is; faces at it cannot become smaller than its edges.
          const auto is_kept = [&](int h) { return mesh.opposite[h] < 0 && !options_.boundary_nodes.empty(); };
          for (int h = 3 * p.face; h < 3 * p.face + 3; ++h)
            if (is_kept(h)) length = std::max(length, length_of(h));
          for (int h = 3 * p.face; h < 3 * p.face + 3; ++h)
            if (!is_kept(h) && length_of(h) > length) length = length_of(h), longest = h;
          if (longest >= 0) edges.push_back({-length, mesh.edge[longest]});
        }
      std::sort(edges.begin(), edges.end());
      edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
      for (const auto& [length, e] : edges) curves_.split_edge(curves_.half_edge(e), 0.5);
    } while (!edges.empty() && curves_.face_count() < static_cast<int>(most));
  }

  // A stroke that runs along an earlier one, or along itself, is left out.
  void drop_overlaps() {
    const double near = 0.25 * snap_, run = 3 * snap_;
    PointGrid grid(edge_length());
    std::vector<std::pair<int, int>> owner;
    for (int k = 0; k < static_cast<int>(paths_.size()); ++k) {
      StrokePath& path = paths_[k];
      // Points of this path that have another line beside them.
      std::vector<char> beside(path.points.size(), 0);
      std::vector<Vec3> normals;
      for (const FacePoint& p : path.points) normals.push_back(normal(p.face));
      const auto distance = [](const Vec3& p, const StrokePath& other, int i) {
        double best = kInfinity;
        for (const int a : {i - 1, i}) {
          if (a < 0 || a + 1 >= static_cast<int>(other.points.size())) continue;
          const Vec3 &from = other.points[a].at, &to = other.points[a + 1].at;
          best = std::min(best, (p - from - nearest_on_segment(p, from, to) * (to - from)).norm());
        }
        return best;
      };
      const auto look = [&](bool self) {
        for (std::size_t i = 0; i < path.points.size(); ++i)
          grid.near(path.points[i].at, 0.5 * snap_, [&](int n) {
            const auto& [other, j] = owner[n];
            if ((other == k) != self) return;
            if (self && !(path.at[j] < path.at[i] - run)) return;
            if (self && std::min(path.at[i], path.at[j]) + path.length() - std::max(path.at[i], path.at[j]) < run) return;  // where it closes
            if (normal(paths_[other].points[j].face).dot(normals[i]) < 0) return;
            if (distance(path.points[i].at, paths_[other], j) < near) beside[i] = 1;
          });
      };
      look(false);
      const int own = static_cast<int>(owner.size());
      for (int i = 0; i < static_cast<int>(path.points.size()); ++i) {
        owner.push_back({k, i});
        grid.add(path.points[i].at);
      }
      look(true);
      for (std::size_t i = 0; i < beside.size();) {
        std::size_t j = i;
        while (j < beside.size() && beside[j]) ++j;
        if (j > i && path.at[j - 1] - path.at[i] > run) {
          report(Kind::Overlap, "a stroke runs along another one or along itself, and is left out", path.line(path.at[i], path.at[j - 1]),
                 path.stroke);
          path.dropped = true;
          break;
        }
        i = std::max(j, i + 1);
      }
      if (path.dropped) {
        owner.resize(own);
        grid.resize(own);
      }
    }
    std::vector<StrokePath> kept;
    for (StrokePath& path : paths_)
      if (!path.dropped) kept.push_back(std::move(path));
    paths_ = std::move(kept);
  }

  // --- where ends go ---------------------------------------------------------------------------------------------------------------
  void find_boundary_nodes() {
    const EditMesh& mesh = curves_.mesh();
    given_nodes_ = !options_.boundary_nodes.empty();
    std::vector<int> nodes = options_.boundary_nodes;
    std::vector<int> sorted = nodes;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
      throw Error(ErrorCode::InvalidInput, "a node of the boundary is given twice");
    for (const int v : nodes)
      if (v < 0 || v >= static_cast<int>(surface_.points.size()) || !mesh.is_boundary(v))
        throw Error(ErrorCode::InvalidInput, "a node is given at the point " + std::to_string(v) + ", which is not on the surface's boundary");
    if (!given_nodes_) nodes = boundary_corners(unit_, snap_ > 0 ? snap_ : kFinest, options_.corner_angle);
    for (const int v : nodes) {
      StrokeJunction j;
      j.place = {mesh.out[v] / 3, curves_.points()[v]};
      j.boundary = true;
      j.vertex = v;
      junctions_.push_back(j);
    }
    given_count_ = static_cast<int>(nodes.size());
    placing_.emplace(curves_);
  }

  const FacePoint& end_of(int path, int end) const { return end == 0 ? paths_[path].points.front() : paths_[path].points.back(); }

  bool near_on_surface(const FacePoint& a, const FacePoint& b) {
    return (a.at - b.at).norm() < tolerance::same_place || paths_on_.join(a, b, 3 * snap_ + 2 * edge_length()).has_value();
  }

  // Ends that are near each other, or near a node of the boundary, become one junction: the closest first, as long as it stays small.
  void join_ends() {
    std::vector<std::vector<int>> groups;
    std::vector<FacePoint> places;
    std::vector<int> group;
    for (const StrokeJunction& j : junctions_) {
      group.push_back(static_cast<int>(groups.size()));
      groups.push_back({static_cast<int>(places.size())});
      places.push_back(j.place);
    }
    std::vector<std::pair<int, int>> ends;
    for (int k = 0; k < static_cast<int>(paths_.size()); ++k)
      for (const int e : {0, 1}) {
        group.push_back(static_cast<int>(groups.size()));
        groups.push_back({static_cast<int>(places.size())});
        places.push_back(end_of(k, e));
        ends.push_back({k, e});
      }
    PointGrid grid(std::max(snap_, edge_length()));
    std::vector<std::tuple<double, int, int>> pairs;
    for (int i = 0; i < static_cast<int>(places.size()); ++i) {
      grid.near(places[i].at, snap_, [&](int j) { pairs.push_back({(places[j].at - places[i].at).norm(), j, i}); });
      grid.add(places[i].at);
    }
    std::sort(pairs.begin(), pairs.end());
    for (const auto& [distance, i, j] : pairs) {
      std::vector<int>&a = groups[group[i]], &b = groups[group[j]];
      if (group[i] == group[j]) continue;
      bool fits = !(a[0] < given_count_ && b[0] < given_count_);
      for (const int x : a)
        for (const int y : b) {
          fits = fits && (places[x].at - places[y].at).norm() <= 1.5 * snap_;
          // A short stroke is not closed.
          if (x >= given_count_ && y >= given_count_ && ends[x - given_count_].first == ends[y - given_count_].first)
            fits = fits && paths_[ends[x - given_count_].first].length() > 4 * snap_;
        }
      if (!fits || !near_on_surface(places[i], places[j])) continue;
      std::vector<int> moved = std::move(b);
      b.clear();
      const int target = group[i];
      for (const int x : moved) group[x] = target;
      a.insert(a.end(), moved.begin(), moved.end());
      std::sort(a.begin(), a.end());
    }
    for (const std::vector<int>& members : groups) {
      if (members.empty()) continue;
      int number = members[0];
      if (number >= given_count_) {
        Vec3 sum = Vec3::Zero();
        for (const int x : members) sum += places[x].at;
        StrokeJunction j;
        j.place = paths_on_.locate(sum / static_cast<double>(members.size()), places[members[0]].face);
        number = static_cast<int>(junctions_.size());
        junctions_.push_back(j);
      }
      for (const int x : members) {
        if (x < given_count_) continue;
        const auto& [path, end] = ends[x - given_count_];
        junctions_[number].ends.push_back({path, end});
        paths_[path].junction[end] = number;
      }
    }
  }

  // Junctions go to the boundary, or to a stroke that passes by, if that is near.
  void attach_ends() {
    PointGrid grid(std::max(snap_, edge_length()));
    std::vector<std::pair<int, int>> owner;
    for (int k = 0; k < static_cast<int>(paths_.size()); ++k)
      for (int i = 0; i < static_cast<int>(paths_[k].points.size()); ++i) {
        owner.push_back({k, i});
        grid.add(paths_[k].points[i].at);
      }
    for (int number = given_count_; number < static_cast<int>(junctions_.size()); ++number) {
      StrokeJunction& j = junctions_[number];
      const Vec3 p = j.place.at;
      bool leaves = false;
      for (const auto& [path, end] : j.ends) leaves = leaves || paths_[path].at_boundary[end];
      const bool closed = j.ends.size() == 2 && j.ends[0].first == j.ends[1].first;
      if (closed && !leaves) continue;
      // The nearest place on a stroke that does not begin or end here.
      double best = kInfinity, at = 0;
      int other = -1;
      FacePoint place;
      grid.near(p, snap_ + edge_length(), [&](int n) {
        const auto& [k, i] = owner[n];
        const StrokePath& path = paths_[k];
        for (const int a : {i - 1, i}) {
          if (a < 0 || a + 1 >= static_cast<int>(path.points.size())) continue;
          const Vec3 from = path.points[a].at, along = path.points[a + 1].at - from;
          const double t = nearest_on_segment(p, from, path.points[a + 1].at), s = path.at[a] + t * along.norm();
          const double d = (p - from - t * along).norm();
          if (d > snap_ || !(d < best)) continue;
          if (path.junction[0] == number && s < 3 * snap_) continue;
          if (path.junction[1] == number && s > path.length() - 3 * snap_) continue;
          best = d, at = s, other = k;
          place = {path.points[t < 0.5 ? a : a + 1].face, from + t * along};
        }
      });
      if (other >= 0 && !near_on_surface(j.place, place)) other = -1, best = kInfinity;
      const FacePoint rim = placing_->nearest_on_boundary(p, leaves ? kInfinity : std::min(snap_, best));
      if (rim.face >= 0 && (leaves || near_on_surface(j.place, rim))) {
        j.place = rim;
        j.boundary = true;
        if (given_nodes_)
          for (const auto& [path, end] : j.ends)
            report(Kind::BetweenNodes, "a stroke ends on the boundary, but at none of its nodes", {rim.at}, paths_[path].stroke);
      } else if (other >= 0) {
        j.place = paths_on_.locate(place.at, place.face);
        paths_[other].stops.push_back({at, number});
      }
    }
    for (StrokePath& path : paths_)
      std::stable_sort(path.stops.begin(), path.stops.end(), [](const StrokePath::Stop& a, const StrokePath::Stop& b) { return a.at < b.at; });
  }

  // Every junction becomes a vertex.
  void place_junctions() {
    for (const StrokeJunction& j : junctions_)
      if (j.vertex >= 0) placing_->take(j.vertex);
    for (StrokeJunction& j : junctions_)
      if (j.vertex < 0) j.vertex = j.boundary ? placing_->on_boundary(j.place.at) : placing_->inside(j.place);
    for (StrokePath& path : paths_)
      for (FacePoint& p : path.points) p = paths_on_.locate(p.at, p.face);
  }

  // --- curves ----------------------------------------------------------------------------------------------------------------------
  FacePoint at_vertex(int v) const { return {curves_.mesh().out[v] / 3, curves_.points()[v]}; }

  void draw() {
    for (int k = 0; k < static_cast<int>(paths_.size()); ++k) {
      progress_.check();
      StrokePath& path = paths_[k];
      const Vec3 &start = curves_.points()[junctions_[path.junction[0]].vertex], &end = curves_.points()[junctions_[path.junction[1]].vertex];
      // The way to the end's vertex begins before it.
      const double before = std::max(0.5 * snap_, 1.2 * (path.points.front().at - start).norm()),
                   after = std::max(0.5 * snap_, 1.2 * (path.points.back().at - end).norm());
      std::size_t first = 0, last = path.points.size();
      while (first < last && (path.points[first].at - start).norm() < before && path.at[first] < 3 * snap_) ++first;
      while (last > first && (path.points[last - 1].at - end).norm() < after && path.at[last - 1] > path.length() - 3 * snap_) --last;
      int from = junctions_[path.junction[0]].vertex;
      FacePoint at = at_vertex(from);
      std::vector<SurfaceCurves::Step> steps;
      std::size_t stop = 0;
      bool joined = true;
      const auto go_to = [&](const FacePoint& to) {
        const auto way = joined ? paths_on_.join(at, to, kInfinity) : std::nullopt;
        joined = way.has_value();
        if (joined) steps.insert(steps.end(), way->begin(), way->end());
        at = to;
      };
      int pieces = 0;
      const auto end_at = [&](int v) {
        go_to(at_vertex(v));
        if (joined && curves_.add(from, v, steps, k) >= 0) ++pieces;
        from = v;
        at = at_vertex(v);
        steps.clear();
      };
      for (std::size_t i = first; i < last && joined; ++i) {
        for (; stop < path.stops.size() && path.stops[stop].at <= path.at[i]; ++stop) end_at(junctions_[path.stops[stop].junction].vertex);
        go_to(path.points[i]);
      }
      for (; stop < path.stops.size(); ++stop) end_at(junctions_[path.stops[stop].junction].vertex);
      end_at(junctions_[path.junction[1]].vertex);
      if (!joined)
        report(Kind::Disconnected, "a stroke goes from one component of the surface to another", path.line(), path.stroke);
      else if (pieces == 0 && path.junction[0] != path.junction[1])
        report(Kind::Overlap, "nothing is left of a stroke: another one joins the same nodes there", path.line(), path.stroke);
    }
  }

  std::vector<int> vertices() const {
    std::vector<int> all;
    for (const StrokeJunction& j : junctions_) all.push_back(j.vertex);
    return all;
  }
  std::vector<int> boundary_nodes() const {
    std::vector<int> nodes = vertices();
    nodes.resize(given_count_);
    return nodes;
  }

  void tighten() {
    // What bounds a face with fewer than three sides would shrink to nothing: it is left as it was drawn, so that it can be seen.
    const PatchLayout layout = make_patch_layout(surface_, curves_, boundary_nodes());
    std::vector<char> fixed;
    std::size_t next = 0;
    std::vector<int> number;
    for (int c = 0; c < curves_.curve_count(); ++c) {
      number.push_back(curves_.curve(c).alive ? static_cast<int>(next++) : -1);
      fixed.push_back(!curves_.curve(c).alive || paths_[curves_.curve(c).stroke].fit == DrawnStroke::Fit::AsDrawn);
    }
    std::vector<char> small(layout.curves.size(), 0);
    for (const PatchLayout::Face& face : layout.faces) {
      if (!face.is_disk() || face.side_count() > 2) continue;
      const std::vector<PatchLayout::Side>& cycle = face.cycles[0];
      if (cycle.size() == 2 && cycle[0].curve == cycle[1].curve) continue;  // all around one curve
      for (const PatchLayout::Side& s : cycle) small[s.curve] = 1;
    }
    for (std::size_t c = 0; c < fixed.size(); ++c) fixed[c] = fixed[c] || small[number[c]];
    const std::vector<char> detours = find_detours(curves_, fixed, 2 * snap_, progress_);
    for (std::size_t c = 0; c < fixed.size(); ++c) fixed[c] = fixed[c] || detours[c];
    CurveTightener(curves_, fixed).tighten_all(progress_);
  }

  DrawnLayout finish() {
    DrawnLayout out;
    out.layout = make_patch_layout(surface_, curves_, boundary_nodes());
    std::vector<char> found(strokes_.size(), 0);
    for (const LayoutProblem& p : problems_) found[p.stroke] = 1;
    for (PatchLayout::Curve& c : out.layout.curves)
      if (c.stroke >= 0) found[c.stroke = paths_[c.stroke].stroke] = 1;
    for (const StrokePath& path : paths_) {
      if (found[path.stroke]) continue;
      found[path.stroke] = 1;
      report(Kind::Unusable, "nothing is left of a stroke: it is too small", path.line(), path.stroke);
    }
    for (LayoutProblem& p : problems_) {
      for (Vec3& x : p.where) x = frame_.from_unit(x);
      out.problems.push_back(std::move(p));
    }
    for (LayoutProblem& p : find_problems(out.layout)) out.problems.push_back(std::move(p));
    return out;
  }

  const TriangleSurface& surface_;
  const std::vector<DrawnStroke>& strokes_;
  const DrawnLayoutOptions& options_;
  const Progress& progress_;
  Placement frame_;
  double snap_;
  TriangleSurface unit_;
  SurfaceCurves curves_;
  SurfacePaths paths_on_;
  std::vector<StrokePath> paths_;
  std::vector<StrokeJunction> junctions_;  // first those of the boundary
  int given_count_ = 0;
  bool given_nodes_ = false;
  std::optional<VertexPlacing> placing_;
  std::vector<LayoutProblem> problems_;
};

}  // namespace

DrawnLayout make_layout(const TriangleSurface& surface, const std::vector<DrawnStroke>& strokes, const DrawnLayoutOptions& options,
                        const Progress& progress) {
  if (!(options.snap >= 0 && options.snap <= limits::most_snap))
    throw Error(ErrorCode::InvalidInput, "snap must be from 0 to " + std::to_string(limits::most_snap));
  if (!(options.reach >= 0 && std::isfinite(options.reach))) throw Error(ErrorCode::InvalidInput, "reach must be at least 0");
  if (!(options.corner_angle > 0)) throw Error(ErrorCode::InvalidInput, "corner_angle must be greater than 0");
  if (surface.empty()) throw Error(ErrorCode::InvalidInput, "a surface without faces has no layout");
  DrawnLayout out = LayoutMaker(surface, strokes, options, progress).run();
  progress(1);
  return out;
}

}  // namespace hybrid_mesh
