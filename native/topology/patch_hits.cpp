// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/patch_hits.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>

namespace hybrid_mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 exact(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

Kernel::Triangle_3 triangle(const std::array<const Vec3*, 3>& t) { return {exact(*t[0]), exact(*t[1]), exact(*t[2])}; }

bool flat(const std::array<const Vec3*, 3>& t) { return CGAL::collinear(exact(*t[0]), exact(*t[1]), exact(*t[2])); }

}  // namespace

bool triangles_meet(const std::array<const Vec3*, 3>& a, const std::array<const Vec3*, 3>& b) {
  for (int k = 0; k < 3; ++k)
    if (std::max({(*a[0])[k], (*a[1])[k], (*a[2])[k]}) < std::min({(*b[0])[k], (*b[1])[k], (*b[2])[k]}) ||
        std::max({(*b[0])[k], (*b[1])[k], (*b[2])[k]}) < std::min({(*a[0])[k], (*a[1])[k], (*a[2])[k]}))
      return false;
  if (flat(a) || flat(b)) return false;
  int shared = 0, i = 0, j = 0;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l)
      if (a[k] == b[l]) ++shared, i = k, j = l;
  // Two that share an edge overlap only where they lie on each other.
  if (shared >= 2) return false;
  if (shared == 0) return CGAL::do_intersect(triangle(a), triangle(b));
  // Beyond a common corner they meet only if the side across from it of one of them meets the other.
  const Kernel::Segment_3 across_a(exact(*a[(i + 1) % 3]), exact(*a[(i + 2) % 3])), across_b(exact(*b[(j + 1) % 3]), exact(*b[(j + 2) % 3]));
  return CGAL::do_intersect(across_a, triangle(b)) || CGAL::do_intersect(across_b, triangle(a));
}

int PatchHits::count(const std::vector<int>& rim, const RimPatch& patch, const std::vector<int>& hidden, int most) const {
  int hits = 0;
  std::vector<int> faces;
  const auto place = [&](int v) {
    const int rim_points = static_cast<int>(rim.size());
    return v < rim_points ? &surface_.points[rim[v]] : &patch.points[v - rim_points];
  };
  for (const auto& face : patch.faces) {
    const std::array<const Vec3*, 3> t{place(face[0]), place(face[1]), place(face[2])};
    query_.faces_in_box(t[0]->cwiseMin(*t[1]).cwiseMin(*t[2]), t[0]->cwiseMax(*t[1]).cwiseMax(*t[2]), surface_.faces.size(), faces);
    const bool hit = std::any_of(faces.begin(), faces.end(), [&](int f) {
      if (std::binary_search(hidden.begin(), hidden.end(), f)) return false;
      const auto& [a, b, c] = surface_.faces[f];
      return triangles_meet(t, {&surface_.points[a], &surface_.points[b], &surface_.points[c]});
    });
    if (hit && ++hits >= most) break;
  }
  return hits;
}

}  // namespace hybrid_mesh
