// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A boundary loop of a surface, which lies on its left, with arc lengths. Keeps a reference to the points.
class BoundaryLoop {
 public:
  BoundaryLoop(const std::vector<Vec3>& points, std::vector<int> loop);

  int size() const { return static_cast<int>(loop_.size()); }
  int vertex(int i) const { return loop_[i % size()]; }
  const Vec3& point(int i) const { return points_[vertex(i)]; }
  double arc(int i) const { return at_[i]; }  // from point 0 to point i
  double length() const { return at_.back(); }
  double distance(int i, int j) const;  // along the loop, the shorter way

  Vec3 at(double arc) const;                // counted around the loop
  double nearest(const Vec3& place) const;  // the arc length of the point of the loop that is nearest
  // The angle between the ways from a length before point i to it, and from it to a length after it.
  double turn(int i, double window) const;

 private:
  const std::vector<Vec3>& points_;
  std::vector<int> loop_;
  std::vector<double> at_;
};

// All loops, each from its first vertex on.
std::vector<BoundaryLoop> boundary_loops(const TriangleSurface& surface);

}  // namespace hybrid_mesh
