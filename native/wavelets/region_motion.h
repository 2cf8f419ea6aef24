// SPDX-License-Identifier: GPL-3.0-or-later
// Private to wavelets/.
#pragma once

#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// `mesh` and `outer` are a level before and after its operations, in either order. `place` has the vertex of `outer` for each of `mesh`, -1 for those
// of regions that `outer` does not have. `after` has where the vertices of `outer` go already, and gets where those of the regions go: their
// differences from the harmonic extension of their region's rim are carried to the new rim's, and turn with the harmonic extension of the motions of
// the rim's stars in `outer`. A region whose rim has no star that changes stays as it is.
void move_regions(const QuadMesh& mesh, const std::vector<int>& place, const QuadMesh& outer, const std::vector<Vec3>& outer_after,
                  std::vector<Vec3>& after);

}  // namespace hybrid_mesh
