// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/context.h"
#include "layout/layout_edit.h"

namespace hybrid_mesh {

// How many quads of the region each of its corners must have to be regular, its quads outside being what they are; at least 1.
std::vector<int> regular_quads(const QuadGraph& graph, const PatchRegion& region);

// Pairs of corners, each in both orders, that a side outside the region joins: joined inside it as well, they would be joined twice. The region's own
// sides are left out.
std::set<std::pair<int, int>> joined_outside(const QuadGraph& graph, const PatchRegion& region);

// Quads that fill a region of disks, each found from its boundary alone: its corners become regular where they can; see find_edit_defect() for where
// they cannot. Throws Error{InvalidInput} for an odd number of boundary sides.
LayoutEdit automatic_edit(const QuadGraph& graph, const PatchRegion& region, const Progress& progress);

// Quads in rows for an annulus: from one rim to the other, `rows` of them, or from its rim to its open loop. Where the two have the same number of
// sides the rows are rings, and corner `shift` - i (counted on the second rim) is joined to corner i of the first; else they are joined at corners 0
// and `shift`, and the rest is filled as automatic_edit() would. `spoke` gets the nodes along the way from corner 0 to the other boundary.
// Throws Error{InvalidInput} for another region, or an odd number of boundary sides.
LayoutEdit rows_edit(const QuadGraph& graph, const PatchRegion& region, int rows, int shift, std::vector<int>& spoke, const Progress& progress);
bool is_annulus(const PatchRegion& region);
// Whether the rows would be rings.
bool has_rings(const PatchRegion& region);

// Given quads for the region, numbered as in LayoutEdit. Throws Error{InvalidInput} if they do not fill it.
LayoutEdit template_edit(const PatchRegion& region, std::vector<std::array<int, 4>> quads);

// Why quads, numbered as in LayoutEdit, do not fill the region: what "new_quads" does; empty if they have its rims and its topology.
std::string find_filling_defect(const std::vector<std::array<int, 4>>& quads, const PatchRegion& region);
// The same for a disk with so many corners.
std::string find_filling_defect(const std::vector<std::array<int, 4>>& quads, int corners);

// Why the surface with the edit done would be no base to refine from: a node with too few or too many quads, or two nodes joined twice; empty if it
// is one.
std::string find_edit_defect(const QuadGraph& graph, const PatchRegion& region, const LayoutEdit& edit);

}  // namespace hybrid_mesh
