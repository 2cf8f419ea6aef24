// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/closest_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "surface/scaled_points.h"

namespace hybrid_mesh {

namespace {

struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  void add(const Box& b) { low = low.cwiseMin(b.low), high = high.cwiseMax(b.high); }
  double squared_distance(const Vec3& p) const {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const double d = std::max(std::max(low[i] - p[i], p[i] - high[i]), 0.0);
      sum += d * d;
    }
    return sum;
  }
  bool meets(const Box& b) const { return (low.array() <= b.high.array()).all() && (b.low.array() <= high.array()).all(); }
};

struct Corners {
  const Vec3 &a, &b, &c;
};

// Based on: Ericson, Real-Time Collision Detection, 2005, section 5.1.5. Triangles without area are taken as the segments or points they
// are.
double closest_on_triangle(const Vec3& p, const Corners& t, std::array<double, 3>& weights) {
  const auto on_segment = [&](const Vec3& a, const Vec3& b) {
    const Vec3 ab = b - a;
    const double l = ab.squaredNorm();
    return l > 0 ? std::clamp((p - a).dot(ab) / l, 0.0, 1.0) : 0.0;
  };
  const auto distance = [&] { return (p - (weights[0] * t.a + weights[1] * t.b + weights[2] * t.c)).squaredNorm(); };

  const Vec3 ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return weights = {1, 0, 0}, ap.squaredNorm();
  const Vec3 bp = p - t.b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return weights = {0, 1, 0}, bp.squaredNorm();
  const Vec3 cp = p - t.c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return weights = {0, 0, 1}, cp.squaredNorm();
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) {
    const double s = d1 / (d1 - d3);
    return weights = {1 - s, s, 0}, distance();
  }
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 - d6 > 0) {
    const double s = d2 / (d2 - d6);
    return weights = {1 - s, 0, s}, distance();
  }
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0) {
    const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return weights = {0, 1 - s, s}, distance();
  }
  const double sum = va + vb + vc;
  if (va > 0 && vb > 0 && vc > 0 && std::isfinite(1 / sum)) {
    weights = {va / sum, vb / sum, vc / sum};
    return distance();
  }
  // No area, or so little that rounding decided above: the closest of the three sides.
  const std::array<std::array<double, 3>, 3> sides = [&] {
    const double s = on_segment(t.a, t.b), u = on_segment(t.b, t.c), v = on_segment(t.c, t.a);
    return std::array<std::array<double, 3>, 3>{{{1 - s, s, 0}, {0, 1 - u, u}, {v, 0, 1 - v}}};
  }();
  double best = std::numeric_limits<double>::infinity();
  std::array<double, 3> best_weights{1, 0, 0};
  for (const auto& side : sides) {
    weights = side;
    if (const double d = distance(); d < best) best = d, best_weights = side;
  }
  weights = best_weights;
  return best;
}

}  // namespace

// A hierarchy of boxes over the triangles, halved at the median along the longest side. Coordinates are centred and scaled.
class SurfaceDistanceQuery::Tree {
 public:
  Tree(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& faces, const Progress* progress) {
    if (faces.empty()) throw Error(ErrorCode::InvalidInput, "a surface without faces has no closest points");
    if (faces.size() > static_cast<std::size_t>(std::numeric_limits<int>::max() / 2))
      throw Error(ErrorCode::Unsupported, "too many faces: " + std::to_string(faces.size()));
    Box box;
    for (const auto& face : faces)
      for (const int v : face) box.add(points[v]);
    // Halves, so that the sum cannot overflow.
    centre_ = box.low / 2 + box.high / 2;
    const double size = (box.high / 2 - box.low / 2).maxCoeff();
    std::frexp(size, &exponent_);
    const int count = static_cast<int>(faces.size());
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), 0);
    {
      std::vector<Box> boxes(count);
      for (int f = 0; f < count; ++f)
        for (const int v : faces[f]) boxes[f].add(local(points[v]));
      nodes_.reserve(nodes_for(count));
      build(0, count, boxes, progress);
    }
    slot_.resize(count);
    corners_.resize(count);
    points_.reserve(std::min(points.size(), 3 * faces.size()));
    std::vector<int> renamed(points.size(), -1);
    for (int i = 0; i < count; ++i) {
      slot_[order_[i]] = i;
      for (int k = 0; k < 3; ++k) {
        const int v = faces[order_[i]][k];
        if (renamed[v] < 0) {
          renamed[v] = static_cast<int>(points_.size());
          points_.push_back(local(points[v]));
        }
        corners_[i][k] = renamed[v];
      }
    }
  }

  ClosestPoint closest(const Vec3& point, int guess) const {
    const Vec3 p = local(point);
    ClosestPoint best;
    best.squared_distance = std::numeric_limits<double>::infinity();
    if (guess >= 0 && guess < static_cast<int>(slot_.size())) test(slot_[guess], p, best);
    struct Entry {
      double distance;
      int node;
    };
    Entry stack[64];  // as deep as the tree at most, which is balanced
    int depth = 0;
    stack[depth++] = {nodes_[0].box.squared_distance(p), 0};
    while (depth > 0) {
      const Entry entry = stack[--depth];
      if (entry.distance > best.squared_distance) continue;  // equal ones may hold an earlier face
      const Node& node = nodes_[entry.node];
      if (node.begin >= 0) {
        for (int i = node.begin; i < node.end; ++i) test(i, p, best);
        continue;
      }
      const int second = node.second();
      Entry near{nodes_[entry.node + 1].box.squared_distance(p), entry.node + 1}, far{nodes_[second].box.squared_distance(p), second};
      if (far.distance < near.distance) std::swap(near, far);
      if (far.distance <= best.squared_distance) stack[depth++] = far;
      if (near.distance <= best.squared_distance) stack[depth++] = near;
    }
    best.squared_distance = std::ldexp(best.squared_distance, 2 * exponent_);
    return best;
  }

  double squared_distance(const Vec3& point, int face) const {
    std::array<double, 3> weights;
    return std::ldexp(closest_on_triangle(local(point), triangle(slot_[face]), weights), 2 * exponent_);
  }

  bool faces_in_box(const Vec3& low, const Vec3& high, std::size_t most, std::vector<int>& faces) const {
    const Box box{local(low), local(high)};
    faces.clear();
    int stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const int index = stack[--depth];
      const Node& node = nodes_[index];
      if (!box.meets(node.box)) continue;
      if (node.begin < 0) {
        stack[depth++] = node.second();
        stack[depth++] = index + 1;
        continue;
      }
      for (int i = node.begin; i < node.end; ++i) {
        Box own;
        for (const int v : corners_[i]) own.add(points_[v]);
        if (!box.meets(own)) continue;
        if (faces.size() == most) return false;
        faces.push_back(order_[i]);
      }
    }
    return true;
  }

 private:
  struct Node {
    Box box;
    int begin, end;  // of a leaf: its triangles; else -1 and the second child: the first one follows its parent
    int second() const { return end; }
  };
  static constexpr int leaf_size = 4;

  // How many there are over so many triangles.
  static std::size_t nodes_for(int count) { return count <= leaf_size ? 1 : 1 + nodes_for(count / 2) + nodes_for(count - count / 2); }

  Vec3 local(const Vec3& p) const { return scaled(Vec3(p / 2 - centre_ / 2), exponent_ - 1); }

  Corners triangle(int slot) const { return {points_[corners_[slot][0]], points_[corners_[slot][1]], points_[corners_[slot][2]]}; }

  int build(int begin, int end, const std::vector<Box>& boxes, const Progress* progress) {
    constexpr int few = 4096;  // faces, which take no time
    if (progress && end - begin > few) progress->check();
    const int index = static_cast<int>(nodes_.size());
    nodes_.push_back({{}, begin, end});
    Box box, centres;
    for (int i = begin; i < end; ++i) {
      box.add(boxes[order_[i]]);
      centres.add(Vec3(boxes[order_[i]].low + boxes[order_[i]].high));
    }
    nodes_[index].box = box;
    if (end - begin <= leaf_size) return index;
    int axis = 0;
    (centres.high - centres.low).maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int f, int g) {
      const double a = boxes[f].low[axis] + boxes[f].high[axis], b = boxes[g].low[axis] + boxes[g].high[axis];
      return a != b ? a < b : f < g;
    });
    build(begin, middle, boxes, progress);
    nodes_[index].begin = -1;
    nodes_[index].end = build(middle, end, boxes, progress);
    return index;
  }

  void test(int slot, const Vec3& p, ClosestPoint& best) const {
    std::array<double, 3> weights;
    const double d = closest_on_triangle(p, triangle(slot), weights);
    if (d > best.squared_distance || (d == best.squared_distance && order_[slot] >= best.face)) return;
    best.squared_distance = d;
    best.weights = weights;
    best.face = order_[slot];
  }

  std::vector<Node> nodes_;
  // Of the triangles, in the order of the leaves, and so are the points: what is looked at together is near in memory, and takes little of it.
  std::vector<std::array<int, 3>> corners_;
  std::vector<Vec3> points_;
  std::vector<int> order_;  // the face of each triangle
  std::vector<int> slot_;   // the reverse
  Vec3 centre_;
  int exponent_ = 0;
};

SurfaceDistanceQuery::SurfaceDistanceQuery(const TriangleSurface& surface) : SurfaceDistanceQuery(surface.points, surface.faces) {}
SurfaceDistanceQuery::SurfaceDistanceQuery(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& faces)
    : tree_(std::make_unique<const Tree>(points, faces, nullptr)) {}
SurfaceDistanceQuery::SurfaceDistanceQuery(const TriangleSurface& surface, const Progress& progress)
    : tree_(std::make_unique<const Tree>(surface.points, surface.faces, &progress)) {}
SurfaceDistanceQuery::~SurfaceDistanceQuery() = default;
SurfaceDistanceQuery::SurfaceDistanceQuery(SurfaceDistanceQuery&&) noexcept = default;
SurfaceDistanceQuery& SurfaceDistanceQuery::operator=(SurfaceDistanceQuery&&) noexcept = default;

ClosestPoint SurfaceDistanceQuery::closest(const Vec3& p) const { return tree_->closest(p, -1); }
ClosestPoint SurfaceDistanceQuery::closest(const Vec3& p, int guess) const { return tree_->closest(p, guess); }
double SurfaceDistanceQuery::squared_distance(const Vec3& p, int face) const { return tree_->squared_distance(p, face); }
bool SurfaceDistanceQuery::faces_in_box(const Vec3& low, const Vec3& high, std::size_t most, std::vector<int>& faces) const {
  return tree_->faces_in_box(low, high, most, faces);
}

}  // namespace hybrid_mesh
