// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/closest_point.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// How long the edges of quads are to be at each place of a surface, beside one another. A mesh is even in the metric in which lengths are multiplied
// by the field's fineness if its quads have these sizes: whatever decides on even quads measures so, whatever tells how far a mesh is from the
// surface or what angles it has does not. The field goes by places, so that it holds for whatever points are put on the surface later.
class SizeField {
 public:
  // `size`: per point of the surface, positive and finite; in any unit.
  SizeField(const TriangleSurface& surface, std::vector<double> size);

  // By how much lengths count more near p than on average: the surface's area is the same with it. Lengths of edges are to be 1 / fineness.
  double fineness(const Vec3& p) const;
  std::vector<double> fineness(const std::vector<Vec3>& points) const;

 private:
  // `face`: one near p (-1: none is known); becomes the one under it.
  double fineness(const Vec3& p, int& face) const;

  SurfaceDistanceQuery query_;
  std::vector<std::array<int, 3>> faces_;
  std::vector<double> fineness_;  // per point
};

// Of the surface's points by its field; empty: it has none, and quads are to be even.
std::vector<double> fineness_at_points(const TriangleSurface& surface);

// By how much lengths count more on a face than on average. `fineness`: per point, or empty.
inline double fineness_on_face(const std::vector<double>& fineness, int a, int b, int c) {
  return fineness.empty() ? 1.0 : (fineness[a] + fineness[b] + fineness[c]) / 3;
}

// ... and on an edge.
inline double fineness_on_edge(const std::vector<double>& fineness, int a, int b) {
  return fineness.empty() ? 1.0 : 0.5 * (fineness[a] + fineness[b]);
}

// The area in the metric of the surface's field.
double measured_area(const TriangleSurface& surface);

// The same sizes, but where they would grow faster than by `slope` times the length of an edge: what is small stays. Per point of the surface.
std::vector<double> graded(const TriangleSurface& surface, std::vector<double> size, double slope);

}  // namespace hybrid_mesh
