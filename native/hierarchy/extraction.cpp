// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes taken out of the hierarchy.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/error.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

namespace {

constexpr double side_u[4] = {0, 1, 1, 0}, side_v[4] = {0, 0, 1, 1};

}  // namespace

PolygonSoup to_soup(const QuadMesh& mesh) {
  PolygonSoup soup;
  soup.points = mesh.points;
  soup.offsets = mesh.offsets;
  soup.indices = mesh.indices;
  return soup;
}

QuadMesh HybridMesh::level_mesh(int cap, LevelKind kind, FaceClosure closure, const Positions* positions) const {
  std::vector<PlaceInFace> places;
  LevelMesh level = connectivity(cap, kind, closure, &places);
  QuadMesh mesh;
  mesh.offsets = std::move(level.offsets);
  mesh.indices = std::move(level.indices);
  mesh.node = std::move(level.node);
  mesh.vertex = std::move(level.vertex);
  mesh.sharp = std::move(level.sharp);
  mesh.root.reserve(mesh.node.size());
  for (const int node : mesh.node) mesh.root.push_back(nodes_[node].root);
  mesh.location.reserve(places.size());
  int node = -1, owner = -1;
  Square square;
  for (const PlaceInFace& place : places) {
    if (place.node != node) {
      node = place.node;
      owner = map_owner(node);
      if (owner < 0) owner = nodes_[node].root;
      square = square_in(node, owner);
    }
    const int s = place.side;
    if (s < 0) {
      const double w = 0.5 * square.width;
      mesh.location.push_back({owner, square.u + w, square.v + w});
      continue;
    }
    const double u0 = square.u + square.width * side_u[s], v0 = square.v + square.width * side_v[s];
    const double du = square.width * (side_u[(s + 1) % 4] - side_u[s]), dv = square.width * (side_v[(s + 1) % 4] - side_v[s]);
    mesh.location.push_back({owner, u0 + du * place.t, v0 + dv * place.t});
  }
  mesh.points.assign(mesh.vertex.size(), Vec3::Zero());
  std::vector<char> known(mesh.vertex.size(), 0);
  if (positions) {
    std::vector<int> index(vertex_slots(), -1);
    for (std::size_t v = 0; v < mesh.vertex.size(); ++v) index[vertex_slot(mesh.vertex[v])] = static_cast<int>(v);
    for (const auto& [id, point] : *positions) {
      const int i = index[vertex_slot(id)];
      if (i < 0) continue;
      mesh.points[i] = point;
      known[i] = 1;
    }
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.vertex.size(), 1024), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (known[i]) continue;
      const MapLocation& location = mesh.location[i];
      if (const PatchSampler* sampler = this->sampler(location.node)) mesh.points[i] = (*sampler)(location.u, location.v).position;
    }
  });
  return mesh;
}

QuadMesh HybridMesh::level_mesh(int j, LevelKind kind, FaceClosure closure) const {
  if (j < 0) throw Error(ErrorCode::InvalidInput, "a level below zero");
  return level_mesh(j, kind, closure, has_level_positions(j) ? &level_positions_[j] : nullptr);
}

QuadMesh HybridMesh::final_mesh(FaceClosure closure) const {
  return level_mesh(max_level + 1, LevelKind::N, closure, has_final_positions() ? &final_positions_ : nullptr);
}

// Joins two sorted lists; the later one wins.
static void merge_positions(std::vector<std::pair<VertexId, Vec3>>& kept, const QuadMesh& mesh) {
  if (mesh.points.size() != mesh.vertex.size()) throw Error(ErrorCode::InvalidInput, "positions and vertices differ in number");
  // Sorted in linear time: names are whole numbers.
  const auto last = std::max_element(mesh.vertex.begin(), mesh.vertex.end());
  std::vector<int> place(last == mesh.vertex.end() ? 0 : last->code + 1, -1);
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v) place[mesh.vertex[v].code] = static_cast<int>(v);
  std::vector<std::pair<VertexId, Vec3>> joined;
  joined.reserve(kept.size() + mesh.points.size());
  std::size_t i = 0;
  for (const int v : place) {
    if (v < 0) continue;
    while (i < kept.size() && kept[i].first < mesh.vertex[v]) joined.push_back(kept[i++]);
    if (i < kept.size() && kept[i].first == mesh.vertex[v]) ++i;
    joined.emplace_back(mesh.vertex[v], mesh.points[v]);
  }
  joined.insert(joined.end(), kept.begin() + static_cast<std::ptrdiff_t>(i), kept.end());
  kept = std::move(joined);
}

void HybridMesh::set_level_positions(int j, const QuadMesh& mesh) {
  if (j < 0 || j > max_level) throw Error(ErrorCode::InvalidInput, "a level out of range");
  if (static_cast<int>(level_positions_.size()) <= j) level_positions_.resize(j + 1);
  merge_positions(level_positions_[j], mesh);
}

void HybridMesh::set_final_positions(const QuadMesh& mesh) { merge_positions(final_positions_, mesh); }

void HybridMesh::clear_positions() {
  level_positions_.clear();
  final_positions_.clear();
}

bool HybridMesh::has_level_positions(int j) const { return j >= 0 && j < static_cast<int>(level_positions_.size()) && !level_positions_[j].empty(); }

}  // namespace hybrid_mesh
