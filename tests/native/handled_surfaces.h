// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces whose topology is made up handle by handle.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "generated_surfaces.h"

namespace hybrid_mesh::testing {

// A tube with three sides between two faces, which it takes away; `lift` is how high it arches along the normals. Within a component it adds one to
// the genus.
inline void join_faces(TriangleSurface& s, int f, int g, int rows, double lift) {
  const std::array<int, 3> a = s.faces[f], far = s.faces[g];
  const auto normal = [&](const std::array<int, 3>& t) {
    return Vec3((s.points[t[1]] - s.points[t[0]]).cross(s.points[t[2]] - s.points[t[0]]).normalized());
  };
  const Vec3 up = (normal(a) + normal(far)).normalized() * lift;
  // Turned so that the corners that are joined are near each other.
  std::array<int, 3> b{};
  double least = 1e300;
  for (int turn = 0; turn < 3; ++turn) {
    const std::array<int, 3> c{far[turn], far[(turn + 2) % 3], far[(turn + 1) % 3]};
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += (s.points[a[k]] - s.points[c[k]]).squaredNorm();
    if (sum < least) least = sum, b = c;
  }
  std::array<int, 3> ring = a;
  for (int row = 1; row <= rows; ++row) {
    std::array<int, 3> next = b;
    const double t = static_cast<double>(row) / rows;
    for (int k = 0; row < rows && k < 3; ++k) {
      next[k] = static_cast<int>(s.points.size());
      s.points.push_back((1 - t) * s.points[a[k]] + t * s.points[b[k]] + std::sin(std::numbers::pi * t) * up);
    }
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      const std::array<int, 3> one{ring[k], ring[l], next[l]}, two{ring[k], next[l], next[k]};
      if (row == 1 && k == 0) {
        s.faces[f] = one;
      } else {
        s.faces.push_back(one);
      }
      if (row == rows && k == 0) {
        s.faces[g] = two;
      } else {
        s.faces.push_back(two);
      }
    }
    ring = next;
  }
}

inline void finish(TriangleSurface& s) {
  s.source_face.resize(s.faces.size());
  for (std::size_t f = 0; f < s.faces.size(); ++f) s.source_face[f] = static_cast<int>(f);
  connect_half_edges(s);
}

// The face whose middle lies farthest in a direction.
inline int face_towards(const TriangleSurface& s, const Vec3& direction) {
  int best = -1;
  double most = -1e300;
  for (std::size_t f = 0; f < s.faces.size(); ++f) {
    const Vec3 middle = (s.points[s.faces[f][0]] + s.points[s.faces[f][1]] + s.points[s.faces[f][2]]) / 3;
    const double along = middle.normalized().dot(direction.normalized());
    if (along > most) most = along, best = static_cast<int>(f);
  }
  return best;
}

// A ball with as many tiny handles, each between two faces with a face's distance: what noise makes of a scan. 8 n^2 faces.
inline TriangleSurface noisy_ball(int n, int handles) {
  TriangleSurface s = repaired(ball(n));
  std::vector<char> used(s.points.size(), 0);
  std::vector<std::vector<int>> faces_of(s.points.size());
  for (std::size_t f = 0; f < s.faces.size(); ++f)
    for (const int v : s.faces[f]) faces_of[v].push_back(static_cast<int>(f));
  const TriangleSurface flat = s;  // as it was before the handles
  const auto free = [&](int f) { return !used[flat.faces[f][0]] && !used[flat.faces[f][1]] && !used[flat.faces[f][2]]; };
  const int faces = static_cast<int>(s.faces.size());
  int made = 0;
  for (int i = 0; i < faces && made < handles; ++i) {
    const int f = static_cast<int>(static_cast<long>(i) * 7919 % faces);
    if (!free(f)) continue;
    // Faces around the far corner of the one across.
    const int across = flat.opposite[3 * f] / 3, tip = flat.from(TriangleSurface::previous(flat.opposite[3 * f]));
    int g = -1;
    for (const int other : faces_of[tip]) {
      bool apart = other != across && free(other);
      for (const int v : flat.faces[other])
        for (const int w : flat.faces[f]) apart = apart && v != w;
      if (apart) g = other;
    }
    if (g < 0) continue;
    const double edge = (flat.points[flat.faces[f][0]] - flat.points[flat.faces[f][1]]).norm();
    for (const int v : flat.faces[f]) used[v] = 1;
    for (const int v : flat.faces[g]) used[v] = 1;
    join_faces(s, f, g, 3, made % 2 ? edge : -edge);
    ++made;
  }
  finish(s);
  return s;
}

}  // namespace hybrid_mesh::testing
