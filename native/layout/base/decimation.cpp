// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Garland, Heckbert, Surface simplification using quadric error metrics, 1997 (the error measure).
#include "layout/base/decimation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <queue>

namespace hybrid_mesh {
namespace {

struct Candidate {
  double cost;
  int vertex, half_edge;
  std::uint32_t stamp;
  bool operator<(const Candidate& o) const { return cost != o.cost ? cost > o.cost : vertex > o.vertex; }
};

// A number in [0, 1) that depends on the seed and the vertex alone.
double jitter(std::uint64_t seed, int v) {
  std::uint64_t x = seed * 0x9E3779B97F4A7C15ull + static_cast<std::uint64_t>(v) * 0xBF58476D1CE4E5B9ull;
  x ^= x >> 31, x *= 0x94D049BB133111EBull, x ^= x >> 29;
  return static_cast<double>(x >> 11) * 0x1.0p-53;
}

class Decimation {
 public:
  Decimation(EditMesh& mesh, const std::vector<Vec3>& points, const DecimationOptions& options, std::vector<MeshEdit>& log)
      : mesh_(mesh), points_(points), options_(options), log_(log), quadrics_(points.size()) {
    valences_.assign(points.size(), 0);
    if (options.fixed.empty()) loop_ = mesh.boundary_loops();
    if (std::all_of(loop_.begin(), loop_.end(), [](int loop) { return loop < 0; })) loop_.clear();
    stamps_.assign(points.size(), 0);
    for (std::size_t f = 0; f < mesh.alive.size(); ++f)
      if (mesh.alive[f]) add_face(static_cast<int>(f));
    for (std::size_t v = 0; v < points.size(); ++v)
      if (mesh.vertex_alive(static_cast<int>(v))) {
        valences_[v] = mesh.valence(static_cast<int>(v));
        loose_ += is_loose(static_cast<int>(v));
      }
  }

  void run(const Progress& progress) {
    const int initial = mesh_.face_count;
    int next_flips = static_cast<int>(0.7 * std::min<double>(initial, 12.0 * options_.target_faces));
    refill();
    int steps = 0;
    while (mesh_.face_count > options_.target_faces || loose_ > 0) {
      if (heap_.empty() && !loop_.empty() && !flipped_) {
        flips();
        refill();
      }
      if (heap_.empty()) break;
      if (++steps % 512 == 0)
        progress(std::clamp((std::log(initial) - std::log(mesh_.face_count)) / std::max(1e-9, std::log(initial) - std::log(options_.target_faces)),
                            0.0, 1.0));
      const Candidate best = heap_.top();
      heap_.pop();
      if (!mesh_.vertex_alive(best.vertex) || best.stamp != stamps_[best.vertex]) continue;
      if (mesh_.face_count <= options_.target_faces && !is_loose(best.vertex)) continue;
      collapse(best.half_edge);
      if (mesh_.face_count <= next_flips) {
        flips();
        next_flips = static_cast<int>(0.7 * mesh_.face_count);
        refill();
      }
    }
    flips();
    progress(1);
  }

  std::vector<VertexQuadric> take_quadrics() { return std::move(quadrics_); }

 private:
  void add_face(int f) {
    const int h = 3 * f;
    const Vec3 &a = points_[mesh_.from(h)], &b = points_[mesh_.to(h)], &c = points_[mesh_.apex(h)];
    const Vec3 n = (b - a).cross(c - a);
    const double length = n.norm();
    if (length > 0) {
      Quadric q;
      const Vec3 unit = n / length;
      q.add_plane(unit, -unit.dot(a), length / 6);
      for (int i = 0; i < 3; ++i) {
        quadrics_[mesh_.from(h + i)].planes += q;
        quadrics_[mesh_.from(h + i)].area += length / 6;
      }
    }
    for (int i = 0; i < 3; ++i) {
      if (mesh_.opposite[h + i] >= 0) continue;
      // The boundary curve is held by planes along it, upright on the face.
      const Vec3 e = points_[mesh_.to(h + i)] - points_[mesh_.from(h + i)];
      Vec3 side = length > 0 ? e.cross(n / length) : Vec3::Zero();
      const double l = side.norm();
      if (l == 0) continue;
      side /= l;
      Quadric q;
      q.add_plane(side, -side.dot(points_[mesh_.from(h + i)]), e.squaredNorm());
      quadrics_[mesh_.from(h + i)].planes += q;
      quadrics_[mesh_.to(h + i)].planes += q;
    }
  }

  // Cost of moving from(h) onto to(h); infinite where the topology forbids it.
  double cost(int h) {
    const int v = mesh_.from(h), u = mesh_.to(h), o = mesh_.opposite[h];
    const Vec3& target = points_[u];
    double longest = 0, worst_shape = 1, worst_turn = 1;
    int g = mesh_.out[v];
    do {
      const int a = mesh_.to(g), b = mesh_.apex(g);
      if (a != u && b != u) {
        const Vec3 ab = points_[b] - points_[a], au = target - points_[a], bu = target - points_[b];
        const Vec3 fresh = au.cross(bu), before = (points_[v] - points_[a]).cross(points_[v] - points_[b]);
        const double la = au.squaredNorm(), lb = bu.squaredNorm(), area2 = fresh.norm();
        longest = std::max({longest, la, lb});
        const double sum = ab.squaredNorm() + la + lb;
        worst_shape = std::min(worst_shape, sum > 0 ? 2 * std::sqrt(3.0) * area2 / sum : 0.0);
        const double scale = area2 * before.norm();
        if (scale > 0) worst_turn = std::min(worst_turn, fresh.dot(before) / scale);
      }
      const int n = mesh_.ccw(g);
      if (n < 0) break;
      g = n;
    } while (g != mesh_.out[v]);
    const double area = quadrics_[v].area + quadrics_[u].area;
    double error = (quadrics_[v].planes(target) + quadrics_[u].planes(target)) / std::max(area, 1e-300);
    error += options_.evenness * longest;
    error *= 1 + 0.3 * (1 / std::max(worst_shape, 0.01) - 1);
    error *= 1 + 20 * std::max(0.0, 0.3 - worst_turn);
    const auto misfit = [&](int w, int valence) {
      const int regular = mesh_.is_boundary(w) ? 4 : 6;
      const double high = std::max(0, valence - regular), low = std::max(0, regular - 1 - valence);
      return high * high + low * low;
    };
    const int apex = mesh_.apex(h);
    double valence = misfit(u, valences_[u] + valences_[v] - (mesh_.is_boundary(v) ? 3 : 4)) + misfit(apex, valences_[apex] - 1);
    if (o >= 0) valence += misfit(mesh_.apex(o), valences_[mesh_.apex(o)] - 1);
    error *= 1 + 0.15 * valence;
    return error * (1 + 1e-3 * jitter(options_.seed, v));
  }

  // On a boundary that is to be left with the fixed vertices only.
  bool is_loose(int v) const { return !options_.fixed.empty() && !options_.fixed[v] && mesh_.is_boundary(v); }

  // Would an inner edge join two vertices of one boundary loop? A map of the surface at this stage could give a triangle between it and the boundary
  // no area, where a straight side of the base runs along it. What only decides on the base, from the first flips on, may have such edges.
  bool makes_chord(int h) {
    const int v = mesh_.from(h), u = mesh_.to(h), o = mesh_.opposite[h];
    if (loop_.empty() || flipped_ || loop_[u] < 0 || loop_[v] >= 0) return false;
    mesh_.ring(v, around_);
    return std::any_of(around_.begin(), around_.end(),
                       [&](int w) { return loop_[w] == loop_[u] && w != u && w != mesh_.apex(h) && (o < 0 || w != mesh_.apex(o)); });
  }

  void push(int v) {
    ++stamps_[v];
    if (!options_.fixed.empty() && options_.fixed[v]) return;
    scratch_.clear();
    int g = mesh_.out[v];
    do {
      scratch_.push_back({cost(g), v, g, stamps_[v]});
      const int n = mesh_.ccw(g);
      if (n < 0 || mesh_.is_boundary(v)) break;  // a boundary vertex moves along its outgoing boundary edge
      g = n;
    } while (g != mesh_.out[v]);
    // The cheapest allowed one; the topological test is dearer than the cost of most.
    std::sort(scratch_.begin(), scratch_.end(),
              [](const Candidate& a, const Candidate& b) { return a.cost != b.cost ? a.cost < b.cost : a.half_edge < b.half_edge; });
    for (const Candidate& c : scratch_)
      if (mesh_.can_collapse(c.half_edge) && !makes_chord(c.half_edge)) {
        heap_.push(c);
        return;
      }
  }

  void refill() {
    heap_ = {};
    for (std::size_t v = 0; v < points_.size(); ++v)
      if (mesh_.vertex_alive(static_cast<int>(v))) push(static_cast<int>(v));
  }

  void collapse(int h) {
    if (!mesh_.can_collapse(h) || makes_chord(h)) return;
    const int v = mesh_.from(h), u = mesh_.to(h), o = mesh_.opposite[h];
    valences_[u] += valences_[v] - (mesh_.is_boundary(v) ? 3 : 4);
    --valences_[mesh_.apex(h)];
    if (o >= 0) --valences_[mesh_.apex(o)];
    quadrics_[u].planes += quadrics_[v].planes;
    quadrics_[u].area += quadrics_[v].area;
    loose_ -= is_loose(v);
    mesh_.collapse(h);
    log_.push_back({MeshEdit::Kind::Collapse, h});
    mesh_.ring(u, ring_);
    push(u);
    for (const int w : ring_) push(w);
  }

  double flip_gain(int h) {
    const int o = mesh_.opposite[h];
    const int a = mesh_.from(h), b = mesh_.to(h), c = mesh_.apex(h), d = mesh_.apex(o);
    const Vec3 &A = points_[a], &B = points_[b], &C = points_[c], &D = points_[d];
    const auto angle = [](const Vec3& at, const Vec3& p, const Vec3& q) {
      const Vec3 x = p - at, y = q - at;
      return std::atan2(x.cross(y).norm(), x.dot(y));
    };
    const Vec3 n1 = (B - A).cross(C - A).normalized(), n2 = (A - B).cross(D - B).normalized();
    const Vec3 m1 = (D - C).cross(A - C), m2 = (C - D).cross(B - D);
    const Vec3 mean = n1 + n2;
    if (!(m1.dot(mean) > 0) || !(m2.dot(mean) > 0)) return -1;
    const double dihedral = m1.normalized().dot(m2.normalized()) - n1.dot(n2);
    const double delaunay = (angle(C, A, B) + angle(D, A, B)) - (angle(A, C, D) + angle(B, C, D));
    const auto misfit = [&](int w, int change) {
      const double x = valences_[w] + change - (mesh_.is_boundary(w) ? 4 : 6);
      return x * x;
    };
    const double valence = misfit(a, 0) + misfit(b, 0) + misfit(c, 0) + misfit(d, 0) - misfit(a, -1) - misfit(b, -1) - misfit(c, 1) - misfit(d, 1);
    return 0.15 * valence + 0.5 * delaunay + 2 * dihedral;
  }

  void flips() {
    flipped_ = true;
    for (int sweep = 0; sweep < 3; ++sweep) {
      int count = 0;
      for (int h = 0; h < static_cast<int>(mesh_.origin.size()); ++h) {
        if (!mesh_.alive[h / 3] || mesh_.opposite[h] < h) continue;
        if (flip_gain(h) <= 0.05 || !mesh_.can_flip(h)) continue;
        --valences_[mesh_.from(h)], --valences_[mesh_.to(h)];
        ++valences_[mesh_.apex(h)], ++valences_[mesh_.apex(mesh_.opposite[h])];
        mesh_.flip(h);
        log_.push_back({MeshEdit::Kind::Flip, h});
        ++count;
      }
      if (count == 0) return;
    }
  }

  EditMesh& mesh_;
  const std::vector<Vec3>& points_;
  const DecimationOptions& options_;
  std::vector<MeshEdit>& log_;
  std::vector<VertexQuadric> quadrics_;
  std::vector<int> valences_;
  std::vector<std::uint32_t> stamps_;
  std::priority_queue<Candidate> heap_;
  std::vector<Candidate> scratch_;
  std::vector<int> ring_, around_;
  std::vector<int> loop_;  // per vertex its boundary loop, or -1; empty: there are none, or only the fixed vertices of them will be left
  bool flipped_ = false;
  int loose_ = 0;
};

}  // namespace

std::vector<VertexQuadric> decimate(EditMesh& mesh, const std::vector<Vec3>& points, const DecimationOptions& options, std::vector<MeshEdit>& log,
                                    const Progress& progress) {
  Decimation decimation(mesh, points, options, log);
  decimation.run(progress);
  return decimation.take_quadrics();
}

}  // namespace hybrid_mesh
