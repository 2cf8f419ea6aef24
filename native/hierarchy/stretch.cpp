// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/stretch.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace hybrid_mesh {

namespace {

// A convex piece of a map's triangle.
struct Piece {
  std::array<Vec2, 8> points;
  int size = 0;
  int triangle = -1;

  double area() const {
    double twice = 0;
    for (int i = 2; i < size; ++i) {
      const Vec2 a = points[i - 1] - points[0], b = points[i] - points[0];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    return 0.5 * twice;
  }
};

Piece clip(const Piece& in, int axis, double bound, double sign) {
  Piece out;
  out.triangle = in.triangle;
  for (int i = 0; i < in.size; ++i) {
    const Vec2 &a = in.points[i], &b = in.points[i + 1 == in.size ? 0 : i + 1];
    const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
    if (da >= 0 && out.size < 8) out.points[out.size++] = a;
    if (((da > 0 && db < 0) || (da < 0 && db > 0)) && out.size < 8) {
      Vec2 p = a + (b - a) * (da / (da - db));
      p[axis] = bound;
      out.points[out.size++] = p;
    }
  }
  return out;
}

// Area and mean metric of the map over the squares of nodes, by cutting the triangles down the tree.
class SquareMetrics {
 public:
  SquareMetrics(const PatchMap& map) : map_(map), area_ratio_(map.triangles.size()), metric_(map.triangles.size()) {
    for (std::size_t t = 0; t < map.triangles.size(); ++t) {
      const auto& c = map.triangles[t];
      const Vec2 a = map.uv[c[1]] - map.uv[c[0]], b = map.uv[c[2]] - map.uv[c[0]];
      const Vec3 p = map.positions[c[1]] - map.positions[c[0]], q = map.positions[c[2]] - map.positions[c[0]];
      const double det = a.x() * b.y() - a.y() * b.x();
      area_ratio_[t] = det > 0 ? p.cross(q).norm() / det : 0;
      const Vec3 du = det > 0 ? Vec3((p * b.y() - q * a.y()) / det) : Vec3::Zero(), dv = det > 0 ? Vec3((q * a.x() - p * b.x()) / det) : Vec3::Zero();
      metric_[t] = {du.dot(du), du.dot(dv), dv.dot(dv)};
    }
  }

  std::vector<Piece> whole() const {
    std::vector<Piece> pieces(map_.triangles.size());
    for (std::size_t t = 0; t < pieces.size(); ++t) {
      for (int i = 0; i < 3; ++i) pieces[t].points[i] = map_.uv[map_.triangles[t][i]];
      pieces[t].size = 3;
      pieces[t].triangle = static_cast<int>(t);
    }
    return pieces;
  }

  void measure(const std::vector<Piece>& pieces, double& area, double& anisotropy) const {
    area = 0;
    std::array<double, 3> metric{0, 0, 0};
    for (const Piece& piece : pieces) {
      const double under = piece.area();
      area += under * area_ratio_[piece.triangle];
      for (int i = 0; i < 3; ++i) metric[i] += under * metric_[piece.triangle][i];
    }
    // Ratio of the singular values = sqrt of that of the metric's eigenvalues.
    const double half = 0.5 * (metric[0] + metric[2]), root = std::hypot(0.5 * (metric[0] - metric[2]), metric[1]);
    const double low = half - root;
    anisotropy = low > 0 ? std::sqrt((half + root) / low) : 1e6;
    anisotropy = std::min(anisotropy, 1e6);
  }

 private:
  const PatchMap& map_;
  std::vector<double> area_ratio_;
  std::vector<std::array<double, 3>> metric_;
};

std::vector<Piece> part_of(const std::vector<Piece>& pieces, int axis, double bound, double sign) {
  std::vector<Piece> result;
  for (const Piece& piece : pieces) {
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < piece.size; ++i) {
      const double d = sign * (piece.points[i][axis] - bound);
      low = std::min(low, d);
      high = std::max(high, d);
    }
    if (high <= 0) continue;
    if (low >= 0) {
      result.push_back(piece);
    } else {
      Piece cut = clip(piece, axis, bound, sign);
      if (cut.size > 2) result.push_back(cut);
    }
  }
  return result;
}

}  // namespace

double weighted_median(const std::vector<double>& values, const std::vector<double>& weights) {
  if (values.empty()) return 0;
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] != values[b] ? values[a] < values[b] : a < b; });
  double total = 0, sum = 0;
  for (std::size_t i : order) total += weights[i];
  for (std::size_t i : order) {
    sum += weights[i];
    if (sum >= 0.5 * total) return values[i];
  }
  return values[order.back()];
}

LevelStretch level_stretch(const HybridMesh& hierarchy, const QuadMesh& mesh) {
  const std::size_t faces = mesh.face_count();
  LevelStretch result{std::vector<double>(faces, 1.0), std::vector<double>(faces, 1.0)};
  std::vector<int> nodes(mesh.node.begin(), mesh.node.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());  // faces of one node follow each other
  std::vector<char> wanted(hierarchy.node_count(), 0), above(hierarchy.node_count(), 0);
  std::vector<int> owners;
  std::vector<char> is_owner(hierarchy.node_count(), 0);
  for (int n : nodes) {
    wanted[n] = 1;
    const int owner = hierarchy.map_owner(n);
    if (owner < 0) continue;
    if (!is_owner[owner]) owners.push_back(owner);
    is_owner[owner] = 1;
    for (int up = n; !above[up]; up = hierarchy.parent(up)) {
      above[up] = 1;
      if (up == owner) break;
    }
  }
  std::vector<double> area(hierarchy.node_count(), 0), anisotropy(hierarchy.node_count(), 1);
  parallel_for_each_index(static_cast<std::int64_t>(owners.size()), [&](std::int64_t i) {
    const int owner = owners[i];
    const SquareMetrics metrics(*hierarchy.map(owner));
    struct Item {
      int node;
      double u, v, width;
      std::vector<Piece> pieces;
    };
    std::vector<Item> stack;
    stack.push_back({owner, 0, 0, 1, metrics.whole()});
    while (!stack.empty()) {
      Item item = std::move(stack.back());
      stack.pop_back();
      if (wanted[item.node]) metrics.measure(item.pieces, area[item.node], anisotropy[item.node]);
      const int child = hierarchy.first_child(item.node);
      if (child < 0) continue;
      bool any = false;
      for (int k = 0; k < 4; ++k) any |= above[child + k] && hierarchy.map(child + k) == nullptr;
      if (!any) continue;
      const double w = 0.5 * item.width;
      const auto left = part_of(item.pieces, 0, item.u + w, -1), right = part_of(item.pieces, 0, item.u + w, 1);
      for (int k = 0; k < 4; ++k) {
        if (!above[child + k] || hierarchy.map(child + k)) continue;
        const bool is_right = k == 1 || k == 2, is_high = k >= 2;
        stack.push_back(
            {child + k, item.u + w * is_right, item.v + w * is_high, w, part_of(is_right ? right : left, 1, item.v + w, is_high ? 1 : -1)});
      }
    }
  });
  std::vector<double> ratio, weight;
  for (int n : nodes) {
    if (hierarchy.map_owner(n) < 0) continue;
    ratio.push_back(area[n] * std::ldexp(1.0, 2 * hierarchy.level(n)));
    weight.push_back(area[n]);
  }
  const double median = weighted_median(ratio, weight);
  for (std::size_t f = 0; f < faces; ++f) {
    const int n = mesh.node[f];
    if (hierarchy.map_owner(n) < 0) continue;
    result.stretch[f] = median > 0 ? area[n] * std::ldexp(1.0, 2 * hierarchy.level(n)) / median : 1;
    result.anisotropy[f] = anisotropy[n];
  }
  return result;
}

}  // namespace hybrid_mesh
