// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/context.h"
#include "parameterization/patch_gluing.h"

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
std::optional<PatchRegion> make_region(const PatchedSurface& surface, const std::vector<int>& patches, PatchSide start = {});

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
LayoutEdit tower_edit(const PatchedSurface& surface, const PatchRegion& region, int rings);
// The number of rings that makes a tower's quads about square: the depth of the region, from its boundary to the point farthest from it, over the
// mean length of its boundary sides.
int tower_height(const PatchedSurface& surface, const PatchRegion& region);

// A new layout for a region and where its sides lie.
struct DrawnEdit {
  LayoutEdit edit;
  PatchedSurface piece;  // the region cut along the new quads' sides
};
// New quads of even size that follow the region's shape, found by decimating it; about `quads`. Nothing if there are none that keep its boundary.
std::optional<DrawnEdit> even_edit(const PatchedSurface& surface, const PatchRegion& region, double quads, std::uint64_t seed,
                                   const Progress& progress);

// By how many inner nodes with other than four quads would the edit raise their number? Nothing if it changed an inner node to fewer than 3 or more
// than 6 quads, or a boundary node to more than 4. `valence` and `on_boundary`: of the surface's nodes.
std::optional<int> irregular_growth(const PatchedSurface& surface, const PatchRegion& region, const LayoutEdit& edit, const std::vector<int>& valence,
                                    const std::vector<char>& on_boundary);
// Quads around each node.
std::vector<int> node_valences(const PatchedSurface& surface);
std::vector<char> boundary_nodes(const PatchedSurface& surface);

// What an edit does to the numbers of patches and nodes; a removed one has -1.
struct LayoutChange {
  std::vector<int> added;        // per new quad: its patch
  std::vector<int> patch, node;  // per old one: its new number. New inner nodes follow the old nodes
};
// Applies an edit to the nodes and neighbours alone. The new quads take the numbers of the old ones, then further ones; holes are filled with the
// last patches; nodes are numbered densely in the order of their first use: all depends on the layout alone. Throws Error{Internal} if the region is
// no disk.
LayoutChange change_layout(PatchedSurface& layout, const LayoutEdit& edit);
// An edit of other patches that was found before `change`.
LayoutEdit renumbered(LayoutEdit edit, const LayoutChange& change);

// Applies an edit: the region is mapped to a convex polygon, the new quads are drawn in it with straight sides, and the surface is cut along them.
// The quads' maps are left to map_patches, and `mapped.corners` has entries for all faces. Throws Error{Internal} if the region's map degenerates.
LayoutChange apply_edit(MappedSurface& mapped, const LayoutEdit& edit);
LayoutChange apply_edit(MappedSurface& mapped, DrawnEdit edit);

}  // namespace hybrid_mesh
