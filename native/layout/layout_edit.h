// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "parameterization/quad_graph.h"

namespace hybrid_mesh {

// One connected part of a region: its topology.
struct RegionPiece {
  std::vector<int> rims;  // of the region, ascending
  int euler = 1;
  int open_loops = 0;  // boundary loops of the surface that belong to it and are no rims
  friend bool operator==(const RegionPiece&, const RegionPiece&) = default;
};

// Patches that are laid out anew together, of any topology: one or several pieces, with handles, with free boundaries. Its rims are the closed walks
// along its boundary that an edit leaves as they are; no node is on the boundary twice, and every piece has a rim.
struct PatchRegion {
  std::vector<int> patches;
  std::vector<PatchSide> boundary;  // the sides of the rims, rim after rim, each walk with the region on its left
  std::vector<int> rims;            // per rim: its first side, and at the end the number of all
  std::vector<int> corners;         // node at the start of each boundary side
  std::vector<int> inner_nodes;     // all others, those of open loops included
  std::vector<RegionPiece> pieces;

  int rim_count() const { return static_cast<int>(rims.size()) - 1; }
  // The corner that follows another one on its rim.
  int next(int corner) const;
  std::vector<PatchSide> starts() const;  // the first side of each rim
  bool is_disk() const { return pieces.size() == 1 && pieces[0] == RegionPiece{{0}, 1, 0}; }
};

// Whether a boundary loop of the surface of which a region has all sides is a rim, or open: an edit may then put other nodes on it.
enum class FreeLoops { Rims, Open };

// The region made of some patches. `starts`: sides that begin its first rims, one each; further rims follow in the order of the patches, and loops
// that are not begun by one of `starts` are what `loops` says. Nothing if its boundary meets a node twice, a piece has no rim, or one of `starts` is
// not on a rim of its own.
std::optional<PatchRegion> make_region(const QuadGraph& graph, const std::vector<int>& patches, const std::vector<PatchSide>& starts = {},
                                       FreeLoops loops = FreeLoops::Rims);
// The same where only a disk will do.
std::optional<PatchRegion> make_disk(const QuadGraph& graph, const std::vector<int>& patches, const std::vector<PatchSide>& starts = {});

// New quads for a region: a replacement of its patches that leaves its rims as they are. It names patches and corners alone, so that the same edit
// applies to every surface with the same layout, coarse or fine. Sides of new quads that are neither between two of them nor on a rim are on the
// surface's boundary.
struct LayoutEdit {
  std::vector<int> patches;
  std::vector<PatchSide> starts;          // per rim the side that begins at its first corner
  std::vector<std::array<int, 4>> quads;  // nodes, counter-clockwise: 0 .. n - 1 the region's corners, n .. the new ones
  int rings = 0;        // the first new nodes form so many rings inside the boundary, outermost first, node n r + k facing corner k in the r-th
  int inner_nodes = 0;  // new nodes, those of the rings and of open loops included

  int growth() const { return static_cast<int>(quads.size()) - static_cast<int>(patches.size()); }
};
// An edit of the region that has no quads yet.
LayoutEdit edit_of(const PatchRegion& region);

// The quads around an inner node: `region` is a disk with an even number of corners; the node is joined to the corners of one parity.
LayoutEdit star_edit(const PatchRegion& region, int parity);
// Two quads instead of two: the side between them joins corners `from` and `from` + 3 of six.
LayoutEdit chord_edit(const PatchRegion& region, int from);
// A cube tower on a disk: the region's quads shrunk, with rings of quads around them: skin for a feature that sticks out of the region.
LayoutEdit tower_edit(const QuadGraph& graph, const PatchRegion& region, int rings);
// By how many inner nodes with other than four quads would the edit raise their number? Nothing if it changed an inner node to fewer than 3 or more
// than 6 quads, or a boundary node to more than 4. `valence` and `on_boundary`: of the graph's nodes.
std::optional<int> irregular_growth(const QuadGraph& graph, const PatchRegion& region, const LayoutEdit& edit, const std::vector<int>& valence,
                                    const std::vector<char>& on_boundary);
// What an edit does to the numbers of patches and nodes; a removed one has -1.
struct LayoutChange {
  std::vector<int> added;        // per new quad: its patch
  std::vector<int> patch, node;  // per old one: its new number. New inner nodes follow the old nodes
};
// Applies an edit to the nodes and neighbours alone. The new quads take the numbers of the old ones, then further ones; holes are filled with the
// last patches; nodes are numbered densely in the order of their first use: all depends on the layout alone. Throws Error{Internal} if there is no
// such region.
LayoutChange change_layout(QuadGraph& layout, const LayoutEdit& edit);
// An edit of other patches that was found before `change`.
LayoutEdit renumbered(LayoutEdit edit, const LayoutChange& change);

}  // namespace hybrid_mesh
