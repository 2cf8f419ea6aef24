// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Rabinovich, Poranne, Panozzo, Sorkine-Hornung, Scalable locally injective mappings, 2017; Khodakovsky, Litke, Schroeder, Globally smooth
// parameterizations with low distortion, 2003; Smith, Schaefer, Bijective parameterization with free boundaries, 2015 (the exact step limit).
#include "parameterization/global_map.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "parameterization/cone_motion.h"
#include "parameterization/corner_motion.h"

namespace hybrid_mesh {
namespace {

double cross(const Complex& a, const Complex& b) { return a.real() * b.imag() - a.imag() * b.real(); }

constexpr const char* kCutStays = "a cut of the surface cannot be undone in the map";

class MapSmoothing {
 public:
  MapSmoothing(ChartMesh& charts, const GlobalMapOptions& options)
      : c_(charts), options_(options), density_{options.theta}, stars_(charts, density_), corners_(charts, density_) {}

  GlobalMapReport smooth(const PatchedSurface& surface, const Progress& progress) {
    progress.check();
    take_sources(surface);
    merge_insertions(0.01);
    progress(0.1);
    relax_bad_stars(0.02, 30, progress.part(0.1, 0.2));
    report_.energy_before = mean_energy();
    const int target = static_cast<int>(std::min(options_.vertices_a_quad * surface.patch_count(), 2e9));
    const std::vector<std::size_t> levels = collapse(target);
    progress(0.3);
    report_.coarse_vertices = c_.mesh.vertex_count;
    newton(options_.newton_steps, progress.part(0.3, 0.45));
    std::vector<int> corners = options_.corners_move ? corners_.all() : std::vector<int>();
    for (int round = 0; round < options_.cone_rounds; ++round) {
      // Those that stay are not tried again.
      corners = corners_.move_downhill(corners, original_);
      const int moved = static_cast<int>(corners.size()) + move_cones(c_, density_, original_);
      report_.cone_moves += moved;
      if (moved == 0) break;
      newton(2, progress.part(0.45, 0.6));
    }
    report_.energy_coarse = mean_energy();
    refine(levels, progress.part(0.6, 1));
    report_.energy = mean_energy();
    return report_;
  }

  // Merges every inserted point; see uncut_map().
  std::vector<int> uncut(const PatchedSurface& surface, const Progress& progress) {
    progress.check();
    take_sources(surface);
    merge_insertions(0.01);
    for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
      if (c_.mesh.vertex_alive(v) && c_.kind[v] == ChartMesh::Kind::Cone && is_inserted(v)) settle(v);
    for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
      if (c_.mesh.vertex_alive(v) && c_.kind[v] == ChartMesh::Kind::Pinned && is_inserted(v)) settle_corner(v);
    // Triangles without area may come in between: what is left in the end are the triangles that were cut.
    merge_insertions(0.01);
    merge_insertions(1e-4, -1);
    merge_by_force(progress);
    relax_bad_stars(0.02, 10, progress);
    progress(1);
    std::vector<int> point(c_.points.size(), -1);
    for (std::size_t v = 0; v < point.size(); ++v)
      if (c_.mesh.vertex_alive(static_cast<int>(v))) point[v] = source_[v].vertices[0];
    return point;
  }

  GlobalMapReport carry(const std::vector<int>& log, const Progress& progress) {
    log_ = log;
    // A sweep whenever the mesh has grown by a fifth.
    std::vector<std::size_t> levels;
    double vertices = c_.mesh.vertex_count;
    const double all = vertices + static_cast<double>(log.size());
    while (vertices < all) {
      levels.push_back(static_cast<std::size_t>(all - vertices));
      vertices *= 1.2;
    }
    std::reverse(levels.begin(), levels.end());
    refine(levels, progress);
    report_.energy = mean_energy();
    return report_;
  }

 private:
  static int next(int h) { return EditMesh::next(h); }
  static int prev(int h) { return EditMesh::prev(h); }

  double mean_energy() const {
    double sum = 0, area = 0;
    for (int f = 0; f < static_cast<int>(c_.mesh.alive.size()); ++f) {
      if (!c_.mesh.alive[f]) continue;
      sum += stars_.face_energy(f);
      area += c_.flat(f).area;
    }
    return sum / area;
  }

  // --- merging the points that cutting inserted --------------------------------------------------------------------------------
  // Cones keep to points of the surface that was cut, so that inserted ones can be merged away.
  void take_sources(const PatchedSurface& surface) {
    source_ = surface.source;
    original_.resize(source_.size());
    for (std::size_t v = 0; v < original_.size(); ++v) original_[v] = !is_inserted(static_cast<int>(v));
  }
  bool is_inserted(int v) const { return source_[v].vertices[1] >= 0; }

  // A point inside an edge or a face of the surface that was cut goes to a neighbour on the same edge or face: the surface stays the same set of
  // points.
  bool merges_in_place(int h) const {
    const PointSource& p = source_[c_.mesh.from(h)];
    const PointSource& q = source_[c_.mesh.to(h)];
    for (const int w : q.vertices)
      if (w >= 0 && std::find(p.vertices.begin(), p.vertices.end(), w) == p.vertices.end()) return false;
    return true;
  }

  // Would the triangles of from(h)'s star stay counter-clockwise, with determinants and 3D shapes not below the bounds?
  bool collapse_keeps_map(int h, double least_determinant, double least_shape) const {
    const int v = c_.mesh.from(h), u = c_.mesh.to(h);
    const Complex target = c_.corner[h].back(c_.at(next(h)));
    bool good = true;
    double fan = 0;  // the angle that the new triangles fill at u
    c_.for_star(v, [&](int g, const Complex& a, const Complex& b) {
      const int p = c_.mesh.to(g), q = c_.mesh.apex(g);
      if (!good || p == u || q == u) return;
      const Vec3 x = c_.points[p] - c_.points[u], y = c_.points[q] - c_.points[u];
      const double area = x.cross(y).norm(), sum = x.squaredNorm() + y.squaredNorm() + (x - y).squaredNorm();
      if (!(area > least_shape * sum)) {
        good = false;
        return;
      }
      const double signed_area = 0.5 * cross(b - a, target - a);
      if (!(signed_area > least_determinant * 0.5 * area * c_.scale * c_.scale)) good = false;
      fan += std::arg((b - target) * std::conj(a - target));
    });
    // v could not come back into a fan of a full turn, which only a cone of five or more quads has room for. The fan may still widen, and u become
    // such a cone.
    return good && fan < (c_.kind[u] == ChartMesh::Kind::Cone ? 3.0 : 4.0);
  }

  // Within the plane of a face, or of the two beside an edge, triangles that fold over each other have too much area.
  bool keeps_area(int h) const {
    const int v = c_.mesh.from(h);
    const Vec3& target = c_.points[c_.mesh.to(h)];
    double before = 0, after = 0;
    c_.for_star(v, [&](int g, const Complex&, const Complex&) {
      const Vec3 &p = c_.points[c_.mesh.to(g)], &q = c_.points[c_.mesh.apex(g)];
      before += (p - c_.points[v]).cross(q - c_.points[v]).norm();
      after += (p - target).cross(q - target).norm();
    });
    return after <= before * (1 + 1e-9);
  }

  void merge_insertions(double least_determinant, double least_shape = 1e-6) {
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
          if (l < shortest && merges_in_place(h) && c_.can_collapse(h) && collapse_keeps_map(h, least_determinant, least_shape) &&
              (least_shape < 0 || keeps_area(h)))
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

  // A cone at an inserted point takes the place of a neighbour, a point of the surface: that is merged into it, and its name and place on the surface
  // go over.
  void settle(int cone) {
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
      const std::vector<Complex> before = c_.uv;
      const int seen_from = prev(half);
      const Complex place = c_.corner[seen_from].back(c_.at(half));
      c_.collapse(half);
      c_.mesh.grow(region, 1);
      for (int rings = 0; rings < 3; ++rings) {
        if (rings > 0) c_.mesh.grow(region, 1);
        if (!stars_.unfold(region)) continue;
        c_.move_point(cone, c_.points[w]);
        source_[cone] = source_[w];
        original_[cone] = 1;
        return;
      }
      c_.uv = before;
      c_.undo_collapse(half);
      if (c_.kind[c_.mesh.origin[seen_from]] == ChartMesh::Kind::Cone) break;
      c_.uv[w] = c_.corner[seen_from](place);
    }
    const int next = evict_cone(c_, density_, cone, original_);
    if (next < 0) throw Error(ErrorCode::Internal, "an irregular node of the base cannot be moved to a vertex");
  }

  // A corner of the base on the boundary that is inside an edge of the surface goes to one of the edge's ends, the nearer one if the map unfolds
  // there.
  void settle_corner(int corner) {
    const auto length_to = [&](int v) { return (c_.points[v] - c_.points[corner]).norm(); };
    const bool onward = length_to(corners_.next(corner, true)) < length_to(corners_.next(corner, false));
    for (const bool forward : {onward, !onward}) {
      int at = corner;
      while (at >= 0 && is_inserted(at)) at = corners_.move(at, forward);
      if (at >= 0) return;
    }
    throw Error(ErrorCode::Internal, "a corner of the base on the boundary cannot be moved to a vertex");
  }

  // Merges what is left whatever becomes of the map, and unfolds it there. What does not unfold is tried again when others have gone; cones and
  // corners of the boundary near it, which may ask a triangle for an angle that none can have, give way.
  void merge_by_force(const Progress& progress) {
    // Where it can be done at all, it has taken up to 60 relaxations a vertex. Where triangles are too long for the map to be linear on them,
    // thousands of points resist.
    const std::int64_t most = stars_.relaxed_folded() + 100 * static_cast<std::int64_t>(c_.mesh.vertex_count);
    for (int pass = 0; pass < 8; ++pass) {
      progress.check();
      std::vector<int> left;
      for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
        if (c_.mesh.vertex_alive(v) && is_inserted(v) && !unfolds_when_merged(v, pass)) {
          left.push_back(v);
          if (stars_.relaxed_folded() > most) throw Error(ErrorCode::Internal, kCutStays);
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
      merge_insertions(1e-4, -1);
    }
    throw Error(ErrorCode::Internal, kCutStays);
  }

  bool unfolds_when_merged(int v, int pass) {
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
      const std::vector<Complex> before = c_.uv;
      // Where v is, seen from another corner of its face: its own frame is lost.
      const int seen_from = c_.kind[c_.mesh.to(half)] != ChartMesh::Kind::Cone ? next(half) : prev(half);
      const Complex place = c_.corner[seen_from].back(c_.at(half));
      const bool known = c_.kind[c_.mesh.origin[seen_from]] != ChartMesh::Kind::Cone;
      c_.collapse(half);
      // More room and patience with those that resist.
      for (int rings = 0; rings < (pass < 3 ? 3 : 6); ++rings) {
        if (rings > 0) c_.mesh.grow(region, 1);
        if (stars_.unfold(region, pass < 3 ? 24 : 120)) return true;
      }
      c_.uv = before;
      const bool placed = c_.undo_collapse(half);
      if (known && !c_.mesh.is_boundary(v)) c_.uv[v] = c_.corner[seen_from](place);
      if (!placed && !known) break;
    }
    return false;
  }
  double least_determinant_after(int h) const {
    const int v = c_.mesh.from(h), u = c_.mesh.to(h);
    const Complex target = c_.corner[h].back(c_.at(next(h)));
    double least = 1e300;
    c_.for_star(v, [&](int g, const Complex& a, const Complex& b) {
      if (c_.mesh.to(g) != u && c_.mesh.apex(g) != u) least = std::min(least, cross(b - a, target - a));
    });
    return least;
  }

  // Badly squeezed triangles first: a global line search would stall on them.
  void relax_bad_stars(double least, int sweeps, const Progress& progress) {
    std::vector<int> around;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      std::vector<char> chosen(c_.points.size(), 0);
      bool any = false;
      for (int f = 0; f < static_cast<int>(c_.mesh.alive.size()); ++f)
        if (c_.mesh.alive[f] && c_.determinant(f) < least) {
          any = true;
          for (int i = 0; i < 3; ++i) chosen[c_.mesh.origin[3 * f + i]] = 1;
        }
      if (!any) break;
      for (int ring = 0; ring < 3; ++ring) {
        std::vector<char> grown = chosen;
        for (int f = 0; f < static_cast<int>(c_.mesh.alive.size()); ++f) {
          if (!c_.mesh.alive[f]) continue;
          const int* v = &c_.mesh.origin[3 * f];
          if (chosen[v[0]] || chosen[v[1]] || chosen[v[2]]) grown[v[0]] = grown[v[1]] = grown[v[2]] = 1;
        }
        chosen.swap(grown);
      }
      for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
        if (chosen[v] && c_.mesh.vertex_alive(v) && c_.movable(v)) stars_.relax(v, true);
      progress((sweep + 1.0) / sweeps);
    }
  }

  // --- the collapse hierarchy ------------------------------------------------------------------------------------------------------
  // Collapses down to `target` vertices in passes over independent stars; returns the length of the log after each pass.
  std::vector<std::size_t> collapse(int target) {
    std::vector<std::size_t> levels;
    struct Candidate {
      double cost;
      int vertex;
    };
    std::vector<Candidate> order;
    std::vector<char> locked(c_.points.size(), 0);
    std::vector<int> ring;
    while (c_.mesh.vertex_count > target) {
      order.clear();
      for (int v = 0; v < static_cast<int>(c_.points.size()); ++v) {
        locked[v] = 0;
        if (!c_.mesh.vertex_alive(v) || !c_.movable(v)) continue;
        double shortest = 1e300;
        int h = c_.mesh.out[v];
        do {
          shortest = std::min(shortest, (c_.points[c_.mesh.to(h)] - c_.points[v]).squaredNorm());
          h = c_.mesh.ccw(h);
        } while (h >= 0 && h != c_.mesh.out[v]);
        order.push_back({shortest, v});
      }
      std::sort(order.begin(), order.end(),
                [](const Candidate& a, const Candidate& b) { return a.cost != b.cost ? a.cost < b.cost : a.vertex < b.vertex; });
      // Only the shorter half: a pass over independent stars must not reach for long edges while short ones are locked.
      order.resize((order.size() + 1) / 2);
      const std::size_t before = log_.size();
      for (const Candidate& candidate : order) {
        const int v = candidate.vertex;
        if (locked[v]) continue;
        std::vector<std::pair<double, int>> halves;
        int h = c_.mesh.out[v];
        do {
          halves.push_back({(c_.points[c_.mesh.to(h)] - c_.points[v]).squaredNorm(), h});
          if (c_.mesh.is_boundary(v)) break;
          h = c_.mesh.ccw(h);
        } while (h >= 0 && h != c_.mesh.out[v]);
        std::sort(halves.begin(), halves.end());
        for (std::size_t i = 0; i < std::min<std::size_t>(3, halves.size()); ++i) {
          const int half = halves[i].second;
          if (!c_.can_collapse(half) || !collapse_keeps_map(half, 0.05, 0.03)) continue;
          c_.mesh.ring(v, ring);
          for (const int w : ring) locked[w] = 1;
          c_.collapse(half);
          log_.push_back(half);
          break;
        }
        if (c_.mesh.vertex_count <= target) break;
      }
      if (log_.size() - before < 0.005 * c_.mesh.vertex_count + 1) {
        if (log_.size() > before) levels.push_back(log_.size());
        break;
      }
      levels.push_back(log_.size());
    }
    return levels;
  }

  void sweep(int count, const std::vector<int>& vertices, const Progress& progress) {
    for (int i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        if (k % 4096 == 0) progress.check();
        stars_.relax(vertices[i % 2 == 0 ? k : vertices.size() - 1 - k], false);
      }
    }
  }

  std::vector<int> movable_vertices() const {
    std::vector<int> vertices;
    for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
      if (c_.mesh.vertex_alive(v) && c_.movable(v)) vertices.push_back(v);
    return vertices;
  }

  void refine(const std::vector<std::size_t>& levels, const Progress& progress) {
    int swept = c_.mesh.vertex_count;
    for (std::size_t level = levels.size(); level-- > 0;) {
      const std::size_t begin = level > 0 ? levels[level - 1] : 0;
      while (log_.size() > begin) {
        const int h = log_.back();
        log_.pop_back();
        if (log_.size() % 4096 == 0) progress.check();
        const int v = c_.mesh.from(h);
        bool placed = c_.undo_collapse(h);
        const int kept = c_.mesh.to(h);
        for (int tries = 0; tries < 3 && !placed && c_.kind[kept] == ChartMesh::Kind::Cone; ++tries) {
          // The vertex would come back into a fan of a full turn or more, for which a cone has room: the cone has to give way.
          c_.collapse(h);
          const bool evicted = evict_cone(c_, density_, kept) >= 0;
          placed = c_.undo_collapse(h);
          if (!evicted) break;
        }
        std::vector<Complex> before;
        if (!placed) before = c_.uv;
        // Where its ring has no kernel, the ring is given the chance to become rounder first.
        for (int tries = 0; tries < 3 && !placed && !unfolds_around(v, 2, 24); ++tries) {
          c_.collapse(h);
          std::vector<int> region{kept};
          c_.mesh.grow(region, 2 + tries);
          for (int sweep = 0; sweep < 10; ++sweep)
            for (const int w : region)
              if (c_.movable(w)) stars_.relax(w, true);
          placed = c_.undo_collapse(h);
        }
        if (!placed && options_.corners_move && !corners_.near(v).empty()) {
          // Collapsed again, the map is unfolded as it was.
          const auto take_back = [&] {
            c_.collapse(h);
            c_.uv = before;
          };
          take_back();
          placed = corners_.move_near(kept, [&](int) {
            before = c_.uv;
            if (c_.undo_collapse(h) || unfolds_around(v, 2, 24)) return true;
            take_back();
            return false;
          });
          if (!placed) placed = c_.undo_collapse(h);
        }
        if (!placed) {
          ++report_.unplaced;
          untangle(v);
        }
        make_room(v);
      }
      // A full sweep whenever the mesh has grown by half, and at the end.
      if (c_.mesh.vertex_count > 1.5 * swept || level == 0) {
        sweep(options_.sweeps, movable_vertices(), progress);
        swept = c_.mesh.vertex_count;
        for (int round = 0; round < 2; ++round) report_.cone_moves += move_cones(c_, density_, original_);
      }
      progress(1 - static_cast<double>(level) / levels.size());
    }
  }

  // Relaxes a vertex that has just come back, and where its triangles are squeezed its neighbours with it: the next ones to come back there would be
  // squeezed more and more.
  void make_room(int v) {
    std::vector<int> ring;
    for (int tries = 0; tries < 6; ++tries) {
      stars_.relax(v, tries > 0);
      double least = 1e300;
      int h = c_.mesh.out[v];
      do {
        least = std::min(least, c_.determinant(h / 3));
        h = c_.mesh.ccw(h);
      } while (h >= 0 && h != c_.mesh.out[v]);
      if (least > 0.1) return;
      c_.mesh.ring(v, ring);
      for (const int w : ring)
        if (c_.movable(w)) stars_.relax(w, true);
    }
  }

  // The star of v has no kernel: its neighbours are moved until it has one.
  bool unfolds_around(int v, int rings, int sweeps) {
    std::vector<int> region{v};
    c_.mesh.grow(region, rings);
    return stars_.unfold(region, sweeps);
  }
  void untangle(int v) {
    for (int rings = 2; rings < 7; ++rings)
      if (unfolds_around(v, rings, rings < 4 ? 24 : 150)) return;
    throw Error(ErrorCode::Internal, "the map could not be carried to a finer mesh");
  }

  // --- the coarse mesh -----------------------------------------------------------------------------------------------------------
  void newton(int steps, const Progress& progress) {
    const std::vector<int> vertices = movable_vertices();
    std::vector<int> unknown(2 * c_.points.size(), -1);
    int n = 0;
    for (const int v : vertices) {
      if (c_.kind[v] != ChartMesh::Kind::SlideV) unknown[2 * v] = n++;
      if (c_.kind[v] != ChartMesh::Kind::SlideU) unknown[2 * v + 1] = n++;
    }
    if (n == 0) return;
    std::vector<int> faces;
    std::vector<FlatTriangle> flat;
    for (int f = 0; f < static_cast<int>(c_.mesh.alive.size()); ++f)
      if (c_.mesh.alive[f]) {
        faces.push_back(f);
        flat.push_back(c_.flat(f));
      }
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver;
    bool analyzed = false;
    std::vector<Eigen::Triplet<double>> entries;
    const auto energy_now = [&] {
      double sum = 0;
      for (std::size_t i = 0; i < faces.size(); ++i)
        sum += stars_.triangle_energy(flat[i], c_.at(3 * faces[i]), c_.at(3 * faces[i] + 1), c_.at(3 * faces[i] + 2));
      return sum;
    };
    for (int step = 0; step < steps; ++step) {
      progress(static_cast<double>(step) / steps);
      entries.clear();
      Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
      double energy = 0;
      for (std::size_t i = 0; i < faces.size(); ++i) {
        const int f = faces[i];
        const FlatTriangle& t = flat[i];
        Complex a(0, 0), b(0, 0);
        Eigen::Matrix<double, 4, 6> j;
        std::array<int, 6> at;
        for (int k = 0; k < 3; ++k) {
          const int h = 3 * f + k, v = c_.mesh.origin[h];
          const Complex z = c_.at(h), x = c_.corner[h].rotate(t.alpha[k]), y = c_.corner[h].rotate(std::conj(t.alpha[k]));
          a += t.alpha[k] * z;
          b += std::conj(t.alpha[k]) * z;
          j.block<4, 2>(0, 2 * k) << x.real(), -x.imag(), x.imag(), x.real(), y.real(), -y.imag(), y.imag(), y.real();
          at[2 * k] = unknown[2 * v];
          at[2 * k + 1] = unknown[2 * v + 1];
        }
        const Distortion::Derivatives e = density_(std::norm(a), std::norm(b));
        energy += t.area * e.value;
        Eigen::Vector4d g4;
        g4 << 2 * e.s * a.real(), 2 * e.s * a.imag(), 2 * e.t * b.real(), 2 * e.t * b.imag();
        const Eigen::Matrix<double, 6, 1> g = t.area * (j.transpose() * g4);
        const Eigen::Matrix<double, 6, 6> hessian = t.area * (j.transpose() * ProjectedHessian(e, a, b).matrix() * j);
        for (int p = 0; p < 6; ++p) {
          if (at[p] < 0) continue;
          gradient[at[p]] += g[p];
          for (int q = 0; q < 6; ++q)
            if (at[q] >= 0 && at[q] <= at[p]) entries.push_back({at[p], at[q], hessian(p, q) + (p == q ? 1e-10 * t.area : 0.0)});
        }
      }
      Eigen::SparseMatrix<double> matrix(n, n);
      matrix.setFromTriplets(entries.begin(), entries.end());
      if (!analyzed) solver.analyzePattern(matrix);
      analyzed = true;
      progress.check();
      double damping = 0;
      for (int tries = 0; tries < 5; ++tries) {
        solver.factorize(matrix);
        if (solver.info() == Eigen::Success) break;
        damping = damping == 0 ? 1e-6 : 100 * damping;
        for (int i = 0; i < n; ++i) matrix.coeffRef(i, i) *= 1 + damping;
      }
      if (solver.info() != Eigen::Success) return;
      const Eigen::VectorXd direction = -solver.solve(gradient);
      const double slope = direction.dot(gradient);
      if (!(slope < 0)) return;
      const auto direction_at = [&](int h) {
        const int v = c_.mesh.origin[h];
        const int x = unknown[2 * v], y = unknown[2 * v + 1];
        return c_.corner[h].rotate(Complex(x >= 0 ? direction[x] : 0.0, y >= 0 ? direction[y] : 0.0));
      };
      // The largest step before a triangle's area, a quadratic in the step, vanishes.
      double limit = 1e300;
      for (const int f : faces) {
        const Complex p = c_.at(3 * f), e1 = c_.at(3 * f + 1) - p, e2 = c_.at(3 * f + 2) - p;
        const Complex d = direction_at(3 * f), d1 = direction_at(3 * f + 1) - d, d2 = direction_at(3 * f + 2) - d;
        const double c0 = cross(e1, e2), c1 = cross(e1, d2) + cross(d1, e2), c2 = cross(d1, d2);
        const double discriminant = c1 * c1 - 4 * c2 * c0;
        if (discriminant < 0) continue;
        const double root = std::sqrt(discriminant);
        // The smallest positive root, without cancellation.
        const double q = -0.5 * (c1 + (c1 < 0 ? -root : root));
        for (const double r : {c2 != 0 ? q / c2 : -1.0, q != 0 ? c0 / q : -1.0})
          if (r > 0 && r < limit) limit = r;
      }
      double t = std::min(1.0, 0.9 * limit);
      const std::vector<Complex> start = c_.uv;
      bool accepted = false;
      double fresh = energy;
      for (int tries = 0; tries < 25; ++tries, t *= 0.5) {
        for (const int v : vertices) {
          const int x = unknown[2 * v], y = unknown[2 * v + 1];
          c_.uv[v] = start[v] + t * Complex(x >= 0 ? direction[x] : 0.0, y >= 0 ? direction[y] : 0.0);
        }
        fresh = energy_now();
        if (fresh <= energy + 1e-4 * t * slope && std::isfinite(fresh)) {
          bool unfolded = true;
          for (const int f : faces) {
            const Complex p = c_.at(3 * f);
            if (!(cross(c_.at(3 * f + 1) - p, c_.at(3 * f + 2) - p) > 0)) unfolded = false;
          }
          if (unfolded) {
            accepted = true;
            break;
          }
        }
      }
      if (!accepted) {
        c_.uv = start;
        return;
      }
      report_.newton_steps = step + 1;
      if (energy - fresh < 1e-5 * energy) return;
    }
  }

  ChartMesh& c_;
  const GlobalMapOptions& options_;
  Distortion density_;
  StarRelaxation stars_;
  CornerMotion corners_;
  GlobalMapReport report_;
  std::vector<int> log_;
  std::vector<PointSource> source_;  // per vertex; empty where nothing was cut
  std::vector<char> original_;       // per vertex whether it is a point of the surface that was cut; empty: all are
};

}  // namespace

GlobalMapReport smooth_map(ChartMesh& charts, const PatchedSurface& surface, const GlobalMapOptions& options, const Progress& progress) {
  return MapSmoothing(charts, options).smooth(surface, progress);
}

std::vector<int> uncut_map(ChartMesh& charts, const PatchedSurface& surface, const GlobalMapOptions& options, const Progress& progress) {
  return MapSmoothing(charts, options).uncut(surface, progress);
}

GlobalMapReport carry_map(ChartMesh& charts, const std::vector<int>& log, const GlobalMapOptions& options, const Progress& progress) {
  return MapSmoothing(charts, options).carry(log, progress);
}

}  // namespace hybrid_mesh
