// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangle_intersection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hybrid_mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 exact(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

Kernel::Triangle_3 triangle(const TriangleCorners& t) { return {exact(*t[0]), exact(*t[1]), exact(*t[2])}; }

bool flat(const TriangleCorners& t) { return CGAL::collinear(exact(*t[0]), exact(*t[1]), exact(*t[2])); }

// Do two triangles that share two corners lie in one plane, on the same side of their edge?
bool folded(const TriangleCorners& a, const TriangleCorners& b) {
  const auto own = [](const TriangleCorners& t, const TriangleCorners& other) {
    return static_cast<int>(std::find_if(t.begin(), t.end(), [&](const Vec3* p) { return std::find(other.begin(), other.end(), p) == other.end(); }) -
                            t.begin());
  };
  const int i = own(a, b);
  const Kernel::Point_3 p = exact(*a[i]), q = exact(*b[own(b, a)]), from = exact(*a[(i + 1) % 3]), to = exact(*a[(i + 2) % 3]);
  return CGAL::coplanar(from, to, p, q) && CGAL::coplanar_orientation(from, to, p, q) == CGAL::POSITIVE;
}

Vec3 normal_of(const TriangleCorners& t) { return (*t[1] - *t[0]).cross(*t[2] - *t[0]); }

constexpr double kSure = 1e-9;  // of a length: far above what rounding changes, far below what matters to how often it is sure

// Are two triangles surely on opposite sides of a plane across to a direction? `from`: a corner that they share, which may lie on it.
bool parted(const TriangleCorners& a, const TriangleCorners& b, const Vec3& direction, const Vec3* from) {
  double above = -std::numeric_limits<double>::infinity(), below = -above, size = 0;
  for (const Vec3* p : a)
    if (p != from) above = std::max(above, direction.dot(*p - *a[0])), size = std::max(size, (*p - *a[0]).squaredNorm());
  for (const Vec3* p : b)
    if (p != from) below = std::min(below, direction.dot(*p - *a[0])), size = std::max(size, (*p - *a[0]).squaredNorm());
  const double margin = kSure * std::sqrt(size) * direction.norm();
  if (!from) return above + margin < below;
  const double middle = direction.dot(*from - *a[0]);
  return above + margin < middle && middle + margin < below;
}

// A fast look for a plane between two triangles, which share the corners a[i] and b[j], or none where `shared` is 0. Most pairs that are asked for
// lie beside each other on a surface, and have one.
bool surely_apart(const TriangleCorners& a, const TriangleCorners& b, int shared, int i, int j) {
  if (shared == 0) {
    const Vec3 across = (*b[0] + *b[1] + *b[2]) - (*a[0] + *a[1] + *a[2]), normal_a = normal_of(a), normal_b = normal_of(b);
    const auto along = [&](const Vec3& n) { return n.dot(across) < 0 ? Vec3(-n) : n; };
    return parted(a, b, across, nullptr) || parted(a, b, along(normal_a), nullptr) || parted(a, b, along(normal_b), nullptr);
  }
  const auto to = [](const TriangleCorners& t, int from, int k) { return Vec3((*t[(from + k) % 3] - *t[from]).normalized()); };
  const std::array<Vec3, 2> of_a{to(a, i, 1), to(a, i, 2)}, of_b{to(b, j, 1), to(b, j, 2)};
  if (parted(a, b, of_b[0] + of_b[1] - of_a[0] - of_a[1], a[i])) return true;
  for (const Vec3& p : of_a)
    for (const Vec3& q : of_b)
      if (parted(a, b, q - p, a[i])) return true;
  return false;
}

bool in_plane_of(const TriangleCorners& t, const Vec3& p) { return CGAL::coplanar(exact(*t[0]), exact(*t[1]), exact(*t[2]), exact(p)); }

// The part of a polygon in the triangle's plane that lies on the triangle. Based on: Sutherland, Hodgman, Reentrant polygon clipping, 1974.
std::vector<Vec3> on_triangle(std::vector<Vec3> polygon, const TriangleCorners& t) {
  const Vec3 normal = normal_of(t);
  for (int k = 0; k < 3; ++k) polygon = clipped(polygon, normal.cross(*t[(k + 1) % 3] - *t[k]), *t[k]);
  return polygon;
}

// Where a segment that is not in a triangle's plane goes through it.
Vec3 crossing(const Vec3& p, const Vec3& q, const TriangleCorners& t) {
  const Vec3 normal = normal_of(t);
  const double at_p = std::abs(normal.dot(p - *t[0])), at_q = std::abs(normal.dot(q - *t[0])), both = at_p + at_q;
  return both > 0 ? Vec3((at_q * p + at_p * q) / both) : p;
}

// Adds what sides of one triangle have in common with another one.
void add_crossings(const TriangleCorners& sides, const TriangleCorners& through, std::vector<Vec3>& found) {
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = *sides[k], &q = *sides[(k + 1) % 3];
    if (!CGAL::do_intersect(Kernel::Segment_3(exact(p), exact(q)), triangle(through))) continue;
    if (in_plane_of(through, p) && in_plane_of(through, q)) {
      const std::vector<Vec3> part = on_triangle({p, q}, through);
      found.insert(found.end(), part.begin(), part.end());
    } else {
      found.push_back(crossing(p, q, through));
    }
  }
}

// Each end of the line along which two triangles meet lies on a side of one of them.
std::vector<Vec3> common_line(const TriangleCorners& a, const TriangleCorners& b) {
  std::vector<Vec3> found;
  add_crossings(a, b, found);
  add_crossings(b, a, found);
  if (found.empty()) found.push_back(*a[0]);  // A touch that rounding has taken away.
  std::vector<Vec3> ends{found.front()};
  for (const Vec3& p : found)
    for (const Vec3& q : found)
      if ((p - q).squaredNorm() > (ends.front() - ends.back()).squaredNorm()) ends = {p, q};
  return ends;
}

}  // namespace

bool triangles_meet(const TriangleCorners& a, const TriangleCorners& b) {
  for (int k = 0; k < 3; ++k)
    if (std::max({(*a[0])[k], (*a[1])[k], (*a[2])[k]}) < std::min({(*b[0])[k], (*b[1])[k], (*b[2])[k]}) ||
        std::max({(*b[0])[k], (*b[1])[k], (*b[2])[k]}) < std::min({(*a[0])[k], (*a[1])[k], (*a[2])[k]}))
      return false;
  int shared = 0, i = 0, j = 0;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l)
      if (a[k] == b[l]) ++shared, i = k, j = l;
  if (shared < 2 && surely_apart(a, b, shared, i, j)) return false;
  if (flat(a) || flat(b)) return false;
  if (shared == 3) return true;
  // Beyond a common edge they meet only if they lie on each other.
  if (shared == 2) return folded(a, b);
  if (shared == 0) return CGAL::do_intersect(triangle(a), triangle(b));
  // Beyond a common corner they meet only if the side across from it of one of them meets the other.
  const Kernel::Segment_3 across_a(exact(*a[(i + 1) % 3]), exact(*a[(i + 2) % 3])), across_b(exact(*b[(j + 1) % 3]), exact(*b[(j + 2) % 3]));
  return CGAL::do_intersect(across_a, triangle(b)) || CGAL::do_intersect(across_b, triangle(a));
}

std::vector<Vec3> common_polygon(const TriangleCorners& a, const TriangleCorners& b) {
  if (std::all_of(b.begin(), b.end(), [&](const Vec3* p) { return in_plane_of(a, *p); })) {
    std::vector<Vec3> area = on_triangle({*a[0], *a[1], *a[2]}, b);
    if (!area.empty()) return area;
  }
  return common_line(a, b);
}

std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const Vec3& inwards, const Vec3& on_plane) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = inwards.dot(p - on_plane), at_q = inwards.dot(q - on_plane);
    if (at_p >= 0) kept.push_back(p);
    if ((at_p < 0) != (at_q < 0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return kept;
}

}  // namespace hybrid_mesh
