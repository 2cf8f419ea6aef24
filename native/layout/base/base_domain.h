// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/context.h"
#include "base/tolerances.h"
#include "layout/base/decimation.h"
#include "layout/base/mesh_features.h"
#include "layout/base/quad_layout.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

struct BaseDomainOptions {
  double size = 300;  // of the base domain: its quads, plus `boundary_side` for each side on the surface's boundary
  double boundary_side = 0;
  int least = 0;  // coarsening stops before there are fewer quads
  std::uint64_t seed = 1;
  // The surface is half of one, to be joined with its mirror image along those of its boundaries that are in the plane across this normal through the
  // origin. No side but those there joins two nodes there, and they count as no sides on the boundary.
  std::optional<Vec3> mirror;
};

// Per point of a surface: it is on a boundary along which the surface is to be joined with its mirror image.
std::vector<char> points_on_mirror(const TriangleSurface& surface, const Vec3& normal);
// Whether a point of a surface of unit size is in the plane.
inline bool is_in_mirror(const Vec3& p, const Vec3& normal) { return std::abs(normal.dot(p)) < tolerance::same_place; }

// A surface, or a coarser version of it, cut into the patches of a base domain.
struct CutSurface {
  TriangleSurface coarse;   // source_face: face of the surface
  PatchedSurface patches;   // of the coarse surface: points and faces name those of it
  EditMesh collapsed;       // the surface's mesh, as coarse as the coarse surface
  std::vector<int> log;     // the half-edge collapses that made it so; empty if the coarse surface is the surface
  std::vector<int> vertex;  // per point of the coarse surface: that of the surface
  std::vector<char> sharp;  // per name of an edge of `collapsed`: is it on a feature? Empty: none is
};

// A quadrilateral base domain for a surface, found by decimating it. The size is not exceeded unless the surface's topology asks for more. Any genus,
// components, boundary loops. Feature curves are made of its sides, and their corners are nodes. Keeps a reference to the surface, which is scaled to
// a unit bounding-box diagonal.
class BaseDomain {
 public:
  BaseDomain(const TriangleSurface& surface, const FeatureGraph& features, const BaseDomainOptions& options, const Progress& progress);

  int quads() const { return static_cast<int>(decimated_.layout.quads.size()); }
  int boundary_sides() const;  // but those on the mirror
  bool has_features() const { return !features_.empty(); }
  int lacking() const { return decimated_.layout.lacking; }  // see QuadLayout
  // Pulls the base's edges back to a version of the surface that has about `vertices_a_quad` vertices a quad (infinite: the surface itself), and cuts
  // it along them. The decimated mesh, which takes as much room as the surface's, goes into the first cut; for another it is made again.
  CutSurface cut(double vertices_a_quad, const Progress& progress);

 private:
  struct Decimated {
    EditMesh mesh;
    std::vector<MeshEdit> log;
    QuadLayout layout;
  };
  Decimated decimated(double faces, const BaseDomainOptions& options, const Progress& progress) const;
  EditMesh take_mesh();

  const TriangleSurface& surface_;
  MeshFeatures curves_;          // features, and where there are some the boundary too
  MeshFeatures features_;        // with the corners of both
  std::vector<char> on_mirror_;  // see DecimationOptions
  Decimated decimated_;
  // Once a cut has its mesh: per vertex alive EditMesh::out, which also depends on edits that were tried and undone, and are not in the log.
  std::vector<std::pair<int, int>> walks_;
};

}  // namespace hybrid_mesh
