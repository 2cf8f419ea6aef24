// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/layout_edit.h"

namespace hybrid_mesh {

using PatchSet = std::vector<char>;  // per patch of a surface whether it is in the set

// The connected parts, across sides, of a set (value 1) or of what is not in it (value 0); each sorted.
std::vector<std::vector<int>> components(const QuadGraph& graph, const PatchSet& in, char value);

// Patches that share a node with one of the given, and the given.
PatchSet dilated(const QuadGraph& graph, const PatchSet& in);

// Takes out of a set the paths, those of least energy, that join the surface's boundary loops to what is not in the set: with a loop inside it would
// be no disk. `energy`: of each patch.
void open_to_loops(const QuadGraph& graph, PatchSet& in, const std::vector<double>& energy);

// Takes out patches where the set merely touches itself at a node, the fewer ones there.
void part_at_nodes(const QuadGraph& graph, PatchSet& in);

// Disjoint regions that hold the given patches, with what they enclose, and more where their boundary would touch itself. A region has handles, or
// several rims, where the surface has handles there.
std::vector<PatchRegion> regions_around(const QuadGraph& graph, const PatchSet& in);

}  // namespace hybrid_mesh
