// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/boundary_loop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hybrid_mesh {

BoundaryLoop::BoundaryLoop(const std::vector<Vec3>& points, std::vector<int> loop) : points_(points), loop_(std::move(loop)), at_{0} {
  for (int i = 0; i < size(); ++i) at_.push_back(at_.back() + (point(i + 1) - point(i)).norm());
}

double BoundaryLoop::distance(int i, int j) const {
  const double d = std::abs(at_[i] - at_[j]);
  return std::min(d, length() - d);
}

Vec3 BoundaryLoop::at(double arc) const {
  if (!(length() > 0)) return point(0);
  while (arc < 0) arc += length();
  while (arc >= length()) arc -= length();
  const int i = std::max(0, static_cast<int>(std::upper_bound(at_.begin(), at_.end(), arc) - at_.begin()) - 1);
  const double part = at_[i + 1] - at_[i];
  return point(i) + (part > 0 ? (arc - at_[i]) / part : 0) * (point(i + 1) - point(i));
}

double BoundaryLoop::nearest(const Vec3& place) const {
  double best = std::numeric_limits<double>::infinity(), arc = 0;
  for (int i = 0; i < size(); ++i) {
    const Vec3 along = point(i + 1) - point(i);
    const double square = along.squaredNorm();
    const double t = square > 0 ? std::clamp((place - point(i)).dot(along) / square, 0.0, 1.0) : 0;
    const double d = (place - point(i) - t * along).squaredNorm();
    if (d < best) best = d, arc = at_[i] + t * (at_[i + 1] - at_[i]);
  }
  return arc;
}

double BoundaryLoop::turn(int i, double window) const {
  const Vec3 in = point(i) - at(at_[i] - window), out = at(at_[i] + window) - point(i);
  return std::atan2(in.cross(out).norm(), in.dot(out));
}

std::vector<BoundaryLoop> boundary_loops(const TriangleSurface& surface) {
  std::vector<int> next(surface.points.size(), -1);
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h)
    if (surface.opposite[h] < 0) next[surface.from(h)] = surface.to(h);
  std::vector<char> seen(surface.points.size(), 0);
  std::vector<BoundaryLoop> loops;
  for (int first = 0; first < static_cast<int>(next.size()); ++first) {
    if (next[first] < 0 || seen[first]) continue;
    std::vector<int> vertices;
    for (int v = first; !seen[v]; v = next[v]) {
      seen[v] = 1;
      vertices.push_back(v);
    }
    loops.emplace_back(surface.points, std::move(vertices));
  }
  return loops;
}

}  // namespace hybrid_mesh
