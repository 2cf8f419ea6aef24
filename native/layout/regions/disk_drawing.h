// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/regions/region_surface.h"

namespace hybrid_mesh {

// Draws an edit's new quads in a disk, which is mapped to a convex polygon; in it their sides are straight, or in rings around its tip for a tower.
// `disk` gets further points in its inside. Returns it cut along the quads' sides: a patch each, its sources name points, its faces faces of `disk`.
// The boundary stays as it is. Throws NoMap if the map degenerates.
PatchedSurface draw_quads(RegionSurface& disk, const LayoutEdit& edit);

// The source of a point that was given in points which have sources themselves.
PointSource traced(const PointSource& point, const std::vector<PointSource>& sources);

// Lengths of shortest paths along edges from some vertices.
std::vector<double> edge_distances(const TriangleSurface& mesh, const std::vector<int>& from);
double loop_length(const TriangleSurface& mesh, const std::vector<int>& loop);

}  // namespace hybrid_mesh
