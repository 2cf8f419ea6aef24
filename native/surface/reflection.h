// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/context.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A plane in which a surface is reflected: the points p with normal . p = offset. The normal has unit length.
struct MirrorPlane {
  Vec3 normal = Vec3::UnitX();
  double offset = 0;

  double height(const Vec3& p) const { return normal.dot(p) - offset; }
  // The nearest point of the plane. Of a plane across an axis its coordinate is the offset exactly, and the others are those of p.
  Vec3 onto(const Vec3& p) const;
  // The mirror image. Of a plane across an axis the other two coordinates are those of p, and with offset 0 the third one is that of p with the
  // other sign, both exactly.
  Vec3 reflected(const Vec3& p) const;
  // The axis (0 to 2) that the plane is across, exactly; -1: none.
  int axis() const;
};

// How far a surface is from its mirror image, as fractions of the surface's bounding-box diagonal: the distances of points spread over the surface,
// mirrored, to the surface.
struct Asymmetry {
  double rms = 0;
  double largest = 0;
};
Asymmetry asymmetry(const TriangleSurface& surface, const MirrorPlane& plane, const Progress& progress);

struct ReflectionSearch {
  std::optional<MirrorPlane> plane;  // none: the surface is not symmetric enough
  Asymmetry asymmetry;               // with the plane, or with the best one that was tried
};
// The plane in which a surface is most nearly its own mirror image. Planes through the centroid of its area are tried, in all directions; the most
// promising are moved to where the surface is nearest to its image. Of planes that are about as good the one across x comes first, then y, then z.
// Depends on the surface alone.
ReflectionSearch find_reflection(const TriangleSurface& surface, const Progress& progress);

}  // namespace hybrid_mesh
