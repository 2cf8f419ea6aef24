// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "layout/curves/surface_curves.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// Curves on a surface, the nodes where they meet, and the faces that they cut it into. The surface is split along the curves, so that each of their
// segments lies in one of its faces.
struct PatchLayout {
  struct Curve {
    int from = -1, to = -1;   // nodes
    std::vector<int> points;  // of the mesh, both ends included
    int stroke = -1;          // the stroke that it is a piece of; -1: none
    bool boundary = false;    // a piece of the surface's boundary, which has the surface on its left
  };
  struct Side {
    int curve = -1;
    bool forward = true;
  };
  struct Face {
    std::vector<std::vector<Side>> cycles;  // each counter-clockwise: the face is on the left
    int euler = 1;                          // Euler number of the face, cut out along its sides

    bool is_disk() const { return euler == 1 && cycles.size() == 1; }
    int side_count() const;  // of all cycles
  };

  TriangleSurface mesh;             // the surface, split; source_face: face of the surface
  std::vector<PointSource> source;  // per point: where it lies on the surface
  std::vector<int> face;            // per face of the mesh: the layout's
  std::vector<int> along;           // per half-edge of the mesh: the curve along it, -1: none
  std::vector<int> nodes;           // points of the mesh
  std::vector<Curve> curves;
  std::vector<Face> faces;

  int start(const Side& s) const { return s.forward ? curves[s.curve].from : curves[s.curve].to; }
  std::vector<int> points(const Side& s) const;  // from its start to its end
  bool is_quads() const;                         // all faces are disks with four sides
};

// What keeps a layout from being one of quads.
struct LayoutProblem {
  enum class Kind {
    Unusable,      // a stroke without two different points, or with one that is not finite
    OffSurface,    // a stroke that is too far from the surface
    Disconnected,  // a stroke that goes from one component to another
    Overlap,       // a stroke that runs along another one, itself, or the boundary
    BetweenNodes,  // a stroke that ends on a boundary that has its nodes, but at none of them
    Dangling,      // a curve that ends where no other does
    Uncovered,     // a component without curves
    NotADisk,      // a face with a hole or a handle
    TooFewSides,
    OddSides,
    ManySides,     // a face of more than four sides in which no quads can be drawn
    TouchesItself  // a face that has the same node at two of its corners: no map of it to a polygon is one to one
  };
  Kind kind;
  std::string message;
  std::vector<Vec3> where;  // what to mark: a point, or a line along the surface
  int stroke = -1;
  int face = -1;  // of the layout
};
const char* name_of(LayoutProblem::Kind kind);

// The layout that curves on a surface make: `curves` was made from `surface`. `nodes`: vertices that are nodes whether or not a curve ends there;
// they are numbered first. A boundary without nodes gets one. The first curves are those of `curves` that are alive, in their order.
PatchLayout make_patch_layout(const TriangleSurface& surface, const SurfaceCurves& curves, const std::vector<int>& nodes);

// Problems that can be seen from the layout itself: Dangling to TouchesItself. One that follows from another at the same face is left out.
std::vector<LayoutProblem> find_problems(const PatchLayout& layout);

// A layout of quads as the maps use it: the patches are the layout's faces, the nodes its nodes. Throws Error{InvalidInput} if a face is no disk with
// four sides. map_patches() takes the result if the layout has no problems.
PatchedSurface to_patched_surface(const PatchLayout& layout);

// A face cut out: points where it touches itself are doubled.
struct LayoutFacePart {
  TriangleSurface mesh;
  std::vector<int> face, point;         // of the layout's mesh
  std::vector<std::vector<int>> sides;  // per side of the first cycle: points of `mesh`, both ends included
};
LayoutFacePart cut_out(const PatchLayout& layout, int face);

}  // namespace hybrid_mesh
