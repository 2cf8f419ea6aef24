// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code, 2021 (the regularised determinant).
#include "parameterization/star_relaxation.h"

#include <Eigen/LU>

namespace hybrid_mesh {
namespace {

double cross(const Complex& a, const Complex& b) { return a.real() * b.imag() - a.imag() * b.real(); }

// (s + t) / chi(D), D = s - t.
struct FoldedDistortion {
  double eps;
  double chi(double d) const { return 0.5 * (d + std::sqrt(eps * eps + d * d)); }
  double value(double s, double t) const { return (s + t) / chi(s - t); }
  Distortion::Derivatives operator()(double s, double t) const {
    const double d = s - t, root = std::sqrt(eps * eps + d * d), x = chi(d), x1 = 0.5 * (1 + d / root), x2 = 0.5 * eps * eps / (root * root * root);
    const double w = s + t, a = x1 / (x * x), b = w * x2 / (x * x) - 2 * w * x1 * x1 / (x * x * x);
    return {w / x, 1 / x - w * a, 1 / x + w * a, -2 * a - b, b, 2 * a - b};
  }
};

}  // namespace

void StarRelaxation::gather(int v) {
  star_.clear(), line_.clear();
  c_.for_star(v, [&](int g, const Complex& a, const Complex& b) {
    if (c_.is_sharp(g)) line_.push_back(a);
    const FlatTriangle& t = c_.flat(g / 3);
    const int i = g % 3, j = (i + 1) % 3, k = (i + 2) % 3;
    star_.push_back({a, b, {{t.alpha[i], t.alpha[j], t.alpha[k]}, t.area}});
  });
  if (c_.mesh.is_boundary(v)) line_ = {star_.front().a, star_.back().b};
}

double StarRelaxation::star_energy(const Complex& p) const {
  double sum = 0;
  for (const Spoke& s : star_) {
    if (!(cross(s.a - p, s.b - p) > 0)) return 1e300;
    sum += density_.of(s.t, p, s.a, s.b);
  }
  return sum;
}

template <class Density>
StarRelaxation::Quadratic StarRelaxation::expand(const Complex& p, const Density& density) const {
  Quadratic q;
  for (const Spoke& s : star_) {
    const Complex &x = s.t.alpha[0], &y = s.t.alpha[1], &z = s.t.alpha[2];
    const Complex a = x * p + y * s.a + z * s.b, b = std::conj(x) * p + std::conj(y) * s.a + std::conj(z) * s.b;
    const Distortion::Derivatives e = density(std::norm(a), std::norm(b));
    q.energy += s.t.area * e.value;
    const Complex g = 2 * e.s * a * std::conj(x) + 2 * e.t * b * x;
    q.gradient += s.t.area * Eigen::Vector2d(g.real(), g.imag());
    q.hessian += s.t.area * ProjectedHessian(e, a, b).along(x);
  }
  return q;
}

Complex StarRelaxation::newton_step(int v, Quadratic& q) const {
  if (c_.kind[v] == ChartMesh::Kind::SlideU) return {-q.gradient.x() / std::max(q.hessian(0, 0), 1e-300), 0};
  if (c_.kind[v] == ChartMesh::Kind::SlideV) return {0, -q.gradient.y() / std::max(q.hessian(1, 1), 1e-300)};
  const double trace = q.hessian.trace();
  if (!(q.hessian.determinant() > 1e-12 * trace * trace)) q.hessian += 1e-6 * trace * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d step = -q.hessian.inverse() * q.gradient;
  return {step.x(), step.y()};
}

void StarRelaxation::relax(int v, bool lengthen) {
  gather(v);
  const Complex p = c_.uv[v];
  Quadratic q = expand(p, density_);
  const Complex d = newton_step(v, q);
  if (!std::isfinite(d.real()) || !std::isfinite(d.imag())) return;
  double t = 1;
  for (int tries = 0; tries < 10; ++tries, t *= 0.5) {
    double least = star_energy(p + t * d);
    if (!(least < q.energy)) continue;
    Complex best = p + t * d;
    while (lengthen && t < 64) {
      t *= 2;
      const double further = star_energy(p + t * d);
      if (!(further < least)) break;
      least = further;
      best = p + t * d;
    }
    c_.uv[v] = best;
    return;
  }
}

void StarRelaxation::relax_folded(int v, double eps) {
  ++relaxed_folded_;
  gather(v);
  const FoldedDistortion density{eps};
  const Complex p = c_.uv[v];
  Quadratic q = expand(p, density);
  const Complex d = newton_step(v, q);
  if (!std::isfinite(d.real()) || !std::isfinite(d.imag())) return;
  double t = 1;
  if (c_.kind[v] != ChartMesh::Kind::Free) {
    // Never past the neighbours on its line: these keep their order.
    for (const Complex& end : line_)
      if (const double along = ((end - p) * std::conj(d)).real(); along > 0) t = std::min(t, 0.9 * along / std::norm(d));
  }
  for (int tries = 0; tries < 8; ++tries, t *= 0.5) {
    const Complex x = p + t * d;
    double energy = 0;
    for (const Spoke& s : star_) {
      const Complex a = s.t.alpha[0] * x + s.t.alpha[1] * s.a + s.t.alpha[2] * s.b;
      const Complex b = std::conj(s.t.alpha[0]) * x + std::conj(s.t.alpha[1]) * s.a + std::conj(s.t.alpha[2]) * s.b;
      energy += s.t.area * density.value(std::norm(a), std::norm(b));
    }
    if (energy < q.energy) {
      c_.uv[v] = x;
      return;
    }
  }
}

// On a straight boundary a vertex beyond its neighbours has a star of a full turn instead of half a one, without any folded triangle, and a corner of
// the boundary near it another angle.
bool StarRelaxation::is_wound(int v) const {
  switch (c_.kind[v]) {
    case ChartMesh::Kind::Cone:
      return false;
    case ChartMesh::Kind::SlideU:
    case ChartMesh::Kind::SlideV:
      return c_.angle_at(v) > (c_.mesh.is_boundary(v) ? 4 : 9);
    default:
      return c_.angle_at(v) > 9;
  }
}

bool StarRelaxation::is_unfolded(const std::vector<int>& vertices) const {
  for (const int v : vertices) {
    int h = c_.mesh.out[v];
    do {
      const Complex p = c_.at(h);
      if (!(cross(c_.at(EditMesh::next(h)) - p, c_.at(EditMesh::prev(h)) - p) > 0)) return false;
      h = c_.mesh.ccw(h);
    } while (h >= 0 && h != c_.mesh.out[v]);
    if (is_wound(v)) return false;
  }
  // The stars of the vertices around share their faces, and may have been wound up with them.
  std::vector<int> ring;
  for (const int v : vertices) {
    c_.mesh.ring(v, ring);
    for (const int w : ring)
      if (is_wound(w)) return false;
  }
  return true;
}

bool StarRelaxation::unfold(const std::vector<int>& vertices, int sweeps) {
  double eps = 0.3;
  const double shrink = std::pow(1.7e-5, 1.0 / sweeps);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    if (is_unfolded(vertices)) return true;
    for (const int v : vertices)
      if (c_.movable(v)) relax_folded(v, eps);
    eps *= shrink;
  }
  return is_unfolded(vertices);
}

void StarRelaxation::relax_squeezed(double least, int sweeps, const Progress& progress) {
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
      if (chosen[v] && c_.mesh.vertex_alive(v) && c_.movable(v)) relax(v, true);
    progress((sweep + 1.0) / sweeps);
  }
}

}  // namespace hybrid_mesh
