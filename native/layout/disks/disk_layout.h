// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/context.h"

namespace hybrid_mesh {

// Quads that fill a disk. Nodes 0 .. n - 1 are its boundary, counter-clockwise, n .. n + inner_nodes - 1 lie inside.
struct DiskLayout {
  std::vector<std::array<int, 4>> quads;  // corners, counter-clockwise
  int inner_nodes = 0;
};

// Fills a disk whose boundary has as many edges as there are numbers given: an even number, at least four. quads_at[i] is the wished number of quads
// at boundary node i: 1 at a convex corner, 2 where the boundary is straight, 3 at a reflex corner; less than 1 counts as 1, more than 8 as 8. In
// this order: the wishes are kept (where they cannot be, the sum of the differences is small), few inner nodes have other than four quads (they have
// three or five), and there are few quads. A pattern that a regular grid fills gets that grid, be it a rectangle or any other rectilinear shape. The
// layout depends on the wishes in their cyclic order alone. Throws Error{InvalidInput} for an odd number of edges or fewer than four. Reports no
// progress, but can be cancelled: hundreds of edges may take minutes.
DiskLayout fill_disk(const std::vector<int>& quads_at, const Progress& progress);

// Fills a disk with so many boundary edges, a ring of quads along them first: two quads at every boundary node, and no two of these nodes joined
// inside. Throws as above.
DiskLayout fill_disk_with_ring(int edges, const Progress& progress);

}  // namespace hybrid_mesh
