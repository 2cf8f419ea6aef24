// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Tutte, How to draw a graph, 1963; Floater, Mean value coordinates, 2003 (the weights, here made symmetric).
#include "parameterization/convex_map.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace hybrid_mesh {

bool ConvexMap::operator()(const std::vector<int>& faces, const std::vector<DiskSide>& sides, const std::vector<Vec2>& polygon, std::vector<std::array<Vec2, 3>>& corners) {
  index_.resize(mesh_.points.size(), -1);
  for (const Weights kind : {Weights::MeanValue, Weights::SquareRoot, Weights::Uniform})
    if (embed(faces, sides, polygon, kind, corners)) return true;
  return false;
}

std::vector<int> ConvexMap::side_chords(const std::vector<int>& faces, const std::vector<DiskSide>& sides) {
  on_sides_.resize(mesh_.points.size(), 0);
  in_disk_.resize(mesh_.faces.size(), 0);
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (const int v : sides[i].points) on_sides_[v] |= std::uint64_t{1} << (i % 64);
  for (const int f : faces) in_disk_[f] = 1;
  std::vector<int> chords;
  for (const int f : faces)
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      const int o = mesh_.opposite[h];
      if (o < h || in_disk_[f] != 1 || in_disk_[o / 3] != 1) continue;
      const int a = mesh_.from(h), b = mesh_.to(h);
      if (!(on_sides_[a] & on_sides_[b])) continue;
      // An edge of the side itself, met from both of its sides in a patch that borders itself, is no chord.
      bool along = false;
      for (const DiskSide& side : sides)
        for (std::size_t k = 1; k < side.points.size(); ++k) along |= std::minmax(side.points[k - 1], side.points[k]) == std::minmax(a, b);
      if (along) continue;
      in_disk_[f] = in_disk_[o / 3] = 2;  // taken
      chords.push_back(h);
    }
  for (const int f : faces) in_disk_[f] = 0;
  for (const DiskSide& side : sides)
    for (const int v : side.points) on_sides_[v] = 0;
  return chords;
}

std::vector<double> ConvexMap::arc_fractions(const std::vector<int>& side) const {
  std::vector<double> length{0};
  for (std::size_t k = 1; k < side.size(); ++k) length.push_back((mesh_.points[side[k]] - mesh_.points[side[k - 1]]).norm());
  double total = 0, sum = 0;
  for (const double l : length) total += l;
  // A floor keeps neighbouring points of a side apart in doubles.
  const double floor = 0.01 / side.size();
  for (std::size_t k = 1; k < side.size(); ++k) sum += length[k] = std::max(total > 0 ? length[k] / total : 0.0, floor);
  double at = 0;
  for (double& l : length) l = at += l / sum;
  return length;
}

bool ConvexMap::embed(const std::vector<int>& faces, const std::vector<DiskSide>& sides, const std::vector<Vec2>& polygon, Weights kind,
                      std::vector<std::array<Vec2, 3>>& corners) {
  std::vector<int> points;
  std::vector<Vec2> uv;
  const auto add = [&](int v, const Vec2& at) {
    index_[v] = static_cast<int>(points.size());
    points.push_back(v);
    uv.push_back(at);
  };
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const std::vector<double> fractions = sides[i].fractions.empty() ? arc_fractions(sides[i].points) : sides[i].fractions;
    const Vec2 begin = polygon[i], along = polygon[(i + 1) % polygon.size()] - begin;
    add(sides[i].points[0], begin);
    for (std::size_t k = 1; k + 1 < sides[i].points.size(); ++k) add(sides[i].points[k], begin + fractions[k] * along);
  }
  const int rim = static_cast<int>(points.size());
  for (const int f : faces)
    for (const int v : mesh_.faces[f])
      if (index_[v] < 0) add(v, Vec2(0.5, 0.5));
  const int inner = static_cast<int>(points.size()) - rim;
  if (inner > 0) {
    // w_ij = sum over the ends a of tan(half the angles at a beside the edge) * mean edge length at a / |ij|.
    std::vector<double> mean(points.size(), 0), count(points.size(), 0);
    struct Edge {
      int i, j;
      double w;
    };
    std::vector<Edge> edges;
    for (const int f : faces)
      for (int k = 0; k < 3; ++k) {
        const int i = index_[mesh_.faces[f][k]], j = index_[mesh_.faces[f][(k + 1) % 3]];
        const double l = (mesh_.points[points[i]] - mesh_.points[points[j]]).norm();
        mean[i] += l, mean[j] += l, count[i] += 1, count[j] += 1;
      }
    for (const int f : faces)
      for (int k = 0; k < 3; ++k) {
        const int i = index_[mesh_.faces[f][k]], j = index_[mesh_.faces[f][(k + 1) % 3]], c = index_[mesh_.faces[f][(k + 2) % 3]];
        double w = 1;
        if (kind != Weights::Uniform) {
          const Vec3 ij = mesh_.points[points[j]] - mesh_.points[points[i]];
          const double l = std::max(ij.norm(), 1e-12);
          const auto half_tangent = [&](const Vec3& x, const Vec3& y) { return std::tan(0.5 * std::min(std::atan2(x.cross(y).norm(), x.dot(y)), 3.1)); };
          const Vec3 ic = mesh_.points[points[c]] - mesh_.points[points[i]], jc = mesh_.points[points[c]] - mesh_.points[points[j]];
          w = (half_tangent(ij, ic) * mean[i] / count[i] + half_tangent(-ij, jc) * mean[j] / count[j]) / l;
          w = std::clamp(w, 1e-6, 1e6);
          if (kind == Weights::SquareRoot) w = std::sqrt(w);
        }
        edges.push_back({i, j, w});
      }
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(inner, 2);
    for (const Edge& e : edges)
      for (const auto& [i, j] : {std::pair(e.i, e.j), std::pair(e.j, e.i)}) {
        if (i < rim) continue;
        entries.push_back({i - rim, i - rim, e.w});
        if (j < rim)
          right.row(i - rim) += e.w * uv[j].transpose();
        else
          entries.push_back({i - rim, j - rim, -e.w});
      }
    Eigen::SparseMatrix<double> matrix(inner, inner);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    if (solver.info() == Eigen::Success) {
      const Eigen::MatrixX2d solution = solver.solve(right);
      for (int i = 0; i < inner; ++i) uv[rim + i] = solution.row(i).transpose();
    }
  }
  bool good = true;
  for (const int f : faces) {
    for (int k = 0; k < 3; ++k) corners[f][k] = uv[index_[mesh_.faces[f][k]]];
    const Vec2 a = corners[f][1] - corners[f][0], b = corners[f][2] - corners[f][0];
    if (!(a.x() * b.y() - a.y() * b.x() > 1e-26)) good = false;
  }
  for (const int v : points) index_[v] = -1;
  return good;
}

}  // namespace hybrid_mesh
