// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Van Oosterom, Strackee, The solid angle of a plane triangle, 1983; Jacobson, Kavan, Sorkine-Hornung, Robust inside-outside segmentation
// using generalized winding numbers, 2013; Barill et al., Fast winding numbers for soups and clouds, 2018.
#include "topology/loop_kind.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace hybrid_mesh {
namespace {

std::vector<int> components_of_faces(const TriangleSurface& surface) {
  std::vector<int> component(surface.faces.size(), -1), stack;
  int count = 0;
  for (std::size_t f = 0; f < component.size(); ++f) {
    if (component[f] >= 0) continue;
    component[f] = count;
    stack.assign(1, static_cast<int>(f));
    while (!stack.empty()) {
      const int face = stack.back();
      stack.pop_back();
      for (int h = 3 * face; h < 3 * face + 3; ++h)
        if (const int g = surface.opposite[h]; g >= 0 && component[g / 3] < 0) {
          component[g / 3] = count;
          stack.push_back(g / 3);
        }
    }
    ++count;
  }
  return component;
}

// How often some faces wind around points. Groups of faces that are far away count as one dipole.
class WindingNumber {
 public:
  WindingNumber(const TriangleSurface& surface, std::vector<int> faces, const Progress& progress);
  double operator()(const Vec3& at) const { return sum(0, at) / (4 * std::numbers::pi); }

 private:
  struct Node {
    Vec3 middle, normal;  // weighted by area; the sum of the faces' normals, as long as their areas
    double radius = 0;
    int begin = 0, end = 0;  // of faces_
    std::array<int, 2> child{-1, -1};
  };
  int build(int begin, int end);
  void summarize(Node& node) const;
  double sum(int node, const Vec3& at) const;
  Vec3 middle(int face) const;

  const TriangleSurface& surface_;
  const Progress& progress_;
  std::vector<int> faces_;
  std::vector<Node> nodes_;
};

WindingNumber::WindingNumber(const TriangleSurface& surface, std::vector<int> faces, const Progress& progress)
    : surface_(surface), progress_(progress), faces_(std::move(faces)) {
  build(0, static_cast<int>(faces_.size()));
}

Vec3 WindingNumber::middle(int face) const {
  const auto& [a, b, c] = surface_.faces[face];
  return (surface_.points[a] + surface_.points[b] + surface_.points[c]) / 3;
}

void WindingNumber::summarize(Node& node) const {
  Vec3 weighted = Vec3::Zero();
  double area = 0;
  node.normal = Vec3::Zero();
  for (int i = node.begin; i < node.end; ++i) {
    const auto& [a, b, c] = surface_.faces[faces_[i]];
    const Vec3 normal = (surface_.points[b] - surface_.points[a]).cross(surface_.points[c] - surface_.points[a]) / 2;
    node.normal += normal;
    weighted += normal.norm() * middle(faces_[i]);
    area += normal.norm();
  }
  node.middle = area > 0 ? Vec3(weighted / area) : middle(faces_[node.begin]);
  double square = 0;
  for (int i = node.begin; i < node.end; ++i)
    for (const int v : surface_.faces[faces_[i]]) square = std::max(square, (surface_.points[v] - node.middle).squaredNorm());
  node.radius = std::sqrt(square);
}

int WindingNumber::build(int begin, int end) {
  constexpr int leaf = 8;
  if (end - begin > 4096) progress_.check();
  const int number = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  nodes_[number].begin = begin;
  nodes_[number].end = end;
  summarize(nodes_[number]);
  if (end - begin <= leaf) return number;
  Vec3 low = middle(faces_[begin]), high = low;
  for (int i = begin; i < end; ++i) {
    low = low.cwiseMin(middle(faces_[i]));
    high = high.cwiseMax(middle(faces_[i]));
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const int half = (begin + end) / 2;
  std::nth_element(faces_.begin() + begin, faces_.begin() + half, faces_.begin() + end, [&](int f, int g) {
    const double a = middle(f)[axis], b = middle(g)[axis];
    return a != b ? a < b : f < g;
  });
  const int first = build(begin, half), second = build(half, end);
  nodes_[number].child = {first, second};
  return number;
}

double WindingNumber::sum(int number, const Vec3& at) const {
  // Beyond so many radii the dipole is good enough to tell 0 from 1.
  constexpr double far = 2.5;
  const Node& node = nodes_[number];
  const Vec3 away = node.middle - at;
  const double distance = away.norm();
  if (distance > far * node.radius) return node.normal.dot(away) / (distance * distance * distance);
  if (node.child[0] >= 0) return sum(node.child[0], at) + sum(node.child[1], at);
  double angle = 0;
  for (int i = node.begin; i < node.end; ++i) {
    const auto& [p, q, r] = surface_.faces[faces_[i]];
    const Vec3 a = surface_.points[p] - at, b = surface_.points[q] - at, c = surface_.points[r] - at;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return angle;
}

// The middle, and four points halfway to it.
std::array<Vec3, 5> points_of_disk(const TriangleSurface& surface, const std::vector<int>& loop) {
  Vec3 middle = Vec3::Zero();
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &a = surface.points[loop[i]], &b = surface.points[loop[(i + 1) % loop.size()]];
    middle += (a - b).norm() * (a + b) / 2;
    length += (a - b).norm();
  }
  middle /= length > 0 ? length : 1;
  std::array<Vec3, 5> points{middle};
  for (std::size_t k = 0; k < 4; ++k) points[k + 1] = 0.5 * (middle + surface.points[loop[k * loop.size() / 4]]);
  return points;
}

}  // namespace

void tell_kinds(const TriangleSurface& surface, std::vector<SurfaceLoop>& loops, const Progress& progress) {
  ProgressSteps unseen(progress.part(0, 0), 1);
  tell_kinds(surface, loops, unseen);
}

void tell_kinds(const TriangleSurface& surface, std::vector<SurfaceLoop>& loops, ProgressSteps& steps) {
  if (loops.empty()) return;
  const std::vector<int> component = components_of_faces(surface);
  std::vector<int> of_point(surface.points.size(), -1);
  std::vector<std::vector<int>> faces;
  for (std::size_t f = 0; f < component.size(); ++f) {
    if (component[f] >= static_cast<int>(faces.size())) faces.resize(component[f] + 1);
    faces[component[f]].push_back(static_cast<int>(f));
    for (const int v : surface.faces[f]) of_point[v] = component[f];
  }
  // Loops by component, so that there is one tree at a time.
  std::vector<std::vector<std::size_t>> loops_of(faces.size());
  for (std::size_t i = 0; i < loops.size(); ++i) loops_of[of_point[loops[i].points[0]]].push_back(i);
  for (std::size_t c = 0; c < faces.size(); ++c) {
    if (loops_of[c].empty()) continue;
    const WindingNumber winding(surface, std::move(faces[c]), steps.progress());
    steps(static_cast<std::int64_t>(loops_of[c].size()));
    parallel_for_each_index(static_cast<std::int64_t>(loops_of[c].size()), [&](std::int64_t i) {
      steps.progress().check();
      SurfaceLoop& loop = loops[loops_of[c][i]];
      const auto points = points_of_disk(surface, loop.points);
      double sum = 0;
      for (const Vec3& at : points) sum += std::abs(winding(at));
      loop.kind = sum / static_cast<double>(points.size()) >= 0.5 ? LoopKind::Handle : LoopKind::Tunnel;
      steps();
    });
  }
}

}  // namespace hybrid_mesh
