// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "base/context.h"
#include "parameterization/patch_map.h"
#include "surface/closest_point.h"
#include "surface/feature_graph.h"
#include "surface/placement.h"
#include "surface/polygon_soup.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// The surface on which the base domain and the maps are built: the repaired one, placed, in triangles of at most the size that is asked for, well
// shaped where machine parts have needles. A scan's thin triangles follow its shape: mending them makes the fit worse.
struct WorkingSurface {
  TriangleSurface mesh;             // source_face: face of the repaired surface that the face lies on, or mostly if it lies on several
  std::vector<SurfacePoint> place;  // per point, on the repaired surface
  // Sharp edges that base and maps keep. No inner edge but theirs joins two of their points, or two points of curves that meet.
  FeatureGraph features;

  // Makes a map's sources, given in faces of `mesh`, name faces of the repaired surface: of a triangle that lies on several the one under its
  // middle, and corners that are beyond it are moved onto it.
  void to_repaired(PatchMap& map, const TriangleSurface& repaired) const;

  Placement placement;
  std::shared_ptr<const SurfaceDistanceQuery> query;  // of the placed repaired surface; none where the faces are its own
};

// How long the edges of a working surface are, as fractions of those of the given number of equal equilateral triangles on the same area.
struct WorkingSizes {
  double longest = 2.2;          // maps are straight within a triangle: too few of them for the quads make uneven quads
  double shortest = 0.1;         // smaller things are lost between the final quads
  double collapsible = 0.5;      // well below the longest: what is collapsed is not split again
  double tolerance = 0.002;      // distance that the surface may move: far below the error that quads of that size have
  double most_tolerance = 3e-5;  // the same as a fraction of the diagonal, for the coarsest meshes
  // Needles are mended that cover together so many times the area of an equal triangle: within one, a map can do without.
  double needle_triangles = 16;
};

// How large the triangles are to be for a mesh with so many vertices above a base of so many quads: as large as halves of the final quads, and small
// enough for the base to choose from. In numbers of equal triangles on the same area.
std::int64_t working_faces(double base_quads, std::int64_t vertices);

// `faces`: see working_faces(). Where the repaired surface's are smaller, they stay. `held`: per face of it whether nothing may be mended there;
// empty: of none. `features`: how its sharp edges are found; none: they are not kept. `quad_sizes`: of the quads on it, in unit
// size: its triangles have such sizes, too. None: both are even.
WorkingSurface make_working_surface(const TriangleSurface& repaired, const Placement& placement, std::int64_t faces, const Progress& progress,
                                    const std::vector<char>& held = {}, const std::optional<FeatureOptions>& features = {},
                                    const std::shared_ptr<const SizeField>& quad_sizes = {}, const WorkingSizes& sizes = WorkingSizes());

// Makes corners that stay of the points where the boundary in the plane across `normal` through the origin meets other boundaries.
void hold_ends_of_cut(WorkingSurface& surface, const Vec3& normal);

// Barycentrics of the point of the triangle's plane next to p, moved onto the triangle.
std::array<double, 3> weights_in_triangle(const Vec3& p, const std::array<Vec3, 3>& corners);

}  // namespace hybrid_mesh
