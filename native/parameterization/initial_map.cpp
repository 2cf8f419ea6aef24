// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Tutte, How to draw a graph, 1963; Floater, Mean value coordinates, 2003 (the weights, here made symmetric).
#include "parameterization/initial_map.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <string>

namespace hybrid_mesh {
namespace {

// Which sides of the patch at hand a point lies on, as bits; stamped so that nothing is cleared between patches.
class SideBits {
 public:
  explicit SideBits(const PatchedSurface& surface) : surface_(surface), stamp_(surface.mesh.points.size(), -1), bits_(surface.mesh.points.size(), 0) {}
  void select(int patch) {
    if (stamp_.size() < surface_.mesh.points.size()) {
      stamp_.resize(surface_.mesh.points.size(), -1);
      bits_.resize(surface_.mesh.points.size(), 0);
    }
    current_ = patch;
    for (int i = 0; i < 4; ++i)
      for (const int v : surface_.sides[patch][i]) {
        if (stamp_[v] != patch) stamp_[v] = patch, bits_[v] = 0;
        bits_[v] |= 1 << i;
      }
  }
  int operator()(int v) const { return stamp_[v] == current_ ? bits_[v] : 0; }

 private:
  const PatchedSurface& surface_;
  std::vector<int> stamp_, bits_;
  int current_ = -1;
};

std::vector<std::vector<int>> faces_of_patches(const PatchedSurface& surface) {
  std::vector<std::vector<int>> faces(surface.patch_count());
  for (int f = 0; f < static_cast<int>(surface.patch.size()); ++f) faces[surface.patch[f]].push_back(f);
  return faces;
}

void split_edge(PatchedSurface& surface, int h) {
  TriangleSurface& mesh = surface.mesh;
  const int a = mesh.from(h), b = mesh.to(h), m = static_cast<int>(mesh.points.size());
  mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
  surface.source.push_back(middle_of(surface.source[a], surface.source[b]));
  for (const int g : {h, mesh.opposite[h]}) {
    const int f = g / 3, i = g % 3;
    std::array<int, 3> second = mesh.faces[f];
    mesh.faces[f][(i + 1) % 3] = m;
    second[i] = m;
    mesh.faces.push_back(second);
    mesh.source_face.push_back(mesh.source_face[f]);
    surface.patch.push_back(surface.patch[f]);
  }
}

// Tutte's map of a patch is degenerate where an inner edge joins two points of one side.
void split_side_chords(PatchedSurface& surface) {
  for (;;) {
    SideBits bits(surface);
    const std::vector<std::vector<int>> faces = faces_of_patches(surface);
    std::vector<int> chords;
    std::vector<char> taken(surface.mesh.faces.size(), 0);
    for (int q = 0; q < surface.patch_count(); ++q) {
      bits.select(q);
      for (const int f : faces[q])
        for (int h = 3 * f; h < 3 * f + 3; ++h) {
          const int o = surface.mesh.opposite[h];
          if (o < h || surface.patch[o / 3] != q || taken[f] || taken[o / 3]) continue;
          if (!(bits(surface.mesh.from(h)) & bits(surface.mesh.to(h)))) continue;
          // An edge of the side itself, met from both of its sides in a patch that borders itself, is no chord.
          bool along = false;
          for (const std::vector<int>& side : surface.sides[q])
            for (std::size_t k = 1; k < side.size(); ++k)
              along |= std::minmax(side[k - 1], side[k]) == std::minmax(surface.mesh.from(h), surface.mesh.to(h));
          if (along) continue;
          taken[f] = taken[o / 3] = 1;
          chords.push_back(h);
        }
    }
    if (chords.empty()) return;
    for (const int h : chords) split_edge(surface, h);
    connect_half_edges(surface.mesh);
  }
}

enum class Weights { MeanValue, SquareRoot, Uniform };

class PatchEmbedding {
 public:
  explicit PatchEmbedding(const PatchedSurface& surface) : surface_(surface), bits_(surface), index_(surface.mesh.points.size(), -1) {}

  // False if a triangle is not counter-clockwise in doubles.
  bool embed(int q, const std::vector<int>& faces, Weights kind, std::vector<std::array<Vec2, 3>>& corners) {
    const TriangleSurface& mesh = surface_.mesh;
    const std::array<Vec2, 4> square{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
    std::vector<int> points;
    std::vector<Vec2> uv;
    bits_.select(q);
    const auto add = [&](int v, const Vec2& at) {
      index_[v] = static_cast<int>(points.size());
      points.push_back(v);
      uv.push_back(at);
    };
    for (int i = 0; i < 4; ++i) {
      const std::vector<int>& side = surface_.sides[q][i];
      double total = 0, at = 0;
      for (std::size_t k = 1; k < side.size(); ++k) total += (mesh.points[side[k]] - mesh.points[side[k - 1]]).norm();
      // A floor keeps neighbouring points of a side apart in doubles.
      const double floor = 0.01 / side.size();
      double sum = 0;
      std::vector<double> steps;
      for (std::size_t k = 1; k < side.size(); ++k) {
        steps.push_back(std::max(total > 0 ? (mesh.points[side[k]] - mesh.points[side[k - 1]]).norm() / total : 0.0, floor));
        sum += steps.back();
      }
      add(side[0], square[i]);
      for (std::size_t k = 1; k + 1 < side.size(); ++k) {
        at += steps[k - 1] / sum;
        Vec2 p = square[i];
        const Vec2 d = square[(i + 1) % 4] - square[i];
        p += at * d;
        add(side[k], p);
      }
    }
    const int rim = static_cast<int>(points.size());
    for (const int f : faces)
      for (const int v : mesh.faces[f])
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
          const int i = index_[mesh.faces[f][k]], j = index_[mesh.faces[f][(k + 1) % 3]];
          const double l = (mesh.points[points[i]] - mesh.points[points[j]]).norm();
          mean[i] += l, mean[j] += l, count[i] += 1, count[j] += 1;
        }
      for (const int f : faces)
        for (int k = 0; k < 3; ++k) {
          const int i = index_[mesh.faces[f][k]], j = index_[mesh.faces[f][(k + 1) % 3]], c = index_[mesh.faces[f][(k + 2) % 3]];
          double w = 1;
          if (kind != Weights::Uniform) {
            const Vec3 ij = mesh.points[points[j]] - mesh.points[points[i]];
            const double l = std::max(ij.norm(), 1e-12);
            const auto half_tangent = [&](const Vec3& x, const Vec3& y) { return std::tan(0.5 * std::min(std::atan2(x.cross(y).norm(), x.dot(y)), 3.1)); };
            const Vec3 ic = mesh.points[points[c]] - mesh.points[points[i]], jc = mesh.points[points[c]] - mesh.points[points[j]];
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
      for (int k = 0; k < 3; ++k) corners[f][k] = uv[index_[mesh.faces[f][k]]];
      const Vec2 a = corners[f][1] - corners[f][0], b = corners[f][2] - corners[f][0];
      if (!(a.x() * b.y() - a.y() * b.x() > 1e-26)) good = false;
    }
    for (const int v : points) index_[v] = -1;
    return good;
  }

 private:
  const PatchedSurface& surface_;
  SideBits bits_;
  std::vector<int> index_;
};

}  // namespace

std::vector<std::array<Vec2, 3>> map_patches(PatchedSurface& surface, const Progress& progress) {
  split_side_chords(surface);
  std::vector<std::array<Vec2, 3>> corners(surface.mesh.faces.size());
  const std::vector<std::vector<int>> faces = faces_of_patches(surface);
  PatchEmbedding embedding(surface);
  for (int q = 0; q < surface.patch_count(); ++q) {
    bool good = false;
    for (const Weights kind : {Weights::MeanValue, Weights::SquareRoot, Weights::Uniform})
      if (!good) good = embedding.embed(q, faces[q], kind, corners);
    if (!good) throw Error(ErrorCode::Internal, "the map of base quad " + std::to_string(q) + " degenerates in double precision");
    progress((q + 1.0) / surface.patch_count());
  }
  return corners;
}

}  // namespace hybrid_mesh
