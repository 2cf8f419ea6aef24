// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/topology_summary.h"

#include <limits>
#include <string>

#include "base/error.h"
#include "decoder/disjoint_sets.h"
#include "surface/edge_groups.h"

namespace hybrid_mesh {

TopologySummary summarize_topology(const PolygonSoup& soup) {
  if (soup.indices.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error(ErrorCode::Unsupported, "too many faces: " + std::to_string(soup.polygon_count()));
  const int point_count = static_cast<int>(soup.points.size()), corner_count = static_cast<int>(soup.indices.size());
  for (const int v : soup.indices)
    if (v < 0 || v >= point_count) throw Error(ErrorCode::InvalidInput, "a face has the point " + std::to_string(v) + ", which does not exist");
  TopologySummary t;
  t.faces = static_cast<std::int64_t>(soup.polygon_count());

  // Half-edge c leaves corner c of its polygon.
  std::vector<int> next(corner_count);
  std::vector<char> used(point_count, 0);
  DisjointSets components(point_count);
  for (std::size_t p = 0; p < soup.polygon_count(); ++p)
    for (std::int64_t c = soup.offsets[p]; c < soup.offsets[p + 1]; ++c) {
      next[c] = static_cast<int>(c + 1 < soup.offsets[p + 1] ? c + 1 : soup.offsets[p]);
      used[soup.indices[c]] = 1;
      components.join(soup.indices[c], soup.indices[next[c]]);
    }
  const auto from = [&](int c) { return soup.indices[c]; };
  const auto to = [&](int c) { return soup.indices[next[c]]; };
  const EdgeGroups edges = group_edges(point_count, corner_count, from, to);
  t.edges = edges.count();

  DisjointSets loops(point_count), fans(corner_count);
  std::vector<char> on_boundary(point_count, 0);
  for (int e = 0; e < edges.count(); ++e) {
    const int* c = edges.of(e);
    const int size = edges.size(e), a = from(c[0]), b = to(c[0]);
    t.nonmanifold_edges += size > 2;
    if (size == 1) {
      loops.join(a, b);
      on_boundary[a] = on_boundary[b] = 1;
    }
    int same = 0;
    for (int i = 0; i < size; ++i) same += from(c[i]) == a;
    t.misoriented_edges += (same > 1) + (size - same > 1);
    for (int i = 1; i < size; ++i)
      for (const int v : {a, b}) fans.join(from(c[0]) == v ? c[0] : next[c[0]], from(c[i]) == v ? c[i] : next[c[i]]);
  }
  std::vector<int> fan_count(point_count, 0);
  for (int c = 0; c < corner_count; ++c) fan_count[from(c)] += fans.is_representative(c);
  for (int v = 0; v < point_count; ++v) {
    t.vertices += used[v];
    t.components += used[v] && components.is_representative(v);
    t.boundary_loops += on_boundary[v] && loops.is_representative(v);
    t.nonmanifold_vertices += fan_count[v] > 1;
  }
  t.euler = t.vertices - t.edges + t.faces;
  t.genus = static_cast<double>(2 * t.components - t.boundary_loops - t.euler) / 2;
  return t;
}

PolygonSoup to_soup(const TriangleSurface& surface) {
  PolygonSoup soup;
  soup.points = surface.points;
  soup.indices.reserve(3 * surface.faces.size());
  soup.offsets.reserve(surface.faces.size() + 1);
  for (const auto& face : surface.faces) {
    soup.indices.insert(soup.indices.end(), face.begin(), face.end());
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  return soup;
}

}  // namespace hybrid_mesh
