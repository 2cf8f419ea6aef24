// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/curves/surface_paths.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "layout/curves/face_strip.h"

namespace hybrid_mesh {

double nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double size = along.squaredNorm();
  return size > 0 ? std::clamp((p - a).dot(along) / size, 0.0, 1.0) : 0;
}

double nearest_in_triangle(const Vec3& p, const std::array<Vec3, 3>& corners, std::array<double, 3>& weights) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double area = normal.squaredNorm();
  bool inside = area > 0;
  for (int i = 0; i < 3 && inside; ++i) {
    const Vec3 &b = corners[(i + 1) % 3], &c = corners[(i + 2) % 3];
    weights[i] = (c - b).cross(p - b).dot(normal) / area;
    inside = weights[i] >= 0;
  }
  if (inside) {
    const double sum = weights[0] + weights[1] + weights[2];
    for (double& w : weights) w /= sum;
    return (p - (weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2])).squaredNorm();
  }
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double t = nearest_on_segment(p, corners[i], corners[j]), d = (p - (corners[i] + t * (corners[j] - corners[i]))).squaredNorm();
    if (!(d < best)) continue;
    best = d;
    weights = {0, 0, 0};
    weights[i] = 1 - t;
    weights[j] = t;
  }
  return best;
}

FacePoint SurfacePaths::locate(const Vec3& p, int guess) {
  stamp_.resize(mesh_.origin.size(), 0);
  ++now_;
  FacePoint found;
  double best = std::numeric_limits<double>::infinity();
  std::vector<int> faces{guess};
  stamp_[guess] = now_;
  for (std::size_t i = 0; i < faces.size() && i < 400 && best > 1e-24; ++i) {
    std::array<double, 3> w{1, 0, 0};
    const std::array<Vec3, 3> c = corners(faces[i]);
    const double d = nearest_in_triangle(p, c, w);
    if (d < best) {
      best = d;
      found = {faces[i], w[0] * c[0] + w[1] * c[1] + w[2] * c[2]};
    }
    for (int h = 3 * faces[i]; h < 3 * faces[i] + 3; ++h) {
      const int o = mesh_.opposite[h];
      if (o < 0 || stamp_[o / 3] == now_) continue;
      stamp_[o / 3] = now_;
      faces.push_back(o / 3);
    }
  }
  return found;
}

std::optional<std::vector<SurfaceCurves::Step>> SurfacePaths::join(const FacePoint& from, const FacePoint& to, double most) {
  std::vector<SurfaceCurves::Step> steps;
  if (from.face == to.face) return steps;
  stamp_.resize(mesh_.origin.size(), 0);
  previous_.resize(mesh_.origin.size());
  cost_.resize(mesh_.origin.size());
  ++now_;
  struct Entry {
    double estimate;
    int half_edge;
    bool operator>(const Entry& e) const { return estimate != e.estimate ? estimate > e.estimate : half_edge > e.half_edge; }
  };
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  // Where an edge is crossed, to compare ways: nearest to the straight line.
  const Vec3 line = to.at - from.at;
  const auto place = [&](int h) {
    const Vec3 a = points_[mesh_.from(h)], along = points_[mesh_.to(h)] - a, gap = a - from.at;
    const double ll = line.squaredNorm(), ee = along.squaredNorm(), le = line.dot(along), area = ll * ee - le * le;
    // The nearest point of the two lines; then that of the edge to the segment's end nearest to it.
    double s = area > 1e-12 * ll * ee ? (gap.dot(line) * ee - gap.dot(along) * le) / area : 0.5;
    s = std::clamp(s, 0.0, 1.0);
    const double t = ee > 0 ? (s * line - gap).dot(along) / ee : 0.5;
    return Vec3(a + std::clamp(t, 0.05, 0.95) * along);
  };
  const auto leave = [&](int face, int came, const Vec3& at, double cost) {
    for (int h = 3 * face; h < 3 * face + 3; ++h) {
      if (mesh_.opposite[h] < 0 || mesh_.opposite[h] == came) continue;
      const Vec3 m = place(h);
      const double c = cost + (m - at).norm(), estimate = c + (to.at - m).norm();
      if (estimate > most || (stamp_[h] == now_ && cost_[h] <= c)) continue;
      stamp_[h] = now_;
      cost_[h] = c;
      previous_[h] = came;
      queue.push({estimate, h});
    }
  };
  leave(from.face, -1, from.at, 0);
  int last = -1;
  while (!queue.empty() && last < 0) {
    const auto [estimate, h] = queue.top();
    queue.pop();
    const Vec3 m = place(h);
    if (estimate > cost_[h] + (to.at - m).norm()) continue;
    if (mesh_.opposite[h] / 3 == to.face)
      last = h;
    else
      leave(mesh_.opposite[h] / 3, h, m, cost_[h]);
  }
  if (last < 0) return std::nullopt;
  std::vector<int> half_edges;
  for (int h = last; h >= 0; h = previous_[h]) half_edges.push_back(h);
  std::reverse(half_edges.begin(), half_edges.end());
  FaceStrip strip(mesh_, points_, half_edges, from.at, to.at);
  strip.find_shortest();
  const std::vector<double> fractions = strip.fractions();
  for (std::size_t i = 0; i < half_edges.size(); ++i) steps.push_back({half_edges[i], fractions[i]});
  return steps;
}

}  // namespace hybrid_mesh
