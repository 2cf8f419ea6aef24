// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/mirror_sides.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/found.h"
#include "hierarchy/mirrored.h"
#include "layout/base/base_domain.h"
#include "remesh/adaptive_refinement.h"
#include "remesh/fit.h"

namespace hybrid_mesh {
namespace {

// Does a side of the map lie in the plane? Throws NoMap if a part of it does.
bool lies_in_plane(const PatchMap& map, int side, const Vec3& normal) {
  int in = 0, all = 0;
  std::array<bool, 2> end{};
  for (std::size_t v = 0; v < map.uv.size(); ++v) {
    if (!map.is_on_side(v, side)) continue;
    const double along = side % 2 == 0 ? map.uv[v].x() : map.uv[v].y();
    const bool is_in = is_in_mirror(map.positions[v], normal);
    if (along == 0 || along == 1) end[along == 1] = is_in;
    ++all;
    in += is_in;
  }
  if (in == all) return true;
  if (in > end[0] + end[1]) throw NoMap("a side of the base runs partly in the plane of symmetry");
  return false;
}

}  // namespace

void mark_mirror(HybridMesh& hierarchy, const Vec3& normal) {
  const auto mark = [&](int root, int side) {
    if (lies_in_plane(*hierarchy.map(root), side, normal)) hierarchy.set_on_mirror(root, side);
  };
  for (int q = 0; q < hierarchy.base_count(); ++q)
    for (int s = 0; s < 4; ++s)
      if (!hierarchy.root_neighbour(q, s).valid()) mark(q, s);
  for (int o = 0; o < hierarchy.operation_count(); ++o) {
    const HybridMesh::Operation& operation = hierarchy.operation(o);
    for (std::size_t k = 0; k < operation.roots.size(); ++k)
      for (int s = 0; s < 4; ++s)
        if (operation.repatch.sides[k][s].kind == Repatch::Side::Kind::Open) mark(operation.roots[k], s);
  }
  std::vector<char> on(hierarchy.base_vertex_count(), 0);
  const auto corner = [&](int q, int i) { return hierarchy.corner(q, i % 4).index(); };
  for (int q = 0; q < hierarchy.base_count(); ++q)
    for (int s = 0; s < 4; ++s)
      if (hierarchy.is_on_mirror(q, s)) on[corner(q, s)] = on[corner(q, s + 1)] = 1;
  for (int q = 0; q < hierarchy.base_count(); ++q)
    for (int s = 0; s < 4; ++s)
      if (!hierarchy.is_on_mirror(q, s) && on[corner(q, s)] && on[corner(q, s + 1)])
        throw NoMap("a side of the base joins two nodes in the plane of symmetry");
  for (int n = 0; n < hierarchy.node_count(); ++n)
    for (int s = 0; hierarchy.is_root(n) && s < 4; ++s)
      if (hierarchy.is_on_mirror(n, s) && hierarchy.is_on_mirror(n, (s + 1) % 4))
        throw NoMap("a quad has two sides that meet in the plane of symmetry");
}

std::int64_t mirror_sides(const HybridMesh& hierarchy, int level) {
  std::int64_t sides = 0;
  for (int n = 0; n < hierarchy.node_count(); ++n)
    if (hierarchy.is_active(n) && hierarchy.level(n) == level)
      for (int s = 0; s < 4; ++s) sides += hierarchy.is_on_mirror(n, s);
  return sides;
}

std::int64_t whole_vertices(const HybridMesh& hierarchy, const Source& source) {
  const std::int64_t vertices = closed_vertices(hierarchy);
  if (!source.mirror) return vertices;
  const bool splits = !hierarchy.conforming() && hierarchy.closure() == FaceClosure::Quads;
  return vertices_with_image(vertices, count_mirror_sides(hierarchy), splits, source.half->cut_euler);
}

std::int64_t whole_vertices(const QuadMesh& mesh, const Source& source) {
  auto vertices = static_cast<std::int64_t>(mesh.points.size());
  if (!source.mirror) return vertices;
  const std::vector<char> boundary = boundary_vertices(mesh);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) vertices += !(boundary[v] && is_in_mirror(mesh.points[v], *source.mirror));
  return vertices;
}

}  // namespace hybrid_mesh
