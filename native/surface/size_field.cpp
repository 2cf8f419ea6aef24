// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Borouchaki, Hecht, Frey, Mesh gradation control, 1998 (the bound on how fast sizes grow).
#include "surface/size_field.h"

#include <Eigen/Geometry>
#include <cmath>
#include <queue>
#include <utility>

#include "base/parallel.h"

namespace hybrid_mesh {
namespace {

double area_with(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& faces, const std::vector<double>& fineness) {
  double area = 0;
  for (const auto& [a, b, c] : faces) {
    const double f = fineness_on_face(fineness, a, b, c);
    area += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).norm() * f * f;
  }
  return area;
}

}  // namespace

SizeField::SizeField(const TriangleSurface& surface, std::vector<double> size) : query_(surface), faces_(surface.faces), fineness_(std::move(size)) {
  for (double& x : fineness_) x = 1 / x;
  const double measured = area_with(surface.points, faces_, fineness_);
  const double factor = measured > 0 ? std::sqrt(surface_area(surface) / measured) : 1.0;
  for (double& x : fineness_) x *= factor;
}

double SizeField::fineness(const Vec3& p) const {
  int face = -1;
  return fineness(p, face);
}

double SizeField::fineness(const Vec3& p, int& face) const {
  const ClosestPoint at = query_.closest(p, face);
  face = at.face;
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += at.weights[i] * fineness_[faces_[at.face][i]];
  return sum;
}

std::vector<double> SizeField::fineness(const std::vector<Vec3>& points) const {
  constexpr std::int64_t block = 512;
  const auto count = static_cast<std::int64_t>(points.size());
  std::vector<double> out(points.size());
  parallel_for_each_index((count + block - 1) / block, [&](std::int64_t k) {
    int face = -1;
    for (std::int64_t i = k * block; i < std::min(count, (k + 1) * block); ++i) out[i] = fineness(points[i], face);
  });
  return out;
}

std::vector<double> fineness_at_points(const TriangleSurface& surface) {
  return surface.sizes ? surface.sizes->fineness(surface.points) : std::vector<double>();
}

double measured_area(const TriangleSurface& surface) {
  return surface.sizes ? area_with(surface.points, surface.faces, fineness_at_points(surface)) : surface_area(surface);
}

std::vector<double> graded(const TriangleSurface& surface, std::vector<double> size, double slope) {
  std::vector<std::vector<std::pair<int, double>>> around(surface.points.size());  // neighbour, length
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
    const int a = surface.from(h), b = surface.to(h);
    const double length = (surface.points[b] - surface.points[a]).norm();
    around[a].push_back({b, length});
    if (surface.opposite[h] < 0) around[b].push_back({a, length});
  }
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t v = 0; v < size.size(); ++v) queue.push({size[v], static_cast<int>(v)});
  while (!queue.empty()) {
    const auto [at, v] = queue.top();
    queue.pop();
    if (at > size[v]) continue;
    for (const auto& [w, length] : around[v])
      if (const double most = at + slope * length; most < size[w]) queue.push({size[w] = most, w});
  }
  return size;
}

}  // namespace hybrid_mesh
