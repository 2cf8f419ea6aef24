// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/region_pattern.h"

#include <algorithm>
#include <cstdint>
#include <map>

#include "base/error.h"
#include "layout/disks/disk_layout.h"

namespace hybrid_mesh {
namespace {

std::vector<int> corner_of_node(const QuadGraph& graph, const PatchRegion& region) {
  std::vector<int> corner(graph.node_count, -1);
  for (std::size_t k = 0; k < region.corners.size(); ++k) corner[region.corners[k]] = static_cast<int>(k);
  return corner;
}

// Quads of the region at each of its corners.
std::vector<int> quads_inside(const QuadGraph& graph, const PatchRegion& region) {
  const std::vector<int> corner = corner_of_node(graph, region);
  std::vector<int> count(region.corners.size(), 0);
  for (const int q : region.patches)
    for (const int n : graph.nodes[q])
      if (corner[n] >= 0) ++count[corner[n]];
  return count;
}

using Sides = std::map<std::pair<int, int>, PatchSide>;

// How many quads follow one another around a node, from the quad on the left of a side that starts there on.
int fan_size(const std::vector<std::array<int, 4>>& quads, const Sides& sides, const PatchSide& first) {
  const int node = quads[first.patch][first.side];
  PatchSide at = first;
  for (int count = 1;; ++count) {
    const auto next = sides.find({node, quads[at.patch][(at.side + 3) % 4]});
    if (next == sides.end() || (next->second.patch == first.patch && next->second.side == first.side)) return count;
    at = next->second;
  }
}

bool is_connected(const std::vector<std::array<int, 4>>& quads, const Sides& sides) {
  std::vector<char> reached(quads.size(), 0);
  std::vector<int> stack{0};
  std::size_t count = reached[0] = 1;
  while (!stack.empty()) {
    const std::array<int, 4> quad = quads[stack.back()];
    stack.pop_back();
    for (int i = 0; i < 4; ++i) {
      const auto other = sides.find({quad[(i + 1) % 4], quad[i]});
      if (other == sides.end() || reached[other->second.patch]) continue;
      reached[other->second.patch] = 1;
      stack.push_back(other->second.patch);
      ++count;
    }
  }
  return count == quads.size();
}

}  // namespace

std::vector<int> regular_quads(const QuadGraph& graph, const PatchRegion& region) {
  const std::vector<int> valence = node_valences(graph), inside = quads_inside(graph, region);
  const std::vector<char> on_boundary = boundary_nodes(graph);
  std::vector<int> wanted;
  for (std::size_t k = 0; k < region.corners.size(); ++k) {
    const int node = region.corners[k];
    wanted.push_back(std::max(1, (on_boundary[node] ? 2 : 4) - (valence[node] - inside[k])));
  }
  return wanted;
}

std::set<std::pair<int, int>> joined_outside(const QuadGraph& graph, const PatchRegion& region) {
  const int n = static_cast<int>(region.corners.size());
  const std::vector<int> corner = corner_of_node(graph, region);
  std::vector<char> inside(graph.patch_count(), 0);
  for (const int q : region.patches) inside[q] = 1;
  std::set<std::pair<int, int>> joined;
  for (int q = 0; q < graph.patch_count(); ++q)
    for (int i = 0; i < 4 && !inside[q]; ++i) {
      const int a = corner[graph.nodes[q][i]], b = corner[graph.nodes[q][(i + 1) % 4]];
      if (a >= 0 && b >= 0 && a != (b + 1) % n) joined.insert({{a, b}, {b, a}});
    }
  return joined;
}

LayoutEdit automatic_edit(const QuadGraph& graph, const PatchRegion& region, const Progress& progress) {
  const auto edit_of = [&](DiskLayout filling) {
    LayoutEdit edit;
    edit.patches = region.patches;
    edit.start = region.boundary[0];
    edit.quads = std::move(filling.quads);
    edit.inner_nodes = filling.inner_nodes;
    return edit;
  };
  LayoutEdit edit = edit_of(fill_disk(regular_quads(graph, region), progress));
  if (find_edit_defect(graph, region, edit).empty()) return edit;
  LayoutEdit ringed = edit_of(fill_disk_with_ring(static_cast<int>(region.corners.size()), progress));
  return find_edit_defect(graph, region, ringed).empty() ? ringed : edit;
}

LayoutEdit template_edit(const PatchRegion& region, std::vector<std::array<int, 4>> quads) {
  const int n = static_cast<int>(region.corners.size());
  if (const std::string defect = find_filling_defect(quads, n); !defect.empty()) throw Error(ErrorCode::InvalidInput, "its new quads " + defect);
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  for (const auto& quad : quads) edit.inner_nodes = std::max(edit.inner_nodes, *std::max_element(quad.begin(), quad.end()) + 1 - n);
  edit.quads = std::move(quads);
  return edit;
}

std::string find_filling_defect(const std::vector<std::array<int, 4>>& quads, int corners) {
  const auto node = [](int n) { return "node " + std::to_string(n); };
  if (quads.empty()) return "are none";
  const std::int64_t most = corners + 4 * static_cast<std::int64_t>(quads.size());
  for (const auto& quad : quads)
    for (const int n : quad)
      if (n < 0 || n >= most) return "have " + node(n) + ", and there can be none but those from 0 to " + std::to_string(most - 1);
  Sides sides;
  int nodes = corners;
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (int i = 0; i < 4; ++i) {
      const int a = quads[q][i], b = quads[q][(i + 1) % 4];
      if (a == b || a == quads[q][(i + 2) % 4]) return "have " + node(a) + " twice in quad " + std::to_string(q);
      if (!sides.insert({{a, b}, {static_cast<int>(q), i}}).second) return "have two sides from " + node(a) + " to " + node(b);
      nodes = std::max(nodes, a + 1);
    }
  int rim = 0;
  for (const auto& [ends, side] : sides) rim += !sides.count({ends.second, ends.first});
  if (rim != corners) return "have a boundary of " + std::to_string(rim) + " sides, and the region one of " + std::to_string(corners);
  for (int k = 0; k < corners; ++k) {
    const int next = (k + 1) % corners;
    if (!sides.count({k, next}) || sides.count({next, k})) return "have no side from corner " + std::to_string(k) + " to the next";
  }
  std::vector<int> around(nodes, 0);
  for (const auto& quad : quads)
    for (const int n : quad) ++around[n];
  for (int n = corners; n < nodes; ++n)
    if (around[n] == 0) return "must number their new nodes from " + std::to_string(corners) + " on without gaps: there is no " + node(n);
  // On the boundary the fan begins at the side to the next corner; within it may begin anywhere.
  for (const auto& [ends, side] : sides)
    if (ends.first >= corners || ends.second == (ends.first + 1) % corners)
      if (fan_size(quads, sides, side) != around[ends.first]) return "touch themselves at " + node(ends.first);
  if (!is_connected(quads, sides)) return "are not connected";
  const int edges = (4 * static_cast<int>(quads.size()) + rim) / 2;
  if (nodes - edges + static_cast<int>(quads.size()) != 1) return "are no disk";
  return "";
}

std::string find_edit_defect(const QuadGraph& graph, const PatchRegion& region, const LayoutEdit& edit) {
  const std::set<std::pair<int, int>> joined = joined_outside(graph, region);
  for (const auto& quad : edit.quads)
    for (int i = 0; i < 4; ++i)
      if (joined.count({quad[i], quad[(i + 1) % 4]}))
        return "corners " + std::to_string(quad[i]) + " and " + std::to_string(quad[(i + 1) % 4]) +
               " would be joined inside the region, and are outside it already";
  const int n = static_cast<int>(region.corners.size());
  const std::vector<int> valence = node_valences(graph), inside = quads_inside(graph, region);
  const std::vector<char> on_boundary = boundary_nodes(graph);
  std::vector<int> around(n + edit.inner_nodes, 0);
  for (const auto& quad : edit.quads)
    for (const int k : quad) ++around[k];
  for (int k = 0; k < n + edit.inner_nodes; ++k) {
    const bool fresh = k >= n, rim = !fresh && on_boundary[region.corners[k]];
    const int before = fresh ? 0 : valence[region.corners[k]], after = fresh ? around[k] : before - inside[k] + around[k];
    const int least = rim ? 1 : 3, most = rim ? 4 : 6;
    if (after == before || (after >= least && after <= most)) continue;
    return std::string(fresh ? "new node " : "corner ") + std::to_string(k) + " would have " + std::to_string(after) + " quads; from " +
           std::to_string(least) + " to " + std::to_string(most) + " are possible there";
  }
  return "";
}

}  // namespace hybrid_mesh
