// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "base/context.h"
#include "base/error.h"
#include "layout/drawn/patch_layout.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A line drawn on a surface, or near it.
struct DrawnStroke {
  enum class Fit { Tight, AsDrawn };  // drawn tight to a geodesic, its ends held, unless it runs far from that; or left where it is
  std::vector<Vec3> points;
  Fit fit = Fit::Tight;
};

// Lengths are fractions of the surface's bounding-box diagonal.
struct DrawnLayoutOptions {
  double snap = 0.02;  // what ends so near to a node, a curve, the boundary or one of its corners is joined with it; what juts out by less is cut off
  double reach = 0.05;              // a stroke with a point farther from the surface is left out
  double corner_angle = 0.7;        // radians: where the boundary turns by more, it has a node
  std::vector<int> boundary_nodes;  // points of the surface on its boundary: if there are any, they are the nodes of the boundary, and no others
};

struct DrawnLayout {
  PatchLayout layout;
  std::vector<LayoutProblem> problems;
};

// Makes curves of strokes, and a layout of these. Strokes are projected to the surface; ends are joined with what they are near; where strokes cross
// is a node. Two pieces of a stroke that meet alone are one curve; pieces of two strokes that end at one another meet at a node. Nothing is guessed:
// what is wrong is named, and the layout is made as far as it goes. The result has no problems if every face is a disk with an even number of sides,
// at least four, that does not touch itself. Any scale and place. Throws Error{InvalidInput} for options out of range.
DrawnLayout make_layout(const TriangleSurface& surface, const std::vector<DrawnStroke>& strokes, const DrawnLayoutOptions& options,
                        const Progress& progress);

// Drawn curves that make no layout of quads.
class LayoutError : public Error {
 public:
  explicit LayoutError(std::vector<LayoutProblem> of)
      : Error(ErrorCode::InvalidInput, "the curves make no layout of quads: " + of.front().message), problems(std::move(of)) {}
  std::vector<LayoutProblem> problems;
};

}  // namespace hybrid_mesh
