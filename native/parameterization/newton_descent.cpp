// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Rabinovich, Poranne, Panozzo, Sorkine-Hornung, Scalable locally injective mappings, 2017; Smith, Schaefer, Bijective parameterization
// with free boundaries, 2015 (the exact step limit).
#include "parameterization/newton_descent.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace hybrid_mesh {
namespace {

double cross(const Complex& a, const Complex& b) { return a.real() * b.imag() - a.imag() * b.real(); }

}  // namespace

int newton_descent(ChartMesh& charts, const Distortion& density, int steps, const Progress& progress) {
  const StarRelaxation stars(charts, density);
  int taken = 0;
  const std::vector<int> vertices = charts.movable_vertices();
  std::vector<int> unknown(2 * charts.points.size(), -1);
  int n = 0;
  for (const int v : vertices) {
    if (charts.kind[v] != ChartMesh::Kind::SlideV) unknown[2 * v] = n++;
    if (charts.kind[v] != ChartMesh::Kind::SlideU) unknown[2 * v + 1] = n++;
  }
  if (n == 0) return taken;
  std::vector<int> faces;
  std::vector<FlatTriangle> flat;
  for (int f = 0; f < static_cast<int>(charts.mesh.alive.size()); ++f)
    if (charts.mesh.alive[f]) {
      faces.push_back(f);
      flat.push_back(charts.flat(f));
    }
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver;
  bool analyzed = false;
  std::vector<Eigen::Triplet<double>> entries;
  const auto energy_now = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < faces.size(); ++i)
      sum += stars.triangle_energy(flat[i], charts.at(3 * faces[i]), charts.at(3 * faces[i] + 1), charts.at(3 * faces[i] + 2));
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
        const int h = 3 * f + k, v = charts.mesh.origin[h];
        const Complex z = charts.at(h), x = charts.corner[h].rotate(t.alpha[k]), y = charts.corner[h].rotate(std::conj(t.alpha[k]));
        a += t.alpha[k] * z;
        b += std::conj(t.alpha[k]) * z;
        j.block<4, 2>(0, 2 * k) << x.real(), -x.imag(), x.imag(), x.real(), y.real(), -y.imag(), y.imag(), y.real();
        at[2 * k] = unknown[2 * v];
        at[2 * k + 1] = unknown[2 * v + 1];
      }
      const Distortion::Derivatives e = density(std::norm(a), std::norm(b));
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
    if (solver.info() != Eigen::Success) return taken;
    const Eigen::VectorXd direction = -solver.solve(gradient);
    const double slope = direction.dot(gradient);
    if (!(slope < 0)) return taken;
    const auto direction_at = [&](int h) {
      const int v = charts.mesh.origin[h];
      const int x = unknown[2 * v], y = unknown[2 * v + 1];
      return charts.corner[h].rotate(Complex(x >= 0 ? direction[x] : 0.0, y >= 0 ? direction[y] : 0.0));
    };
    // The largest step before a triangle's area, a quadratic in the step, vanishes.
    double limit = 1e300;
    for (const int f : faces) {
      const Complex p = charts.at(3 * f), e1 = charts.at(3 * f + 1) - p, e2 = charts.at(3 * f + 2) - p;
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
    const std::vector<Complex> start = charts.uv;
    bool accepted = false;
    double fresh = energy;
    for (int tries = 0; tries < 25; ++tries, t *= 0.5) {
      for (const int v : vertices) {
        const int x = unknown[2 * v], y = unknown[2 * v + 1];
        charts.uv[v] = start[v] + t * Complex(x >= 0 ? direction[x] : 0.0, y >= 0 ? direction[y] : 0.0);
      }
      fresh = energy_now();
      if (fresh <= energy + 1e-4 * t * slope && std::isfinite(fresh)) {
        bool unfolded = true;
        for (const int f : faces) {
          const Complex p = charts.at(3 * f);
          if (!(cross(charts.at(3 * f + 1) - p, charts.at(3 * f + 2) - p) > 0)) unfolded = false;
        }
        if (unfolded) {
          accepted = true;
          break;
        }
      }
    }
    if (!accepted) {
      charts.uv = start;
      return taken;
    }
    taken = step + 1;
    if (energy - fresh < 1e-5 * energy) return taken;
  }
  return taken;
}

}  // namespace hybrid_mesh
