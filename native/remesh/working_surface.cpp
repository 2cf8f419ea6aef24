// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/working_surface.h"

#include <algorithm>

#include "surface/edit_mesh.h"

namespace hybrid_mesh {
namespace {

// A side of the base that runs along the boundary is a straight line in the map: a triangle between an inner edge that joins two of its vertices and
// that line would have no area.
void split_chords(TriangleSurface& mesh, std::vector<PointSource>& source) {
  if (std::find(mesh.opposite.begin(), mesh.opposite.end(), -1) == mesh.opposite.end()) return;
  const std::vector<int> loop = EditMesh(mesh).boundary_loops();
  const int points = static_cast<int>(mesh.points.size());
  for (bool any = true; any;) {
    any = false;
    std::vector<char> split(mesh.faces.size(), 0);
    for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
      const int o = mesh.opposite[h], a = mesh.from(h), b = mesh.to(h);
      if (o < h || a >= points || b >= points || loop[a] < 0 || loop[a] != loop[b] || split[h / 3] || split[o / 3]) continue;
      split[h / 3] = split[o / 3] = 1;
      split_inner_edge(mesh, source, h);
      any = true;
    }
    if (any) connect_half_edges(mesh);
  }
}

}  // namespace

void WorkingSurface::to_repaired(PatchMap& map, const TriangleSurface& repaired) const {
  for (std::size_t t = 0; t < map.triangles.size(); ++t) {
    const int face = map.source_face[t];
    const int original = mesh.source_face[face];
    std::array<std::array<double, 3>, 3> corner;
    for (int k = 0; k < 3; ++k) corner[k] = weights_in_face(source[mesh.faces[face][k]], repaired.faces[original]);
    std::array<float, 9> fresh{};
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i) {
        double w = 0;
        for (int k = 0; k < 3; ++k) w += map.source[t][3 * c + k] * corner[k][i];
        fresh[3 * c + i] = static_cast<float>(w);
      }
    map.source[t] = fresh;
    map.source_face[t] = original;
  }
}

WorkingSurface make_working_surface(const TriangleSurface& repaired, const Placement& placement, std::int64_t least_faces) {
  WorkingSurface w;
  w.mesh = repaired;
  for (Vec3& p : w.mesh.points) p = placement.to_unit(p);
  for (std::size_t f = 0; f < repaired.faces.size(); ++f) w.mesh.source_face[f] = static_cast<int>(f);
  for (std::size_t v = 0; v < repaired.points.size(); ++v) w.source.push_back({{static_cast<int>(v), -1, -1}, {1, 0, 0}});
  while (static_cast<std::int64_t>(w.mesh.faces.size()) < least_faces) {
    TriangleSurface& m = w.mesh;
    std::vector<int> middle(m.opposite.size(), -1);
    for (int h = 0; h < static_cast<int>(m.opposite.size()); ++h) {
      if (middle[h] >= 0) continue;
      const int a = m.from(h), b = m.to(h);
      middle[h] = static_cast<int>(m.points.size());
      if (m.opposite[h] >= 0) middle[m.opposite[h]] = middle[h];
      m.points.push_back(0.5 * (m.points[a] + m.points[b]));
      w.source.push_back(middle_of(w.source[a], w.source[b]));
    }
    std::vector<std::array<int, 3>> faces;
    std::vector<int> source_face;
    for (std::size_t f = 0; f < m.faces.size(); ++f) {
      const auto [a, b, c] = m.faces[f];
      const int x = middle[3 * f], y = middle[3 * f + 1], z = middle[3 * f + 2];
      for (const std::array<int, 3>& t : {std::array<int, 3>{a, x, z}, {x, b, y}, {z, y, c}, {x, y, z}}) {
        faces.push_back(t);
        source_face.push_back(m.source_face[f]);
      }
    }
    m.faces = std::move(faces);
    m.source_face = std::move(source_face);
    connect_half_edges(m);
  }
  split_chords(w.mesh, w.source);
  return w;
}

}  // namespace hybrid_mesh
