// SPDX-License-Identifier: GPL-3.0-or-later
// The quads' maps to the surface, and where vertices lie in them.
#include <algorithm>

#include "base/error.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

void HybridMesh::set_map(int node, std::shared_ptr<const PatchMap> map) {
  auto slot = std::make_shared<const MapSlot>(std::move(map));
  if (nodes_[node].map >= 0) {
    maps_[nodes_[node].map] = std::move(slot);
  } else {
    nodes_[node].map = static_cast<int>(maps_.size());
    maps_.push_back(std::move(slot));
  }
}

std::shared_ptr<const PatchMap> HybridMesh::shared_map(int node) const { return nodes_[node].map < 0 ? nullptr : maps_[nodes_[node].map]->map; }

const PatchMap* HybridMesh::map(int node) const { return shared_map(node).get(); }

const PatchSampler* HybridMesh::sampler(int node) const { return nodes_[node].map < 0 ? nullptr : &maps_[nodes_[node].map]->sampler; }

int HybridMesh::map_owner(int node) const {
  while (node >= 0 && nodes_[node].map < 0) node = nodes_[node].parent;
  return node;
}

void HybridMesh::drop_maps() {
  maps_.clear();
  for (Node& node : nodes_) node.map = -1;
}

bool HybridMesh::has_maps() const {
  return std::any_of(nodes_.begin(), nodes_.end(), [](const Node& node) { return node.map >= 0; });
}

MapLocation HybridMesh::locate(VertexId vertex) const {
  int node = -1;
  double u = 0, v = 0;  // in `node`
  const auto on_side = [&](int side, double t) {
    static constexpr double corner_u[4] = {0, 1, 1, 0}, corner_v[4] = {0, 0, 1, 1};
    u = corner_u[side] + t * (corner_u[(side + 1) % 4] - corner_u[side]);
    v = corner_v[side] + t * (corner_v[(side + 1) % 4] - corner_v[side]);
  };
  if (vertex.kind() == VertexId::Kind::Node) {
    node = vertex.index();
    u = v = 0.5;
  } else if (vertex.kind() == VertexId::Kind::Free) {
    node = free_[vertex.index()].origin / 4;
    on_side(free_[vertex.index()].origin % 4, 0);
  } else {
    int e = vertex.index();
    double t = 0.5;  // from the edge's start
    while (true) {
      const int holder = holder_[2 * e] >= 0 ? holder_[2 * e] : holder_[2 * e + 1];
      if (holder >= 0) {
        node = holder / 4;
        on_side(holder % 4, holder_[2 * e] >= 0 ? t : 1 - t);
        break;
      }
      const int up = edges_[e].parent;
      if (up < 0) {  // of a part that is switched off
        node = edges_[e].origin / 4;
        const int k = edges_[e].origin % 4;
        on_side(k, nodes_[node].level == edges_[e].level ? t : 0.5);
        if (nodes_[node].level != edges_[e].level) {  // inner edge: from the middle of side k to the centre
          u += t * (0.5 - u);
          v += t * (0.5 - v);
        }
        break;
      }
      t = 0.5 * (t + (e - edges_[up].child));
      e = up;
    }
  }
  int owner = map_owner(node);
  if (owner < 0) owner = nodes_[node].root;
  const Square square = square_in(node, owner);
  return {owner, square.u + square.width * u, square.v + square.width * v};
}

PatchSample HybridMesh::sample(const MapLocation& location) const {
  const PatchSampler* sampler = location.node < 0 ? nullptr : this->sampler(location.node);
  if (!sampler) throw Error(ErrorCode::InvalidInput, "no map to sample");
  return (*sampler)(location.u, location.v);
}

}  // namespace hybrid_mesh
