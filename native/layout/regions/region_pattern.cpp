// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/region_pattern.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>

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

// The pieces that quads form, once their sides have been matched: which rims they have, and what else tells their topology.
std::vector<RegionPiece> pieces_of(const std::vector<std::array<int, 4>>& quads, const Sides& sides, const PatchRegion& region) {
  const int corners = static_cast<int>(region.corners.size());
  std::vector<RegionPiece> pieces;
  std::vector<int> piece(quads.size(), -1);
  for (std::size_t first = 0; first < quads.size(); ++first) {
    if (piece[first] >= 0) continue;
    const int number = static_cast<int>(pieces.size());
    RegionPiece& p = pieces.emplace_back();
    p.euler = 0;
    std::vector<int> stack{static_cast<int>(first)};
    std::set<int> nodes;
    std::map<int, int> open;  // sides on open loops: from node to node
    piece[first] = number;
    int half_sides = 0;
    while (!stack.empty()) {
      const int q = stack.back();
      stack.pop_back();
      ++p.euler;
      for (int i = 0; i < 4; ++i) {
        const int a = quads[q][i], b = quads[q][(i + 1) % 4];
        nodes.insert(a);
        const auto other = sides.find({b, a});
        half_sides += other == sides.end() ? 2 : 1;
        if (other == sides.end()) {
          if (a < corners && b == region.next(a)) {
            const auto rim = std::find(region.rims.begin(), region.rims.end() - 1, a);
            if (rim != region.rims.end() - 1) p.rims.push_back(static_cast<int>(rim - region.rims.begin()));
          } else {
            open[a] = b;
          }
        } else if (piece[other->second.patch] < 0) {
          piece[other->second.patch] = number;
          stack.push_back(other->second.patch);
        }
      }
    }
    p.euler += static_cast<int>(nodes.size()) - half_sides / 2;
    for (; !open.empty(); ++p.open_loops)
      for (auto at = open.begin(); at != open.end();) {
        const int to = at->second;
        open.erase(at);
        at = open.find(to);
      }
    std::sort(p.rims.begin(), p.rims.end());
  }
  return pieces;
}

std::string describe(const std::vector<RegionPiece>& pieces) {
  std::string text;
  for (const RegionPiece& p : pieces) {
    const int loops = static_cast<int>(p.rims.size()) + p.open_loops;
    text += (text.empty() ? "" : " and ") + std::string("a piece of Euler number ") + std::to_string(p.euler) + " with " + std::to_string(loops) +
            (loops == 1 ? " boundary" : " boundaries");
  }
  return text;
}

bool precedes(const RegionPiece& a, const RegionPiece& b) {
  return std::tie(a.rims, a.euler, a.open_loops) < std::tie(b.rims, b.euler, b.open_loops);
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
  const std::vector<int> corner = corner_of_node(graph, region);
  std::vector<char> inside(graph.patch_count(), 0);
  for (const int q : region.patches) inside[q] = 1;
  std::set<std::pair<int, int>> joined;
  for (int q = 0; q < graph.patch_count(); ++q)
    for (int i = 0; i < 4 && !inside[q]; ++i) {
      const int a = corner[graph.nodes[q][i]], b = corner[graph.nodes[q][(i + 1) % 4]];
      if (a >= 0 && b >= 0 && a != region.next(b)) joined.insert({{a, b}, {b, a}});
    }
  return joined;
}

LayoutEdit automatic_edit(const QuadGraph& graph, const PatchRegion& region, const Progress& progress) {
  const std::vector<int> wanted = regular_quads(graph, region);
  const int corners = static_cast<int>(wanted.size());
  // A disk in each rim.
  const auto filled = [&](const auto& fill) {
    LayoutEdit edit = edit_of(region);
    for (int r = 0; r < region.rim_count(); ++r) {
      const int first = region.rims[r], around = region.rims[r + 1] - first;
      const DiskLayout filling = fill(std::vector<int>(wanted.begin() + first, wanted.begin() + first + around));
      for (std::array<int, 4> quad : filling.quads) {
        for (int& k : quad) k = k < around ? first + k : corners + edit.inner_nodes + k - around;
        edit.quads.push_back(quad);
      }
      edit.inner_nodes += filling.inner_nodes;
    }
    return edit;
  };
  LayoutEdit edit = filled([&](const std::vector<int>& quads_at) { return fill_disk(quads_at, progress); });
  if (find_edit_defect(graph, region, edit).empty()) return edit;
  LayoutEdit ringed = filled([&](const std::vector<int>& quads_at) { return fill_disk_with_ring(static_cast<int>(quads_at.size()), progress); });
  return find_edit_defect(graph, region, ringed).empty() ? ringed : edit;
}

bool is_annulus(const PatchRegion& region) {
  if (region.pieces.size() != 1) return false;
  const RegionPiece& piece = region.pieces.front();
  return piece.euler == 0 && piece.rims.size() + piece.open_loops == 2;
}

bool has_rings(const PatchRegion& region) {
  const int first = region.rims[1], all = static_cast<int>(region.corners.size());
  return is_annulus(region) && (all == first || all == 2 * first);
}

namespace {

// Rings from the first rim to the second, or to an open loop of as many sides.
LayoutEdit ring_edit(const PatchRegion& region, int rows, int shift, std::vector<int>& spoke) {
  const int n = region.rims[1], all = static_cast<int>(region.corners.size());
  const bool open = all == n;
  LayoutEdit edit = edit_of(region);
  edit.inner_nodes = n * (open ? rows : rows - 1);
  const auto node = [&](int i, int row) {
    i %= n;
    if (row == 0) return i;
    return row == rows && !open ? n + ((shift - i) % n + n) % n : all + n * (row - 1) + i;
  };
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < n; ++i) edit.quads.push_back({node(i, row), node(i + 1, row), node(i + 1, row + 1), node(i, row + 1)});
  spoke.clear();
  for (int row = 0; row <= rows; ++row) spoke.push_back(node(0, row));
  return edit;
}

// An annulus between two rims cut open from corner 0 of the first to corner `shift` of the second, filled as a disk, and closed again.
LayoutEdit cut_annulus_edit(const QuadGraph& graph, const PatchRegion& region, int rows, int shift, std::vector<int>& spoke,
                            const Progress& progress) {
  const int n = region.rims[1], all = static_cast<int>(region.corners.size()), m = all - n;
  const std::vector<int> wanted = regular_quads(graph, region);
  std::vector<int> cut{0};  // nodes along it
  for (int row = 1; row < rows; ++row) cut.push_back(all + row - 1);
  cut.push_back(n + shift);
  std::vector<int> node, quads_at;  // around the disk
  const auto add = [&](int corner, int quads) {
    node.push_back(corner);
    quads_at.push_back(std::max(1, quads));
  };
  // What a corner wants is shared by its two places.
  add(0, wanted[0] / 2);
  for (int i = 1; i < n; ++i) add(i, wanted[i]);
  add(0, (wanted[0] + 1) / 2);
  for (int row = 1; row < rows; ++row) add(cut[row], 2);
  add(n + shift, wanted[n + shift] / 2);
  for (int i = 1; i < m; ++i) add(n + (shift + i) % m, wanted[n + (shift + i) % m]);
  add(n + shift, (wanted[n + shift] + 1) / 2);
  for (int row = rows - 1; row > 0; --row) add(cut[row], 2);
  const DiskLayout filling = fill_disk(quads_at, progress);
  const int around = static_cast<int>(node.size());
  LayoutEdit edit = edit_of(region);
  edit.inner_nodes = rows - 1 + filling.inner_nodes;
  for (std::array<int, 4> quad : filling.quads) {
    for (int& k : quad) k = k < around ? node[k] : all + rows - 1 + k - around;
    edit.quads.push_back(quad);
  }
  spoke = std::move(cut);
  return edit;
}

}  // namespace

LayoutEdit rows_edit(const QuadGraph& graph, const PatchRegion& region, int rows, int shift, std::vector<int>& spoke, const Progress& progress) {
  if (!is_annulus(region)) throw Error(ErrorCode::InvalidInput, "rows need a region that is a ring, with two boundaries and no handle");
  if (has_rings(region)) return ring_edit(region, rows, shift, spoke);
  return cut_annulus_edit(graph, region, rows, shift, spoke, progress);
}

LayoutEdit template_edit(const PatchRegion& region, std::vector<std::array<int, 4>> quads) {
  const int n = static_cast<int>(region.corners.size());
  if (const std::string defect = find_filling_defect(quads, region); !defect.empty()) throw Error(ErrorCode::InvalidInput, "its new quads " + defect);
  LayoutEdit edit = edit_of(region);
  for (const auto& quad : quads) edit.inner_nodes = std::max(edit.inner_nodes, *std::max_element(quad.begin(), quad.end()) + 1 - n);
  edit.quads = std::move(quads);
  return edit;
}

std::string find_filling_defect(const std::vector<std::array<int, 4>>& quads, const PatchRegion& region) {
  const auto node = [](int n) { return "node " + std::to_string(n); };
  const int corners = static_cast<int>(region.corners.size());
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
  const bool may_be_open = std::any_of(region.pieces.begin(), region.pieces.end(), [](const RegionPiece& p) { return p.open_loops > 0; });
  if (rim != corners && !may_be_open) return "have a boundary of " + std::to_string(rim) + " sides, and the region one of " + std::to_string(corners);
  for (int k = 0; k < corners; ++k) {
    const int next = region.next(k);
    if (!sides.count({k, next}) || sides.count({next, k})) return "have no side from corner " + std::to_string(k) + " to the next";
  }
  std::vector<int> around(nodes, 0);
  for (const auto& quad : quads)
    for (const int n : quad) ++around[n];
  for (int n = corners; n < nodes; ++n)
    if (around[n] == 0) return "must number their new nodes from " + std::to_string(corners) + " on without gaps: there is no " + node(n);
  // On the boundary the fan begins at the side along it; within it may begin anywhere.
  std::vector<PatchSide> fan(nodes);
  for (const auto& [ends, side] : sides)
    if (fan[ends.first].patch < 0 || !sides.count({ends.second, ends.first})) fan[ends.first] = side;
  for (int n = 0; n < nodes; ++n)
    if (fan_size(quads, sides, fan[n]) != around[n]) return "touch themselves at " + node(n);
  std::vector<RegionPiece> found = pieces_of(quads, sides, region), wanted = region.pieces;
  std::sort(found.begin(), found.end(), precedes);
  std::sort(wanted.begin(), wanted.end(), precedes);
  if (found == wanted) return "";
  if (found.size() > wanted.size() && wanted.size() == 1) return "are not connected";
  if (region.is_disk()) return "are no disk";
  return "are " + describe(found) + ", and the region is " + describe(wanted);
}

std::string find_filling_defect(const std::vector<std::array<int, 4>>& quads, int corners) {
  PatchRegion disk;
  disk.corners.resize(corners);
  disk.rims = {0, corners};
  disk.pieces = {{{0}, 1, 0}};
  return find_filling_defect(quads, disk);
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
  std::set<std::pair<int, int>> sides;
  for (const auto& quad : edit.quads)
    for (int i = 0; i < 4; ++i) {
      ++around[quad[i]];
      sides.insert({quad[i], quad[(i + 1) % 4]});
    }
  std::vector<char> open(n + edit.inner_nodes, 0);
  for (const auto& [a, b] : sides)
    if (a >= n && !sides.count({b, a})) open[a] = 1;
  for (int k = 0; k < n + edit.inner_nodes; ++k) {
    const bool fresh = k >= n, rim = fresh ? open[k] : on_boundary[region.corners[k]];
    const int before = fresh ? 0 : valence[region.corners[k]], after = fresh ? around[k] : before - inside[k] + around[k];
    const int least = rim ? 1 : 3, most = rim ? 4 : 6;
    if (after == before || (after >= least && after <= most)) continue;
    return std::string(fresh ? "new node " : "corner ") + std::to_string(k) + " would have " + std::to_string(after) + " quads; from " +
           std::to_string(least) + " to " + std::to_string(most) + " are possible there";
  }
  return "";
}

}  // namespace hybrid_mesh
