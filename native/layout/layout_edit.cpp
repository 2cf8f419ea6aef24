// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/layout_edit.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

// Whether sides join all of some patches, given in order.
bool are_joined(const QuadGraph& graph, const std::vector<int>& patches) {
  std::vector<char> reached(patches.size(), 0);
  std::vector<int> stack{patches.front()};
  std::size_t count = reached[0] = 1;
  while (!stack.empty()) {
    const int q = stack.back();
    stack.pop_back();
    for (const PatchSide& s : graph.neighbours[q]) {
      const auto at = std::lower_bound(patches.begin(), patches.end(), s.patch);
      if (at == patches.end() || *at != s.patch || reached[at - patches.begin()]) continue;
      reached[at - patches.begin()] = 1;
      stack.push_back(s.patch);
      ++count;
    }
  }
  return count == patches.size();
}

}  // namespace

std::optional<PatchRegion> make_region(const QuadGraph& graph, const std::vector<int>& patches, PatchSide start) {
  std::vector<int> sorted = patches;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return std::nullopt;
  const auto inside = [&](int q) { return std::binary_search(sorted.begin(), sorted.end(), q); };
  const auto on_rim = [&](const PatchSide& s) { return !inside(graph.neighbours[s.patch][s.side].patch); };
  int rim = 0;
  for (const int q : patches)
    for (int i = 0; i < 4; ++i) {
      if (!on_rim({q, i})) continue;
      ++rim;
      if (start.patch < 0) start = {q, i};
    }
  if (rim == 0 || !inside(start.patch) || !on_rim(start)) return std::nullopt;
  // A torus beside the disk changes neither the rim nor the count below.
  if (!are_joined(graph, sorted)) return std::nullopt;
  PatchRegion region;
  region.patches = patches;
  PatchSide at = start;
  do {
    if (static_cast<int>(region.boundary.size()) == rim) return std::nullopt;
    region.boundary.push_back(at);
    region.corners.push_back(graph.nodes[at.patch][at.side]);
    at.side = (at.side + 1) % 4;
    while (!on_rim(at)) {
      at = graph.neighbours[at.patch][at.side];
      at.side = (at.side + 1) % 4;
    }
  } while (at.patch != start.patch || at.side != start.side);
  if (static_cast<int>(region.boundary.size()) != rim) return std::nullopt;
  std::vector<int> nodes, corners = region.corners;
  for (const int q : patches) nodes.insert(nodes.end(), graph.nodes[q].begin(), graph.nodes[q].end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::sort(corners.begin(), corners.end());
  if (std::unique(corners.begin(), corners.end()) != corners.end()) return std::nullopt;
  std::set_difference(nodes.begin(), nodes.end(), corners.begin(), corners.end(), std::back_inserter(region.inner_nodes));
  const int quads = static_cast<int>(patches.size()), edges = rim + (4 * quads - rim) / 2;
  if (static_cast<int>(nodes.size()) - edges + quads != 1) return std::nullopt;
  return region;
}

LayoutEdit star_edit(const PatchRegion& region, int parity) {
  const int n = static_cast<int>(region.corners.size());
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  edit.inner_nodes = 1;
  for (int k = parity; k < n; k += 2) edit.quads.push_back({n, k, (k + 1) % n, (k + 2) % n});
  return edit;
}

LayoutEdit chord_edit(const PatchRegion& region, int from) {
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  for (const int k : {from, from + 3}) edit.quads.push_back({k % 6, (k + 1) % 6, (k + 2) % 6, (k + 3) % 6});
  return edit;
}

LayoutEdit tower_edit(const QuadGraph& graph, const PatchRegion& region, int rings) {
  const int n = static_cast<int>(region.corners.size());
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  edit.rings = rings;
  edit.inner_nodes = n * rings + static_cast<int>(region.inner_nodes.size());
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < n; ++k) edit.quads.push_back({n * r + k, n * r + (k + 1) % n, n * (r + 1) + (k + 1) % n, n * (r + 1) + k});
  const auto place = [](const std::vector<int>& nodes, int node) {
    return static_cast<int>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
  };
  for (const int q : region.patches) {
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) {
      const int corner = place(region.corners, graph.nodes[q][i]);
      quad[i] = n * rings + (corner < n ? corner : n + place(region.inner_nodes, graph.nodes[q][i]));
    }
    edit.quads.push_back(quad);
  }
  return edit;
}

std::optional<int> irregular_growth(const QuadGraph& graph, const PatchRegion& region, const LayoutEdit& edit, const std::vector<int>& valence,
                                    const std::vector<char>& on_boundary) {
  const int n = static_cast<int>(region.corners.size());
  std::vector<int> change(n, 0), fresh(edit.inner_nodes, 0);
  for (const auto& quad : edit.quads)
    for (const int k : quad) ++(k < n ? change[k] : fresh[k - n]);
  for (const int q : region.patches)
    for (const int node : graph.nodes[q]) {
      const auto at = std::find(region.corners.begin(), region.corners.end(), node);
      if (at != region.corners.end()) --change[at - region.corners.begin()];
    }
  int growth = 0;
  for (int k = 0; k < n; ++k) {
    const int node = region.corners[k], after = valence[node] + change[k];
    if (change[k] == 0) continue;
    if (on_boundary[node] ? after < 1 || after > 4 : after < 3 || after > 6) return std::nullopt;
    if (!on_boundary[node]) growth += (after != 4) - (valence[node] != 4);
  }
  for (const int v : fresh) {
    if (v < 3 || v > 6) return std::nullopt;
    growth += v != 4;
  }
  for (const int node : region.inner_nodes) growth -= valence[node] != 4;
  return growth;
}

LayoutChange change_layout(QuadGraph& layout, const LayoutEdit& edit) {
  const std::optional<PatchRegion> region = make_region(layout, edit.patches, edit.start);
  if (!region) throw Error(ErrorCode::Internal, "a region to be laid out anew is no disk");
  const int n = static_cast<int>(region->corners.size());
  const int old_count = layout.patch_count(), removed = static_cast<int>(edit.patches.size()), added = static_cast<int>(edit.quads.size());
  LayoutChange change;
  std::vector<int> holes = edit.patches;
  std::sort(holes.begin(), holes.end());
  change.patch.resize(old_count);
  std::iota(change.patch.begin(), change.patch.end(), 0);
  for (int i = 0; i < added; ++i) change.added.push_back(i < removed ? holes[i] : old_count + i - removed);
  const int count = old_count + added - removed;
  for (int i = added, last = old_count - 1; i < removed && holes[i] < count; ++i) {
    while (std::binary_search(holes.begin(), holes.end(), last)) --last;
    change.patch[last--] = holes[i];
  }
  for (const int q : edit.patches) change.patch[q] = -1;

  std::vector<std::array<int, 4>> nodes(count);
  std::vector<std::array<PatchSide, 4>> neighbours(count);
  for (int q = 0; q < old_count; ++q) {
    if (change.patch[q] < 0) continue;
    nodes[change.patch[q]] = layout.nodes[q];
    for (int i = 0; i < 4; ++i) {
      PatchSide other = layout.neighbours[q][i];
      if (other.patch >= 0) other.patch = change.patch[other.patch];
      neighbours[change.patch[q]][i] = other;
    }
  }
  std::map<std::pair<int, int>, PatchSide> side_between;
  for (int k = 0; k < added; ++k)
    for (int i = 0; i < 4; ++i) side_between[{edit.quads[k][i], edit.quads[k][(i + 1) % 4]}] = {change.added[k], i};
  for (int k = 0; k < added; ++k)
    for (int i = 0; i < 4; ++i) {
      const int a = edit.quads[k][i], b = edit.quads[k][(i + 1) % 4], q = change.added[k];
      nodes[q][i] = a < n ? region->corners[a] : layout.node_count + a - n;
      if (a < n && b == (a + 1) % n) {
        const PatchSide& rim = region->boundary[a];
        PatchSide other = layout.neighbours[rim.patch][rim.side];
        if (other.patch >= 0) {
          other.patch = change.patch[other.patch];
          neighbours[other.patch][other.side] = {q, i};
        }
        neighbours[q][i] = other;
      } else {
        const auto other = side_between.find({b, a});
        if (other == side_between.end()) throw Error(ErrorCode::Internal, "a new quad of a region has a side without a neighbour");
        neighbours[q][i] = other->second;
      }
    }
  change.node.assign(layout.node_count + edit.inner_nodes, -1);
  layout.node_count = 0;
  for (auto& corners : nodes)
    for (int& x : corners) {
      if (change.node[x] < 0) change.node[x] = layout.node_count++;
      x = change.node[x];
    }
  layout.nodes = std::move(nodes);
  layout.neighbours = std::move(neighbours);
  return change;
}

LayoutEdit renumbered(LayoutEdit edit, const LayoutChange& change) {
  for (int& q : edit.patches) q = change.patch[q];
  edit.start.patch = change.patch[edit.start.patch];
  return edit;
}

}  // namespace hybrid_mesh
