// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Rabinovich, Poranne, Panozzo, Sorkine-Hornung, Scalable locally injective mappings, 2017 (barrier energies of the singular values);
// Shtengel, Poranne, Sorkine-Hornung, Kovalsky, Lipman, Geometric optimization via composite majorization, 2017 (analytic projection of the Hessian).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

using Complex = std::complex<double>;

// A triangle's flat shape: the linear map p -> (f_z, f_zbar) = (sum alpha_c p_c, sum conj(alpha_c) p_c) of complex corner positions p_c, and its area.
struct FlatTriangle {
  std::array<Complex, 3> alpha;
  double area = 0;
};

// Lays a triangle of the surface flat, scaled by `scale`. Heights of slivers are floored at 2 % of their longest side: their exact shape does not matter for the map's quality,
// but an unbounded gradient would.
inline FlatTriangle flatten(const Vec3& a, const Vec3& b, const Vec3& c, double scale) {
  const std::array<Vec3, 3> p{a, b, c};
  std::array<double, 3> length;
  for (int i = 0; i < 3; ++i) length[i] = (p[(i + 1) % 3] - p[i]).norm() * scale;
  int i = 0;
  if (length[1] > length[i]) i = 1;
  if (length[2] > length[i]) i = 2;
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const double l = std::max(length[i], 1e-12);
  const Vec3 base = p[j] - p[i], side = p[k] - p[i];
  const double x = side.dot(base) * scale * scale / l;
  const double y = std::max(side.cross(base).norm() * scale * scale / l, 0.02 * l);
  FlatTriangle t;
  t.area = 0.5 * l * y;
  // Gradients of the barycentric coordinates of (0, 0), (l, 0), (x, y).
  const double d = 1 / (l * y);
  const Complex gi(-y * d, (x - l) * d), gj(y * d, -x * d), gk(0, l * d);
  t.alpha[i] = 0.5 * std::conj(gi);
  t.alpha[j] = 0.5 * std::conj(gj);
  t.alpha[k] = 0.5 * std::conj(gk);
  return t;
}

// An energy density of the singular values with a barrier at folding: (1 - theta) times the mean of their ratio and its inverse, plus theta times the mean of the area's ratio and
// its inverse. Least (1) for isometries. theta in [0, 1]: small for right angles, large for even size.
struct Distortion {
  double theta = 0.05;

  struct Derivatives {
    double value, s, t, ss, st, tt;
  };
  // s = |f_z|^2, t = |f_zbar|^2, s > t.
  double value(double s, double t) const {
    const double d = s - t;
    return (1 - theta) * (s + t) / d + theta * 0.5 * (d + 1 / d);
  }
  Derivatives operator()(double s, double t) const {
    const double d = s - t, i = 1 / d, i2 = i * i, i3 = i2 * i, m = 1 - theta;
    const double g = 0.5 * theta * (1 - i2), gg = theta * i3;
    return {m * (s + t) * i + 0.5 * theta * (d + i), -2 * m * t * i2 + g, 2 * m * s * i2 - g, 4 * m * t * i3 + gg, -2 * m * (s + t) * i3 - gg, 4 * m * s * i3 + gg};
  }
};

// The Hessian of a density with respect to (f_z, f_zbar) as four reals, its negative eigenvalues removed.
inline Eigen::Matrix4d projected_hessian(const Distortion::Derivatives& e, const Complex& a, const Complex& b) {
  const double s = std::norm(a), t = std::norm(b), ra = std::sqrt(s), rb = std::sqrt(t);
  const Eigen::Vector2d ua = ra > 0 ? Eigen::Vector2d(a.real() / ra, a.imag() / ra) : Eigen::Vector2d(1, 0);
  const Eigen::Vector2d ub = rb > 0 ? Eigen::Vector2d(b.real() / rb, b.imag() / rb) : Eigen::Vector2d(1, 0);
  Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
  const Eigen::Vector2d ta(-ua.y(), ua.x()), tb(-ub.y(), ub.x());
  h.topLeftCorner<2, 2>() += std::max(0.0, 2 * e.s) * ta * ta.transpose();
  h.bottomRightCorner<2, 2>() += std::max(0.0, 2 * e.t) * tb * tb.transpose();
  const double p = 2 * e.s + 4 * s * e.ss, q = 4 * ra * rb * e.st, r = 2 * e.t + 4 * t * e.tt;
  const double mean = 0.5 * (p + r), spread = std::hypot(0.5 * (p - r), q);
  for (const double sign : {-1.0, 1.0}) {
    const double lambda = mean + sign * spread;
    if (lambda <= 0) continue;
    Eigen::Vector2d v = std::abs(q) > 0 ? Eigen::Vector2d(q, lambda - p) : ((p >= r) == (sign > 0) ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(0, 1));
    const double n = v.norm();
    if (!(n > 0)) continue;
    v /= n;
    Eigen::Vector4d w;
    w << v.x() * ua, v.y() * ub;
    h += lambda * w * w.transpose();
  }
  return h;
}

}  // namespace hybrid_mesh
