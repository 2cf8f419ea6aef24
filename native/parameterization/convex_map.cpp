// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Tutte, How to draw a graph, 1963; Floater, Mean value coordinates, 2003 (the weights, here made symmetric); Yoshizawa, Belyaev, Seidel, A
// fast and simple stretch-minimizing mesh parameterization, 2004 (weights by stretch).
#include "parameterization/convex_map.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace hybrid_mesh {

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

// The disk while it is mapped: rows are its points, those of the polygon's sides first.
class ConvexMap::Embedding {
 public:
  enum class Weights { MeanValue, SquareRoot, Uniform };

  Embedding(ConvexMap& of, const std::vector<int>& faces, const std::vector<DiskSide>& sides, const std::vector<Vec2>& polygon)
      : mesh_(of.mesh_), index_(of.index_), faces_(faces) {
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const std::vector<double> fractions = sides[i].fractions.empty() ? of.arc_fractions(sides[i].points) : sides[i].fractions;
      const Vec2 begin = polygon[i], along = polygon[(i + 1) % polygon.size()] - begin;
      add(sides[i].points[0], begin);
      for (std::size_t k = 1; k + 1 < sides[i].points.size(); ++k) add(sides[i].points[k], begin + fractions[k] * along);
    }
    rim_ = static_cast<int>(points_.size());
    for (const int f : faces)
      for (const int v : mesh_.faces[f])
        if (index_[v] < 0) add(v, Vec2(0.5, 0.5));
  }
  ~Embedding() {
    for (const int v : points_) index_[v] = -1;
  }

  // w_ij = sum over the ends a of tan(half the angles at a beside the edge) * mean edge length at a / |ij|.
  void weigh(Weights kind) {
    std::vector<double> mean(points_.size(), 0), count(points_.size(), 0);
    for (const int f : faces_)
      for (int k = 0; k < 3; ++k) {
        const int i = row(f, k), j = row(f, k + 1);
        const double l = (place(i) - place(j)).norm();
        mean[i] += l, mean[j] += l, count[i] += 1, count[j] += 1;
      }
    edges_.clear();
    for (const int f : faces_)
      for (int k = 0; k < 3; ++k) {
        const int i = row(f, k), j = row(f, k + 1), c = row(f, k + 2);
        double w = 1;
        if (kind != Weights::Uniform) {
          const Vec3 ij = place(j) - place(i);
          const double l = std::max(ij.norm(), 1e-12);
          const auto half_tangent = [&](const Vec3& x, const Vec3& y) {
            return std::tan(0.5 * std::min(std::atan2(x.cross(y).norm(), x.dot(y)), 3.1));
          };
          w = (half_tangent(ij, place(c) - place(i)) * mean[i] / count[i] + half_tangent(-ij, place(c) - place(j)) * mean[j] / count[j]) / l;
          w = std::clamp(w, 1e-6, 1e6);
          if (kind == Weights::SquareRoot) w = std::sqrt(w);
        }
        edges_.push_back({i, j, w});
      }
  }

  // Weaker springs where the map is squeezed: what lies farther out pulls it open. All weights stay positive.
  void open_squeezed() {
    std::vector<double> stretch(points_.size(), 0), count(points_.size(), 0);
    for (const int f : faces_) {
      const double area = (place(row(f, 1)) - place(row(f, 0))).cross(place(row(f, 2)) - place(row(f, 0))).norm();
      const double log_stretch = 0.5 * (std::log(std::max(area, 1e-30)) - std::log(std::max(determinant(f), 1e-290)));
      for (int k = 0; k < 3; ++k) stretch[row(f, k)] += log_stretch, count[row(f, k)] += 1;
    }
    for (Edge& e : edges_) e.weight = std::clamp(e.weight * std::exp(-0.5 * (stretch[e.i] / count[e.i] + stretch[e.j] / count[e.j])), 1e-250, 1e250);
  }

  void solve() {
    const int inner = static_cast<int>(points_.size()) - rim_;
    if (inner == 0) return;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(inner, 2);
    for (const Edge& e : edges_)
      for (const auto& [i, j] : {std::pair(e.i, e.j), std::pair(e.j, e.i)}) {
        if (i < rim_) continue;
        entries.push_back({i - rim_, i - rim_, e.weight});
        if (j < rim_)
          right.row(i - rim_) += e.weight * uv_[j].transpose();
        else
          entries.push_back({i - rim_, j - rim_, -e.weight});
      }
    Eigen::SparseMatrix<double> matrix(inner, inner);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    if (solver.info() != Eigen::Success) return;
    const Eigen::MatrixX2d solution = solver.solve(right);
    for (int i = 0; i < inner; ++i) uv_[rim_ + i] = solution.row(i).transpose();
  }

  // Are all triangles counter-clockwise, and not so thin that it would be by chance?
  bool is_good() const {
    return std::all_of(faces_.begin(), faces_.end(), [&](int f) { return determinant(f) > 1e-26; });
  }

  void write(std::vector<std::array<Vec2, 3>>& corners) const {
    for (const int f : faces_)
      for (int k = 0; k < 3; ++k) corners[f][k] = uv_[row(f, k)];
  }

 private:
  struct Edge {
    int i, j;
    double weight;
  };
  void add(int v, const Vec2& at) {
    index_[v] = static_cast<int>(points_.size());
    points_.push_back(v);
    uv_.push_back(at);
  }
  int row(int f, int corner) const { return index_[mesh_.faces[f][corner % 3]]; }
  const Vec3& place(int row) const { return mesh_.points[points_[row]]; }
  double determinant(int f) const {
    const Vec2 a = uv_[row(f, 1)] - uv_[row(f, 0)], b = uv_[row(f, 2)] - uv_[row(f, 0)];
    return a.x() * b.y() - a.y() * b.x();
  }

  const TriangleSurface& mesh_;
  std::vector<int>& index_;
  const std::vector<int>& faces_;
  std::vector<int> points_;
  std::vector<Vec2> uv_;
  std::vector<Edge> edges_;
  int rim_ = 0;
};

bool ConvexMap::operator()(const std::vector<int>& faces, const std::vector<DiskSide>& sides, const std::vector<Vec2>& polygon,
                           std::vector<std::array<Vec2, 3>>& corners) {
  index_.resize(mesh_.points.size(), -1);
  Embedding embedding(*this, faces, sides, polygon);
  using Weights = Embedding::Weights;
  bool good = false;
  // What the last resort begins with stands last.
  for (const Weights kind : {Weights::MeanValue, Weights::SquareRoot, Weights::Uniform, Weights::MeanValue}) {
    if (good) break;
    embedding.weigh(kind);
    embedding.solve();
    good = embedding.is_good();
  }
  // A long finger between two parts of one side is squeezed by a factor a row of triangles, more than doubles can tell apart.
  for (int turn = 0; turn < 16 && !good; ++turn) {
    embedding.open_squeezed();
    embedding.solve();
    good = embedding.is_good();
  }
  if (good) embedding.write(corners);
  return good;
}

}  // namespace hybrid_mesh
