// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/boundary_corners.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hybrid_mesh {
namespace {

// A closed polygon with arc lengths.
class Loop {
 public:
  Loop(const std::vector<Vec3>& points, std::vector<int> loop) : points_(points), loop_(std::move(loop)), at_{0} {
    for (int i = 0; i < size(); ++i) at_.push_back(at_.back() + (point(i + 1) - point(i)).norm());
  }
  int size() const { return static_cast<int>(loop_.size()); }
  int vertex(int i) const { return loop_[i % size()]; }
  const Vec3& point(int i) const { return points_[vertex(i)]; }
  double length() const { return at_.back(); }
  double distance(int i, int j) const {
    const double d = std::abs(at_[i] - at_[j]);
    return std::min(d, length() - d);
  }

  // The angle between the ways from a length before point i to it, and from it to a length after it.
  double turn(int i, double window) const {
    const Vec3 in = point(i) - along(at_[i] - window), out = along(at_[i] + window) - point(i);
    return std::atan2(in.cross(out).norm(), in.dot(out));
  }

 private:
  Vec3 along(double s) const {
    while (s < 0) s += length();
    while (s >= length()) s -= length();
    const int i = std::max(0, static_cast<int>(std::upper_bound(at_.begin(), at_.end(), s) - at_.begin()) - 1);
    const double part = at_[i + 1] - at_[i];
    return point(i) + (part > 0 ? (s - at_[i]) / part : 0) * (point(i + 1) - point(i));
  }

  const std::vector<Vec3>& points_;
  std::vector<int> loop_;
  std::vector<double> at_;
};

}  // namespace

std::vector<int> boundary_corners(const TriangleSurface& surface, double window, double angle) {
  std::vector<int> next(surface.points.size(), -1), corners;
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h)
    if (surface.opposite[h] < 0) next[surface.from(h)] = surface.to(h);
  std::vector<char> seen(surface.points.size(), 0);
  for (int first = 0; first < static_cast<int>(next.size()); ++first) {
    if (next[first] < 0 || seen[first]) continue;
    std::vector<int> vertices;
    for (int v = first; !seen[v]; v = next[v]) {
      seen[v] = 1;
      vertices.push_back(v);
    }
    const Loop loop(surface.points, std::move(vertices));
    if (!(loop.length() > 4 * window)) continue;
    std::vector<std::pair<double, int>> sharpest;
    for (int i = 0; i < loop.size(); ++i)
      if (const double turn = loop.turn(i, window); turn > angle) sharpest.push_back({-turn, i});
    std::sort(sharpest.begin(), sharpest.end());
    std::vector<int> kept;
    for (const auto& [turn, i] : sharpest)
      if (std::all_of(kept.begin(), kept.end(), [&, i = i](int k) { return loop.distance(i, k) > window; })) kept.push_back(i);
    std::sort(kept.begin(), kept.end());
    for (const int i : kept) corners.push_back(loop.vertex(i));
  }
  return corners;
}

}  // namespace hybrid_mesh
