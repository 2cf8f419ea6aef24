// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "layout/quad_layout.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// Pulls the curves of a quad layout, which lie on edges of the decimated `mesh`, back to the fine surface by undoing `log`, last operation first, and cuts
// the surface along them. The curves stay disjoint by combinatorics alone: every step replaces one star or quadrilateral, in which the curves are
// non-crossing chords. `mesh` is the fine mesh again afterwards.
PatchedSurface cut_along_layout(const TriangleSurface& surface, EditMesh& mesh, const std::vector<MeshEdit>& log, const QuadLayout& layout, const Progress& progress);

}  // namespace hybrid_mesh
