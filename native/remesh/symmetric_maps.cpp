// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/symmetric_maps.h"

#include <utility>

#include "layout/base/base_domain.h"
#include "remesh/working_surface.h"

namespace hybrid_mesh {

SymmetricMaps::SymmetricMaps(const Source& whole, const Source& half)
    : whole_(whole), half_(half), unit_(whole.placement.to_unit(whole.repaired)), query_(unit_), plane_{*half.mirror, 0} {}

std::array<PatchMap, 2> SymmetricMaps::operator()(const PatchMap& map) const {
  const TriangleSurface& mesh = half_.half->mesh;
  PatchMap own = map;
  for (Vec3& p : own.positions)
    if (is_in_mirror(p, plane_.normal)) p = plane_.onto(p);
  PatchMap image = own;
  for (Vec2& uv : image.uv) std::swap(uv.x(), uv.y());
  for (Vec3& p : image.positions) p = plane_.reflected(p);
  int guess = -1;
  for (std::size_t t = 0; t < map.triangles.size(); ++t) {
    std::swap(image.triangles[t][1], image.triangles[t][2]);
    const int face = map.source_face[t], of_whole = mesh.source_face[face];
    std::array<std::array<double, 3>, 3> corner{};
    for (int k = 0; k < 3; ++k) weights_on(half_.half->place[mesh.faces[face][k]], of_whole, whole_.repaired, corner[k]);
    own.source_face[t] = of_whole;
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i) {
        double weight = 0;
        for (int k = 0; k < 3; ++k) weight += map.source[t][3 * c + k] * corner[k][i];
        own.source[t][3 * c + i] = static_cast<float>(weight);
      }
    const auto& at = image.triangles[t];
    const Vec3 middle = (image.positions[at[0]] + image.positions[at[1]] + image.positions[at[2]]) / 3;
    guess = query_.closest(middle, guess).face;
    image.source_face[t] = guess;
    std::array<Vec3, 3> under;
    for (int i = 0; i < 3; ++i) under[i] = unit_.points[unit_.faces[guess][i]];
    for (int c = 0; c < 3; ++c) {
      const std::array<double, 3> weights = weights_in_triangle(image.positions[at[c]], under);
      for (int i = 0; i < 3; ++i) image.source[t][3 * c + i] = static_cast<float>(weights[i]);
    }
  }
  return {std::move(own), std::move(image)};
}

}  // namespace hybrid_mesh
