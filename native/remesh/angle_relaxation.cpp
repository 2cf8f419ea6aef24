// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Knupp, Algebraic mesh quality metrics for unstructured initial meshes, 2003 (corner shape metrics).
#include "remesh/angle_relaxation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace hybrid_mesh {
namespace {

class AngleRelaxation {
 public:
  AngleRelaxation(QuadMesh& mesh, const std::vector<char>& fixed, const AngleRelaxationOptions& options, CrossingGuard* guard)
      : mesh_(mesh), fixed_(fixed), options_(options), guard_(guard) {
    // The quads around every vertex.
    row_.assign(mesh.points.size() + 1, 0);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      if (is_quad(f))
        for (int i = 0; i < 4; ++i) ++row_[corner(f, i) + 1];
    for (std::size_t v = 0; v + 1 < row_.size(); ++v) row_[v + 1] += row_[v];
    faces_.resize(row_.back());
    std::vector<int> at(row_.begin(), row_.end() - 1);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      if (is_quad(f))
        for (int i = 0; i < 4; ++i) faces_[at[corner(f, i)]++] = static_cast<int>(f);
  }

  void run(const Progress& progress) {
    const int n = static_cast<int>(mesh_.points.size());
    for (int sweep = 0; sweep < options_.sweeps; ++sweep) {
      progress(static_cast<double>(sweep) / options_.sweeps);
      bool any = false;
      for (int k = 0; k < n; ++k) {
        const int v = sweep % 2 ? n - 1 - k : k;
        if (fixed_[v] || row_[v] == row_[v + 1] || !is_poor(v)) continue;
        any |= move(v);
      }
      if (!any) break;
    }
    progress(1);
  }

 private:
  bool is_quad(std::size_t f) const { return mesh_.offsets[f + 1] - mesh_.offsets[f] == 4; }
  int corner(std::size_t f, int i) const { return mesh_.indices[mesh_.offsets[f] + i]; }

  std::array<Vec3, 4> quad(int f) const {
    std::array<Vec3, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = mesh_.points[corner(f, i)];
    return p;
  }
  // Signed sines of a quad's corners.
  static std::array<double, 4> sines(const std::array<Vec3, 4>& p) {
    const Vec3 normal = (p[2] - p[0]).cross(p[3] - p[1]);
    std::array<Vec3, 4> edge;
    std::array<double, 4> length;
    for (int i = 0; i < 4; ++i) {
      edge[i] = p[(i + 1) % 4] - p[i];
      length[i] = edge[i].squaredNorm();
    }
    const double nn = normal.squaredNorm();
    std::array<double, 4> s;
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 3) % 4;
      const double l = std::sqrt(length[i] * length[j] * nn);
      s[i] = l > 0 ? -edge[i].cross(edge[j]).dot(normal) / l : 0.0;
    }
    return s;
  }
  bool is_poor(int v) const {
    for (int k = row_[v]; k < row_[v + 1]; ++k)
      for (const double s : sines(quad(faces_[k])))
        if (s < options_.enough) return true;
    return false;
  }
  // 1 / sine, continued past 0 by a steep but finite wall.
  static double cost(double s) { return 2 / (s + std::sqrt(s * s + 0.02)); }

  double energy(int v, const Vec3& at) const {
    double sum = 0;
    for (int k = row_[v]; k < row_[v + 1]; ++k) {
      const int f = faces_[k];
      std::array<Vec3, 4> p = quad(f);
      for (int i = 0; i < 4; ++i)
        if (corner(f, i) == v) p[i] = at;
      for (const double s : sines(p)) sum += cost(s);
    }
    return sum;
  }

  bool move(int v) {
    const Vec3 p = mesh_.points[v];
    Vec3 normal = Vec3::Zero();
    double shortest = 1e300;
    for (int k = row_[v]; k < row_[v + 1]; ++k) {
      const std::array<Vec3, 4> q = quad(faces_[k]);
      normal += (q[2] - q[0]).cross(q[3] - q[1]);
      for (int i = 0; i < 4; ++i)
        if (corner(faces_[k], i) == v) shortest = std::min({shortest, (q[(i + 1) % 4] - p).norm(), (q[(i + 3) % 4] - p).norm()});
    }
    const double l = normal.norm();
    if (!(l > 0) || !(shortest > 0)) return false;
    normal /= l;
    // Where the surface bends away within a quad's reach there is no plane to move in: tips and ridges stay as they were fitted.
    for (int k = row_[v]; k < row_[v + 1]; ++k) {
      const std::array<Vec3, 4> q = quad(faces_[k]);
      const Vec3 m = (q[2] - q[0]).cross(q[3] - q[1]);
      if (m.dot(normal) < options_.flatness * m.norm()) return false;
    }
    const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
    // Newton in the tangent plane, from differences.
    const double step = 0.05 * shortest, here = energy(v, p);
    const double xp = energy(v, p + step * x), xm = energy(v, p - step * x), yp = energy(v, p + step * y), ym = energy(v, p - step * y);
    const double xy = energy(v, p + step * (x + y));
    const double gx = (xp - xm) / 2, gy = (yp - ym) / 2;
    double hx = xp - 2 * here + xm, hy = yp - 2 * here + ym, h = xy - xp - yp + here;
    const double shift = std::max(0.0, std::hypot(0.5 * (hx - hy), h) - 0.5 * (hx + hy)) * 1.1 + 1e-9;
    hx += shift, hy += shift;
    const double determinant = hx * hy - h * h;
    if (!(determinant > 0)) return false;
    Vec3 d = step * (x * (-(hy * gx - h * gy) / determinant) + y * (-(hx * gy - h * gx) / determinant));
    const double reach = 0.5 * shortest;
    if (d.norm() > reach) d *= reach / d.norm();
    home_.insert({v, {p, options_.reach * shortest}});
    const auto& [start, allowed] = home_.at(v);
    for (double t = 1; t > 0.05; t *= 0.5)
      if ((p + t * d - start).norm() <= allowed && energy(v, p + t * d) < here - 1e-4 && (!guard_ || guard_->allows(v, p + t * d))) {
        mesh_.points[v] = p + t * d;
        if (guard_) guard_->moved(v);
        return true;
      }
    return false;
  }

  QuadMesh& mesh_;
  const std::vector<char>& fixed_;
  const AngleRelaxationOptions& options_;
  CrossingGuard* const guard_;
  std::vector<int> row_, faces_;
  std::unordered_map<int, std::pair<Vec3, double>> home_;  // per vertex that moved: where it was at the start, and how far it may go
};

}  // namespace

void relax_angles(QuadMesh& mesh, const std::vector<char>& fixed, const AngleRelaxationOptions& options, const Progress& progress,
                  CrossingGuard* guard) {
  AngleRelaxation(mesh, fixed, options, guard).run(progress);
}

}  // namespace hybrid_mesh
