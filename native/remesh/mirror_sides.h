// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "hierarchy/hybrid_mesh.h"
#include "remesh/source.h"

namespace hybrid_mesh {

// Marks the sides of a half's hierarchy that lie in the plane across `normal` through the origin, by its maps. Throws NoMap where a side runs partly
// in the plane, or where another side of the base joins two nodes in it: with its mirror image it would be two between the same nodes. Throws NoMap
// as well where a quad has two sides there that meet, which it would have in common with its mirror image.
void mark_mirror(HybridMesh& hierarchy, const Vec3& normal);

// Marked sides of the quads of a level, to which the hierarchy is refined everywhere.
std::int64_t mirror_sides(const HybridMesh& hierarchy, int level);

// The vertices of the mesh of a hierarchy's leaves, closed as the hierarchy says; of a half with its mirror image.
std::int64_t whole_vertices(const HybridMesh& hierarchy, const Source& source);
// The vertices of a mesh, of a half with its mirror image.
std::int64_t whole_vertices(const QuadMesh& mesh, const Source& source);

}  // namespace hybrid_mesh
