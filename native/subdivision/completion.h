// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// An adaptive hierarchy refined until all its leaves are of one level, as programs that know uniform levels alone want it. That level is the finest
// one; one more where hanging nodes have split the leaves in four, so that nothing of the final mesh is lost.
//
// Where the given hierarchy has quads of a level, these stay where they are. A uniform hierarchy is returned as it is. Names and numbers of nodes and
// vertices stay. Throws Error{Unsupported} as refine_all() does.
enum class UnrefinedQuads {
  // They go on by Catmull-Clark subdivision of the level before, sides on features being creases.
  Subdivided,
  // So do their vertices, but those that have a map are put where it has them, on the surface: the corners of large quads, too, which a fit has moved
  // off it.
  OnMaps
};
HybridMesh completed(const HybridMesh& hierarchy, UnrefinedQuads unrefined, const Progress& progress);

}  // namespace hybrid_mesh
