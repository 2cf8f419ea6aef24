// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Van Oosterom, Strackee, The solid angle of a plane triangle, 1983; Jacobson, Kavan, Sorkine-Hornung, Robust inside-outside segmentation
// using generalized winding numbers, 2013.
#include "topology/loop_kind.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace hybrid_mesh {
namespace {

constexpr int faces_between_checks = 65536;

std::vector<int> components_of_faces(const TriangleSurface& surface) {
  std::vector<int> component(surface.faces.size(), -1), stack;
  int count = 0;
  for (std::size_t f = 0; f < component.size(); ++f) {
    if (component[f] >= 0) continue;
    component[f] = count;
    stack.assign(1, static_cast<int>(f));
    while (!stack.empty()) {
      const int face = stack.back();
      stack.pop_back();
      for (int h = 3 * face; h < 3 * face + 3; ++h)
        if (const int g = surface.opposite[h]; g >= 0 && component[g / 3] < 0) {
          component[g / 3] = count;
          stack.push_back(g / 3);
        }
    }
    ++count;
  }
  return component;
}

// How often the faces wind around each of a few points.
template <std::size_t N>
std::array<double, N> winding_numbers(const TriangleSurface& surface, const std::vector<int>& faces, const std::array<Vec3, N>& at,
                                      const Progress& progress) {
  std::array<double, N> angle{};
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (i % faces_between_checks == 0) progress.check();
    const auto& [p, q, r] = surface.faces[faces[i]];
    for (std::size_t k = 0; k < N; ++k) {
      const Vec3 a = surface.points[p] - at[k], b = surface.points[q] - at[k], c = surface.points[r] - at[k];
      const double x = a.norm(), y = b.norm(), z = c.norm();
      angle[k] += std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
    }
  }
  for (double& value : angle) value /= 2 * std::numbers::pi;
  return angle;
}

// The middle, and four points halfway to it.
std::array<Vec3, 5> points_of_disk(const TriangleSurface& surface, const std::vector<int>& loop) {
  Vec3 middle = Vec3::Zero();
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &a = surface.points[loop[i]], &b = surface.points[loop[(i + 1) % loop.size()]];
    middle += (a - b).norm() * (a + b) / 2;
    length += (a - b).norm();
  }
  middle /= length > 0 ? length : 1;
  std::array<Vec3, 5> points{middle};
  for (std::size_t k = 0; k < 4; ++k) points[k + 1] = 0.5 * (middle + surface.points[loop[k * loop.size() / 4]]);
  return points;
}

}  // namespace

void tell_kinds(const TriangleSurface& surface, std::vector<SurfaceLoop>& loops, const Progress& progress) {
  if (loops.empty()) return;
  const std::vector<int> component = components_of_faces(surface);
  std::vector<int> of_point(surface.points.size(), -1);
  std::vector<std::vector<int>> faces;
  for (std::size_t f = 0; f < component.size(); ++f) {
    if (component[f] >= static_cast<int>(faces.size())) faces.resize(component[f] + 1);
    faces[component[f]].push_back(static_cast<int>(f));
    for (const int v : surface.faces[f]) of_point[v] = component[f];
  }
  tbb::parallel_for(std::size_t{0}, loops.size(), [&](std::size_t i) {
    SurfaceLoop& loop = loops[i];
    const auto around = winding_numbers(surface, faces[of_point[loop.points[0]]], points_of_disk(surface, loop.points), progress);
    double sum = 0;
    for (const double number : around) sum += std::abs(number);
    loop.kind = sum / static_cast<double>(around.size()) >= 0.5 ? LoopKind::Handle : LoopKind::Tunnel;
  });
}

}  // namespace hybrid_mesh
