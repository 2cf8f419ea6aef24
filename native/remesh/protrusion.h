// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hierarchy/hybrid_mesh.h"
#include "surface/placement.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// How far a surface sticks out of a mesh that was made of it: the largest distance of a point of the surface that lies outside the mesh. A limb that
// the mesh has lost does; the bottom of a fold that it closes does not. Outside is where the mesh's normals point, or, if the surface is closed and
// has them inwards, where they do not. `placement` brings the surface to where the mesh is.
double protrusion(const TriangleSurface& surface, const Placement& placement, const QuadMesh& mesh);

// The width of a square with the mean area of the mesh's faces.
double mean_width(const QuadMesh& mesh);

}  // namespace hybrid_mesh
