// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "layout/base/quad_layout.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// Pulls the curves of a quad layout, which lie on edges of the decimated `mesh`, back to the fine surface by undoing `log`, last operation first, and
// cuts the surface along them. The curves stay disjoint by combinatorics alone: every step replaces one star or quadrilateral, in which the curves
// are non-crossing chords. Sides on feature curves are the fine surface's own edges there; no other side meets them but at nodes. `mesh` is the fine
// mesh again afterwards.
PatchedSurface cut_along_layout(const TriangleSurface& surface, EditMesh& mesh, const MeshFeatures& features, const std::vector<MeshEdit>& log,
                                const QuadLayout& layout, const Progress& progress);

// Cuts a disk along the curves of a layout drawn as straight segments in the plane: `corners` holds where the faces' corners lie there, a bijective
// map. Segments meet at nodes only, and nodes are vertices of the mesh. Decisions are exact, so that the curves are disjoint whatever the roundings.
// The edges that curves name are ignored.
PatchedSurface cut_along_segments(const TriangleSurface& disk, const std::vector<Vec2>& uv, const QuadLayout& layout);

}  // namespace hybrid_mesh
