// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/level_state.h"

#include <map>

namespace hybrid_mesh {

LevelState quadrisected(const LevelState& state) {
  LevelState finer{quadrisected(state.quads), {}, state.area, state.placement, state.surface, state.sizes};
  for (const QuadMap& m : state.maps)
    for (int k = 0; k < 4; ++k) finer.maps.push_back({m.map, m.square.quadrant(k)});
  return finer;
}

std::vector<std::vector<int>> grouped_by_map(const LevelState& state, const std::vector<int>& quads) {
  std::map<const PatchMap*, std::size_t> number;
  std::vector<std::vector<int>> groups;
  for (std::size_t k = 0; k < quads.size(); ++k) {
    const auto [at, fresh] = number.insert({state.maps[quads[k]].map.get(), groups.size()});
    if (fresh) groups.emplace_back();
    groups[at->second].push_back(static_cast<int>(k));
  }
  return groups;
}

namespace {

// `clip` cuts the parts over some squares out of a map.
template <class Clip>
std::vector<PatchMap> cut_out(const LevelState& state, const std::vector<int>& quads, const Clip& clip) {
  std::vector<PatchMap> out(quads.size());
  for (const std::vector<int>& group : grouped_by_map(state, quads)) {
    std::vector<DyadicSquare> squares;
    for (const int k : group) squares.push_back(state.maps[quads[k]].square);
    std::vector<PatchMap> parts = clip(*state.maps[quads[group.front()]].map, squares);
    for (std::size_t i = 0; i < group.size(); ++i) out[group[i]] = std::move(parts[i]);
  }
  return out;
}

}  // namespace

std::vector<PatchMap> maps_of(const LevelState& state, const std::vector<int>& quads) { return cut_out(state, quads, clip_map); }

std::vector<PatchMap> maps_of(const LevelState& state, const std::vector<int>& quads, FaceSources& roots) {
  return cut_out(state, quads, [&](const PatchMap& map, const std::vector<DyadicSquare>& squares) {
    std::vector<PatchMap> parts = clip_by_triangles(map, squares);
    const int first = static_cast<int>(roots.face.size());
    for (PatchMap& part : parts)
      for (int& f : part.source_face) f += first;
    roots.face.insert(roots.face.end(), map.source_face.begin(), map.source_face.end());
    roots.weights.insert(roots.weights.end(), map.source.begin(), map.source.end());
    return parts;
  });
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
