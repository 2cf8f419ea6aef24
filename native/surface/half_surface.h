// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "surface/reflection.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// The part of a surface on one side of a plane. Where the plane cuts it there is a boundary, whose points lie in the plane exactly.
struct HalfSurface {
  TriangleSurface mesh;             // source_face: face of the whole surface that the face lies on
  std::vector<SurfacePoint> place;  // per point, on the whole surface
  std::vector<char> on_plane;       // per point: it is an end of an edge of the cut, which its mirror image shares
  std::vector<char> corner;         // per point: an end of the cut, where it meets the whole surface's own boundary
  int cut_euler = 0;                // points of the cut less its edges: how many of its curves have ends
};

// Cuts a surface along a plane and keeps what is on the side of its normal. Triangles that the plane crosses are split; vertices within 2e-5 of the
// diagonal, and within a fiftieth of their shortest edge, are moved onto it. Faces in the plane go. Inner edges that join two points of the cut are
// split: with their mirror images they would be two edges between the same points. The half may have any number of pieces and cuts, also none where
// nothing crosses the plane. Throws Error{InvalidInput} if there is no surface on one of the sides.
HalfSurface cut_in_half(const TriangleSurface& whole, const MirrorPlane& plane);

// A half and its mirror image, joined along the cut: the half's points and faces come first, then those of the image that are no part of it.
TriangleSurface joined_with_image(const HalfSurface& half, const MirrorPlane& plane);

// The surface with every vertex moved to the middle between itself and the mirror image of the point that is nearest to its own image. Where what is
// nearest faces another way there is no counterpart, and a vertex moves as those around it do.
TriangleSurface averaged_with_image(const TriangleSurface& whole, const MirrorPlane& plane, const Progress& progress);

}  // namespace hybrid_mesh
