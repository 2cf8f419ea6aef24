// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/vertex_sources.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <utility>

#include "surface/closest_point.h"

namespace hybrid_mesh {

// The triangles of every map, as one set.
struct VertexSources::Pieces {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::pair<const PatchMap*, int>> origin;  // #triangles: the map, and the triangle in it
  std::vector<int> first;                               // #nodes: of the node's own map, -1 without one
  std::optional<SurfaceDistanceQuery> query;

  Vec3 normal(int triangle) const {
    const auto& t = triangles[triangle];
    return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
  }

  SurfacePoint source(const ClosestPoint& closest) const {
    const auto& [map, triangle] = origin[closest.face];
    SurfacePoint result;
    result.face = map->source_face[triangle];
    for (int corner = 0; corner < 3; ++corner) {
      for (int k = 0; k < 3; ++k) result.weights[k] += closest.weights[corner] * map->source[triangle][3 * corner + k];
    }
    return result;
  }
};

VertexSources::VertexSources(const HybridMesh& hierarchy, VertexPlaces places) {
  auto pieces = std::make_unique<Pieces>();
  pieces->first.assign(hierarchy.node_count(), -1);
  for (int node = 0; node < hierarchy.node_count(); ++node) {
    const PatchMap* map = hierarchy.map(node);
    if (!map) continue;
    pieces->first[node] = static_cast<int>(pieces->triangles.size());
    const int shift = static_cast<int>(pieces->points.size());
    pieces->points.insert(pieces->points.end(), map->positions.begin(), map->positions.end());
    for (std::size_t t = 0; t < map->triangles.size(); ++t) {
      const auto& corners = map->triangles[t];
      pieces->triangles.push_back({corners[0] + shift, corners[1] + shift, corners[2] + shift});
      pieces->origin.emplace_back(map, static_cast<int>(t));
    }
  }
  if (places == VertexPlaces::Nearest && !pieces->triangles.empty()) pieces->query.emplace(pieces->points, pieces->triangles);
  pieces_ = std::move(pieces);
}

VertexSources::~VertexSources() = default;

std::vector<SurfacePoint> VertexSources::operator()(const HybridMesh& hierarchy, const QuadMesh& mesh) const {
  std::vector<SurfacePoint> sources(mesh.vertex_count());
  std::vector<int> mapped(mesh.vertex_count(), -1);  // triangle of the set
  for (std::size_t v = 0; v < sources.size(); ++v) {
    const MapLocation& location = mesh.location[v];
    const int owner = location.node < 0 ? -1 : hierarchy.map_owner(location.node);
    if (owner < 0) continue;
    const PatchSample sample = hierarchy.sample(location);
    sources[v] = sample.source;
    mapped[v] = pieces_->first[owner] + sample.triangle;
  }
  if (!pieces_->query) return sources;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sources.size()), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      if (mapped[v] < 0) continue;
      const ClosestPoint closest = pieces_->query->closest(mesh.points[v], mapped[v]);
      if (pieces_->normal(closest.face).dot(pieces_->normal(mapped[v])) > 0) sources[v] = pieces_->source(closest);
    }
  });
  return sources;
}

}  // namespace hybrid_mesh
