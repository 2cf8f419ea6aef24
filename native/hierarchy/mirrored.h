// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// A hierarchy and its mirror image, joined along the sides that are marked (HybridMesh::set_on_mirror()).
struct Mirrored {
  HybridMesh mesh;
  std::vector<int> node, image;  // per node of the half: itself, and its mirror image
  // Per vertex of the whole, sorted: its vertex of the half, and whether it is that one's image only. A vertex of a marked side occurs once.
  struct Origin {
    VertexId vertex, of;
    bool is_image;
  };
  std::vector<Origin> origins;
  // Of a vertex of the whole.
  const Origin& origin(VertexId vertex) const;
};

// The same refinement, operations and sharp sides on both sides; base quad q's image is base_count() + q. An operation and its image are one. A
// quad's image has its square with u and v exchanged, so that side i becomes side 3 - i. Maps and positions are left to the caller. Throws NoMap,
// with the reason, where an operation and its image are refused together.
Mirrored mirrored(const HybridMesh& half);

// The vertices of a half's mesh and of its mirror image together. `own`: of the half's; `mirror_sides`: its faces' sides on marked ones, each of them
// two edges if it `splits` them; `cut_euler`: see HalfSurface.
inline std::int64_t vertices_with_image(std::int64_t own, std::int64_t mirror_sides, bool splits, int cut_euler) {
  return 2 * own - (splits ? 2 : 1) * mirror_sides - cut_euler;
}

// Sides of leaves that are on marked sides.
std::int64_t count_mirror_sides(const HybridMesh& mesh);

}  // namespace hybrid_mesh
