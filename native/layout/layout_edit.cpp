// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/layout_edit.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

// Walks along the boundary of some patches, and tells rims from open loops.
class RegionWalk {
 public:
  RegionWalk(const QuadGraph& graph, const std::vector<int>& patches) : graph_(graph), patches_(patches), order_(patches) {
    std::sort(order_.begin(), order_.end());
    walked_.assign(4 * order_.size(), 0);
  }

  std::optional<PatchRegion> run(const std::vector<PatchSide>& starts, FreeLoops loops) {
    if (order_.empty() || std::adjacent_find(order_.begin(), order_.end()) != order_.end()) return std::nullopt;
    region_.patches = patches_;
    region_.rims = {0};
    piece_of_.assign(order_.size(), -1);
    for (std::size_t k = 0; k < order_.size(); ++k)
      if (piece_of_[k] < 0) flood(static_cast<int>(k));
    for (const PatchSide& start : starts) {
      if (start.patch < 0 || place(start.patch) < 0 || !on_boundary(start) || walked(start)) return std::nullopt;
      add_rim(walk(start));
    }
    for (const int q : patches_)
      for (int i = 0; i < 4; ++i) {
        if (!on_boundary({q, i}) || walked({q, i})) continue;
        std::vector<PatchSide> sides = walk({q, i});
        const bool free = std::all_of(sides.begin(), sides.end(), [&](const PatchSide& s) { return graph_.neighbours[s.patch][s.side].patch < 0; });
        if (free && loops == FreeLoops::Open)
          open(sides);
        else
          add_rim(sides);
      }
    std::vector<int> boundary = region_.corners;
    boundary.insert(boundary.end(), open_nodes_.begin(), open_nodes_.end());
    std::sort(boundary.begin(), boundary.end());
    if (std::adjacent_find(boundary.begin(), boundary.end()) != boundary.end()) return std::nullopt;
    for (const RegionPiece& piece : region_.pieces)
      if (piece.rims.empty()) return std::nullopt;
    count();
    return std::move(region_);
  }

 private:
  int place(int patch) const {
    const auto at = std::lower_bound(order_.begin(), order_.end(), patch);
    return at != order_.end() && *at == patch ? static_cast<int>(at - order_.begin()) : -1;
  }
  bool on_boundary(const PatchSide& s) const {
    const int other = graph_.neighbours[s.patch][s.side].patch;
    return other < 0 || place(other) < 0;
  }
  char& walked(const PatchSide& s) { return walked_[4 * place(s.patch) + s.side]; }

  void flood(int first) {
    const int piece = static_cast<int>(region_.pieces.size());
    region_.pieces.emplace_back();
    std::vector<int> stack{first};
    piece_of_[first] = piece;
    while (!stack.empty()) {
      const int k = stack.back();
      stack.pop_back();
      for (const PatchSide& s : graph_.neighbours[order_[k]]) {
        const int other = s.patch < 0 ? -1 : place(s.patch);
        if (other < 0 || piece_of_[other] >= 0) continue;
        piece_of_[other] = piece;
        stack.push_back(other);
      }
    }
  }

  std::vector<PatchSide> walk(const PatchSide& start) {
    std::vector<PatchSide> sides;
    PatchSide at = start;
    do {
      sides.push_back(at);
      walked(at) = 1;
      at.side = (at.side + 1) % 4;
      while (!on_boundary(at)) {
        at = graph_.neighbours[at.patch][at.side];
        at.side = (at.side + 1) % 4;
      }
    } while (at.patch != start.patch || at.side != start.side);
    return sides;
  }

  RegionPiece& piece(const PatchSide& s) { return region_.pieces[piece_of_[place(s.patch)]]; }

  void add_rim(const std::vector<PatchSide>& sides) {
    piece(sides[0]).rims.push_back(region_.rim_count());
    for (const PatchSide& s : sides) {
      region_.boundary.push_back(s);
      region_.corners.push_back(graph_.nodes[s.patch][s.side]);
    }
    region_.rims.push_back(static_cast<int>(region_.boundary.size()));
  }

  void open(const std::vector<PatchSide>& sides) {
    ++piece(sides[0]).open_loops;
    for (const PatchSide& s : sides) open_nodes_.push_back(graph_.nodes[s.patch][s.side]);
  }

  // Inner nodes, and the pieces' Euler numbers.
  void count() {
    std::vector<std::pair<int, int>> nodes;            // with the piece
    std::vector<int> sides(region_.pieces.size(), 0);  // half an inner one
    for (RegionPiece& p : region_.pieces) p.euler = 0;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      ++region_.pieces[piece_of_[k]].euler;
      for (int i = 0; i < 4; ++i) {
        nodes.push_back({piece_of_[k], graph_.nodes[order_[k]][i]});
        sides[piece_of_[k]] += on_boundary({order_[k], i}) ? 2 : 1;
      }
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    std::vector<int> corners = region_.corners;
    std::sort(corners.begin(), corners.end());
    for (const auto& [piece, node] : nodes) {
      ++region_.pieces[piece].euler;
      if (!std::binary_search(corners.begin(), corners.end(), node)) region_.inner_nodes.push_back(node);
    }
    for (std::size_t p = 0; p < sides.size(); ++p) region_.pieces[p].euler -= sides[p] / 2;
    std::sort(region_.inner_nodes.begin(), region_.inner_nodes.end());
  }

  const QuadGraph& graph_;
  const std::vector<int>& patches_;
  std::vector<int> order_;
  std::vector<int> piece_of_;  // by place in the order
  std::vector<char> walked_;   // per place and side
  std::vector<int> open_nodes_;
  PatchRegion region_;
};

}  // namespace

int PatchRegion::next(int corner) const {
  const int rim = static_cast<int>(std::upper_bound(rims.begin(), rims.end(), corner) - rims.begin()) - 1;
  return corner + 1 < rims[rim + 1] ? corner + 1 : rims[rim];
}

std::vector<PatchSide> PatchRegion::starts() const {
  std::vector<PatchSide> out;
  for (int r = 0; r < rim_count(); ++r) out.push_back(boundary[rims[r]]);
  return out;
}

std::optional<PatchRegion> make_region(const QuadGraph& graph, const std::vector<int>& patches, const std::vector<PatchSide>& starts,
                                       FreeLoops loops) {
  return RegionWalk(graph, patches).run(starts, loops);
}

std::optional<PatchRegion> make_disk(const QuadGraph& graph, const std::vector<int>& patches, const std::vector<PatchSide>& starts) {
  std::optional<PatchRegion> region = make_region(graph, patches, starts);
  if (region && !region->is_disk()) region.reset();
  return region;
}

LayoutEdit edit_of(const PatchRegion& region) {
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.starts = region.starts();
  return edit;
}

LayoutEdit star_edit(const PatchRegion& region, int parity) {
  const int n = static_cast<int>(region.corners.size());
  LayoutEdit edit = edit_of(region);
  edit.inner_nodes = 1;
  for (int k = parity; k < n; k += 2) edit.quads.push_back({n, k, (k + 1) % n, (k + 2) % n});
  return edit;
}

LayoutEdit chord_edit(const PatchRegion& region, int from) {
  LayoutEdit edit = edit_of(region);
  for (const int k : {from, from + 3}) edit.quads.push_back({k % 6, (k + 1) % 6, (k + 2) % 6, (k + 3) % 6});
  return edit;
}

LayoutEdit tower_edit(const QuadGraph& graph, const PatchRegion& region, int rings) {
  const int n = static_cast<int>(region.corners.size());
  LayoutEdit edit = edit_of(region);
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
  const std::optional<PatchRegion> region = make_region(layout, edit.patches, edit.starts, FreeLoops::Open);
  if (!region || region->rim_count() != static_cast<int>(edit.starts.size()))
    throw Error(ErrorCode::Internal, "there is no such region to be laid out anew");
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
      if (a < n && b == region->next(a)) {
        const PatchSide& rim = region->boundary[a];
        PatchSide other = layout.neighbours[rim.patch][rim.side];
        if (other.patch >= 0) {
          other.patch = change.patch[other.patch];
          neighbours[other.patch][other.side] = {q, i};
        }
        neighbours[q][i] = other;
      } else {
        const auto other = side_between.find({b, a});
        if (other != side_between.end()) neighbours[q][i] = other->second;
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
  for (PatchSide& start : edit.starts) start.patch = change.patch[start.patch];
  return edit;
}

}  // namespace hybrid_mesh
