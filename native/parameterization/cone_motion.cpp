// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Khodakovsky, Litke, Schroeder, Globally smooth parameterizations with low distortion, 2003 (moving patch corners); Floater, Mean value
// coordinates, 2003.
#include "parameterization/cone_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <numbers>
#include <unordered_map>

namespace hybrid_mesh {
namespace {

class ConeMotion {
 public:
  ConeMotion(ChartMesh& charts, const Distortion& density, const std::vector<char>& allowed)
      : c_(charts), relaxation_(charts, density), allowed_(allowed) {}

  // Moves the cone where that lowers the energy; with `evict` moves it anyway, if a neighbour can take it. Returns the vertex that it moved to, or
  // -1.
  int try_move(int cone, bool evict) {
    // Another cone or the boundary may be too near for a large disc.
    if (!build_disc(cone, 3) && !build_disc(cone, 2)) return -1;
    solve();
    const int n = static_cast<int>(inner_);
    int best = 0;
    for (int i = 1; i < n; ++i)
      if (std::abs(solved_[i]) < std::abs(solved_[best])) best = i;
    if (best == 0 && !evict) return -1;
    // The cone's neighbours, nearest to the wanted place first.
    std::vector<std::pair<double, int>> targets;
    int h = c_.mesh.out[cone];
    do {
      const int w = c_.mesh.to(h), i = index_.at(w);
      if (c_.kind[w] == ChartMesh::Kind::Free && i < n && (allowed_.empty() || allowed_[w])) targets.push_back({std::abs(solved_[i]), h});
      h = c_.mesh.ccw(h);
    } while (h != c_.mesh.out[cone]);
    std::sort(targets.begin(), targets.end());
    for (std::size_t k = 0; k < targets.size(); ++k) {
      if (!evict && (k == 2 || targets[k].first >= std::abs(solved_[0]))) break;
      const int target = c_.mesh.to(targets[k].second);
      if (hop(cone, targets[k].second, evict)) return target;
    }
    return -1;
  }

 private:
  struct Member {
    explicit Member(int v) : vertex(v) {}
    int vertex;
    double radius = 0, angle = 0;  // developed around the cone: angle in [0, quads * pi / 2)
    int home = -1;                 // a half-edge that leaves it, in a face of the disc ...
    double offset = 0;             // ... and the angle to add to that face's chart
    Complex w;
  };

  // Vertices up to ring `rings` (the rim), developed around the cone. False if an inner one is a cone or at the boundary.
  bool build_disc(int cone, int rings) {
    members_.clear(), index_.clear(), faces_.clear(), pins_.clear(), offsets_.clear();
    quads_ = c_.angle_at(cone) / (0.5 * std::numbers::pi);
    quads_ = std::round(quads_);
    std::vector<int> ring{cone}, next_ring, around;
    members_.emplace_back(cone);
    index_[cone] = 0;
    for (int r = 1; r <= rings; ++r) {
      next_ring.clear();
      for (const int v : ring) {
        if (c_.mesh.is_boundary(v) || (v != cone && c_.kind[v] != ChartMesh::Kind::Free)) return false;
        c_.mesh.ring(v, around);
        for (const int w : around)
          if (index_.insert({w, static_cast<int>(members_.size())}).second) {
            members_.emplace_back(w);
            next_ring.push_back(w);
          }
      }
      if (r == rings) inner_ = members_.size() - next_ring.size();
      ring.swap(next_ring);
    }
    // Faces with an inner vertex, from the cone's star outwards.
    std::vector<int> queue;
    const auto known = [&](int f) { return pins_.count(f) > 0; };
    const int start = c_.mesh.out[cone];
    pins_[start / 3] = c_.at(start);
    offsets_[start / 3] = 0;
    queue.push_back(start / 3);
    const auto seen = [&](int h) { return members_[index_.at(c_.mesh.origin[h])].home >= 0; };
    const auto place = [&](int h, double angle) {
      Member& m = members_[index_.at(c_.mesh.origin[h])];
      m.home = h;
      m.angle = angle;
      m.radius = std::abs(c_.at(h) - pins_[h / 3]);
      m.offset = offsets_[h / 3];
    };
    {
      const int a = EditMesh::next(start);
      offsets_[start / 3] = -std::arg(c_.at(a) - pins_[start / 3]);
      place(a, 0);
    }
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const int f = queue[i];
      const Complex pin = pins_[f];
      // One placed corner gives the angles of the others: a triangle subtends less than half a turn at the cone.
      int known_corner = -1;
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (c_.mesh.origin[h] != cone && seen(h) && (known_corner < 0)) known_corner = h;
      const double base = std::arg(c_.at(known_corner) - pin);
      const double reference = base + offsets_[f];
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        if (c_.mesh.origin[h] == cone || seen(h)) continue;
        place(h, reference + std::arg((c_.at(h) - pin) * std::conj(c_.at(known_corner) - pin)));
      }
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int o = c_.mesh.opposite[h];
        if (o < 0 || known(o / 3)) continue;
        bool inside = false;
        for (int k = 0; k < 3; ++k) {
          const auto it = index_.find(c_.mesh.origin[3 * (o / 3) + k]);
          inside |= it != index_.end() && it->second < static_cast<int>(inner_);
        }
        if (!inside) continue;
        const int g = o / 3;
        pins_[g] = c_.gluing[h](pin);
        // A corner of the shared edge that is not the cone carries the angle over.
        const int shared = c_.mesh.origin[h] == cone ? EditMesh::next(h) : h;
        const int in_g = c_.mesh.origin[o] == c_.mesh.origin[shared] ? o : EditMesh::next(o);
        const double angle = std::arg(c_.at(shared) - pin) + offsets_[f];
        offsets_[g] = angle - std::arg(c_.at(in_g) - pins_[g]);
        queue.push_back(g);
      }
    }
    faces_ = queue;
    for (std::size_t i = 1; i < members_.size(); ++i) {
      Member& m = members_[i];
      if (m.home < 0 || !(m.radius > 0)) return false;
      m.w = std::polar(std::pow(m.radius, 4 / quads_), m.angle * 4 / quads_);
    }
    return true;
  }

  void solve() {
    const int n = static_cast<int>(inner_);
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(n, 2);
    for (int i = 0; i < n; ++i) {
      const int v = members_[i].vertex;
      double sum = 0;
      int h = c_.mesh.out[v];
      do {
        // Mean-value weight of the edge h from the triangles on both sides.
        const int o = c_.mesh.opposite[h];
        const Vec3 &p = c_.points[v], &q = c_.points[c_.mesh.to(h)], &a = c_.points[c_.mesh.apex(h)], &b = c_.points[c_.mesh.apex(o)];
        const auto half_tangent = [](const Vec3& x, const Vec3& y) { return std::tan(0.5 * std::min(std::atan2(x.cross(y).norm(), x.dot(y)), 3.1)); };
        const Vec3 e = q - p;
        const double weight = (half_tangent(e, a - p) + half_tangent(e, b - p)) / std::max(e.norm(), 1e-12);
        sum += weight;
        const int j = index_.at(c_.mesh.to(h));
        if (j < n) {
          matrix(i, j) -= weight;
        } else {
          right(i, 0) += weight * members_[j].w.real();
          right(i, 1) += weight * members_[j].w.imag();
        }
        h = c_.mesh.ccw(h);
      } while (h != c_.mesh.out[v]);
      matrix(i, i) += sum;
    }
    const Eigen::MatrixX2d x = matrix.partialPivLu().solve(right);
    solved_.resize(n);
    for (int i = 0; i < n; ++i) solved_[i] = Complex(x(i, 0), x(i, 1));
  }

  double disc_energy() const {
    double sum = 0;
    for (const int f : faces_) sum += relaxation_.face_energy(f);
    return sum;
  }

  bool hop(int cone, int h, bool at_any_cost) {
    const int target = c_.mesh.to(h), o = c_.mesh.opposite[h];
    const double before = disc_energy();
    std::vector<Complex> uv;
    for (std::size_t i = 0; i < inner_; ++i) uv.push_back(c_.uv[members_[i].vertex]);
    std::vector<Transition> corners, gluings;
    for (const int f : faces_)
      for (int k = 3 * f; k < 3 * f + 3; ++k) {
        corners.push_back(c_.corner[k]);
        gluings.push_back(c_.gluing[k]);
      }
    const Complex pin = c_.at(h);
    const double angle = std::arg(c_.at(EditMesh::next(h)) - pin) + offsets_[h / 3];

    // The old cone becomes regular: the transition across the edge is what walking around it gives.
    Transition t;
    c_.corner[h] = t;
    for (int g = h, n = c_.mesh.ccw(h); n != h; g = n, n = c_.mesh.ccw(n)) {
      t = c_.gluing[EditMesh::prev(g)] * t;
      c_.corner[n] = t;
    }
    c_.gluing[h] = c_.corner[EditMesh::next(o)];
    c_.gluing[o] = c_.gluing[h].inverse();
    // The new one takes the pin, carried around it on the other side of the edge.
    Transition held{0, static_cast<std::int32_t>(pin.real()), static_cast<std::int32_t>(pin.imag())};
    int g = EditMesh::next(h);
    c_.corner[g] = held;
    while (g != o) {
      held = c_.gluing[g] * held;
      g = EditMesh::next(c_.mesh.opposite[g]);
      c_.corner[g] = held;
    }
    c_.kind[cone] = ChartMesh::Kind::Free;
    c_.kind[target] = ChartMesh::Kind::Cone;
    c_.uv[target] = Complex(0, 0);

    // Inner vertices to where the flattened disc wants them, shifted so that the target is at its centre.
    double rim = 1e300;
    for (std::size_t i = inner_; i < members_.size(); ++i) rim = std::min(rim, std::abs(members_[i].w));
    const Complex shift = solved_[index_.at(target)];
    const double power = quads_ / 4;
    for (std::size_t i = 0; i < inner_; ++i) {
      const Member& m = members_[i];
      if (m.vertex == target) continue;
      const Complex w = solved_[i] - shift * std::max(0.0, 1 - std::abs(solved_[i]) / rim);
      if (i == 0) {
        double turn = std::arg(w * std::polar(1.0, -angle / power));
        if (turn < 0) turn += 2 * std::numbers::pi;
        c_.uv[cone] = c_.corner[h].back(pin + std::polar(std::pow(std::abs(w), power), (angle / power + turn) * power - offsets_[h / 3]));
        continue;
      }
      const double turn = std::arg(w * std::polar(1.0, -m.angle / power));
      const Complex z = pins_[m.home / 3] + std::polar(std::pow(std::abs(w), power), (m.angle / power + turn) * power - m.offset);
      c_.uv[m.vertex] = c_.corner[m.home].back(z);
    }

    std::vector<int> inner, all;
    for (std::size_t i = 0; i < members_.size(); ++i) (i < inner_ ? inner : all).push_back(members_[i].vertex);
    bool good = relaxation_.unfold(inner) && std::abs(c_.angle_at(target) - 0.5 * std::numbers::pi * quads_) < 0.1;
    if (good) {
      for (int sweep = 0; sweep < 5; ++sweep)
        for (const int v : inner)
          if (c_.movable(v)) relaxation_.relax(v, false);
      // The rim's own windings could have changed with their neighbours.
      for (const int v : all)
        if (c_.movable(v) && !c_.mesh.is_boundary(v) && std::abs(c_.angle_at(v) - 2 * std::numbers::pi) > 0.1) good = false;
      if (!at_any_cost && !(disc_energy() < before * (1 - 1e-4))) good = false;
    }
    if (good) return true;
    for (std::size_t i = 0; i < inner_; ++i) c_.uv[members_[i].vertex] = uv[i];
    std::size_t at = 0;
    for (const int f : faces_)
      for (int k = 3 * f; k < 3 * f + 3; ++k, ++at) {
        c_.corner[k] = corners[at];
        c_.gluing[k] = gluings[at];
      }
    c_.kind[cone] = ChartMesh::Kind::Cone;
    c_.kind[target] = ChartMesh::Kind::Free;
    return false;
  }

  ChartMesh& c_;
  StarRelaxation relaxation_;
  const std::vector<char>& allowed_;
  std::vector<Member> members_;  // the cone, then ring by ring
  std::unordered_map<int, int> index_;
  std::size_t inner_ = 0;  // members before the rim
  std::vector<int> faces_;
  std::unordered_map<int, Complex> pins_;    // per face: the cone's place in its chart, developed
  std::unordered_map<int, double> offsets_;  // per face: from its chart's angles to developed ones
  std::vector<Complex> solved_;
  double quads_ = 4;
};

}  // namespace

int move_cones(ChartMesh& charts, const Distortion& density, const std::vector<char>& allowed) {
  ConeMotion motion(charts, density, allowed);
  std::vector<int> cones;
  for (int v = 0; v < static_cast<int>(charts.kind.size()); ++v)
    if (charts.mesh.vertex_alive(v) && charts.kind[v] == ChartMesh::Kind::Cone) cones.push_back(v);
  int moved = 0;
  for (const int cone : cones) moved += motion.try_move(cone, false) >= 0;
  return moved;
}

int evict_cone(ChartMesh& charts, const Distortion& density, int cone, const std::vector<char>& allowed) {
  return ConeMotion(charts, density, allowed).try_move(cone, true);
}

}  // namespace hybrid_mesh
