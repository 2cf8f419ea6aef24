// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/need.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "remesh/crossing_faces.h"
#include "remesh/protrusion.h"
#include "remesh/quality.h"
#include "surface/closest_point.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {
namespace {

// What is nearer to the mesh, in widths of its quads and in lengths of the diagonal, needs nothing.
constexpr double kEnoughWidths = 0.5, kEnough = 0.006;
constexpr double kAround = 1.5;    // widths around a place that need smaller quads with it
constexpr double kCrossing = 0.7;  // the size of quads, beside those that were there, where some cross or are inverted
constexpr double kWorth = 0.95;    // times as large: hardly smaller quads change nothing
constexpr double kSmallest = 0.5;  // of all, beside those that need nothing

Vec3 middle_of(const QuadMesh& mesh, int quad) {
  Vec3 sum = Vec3::Zero();
  for (int corner = 0; corner < 4; ++corner) sum += mesh.points[mesh.indices[mesh.offsets[quad] + corner]];
  return sum / 4;
}

}  // namespace

bool Need::learn_from(const QuadMesh& mesh, const Progress& progress) {
  const double width = mean_width(mesh), enough = std::min(kEnoughWidths * width, kEnough);
  std::vector<double> wanted(size_.size(), 1);
  const SurfaceDistanceQuery on_surface(placed_);
  std::vector<int> near;
  const auto need_around = [&](const Vec3& place, double size) {
    const Vec3 reach = Vec3::Constant(kAround * width);
    on_surface.faces_in_box(place - reach, place + reach, placed_.faces.size(), near);
    for (const int f : near)
      for (const int v : placed_.faces[f]) wanted[v] = std::min(wanted[v], size);
  };
  const Triangulation t = triangulate(to_soup(mesh));
  const SurfaceDistanceQuery on_mesh(mesh.points, t.triangles);
  std::vector<double> distance(size_.size());
  parallel_for_each_index(static_cast<std::int64_t>(distance.size()),
                          [&](std::int64_t v) { distance[v] = std::sqrt(on_mesh.closest(placed_.points[v]).squared_distance); });
  for (std::size_t v = 0; v < distance.size(); ++v)
    if (distance[v] > enough) need_around(placed_.points[v], enough / distance[v]);
  progress.check();
  for (const Vec3& p : mesh.points)
    if (const double d = std::sqrt(on_surface.closest(p).squared_distance); d > enough) need_around(p, enough / d);
  for (const auto& [faces, place] : crossing_faces(mesh, progress)) need_around(place, kCrossing);
  for (const int quad : inverted_quads(mesh)) need_around(middle_of(mesh, quad), kCrossing);
  bool any = false;
  for (std::size_t v = 0; v < wanted.size(); ++v) {
    const double size = std::max(kSmallest, size_[v] * wanted[v]);
    any |= size < kWorth * size_[v];
    size_[v] = size;
  }
  return any;
}

}  // namespace hybrid_mesh
