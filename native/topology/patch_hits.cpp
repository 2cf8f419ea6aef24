// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/patch_hits.h"

#include <algorithm>

#include "surface/triangle_intersection.h"

namespace hybrid_mesh {

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
