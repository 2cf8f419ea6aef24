// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangle_surface.h"

#include <Eigen/Geometry>
#include <limits>
#include <string>

#include "base/error.h"
#include "surface/edge_groups.h"

namespace hybrid_mesh {

bool weights_on(const SurfacePoint& place, int face, const TriangleSurface& surface, std::array<double, 3>& weights) {
  weights = place.weights;
  if (place.face == face) return true;
  weights = {0, 0, 0};
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (surface.faces[place.face][k] == surface.faces[face][i]) weights[i] += place.weights[k], sum += place.weights[k];
  constexpr double rounding = 1e-9;
  return sum > 1 - rounding;
}

double surface_area(const TriangleSurface& surface) {
  double area = 0;
  for (const auto& [a, b, c] : surface.faces)
    area += 0.5 * (surface.points[b] - surface.points[a]).cross(surface.points[c] - surface.points[a]).norm();
  return area;
}

void connect_half_edges(TriangleSurface& surface) {
  const int point_count = static_cast<int>(surface.points.size());
  if (surface.faces.size() > static_cast<std::size_t>(std::numeric_limits<int>::max() / 3))
    throw Error(ErrorCode::Unsupported, "too many faces: " + std::to_string(surface.faces.size()));
  for (const auto& face : surface.faces) {
    for (const int v : face)
      if (v < 0 || v >= point_count) throw Error(ErrorCode::InvalidInput, "a face has the point " + std::to_string(v) + ", which does not exist");
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
      throw Error(ErrorCode::InvalidInput, "a face has the point " + std::to_string(face[0] == face[1] ? face[0] : face[2]) + " twice");
  }
  const int half_edges = 3 * static_cast<int>(surface.faces.size());
  const EdgeGroups edges = group_edges(
      point_count, half_edges, [&](int h) { return surface.from(h); }, [&](int h) { return surface.to(h); });
  surface.opposite.assign(half_edges, -1);
  for (int e = 0; e < edges.count(); ++e) {
    if (edges.size(e) == 1) continue;
    const int h = edges.of(e)[0], g = edges.of(e)[1];
    const bool same_direction = surface.from(h) == surface.from(g);
    if (edges.size(e) > 2 || same_direction)
      throw Error(ErrorCode::InvalidInput,
                  "the edge " + std::to_string(surface.from(h)) + "-" + std::to_string(surface.to(h)) +
                      (edges.size(e) > 2 ? " has more than two faces" : " has two faces that run along it in the same direction"));
    surface.opposite[h] = g;
    surface.opposite[g] = h;
  }
}

}  // namespace hybrid_mesh
