// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/needle_regions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybrid_mesh {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

// Strips of a cylinder and triangles of a flat fan are straight across a long edge, whatever their neighbours on the other are like.
bool is_straight(const GuardedMesh& mesh, int f) {
  const int shortest = mesh.shortest(f);
  return !mesh.is_held(EditMesh::next(shortest)) || !mesh.is_held(EditMesh::prev(shortest));
}

bool is_flat(const GuardedMesh& mesh, int h, double flatness) {
  const double longest = std::max(mesh.length(mesh.longest(h / 3)), mesh.length(mesh.longest(mesh.mesh().opposite[h] / 3)));
  return !mesh.is_held(h) && mesh.bulge(h) <= flatness * longest;
}

double area_of(const GuardedMesh& mesh, int f) {
  const Vec3& a = mesh.point(mesh.mesh().from(3 * f));
  return 0.5 * (mesh.point(mesh.mesh().to(3 * f)) - a).cross(mesh.point(mesh.mesh().apex(3 * f)) - a).norm();
}

}  // namespace

std::vector<char> needle_regions(const GuardedMesh& mesh, const NeedleOptions& options) {
  const int faces = mesh.face_count();
  const std::vector<int>& opposite = mesh.mesh().opposite;
  std::vector<char> marked(faces, options.area <= 0);
  if (options.area <= 0) return marked;
  std::vector<char> thin(faces, 0);
  for (int f = 0; f < faces; ++f) thin[f] = !(mesh.smallest_angle(f) >= radians(options.thin_angle)) && is_straight(mesh, f);

  std::vector<char> open = thin;
  std::vector<int> queue, group;  // queue: marked faces
  for (int first = 0; first < faces; ++first) {
    if (!open[first]) continue;
    double area = 0;
    group = {first};
    open[first] = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
      if (!(mesh.smallest_angle(group[i]) >= radians(options.angle))) area += area_of(mesh, group[i]);
      for (int h = 3 * group[i]; h < 3 * group[i] + 3; ++h)
        if (const int o = opposite[h]; o >= 0 && open[o / 3]) {
          open[o / 3] = 0;
          group.push_back(o / 3);
        }
    }
    if (area < options.area) continue;
    for (const int f : group) marked[f] = 1;
    queue.insert(queue.end(), group.begin(), group.end());
  }

  for (std::size_t i = 0; i < queue.size(); ++i)
    for (int h = 3 * queue[i]; h < 3 * queue[i] + 3; ++h) {
      const int o = opposite[h], f = o / 3;
      if (o < 0 || marked[f] || mesh.is_curve(h)) continue;
      if (!thin[f] && !is_flat(mesh, h, options.flatness)) continue;
      marked[f] = 1;
      queue.push_back(f);
    }
  return marked;
}

}  // namespace hybrid_mesh
