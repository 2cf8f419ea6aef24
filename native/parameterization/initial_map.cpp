// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/initial_map.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "parameterization/convex_map.h"

namespace hybrid_mesh {
namespace {

// Where the points of a side lie on it, in its own direction, by the map of the patch across, for which it is `side`.
std::vector<double> fractions_seen_from(const PatchedSurface& surface, const std::vector<int>& faces, const std::vector<std::array<Vec2, 3>>& corners,
                                        int side, const std::vector<int>& points) {
  std::vector<double> fractions(points.size(), -1);
  const double level = side == 1 || side == 2 ? 1 : 0;
  for (const int f : faces)
    for (int i = 0; i < 3; ++i) {
      const Vec2& uv = corners[f][i];
      if (uv[(side + 1) % 2] != level) continue;
      const auto at = std::find(points.begin(), points.end(), surface.mesh.faces[f][i]);
      if (at == points.end()) continue;
      const double along = uv[side % 2];
      fractions[at - points.begin()] = side < 2 ? 1 - along : along;
    }
  for (std::size_t k = 1; k < fractions.size(); ++k)
    if (!(fractions[k] > fractions[k - 1])) throw NoMap("a patch's map does not follow its side");
  return fractions;
}

}  // namespace

void map_patches(PatchedSurface& surface, const std::vector<int>& patches, std::vector<std::array<Vec2, 3>>& corners, const Progress& progress) {
  std::vector<std::vector<int>> faces(surface.patch_count());
  for (int f = 0; f < static_cast<int>(surface.patch.size()); ++f) faces[surface.patch[f]].push_back(f);
  ConvexMap convex_map(surface.mesh);
  std::vector<char> is_given(surface.patch_count(), 1);
  for (const int q : patches) is_given[q] = 0;
  const auto sides_of = [&](int q) {
    std::vector<DiskSide> sides(4);
    for (int i = 0; i < 4; ++i) {
      sides[i].points = surface.sides[q][i];
      const PatchSide other = surface.neighbours[q][i];
      if (other.patch >= 0 && is_given[other.patch])
        sides[i].fractions = fractions_seen_from(surface, faces[other.patch], corners, other.side, sides[i].points);
    }
    return sides;
  };
  for (std::vector<int> pending = patches; !pending.empty();) {
    std::vector<int> split;
    for (const int q : pending) {
      const std::vector<int> chords = convex_map.side_chords(faces[q], sides_of(q));
      if (!chords.empty()) split.push_back(q);
      for (const int h : chords) {
        faces[q].push_back(static_cast<int>(surface.mesh.faces.size()));
        faces[q].push_back(static_cast<int>(surface.mesh.faces.size()) + 1);
        split_inner_edge(surface.mesh, surface.source, h);
        surface.patch.insert(surface.patch.end(), 2, q);
      }
    }
    if (!split.empty()) connect_half_edges(surface.mesh);
    pending = std::move(split);
  }
  corners.resize(surface.mesh.faces.size());
  const std::vector<Vec2> square{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const int q = patches[i];
    if (!convex_map(faces[q], sides_of(q), square, corners))
      throw NoMap("the map of base quad " + std::to_string(q) + " degenerates in double precision");
    progress((i + 1.0) / patches.size());
  }
}

std::vector<std::array<Vec2, 3>> map_patches(PatchedSurface& surface, const Progress& progress) {
  std::vector<int> all(surface.patch_count());
  std::iota(all.begin(), all.end(), 0);
  std::vector<std::array<Vec2, 3>> corners;
  map_patches(surface, all, corners, progress);
  return corners;
}

}  // namespace hybrid_mesh
