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

// A triangle's flat shape: the linear map p -> (f_z, f_zbar) = (sum alpha_c p_c, sum conj(alpha_c) p_c) of complex corner positions p_c, and its
// area.
struct FlatTriangle {
  std::array<Complex, 3> alpha;
  double area = 0;
};

// Lays a triangle of the surface flat, scaled by `scale`. Heights of slivers are floored at 2 % of their longest side: their exact shape does not
// matter for the map's quality, but an unbounded gradient would.
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

// An energy density of the singular values with a barrier at folding: (1 - theta) times the mean of their ratio and its inverse, plus theta times the
// mean of the area's ratio and its inverse. Least (1) for isometries. theta in [0, 1]: small for right angles, large for even size.
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
  // Of a triangle whose corners are mapped there, times its area.
  double of(const FlatTriangle& t, const Complex& p0, const Complex& p1, const Complex& p2) const {
    const Complex a = t.alpha[0] * p0 + t.alpha[1] * p1 + t.alpha[2] * p2;
    const Complex b = std::conj(t.alpha[0]) * p0 + std::conj(t.alpha[1]) * p1 + std::conj(t.alpha[2]) * p2;
    return t.area * value(std::norm(a), std::norm(b));
  }
  Derivatives operator()(double s, double t) const {
    const double d = s - t, i = 1 / d, i2 = i * i, i3 = i2 * i, m = 1 - theta;
    const double g = 0.5 * theta * (1 - i2), gg = theta * i3;
    return {m * (s + t) * i + 0.5 * theta * (d + i),
            -2 * m * t * i2 + g,
            2 * m * s * i2 - g,
            4 * m * t * i3 + gg,
            -2 * m * (s + t) * i3 - gg,
            4 * m * s * i3 + gg};
  }
};

// The Hessian of a density with respect to (f_z, f_zbar) = (a, b): 2 Psi_s and 2 Psi_t across a and b, and a block in the plane of their directions.
// Its negative eigenvalues are removed.
struct ProjectedHessian {
  Complex ua{1, 0}, ub{1, 0};  // directions of a and b
  double across_a, across_b, aa, ab, bb;

  ProjectedHessian(const Distortion::Derivatives& e, const Complex& a, const Complex& b) {
    const double s = std::norm(a), t = std::norm(b), ra = std::sqrt(s), rb = std::sqrt(t);
    if (ra > 0) ua = a / ra;
    if (rb > 0) ub = b / rb;
    across_a = std::max(0.0, 2 * e.s);
    across_b = std::max(0.0, 2 * e.t);
    const double p = 2 * e.s + 4 * s * e.ss, q = 4 * ra * rb * e.st, r = 2 * e.t + 4 * t * e.tt;
    const double mean = 0.5 * (p + r), spread = std::hypot(0.5 * (p - r), q);
    if (mean - spread >= 0) {
      aa = p, ab = q, bb = r;
    } else if (mean + spread <= 0) {
      aa = ab = bb = 0;
    } else {
      // The positive eigenvalue's part: with M the block and l the other eigenvalue, (M - l) scaled.
      const double scale = (mean + spread) / (2 * spread);
      const double low = mean - spread;
      aa = scale * (p - low), ab = scale * q, bb = scale * (r - low);
    }
  }

  // As a matrix of four reals.
  Eigen::Matrix4d matrix() const {
    const Eigen::Vector2d va(ua.real(), ua.imag()), vb(ub.real(), ub.imag()), na(-va.y(), va.x()), nb(-vb.y(), vb.x());
    Eigen::Matrix4d h;
    h.topLeftCorner<2, 2>() = across_a * na * na.transpose() + aa * va * va.transpose();
    h.topRightCorner<2, 2>() = ab * va * vb.transpose();
    h.bottomLeftCorner<2, 2>() = h.topRightCorner<2, 2>().transpose();
    h.bottomRightCorner<2, 2>() = across_b * nb * nb.transpose() + bb * vb * vb.transpose();
    return h;
  }

  // With respect to z where a changes by x z and b by conj(x) z.
  Eigen::Matrix2d along(const Complex& x) const {
    const Complex p = std::conj(x) * ua, q = x * ub;
    const Eigen::Vector2d v(p.real(), p.imag()), w(q.real(), q.imag());
    const double xx = across_a * v.y() * v.y() + across_b * w.y() * w.y() + aa * v.x() * v.x() + 2 * ab * v.x() * w.x() + bb * w.x() * w.x();
    const double yy = across_a * v.x() * v.x() + across_b * w.x() * w.x() + aa * v.y() * v.y() + 2 * ab * v.y() * w.y() + bb * w.y() * w.y();
    const double xy =
        -across_a * v.x() * v.y() - across_b * w.x() * w.y() + aa * v.x() * v.y() + ab * (v.x() * w.y() + v.y() * w.x()) + bb * w.x() * w.y();
    Eigen::Matrix2d h;
    h << xx, xy, xy, yy;
    return h;
  }
};

}  // namespace hybrid_mesh
