// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "layout/curves/surface_paths.h"
#include "layout/drawn/patch_layout.h"
#include "surface/closest_point.h"

namespace hybrid_mesh {

// A stroke brought to the surface, or a piece of it if it left the surface in between.
struct ProjectedStroke {
  int stroke = -1;
  std::vector<FacePoint> points;
  std::array<bool, 2> at_boundary{false, false};  // it was cut off there because it goes on beyond the surface
};

// Brings strokes to a surface of unit size.
class StrokeProjection {
 public:
  // `step`: between neighbouring points; `snap`: length of what counts for nothing; `reach`: how far a stroke may be from the surface.
  struct Options {
    double step, snap, reach;
  };
  StrokeProjection(const TriangleSurface& surface, const Options& options);

  // Nothing, and a problem, for a stroke that cannot be used.
  std::vector<ProjectedStroke> operator()(int number, const std::vector<Vec3>& stroke, std::vector<LayoutProblem>& problems) const;

 private:
  struct Sample {
    Vec3 drawn, on_surface;
    double distance = 0;
    int face = -1;
    bool boundary = false;
  };
  bool on_boundary(int face, const std::array<double, 3>& weights) const;
  Sample sample(const Vec3& p, int guess) const;
  Sample nearby(const Vec3& p, const Sample& before) const;
  Vec3 normal(int face) const;
  std::vector<Sample> samples(const std::vector<Vec3>& stroke) const;

  const TriangleSurface& surface_;
  Options options_;
  SurfaceDistanceQuery query_;
  std::vector<char> boundary_point_;  // per point of the surface
};

}  // namespace hybrid_mesh
