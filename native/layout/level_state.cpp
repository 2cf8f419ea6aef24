// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/level_state.h"

#include <map>

namespace hybrid_mesh {

LevelState quadrisected(const LevelState& state) {
  LevelState finer{quadrisected(state.quads), {}, state.area, state.placement, state.surface};
  for (const QuadMap& m : state.maps)
    for (int k = 0; k < 4; ++k) finer.maps.push_back({m.map, m.square.quadrant(k)});
  return finer;
}

std::vector<PatchMap> maps_of(const LevelState& state, const std::vector<int>& quads) {
  std::map<const PatchMap*, std::vector<std::size_t>> of_map;  // places in `quads`
  for (std::size_t k = 0; k < quads.size(); ++k) of_map[state.maps[quads[k]].map.get()].push_back(k);
  std::vector<PatchMap> out(quads.size());
  for (const auto& [map, places] : of_map) {
    std::vector<DyadicSquare> squares;
    for (const std::size_t k : places) squares.push_back(state.maps[quads[k]].square);
    std::vector<PatchMap> parts = clip_map(*map, squares);
    for (std::size_t i = 0; i < places.size(); ++i) out[places[i]] = std::move(parts[i]);
  }
  return out;
}

QuadGraph part_of(const QuadGraph& graph, const std::vector<int>& part) {
  QuadGraph out;
  std::vector<int> local(graph.patch_count(), -1), node(graph.node_count, -1);
  for (std::size_t k = 0; k < part.size(); ++k) local[part[k]] = static_cast<int>(k);
  for (const int q : part) {
    std::array<int, 4> nodes;
    std::array<PatchSide, 4> neighbours;
    for (int i = 0; i < 4; ++i) {
      int& n = node[graph.nodes[q][i]];
      if (n < 0) n = out.node_count++;
      nodes[i] = n;
      const PatchSide other = graph.neighbours[q][i];
      if (other.patch >= 0 && local[other.patch] >= 0) neighbours[i] = {local[other.patch], other.side};
    }
    out.nodes.push_back(nodes);
    out.neighbours.push_back(neighbours);
  }
  return out;
}

LayoutChange apply(LevelState& state, const MappedEdit& mapped) {
  const LayoutChange change = change_layout(state.quads, mapped.edit);
  std::vector<QuadMap> maps(state.quads.patch_count());
  for (std::size_t q = 0; q < change.patch.size(); ++q)
    if (change.patch[q] >= 0) maps[change.patch[q]] = std::move(state.maps[q]);
  for (const auto& [q, map] : mapped.maps) maps[q] = {std::make_shared<const PatchMap>(map), {}};
  state.maps = std::move(maps);
  for (const int e : mapped.opens) state.surface.open[e] = true;
  return change;
}

}  // namespace hybrid_mesh
