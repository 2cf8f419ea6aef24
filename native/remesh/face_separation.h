// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "remesh/crossing_faces.h"
#include "remesh/crossing_guard.h"

namespace hybrid_mesh {

// Moves vertices of faces that run through one another, one by one, each to where fewer pairs at it do: of a few places nearby and on its way from
// `before` the nearest where they do. No quad is folded by that. Vertices with `fixed` set stay. `filter`: none for all of them.
void separate_faces(QuadMesh& mesh, const std::vector<char>& fixed, const std::vector<Vec3>& before, const CrossingFilter& filter,
                    CrossingGuard& guard, const Progress& progress);

}  // namespace hybrid_mesh
