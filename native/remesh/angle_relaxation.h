// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"
#include "remesh/crossing_guard.h"

namespace hybrid_mesh {

struct AngleRelaxationOptions {
  int sweeps = 20;
  double enough = 0.85;   // quads whose corners all have a sine of at least this are left alone
  double flatness = 0.9;  // a vertex moves only where the normals of its quads are within this cosine of their mean
  double reach = 100;     // how far a vertex may move in all, in lengths of its shortest edge at the start
};

// Moves vertices along the surface, in the tangent plane of the mesh, so that the corners of its quads come nearer to right angles; lengths are free.
// Vertices with `fixed` set stay. A fit should follow, which brings the vertices back onto the surface. `guard`: if there is
// one, no vertex goes where it does not allow it.
void relax_angles(QuadMesh& mesh, const std::vector<char>& fixed, const AngleRelaxationOptions& options, const Progress& progress,
                  CrossingGuard* guard = nullptr);

}  // namespace hybrid_mesh
