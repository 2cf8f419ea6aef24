// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/guarded_mesh.h"

namespace hybrid_mesh {

struct NeedleOptions {
  double angle = 5;  // degrees; a triangle with a smaller one is a needle, where the surface is straight across one of its long edges
  // Area that the needles in a group of thin triangles which share edges must have together: what lies between few of the points of a scan has less.
  // 0: all faces are taken.
  double area = 0;
  double thin_angle = 22;   // degrees; triangles with a smaller one are taken too where needles are
  double flatness = 0.002;  // a face is flat with its neighbour if flipping their edge moves the surface by at most this part of their longest edge
};

// The faces among which triangles are to be mended, marked: groups of needles and thin triangles in flat and bent faces as machine parts have them,
// and the flat faces that they lie in, up to sharp edges. A scan's thin triangles follow its shape, in all directions, and are none.
// All faces of the mesh are to be released, so that it tells what can be moved at all.
std::vector<char> needle_regions(const GuardedMesh& mesh, const NeedleOptions& options);

}  // namespace hybrid_mesh
