// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "parameterization/quad_graph.h"

namespace hybrid_mesh {

// A disk of patches and its boundary, whose nodes are all different.
struct PatchRegion {
  std::vector<int> patches;
  std::vector<PatchSide> boundary;  // counter-clockwise
  std::vector<int> corners;         // node at the start of each boundary side
  std::vector<int> inner_nodes;
};

// The region made of some patches, its boundary beginning at `start`, a boundary side (patch -1: any). Nothing if they are no disk, their boundary
// meets a node twice, or `start` is not on it.
std::optional<PatchRegion> make_region(const QuadGraph& graph, const std::vector<int>& patches, PatchSide start = {});

// New quads for a region: a replacement of its patches that leaves its boundary as it is. It names patches and corners alone, so that the same edit
// applies to every surface with the same layout, coarse or fine.
struct LayoutEdit {
  std::vector<int> patches;
  PatchSide start;                        // the boundary side that begins at corner 0
  std::vector<std::array<int, 4>> quads;  // nodes, counter-clockwise: 0 .. n - 1 the region's corners, n .. the new ones
  int rings = 0;        // the first new nodes form so many rings inside the boundary, outermost first, node n r + k facing corner k in the r-th
  int inner_nodes = 0;  // new nodes, those of the rings included

  int growth() const { return static_cast<int>(quads.size()) - static_cast<int>(patches.size()); }
};

// The quads around an inner node: `region` has an even number of corners; the node is joined to the corners of one parity.
LayoutEdit star_edit(const PatchRegion& region, int parity);
// Two quads instead of two: the side between them joins corners `from` and `from` + 3 of six.
LayoutEdit chord_edit(const PatchRegion& region, int from);
// A cube tower: the region's quads shrunk, with rings of quads around them: skin for a feature that sticks out of the region.
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
// last patches; nodes are numbered densely in the order of their first use: all depends on the layout alone. Throws Error{Internal} if the region is
// no disk.
LayoutChange change_layout(QuadGraph& layout, const LayoutEdit& edit);
// An edit of other patches that was found before `change`.
LayoutEdit renumbered(LayoutEdit edit, const LayoutChange& change);

}  // namespace hybrid_mesh
