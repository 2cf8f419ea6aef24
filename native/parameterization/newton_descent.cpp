// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Rabinovich, Poranne, Panozzo, Sorkine-Hornung, Scalable locally injective mappings, 2017; Smith, Schaefer, Bijective parameterization
// with free boundaries, 2015 (the exact step limit).
#include "parameterization/newton_descent.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "parameterization/element_cholesky.h"

namespace hybrid_mesh {
namespace {

double cross(const Complex& a, const Complex& b) { return a.real() * b.imag() - a.imag() * b.real(); }

// The smallest positive step t at which c0 + c1 t + c2 t^2 vanishes, infinite if there is none.
double first_root(double c0, double c1, double c2) {
  double first = std::numeric_limits<double>::infinity();
  const double discriminant = c1 * c1 - 4 * c2 * c0;
  if (discriminant < 0) return first;
  // Without cancellation.
  const double root = std::sqrt(discriminant), q = -0.5 * (c1 + (c1 < 0 ? -root : root));
  for (const double r : {c2 != 0 ? q / c2 : -1.0, q != 0 ? c0 / q : -1.0})
    if (r > 0) first = std::min(first, r);
  return first;
}

class NewtonDescent {
 public:
  NewtonDescent(ChartMesh& charts, const Distortion& density, const NewtonOptions& options)
      : c_(charts), density_(density), options_(options), vertices_(charts.movable_vertices()), unknown_(2 * charts.points.size(), -1) {
    for (const int v : vertices_) {
      if (c_.kind[v] != ChartMesh::Kind::SlideV) unknown_[2 * v] = unknowns_++;
      if (c_.kind[v] != ChartMesh::Kind::SlideU) unknown_[2 * v + 1] = unknowns_++;
    }
    for (int f = 0; f < static_cast<int>(c_.mesh.alive.size()); ++f)
      if (c_.mesh.alive[f]) {
        faces_.push_back(f);
        flat_.push_back(c_.flat(f));
        ElementCholesky::Element& at = elements_.emplace_back();
        for (int k = 0; k < 6; ++k) at[k] = unknown_[2 * c_.mesh.origin[3 * f + k / 2] + k % 2];
      }
  }

  int run(const Progress& progress) {
    if (unknowns_ == 0) return 0;
    ElementCholesky solver(elements_, unknowns_);
    hessians_.resize(faces_.size());
    for (int step = 0; step < options_.steps; ++step) {
      progress(static_cast<double>(step) / options_.steps);
      const double energy = expand();
      progress.check();
      if (!factorize(solver)) return step;
      const Eigen::VectorXd direction = -solver.solve(gradient_);
      const double slope = direction.dot(gradient_);
      if (!(slope < 0)) return step;
      const double fresh = descend(direction, slope, energy);
      if (!(fresh < energy)) return step;
      if (energy - fresh < options_.converged * energy) return step + 1;
    }
    return options_.steps;
  }

 private:
  // The energy, its gradient, and its Hessian triangle by triangle.
  double expand() {
    gradient_.setZero(unknowns_);
    double energy = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const FlatTriangle& t = flat_[i];
      Complex a(0, 0), b(0, 0);
      Eigen::Matrix<double, 4, 6> j;
      for (int k = 0; k < 3; ++k) {
        const int h = 3 * faces_[i] + k;
        const Complex z = c_.at(h), x = c_.corner[h].rotate(t.alpha[k]), y = c_.corner[h].rotate(std::conj(t.alpha[k]));
        a += t.alpha[k] * z;
        b += std::conj(t.alpha[k]) * z;
        j.block<4, 2>(0, 2 * k) << x.real(), -x.imag(), x.imag(), x.real(), y.real(), -y.imag(), y.imag(), y.real();
      }
      const Distortion::Derivatives e = density_(std::norm(a), std::norm(b));
      energy += t.area * e.value;
      Eigen::Vector4d g4;
      g4 << 2 * e.s * a.real(), 2 * e.s * a.imag(), 2 * e.t * b.real(), 2 * e.t * b.imag();
      const Eigen::Matrix<double, 6, 1> g = t.area * (j.transpose() * g4);
      for (int p = 0; p < 6; ++p)
        if (elements_[i][p] >= 0) gradient_[elements_[i][p]] += g[p];
      hessians_[i] = t.area * (j.transpose() * ProjectedHessian(e, a, b).matrix() * j);
      hessians_[i].diagonal().array() += options_.ridge * t.area;
    }
    return energy;
  }

  bool factorize(ElementCholesky& solver) {
    double damping = options_.damping;
    for (int tries = 0; !solver.factorize(hessians_); ++tries, damping *= options_.damping_growth) {
      if (tries == options_.dampings) return false;
      for (ElementCholesky::Matrix& h : hessians_) h.diagonal() *= 1 + damping;
    }
    return true;
  }

  Complex along(const Eigen::VectorXd& direction, int v) const {
    const int x = unknown_[2 * v], y = unknown_[2 * v + 1];
    return {x >= 0 ? direction[x] : 0.0, y >= 0 ? direction[y] : 0.0};
  }

  // The largest step before a triangle's area, a quadratic in the step, vanishes.
  double largest_step(const Eigen::VectorXd& direction) const {
    double limit = std::numeric_limits<double>::infinity();
    for (const int f : faces_) {
      std::array<Complex, 3> d;
      for (int k = 0; k < 3; ++k) d[k] = c_.corner[3 * f + k].rotate(along(direction, c_.mesh.origin[3 * f + k]));
      const Complex p = c_.at(3 * f), e1 = c_.at(3 * f + 1) - p, e2 = c_.at(3 * f + 2) - p, d1 = d[1] - d[0], d2 = d[2] - d[0];
      limit = std::min(limit, first_root(cross(e1, e2), cross(e1, d2) + cross(d1, e2), cross(d1, d2)));
    }
    return limit;
  }

  // Infinite where a triangle is folded.
  double energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const Complex p = c_.at(3 * faces_[i]), q = c_.at(3 * faces_[i] + 1), r = c_.at(3 * faces_[i] + 2);
      if (!(cross(q - p, r - p) > 0)) return std::numeric_limits<double>::infinity();
      sum += density_.of(flat_[i], p, q, r);
    }
    return sum;
  }

  // Backtracking line search. Returns the energy, which is not less than it was where there is no step to take; then nothing has moved.
  double descend(const Eigen::VectorXd& direction, double slope, double energy_before) {
    const std::vector<Complex> start = c_.uv;
    double t = std::min(1.0, options_.to_boundary * largest_step(direction));
    for (int tries = 0; tries < options_.halvings; ++tries, t *= 0.5) {
      for (const int v : vertices_) c_.uv[v] = start[v] + t * along(direction, v);
      const double fresh = energy();
      if (fresh <= energy_before + options_.sufficient * t * slope && std::isfinite(fresh)) return fresh;
    }
    c_.uv = start;
    return energy_before;
  }

  ChartMesh& c_;
  const Distortion& density_;
  const NewtonOptions& options_;
  std::vector<int> vertices_, unknown_;  // those that move; two a vertex, -1: held
  int unknowns_ = 0;
  std::vector<int> faces_;
  std::vector<FlatTriangle> flat_;  // by face, as what follows
  std::vector<ElementCholesky::Element> elements_;
  std::vector<ElementCholesky::Matrix> hessians_;
  Eigen::VectorXd gradient_;
};

}  // namespace

int newton_descent(ChartMesh& charts, const Distortion& density, const NewtonOptions& options, const Progress& progress) {
  return NewtonDescent(charts, density, options).run(progress);
}

}  // namespace hybrid_mesh
