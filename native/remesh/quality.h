// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Shape of a mesh's quads. The scaled Jacobian of a quad is the least over its corners of the sine of the corner's angle, signed by the quad's normal
// (the cross product of its diagonals). Irregular: inner vertices where other than four faces meet.
struct QuadQuality {
  double jacobian_min = 0, jacobian_p05 = 0, jacobian_median = 0;
  double inverted = 0;  // fraction of the quads
  std::int64_t quads = 0, triangles = 0;
  std::size_t worst = 0;  // the face with the least scaled Jacobian, the first of them
};

// Of a quad by its corners; of a face that is a quad.
double scaled_jacobian(const std::array<Vec3, 4>& corners);
double scaled_jacobian(const QuadMesh& mesh, std::size_t face);

// The quads whose scaled Jacobian is not positive.
std::vector<int> inverted_quads(const QuadMesh& mesh);

QuadQuality quad_quality(const QuadMesh& mesh);

// Per vertex: is it irregular?
std::vector<char> irregular_vertices(const QuadMesh& mesh);

}  // namespace hybrid_mesh
