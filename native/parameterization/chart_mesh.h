// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Khodakovsky, Litke, Schroeder, Globally smooth parameterizations with low distortion, 2003 (charts with transition functions).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "parameterization/distortion.h"
#include "parameterization/patched_surface.h"
#include "surface/edit_mesh.h"

namespace hybrid_mesh {

// z -> i^turns z + (x + i y): how one chart of the integer grid continues in another.
struct Transition {
  // In one word: a map has two of them a half-edge.
  std::uint64_t turns : 2 = 0;
  std::int64_t x : 31 = 0, y : 31 = 0;

  Complex operator()(const Complex& z) const { return rotate(z) + offset(); }
  Complex offset() const { return {static_cast<double>(x), static_cast<double>(y)}; }
  Complex rotate(const Complex& z) const {
    switch (turns) {
      case 0:
        return z;
      case 1:
        return {-z.imag(), z.real()};
      case 2:
        return -z;
      default:
        return {z.imag(), -z.real()};
    }
  }
  Complex rotate_back(const Complex& z) const { return Transition{(4u - turns) & 3u, 0, 0}.rotate(z); }
  Complex back(const Complex& z) const { return rotate_back(z - offset()); }
  Transition inverse() const;
  friend bool operator==(const Transition& a, const Transition& b) = default;
};
Transition operator*(const Transition& a, const Transition& b);  // first b, then a

// The transition of a patch's chart to its neighbour's across the neighbour's side.
Transition across(int side, int other_side);

// A triangle mesh whose faces lie in charts of the integer grid, glued by transitions: a piecewise linear map to the base domain that knows no patch
// boundaries. A vertex has a position in a frame of its own, and each of its corners the transition from that frame to the face's chart. Around a
// cone (an irregular base node) no frame closes: its position is 0 and its corners' transitions carry the grid points it is pinned to. Every triangle
// is counter-clockwise in its chart at all times.
class ChartMesh {
 public:
  // Slide: a vertex on the boundary or a feature, a straight line in the charts, that keeps its other coordinate.
  enum class Kind : std::uint8_t { Free, SlideU, SlideV, Pinned, Cone };

  ChartMesh() = default;
  // From patches mapped to unit squares, (u, v) a face's corner.
  ChartMesh(const PatchedSurface& surface, const std::vector<std::array<Vec2, 3>>& corners);

  // The same charts over another mesh with the same triangles: one that was collapsed from the surface `fine`. `vertex_of`: per vertex of `charts`
  // that is alive its vertex there; `sharp_edges`: per name of an edge of `collapsed` whether it is on a feature, empty for none. What was collapsed
  // comes back by undo_collapse(). Throws Error{Internal} if the triangles differ.
  ChartMesh(const ChartMesh& charts, EditMesh collapsed, const TriangleSurface& fine, const std::vector<int>& vertex_of,
            std::vector<char> sharp_edges);

  Complex at(int h) const { return corner[h](uv[mesh.origin[h]]); }  // the position of from(h) in the chart of h's face
  bool movable(int v) const { return kind[v] == Kind::Free || kind[v] == Kind::SlideU || kind[v] == Kind::SlideV; }
  std::vector<int> movable_vertices() const;  // that are alive
  // Remembered until the face or the scale changes; good until it is asked for another face's.
  const FlatTriangle& flat(int f) const;
  // Remembers those of all faces that are alive: as long as nothing but positions changes, flat() only reads, and may be called from several threads.
  void remember_flat() const;
  void forget_flat();
  void move_point(int v, const Vec3& place);  // on the surface
  // Of the edge between two vertices, as even quads count it.
  double squared_length(int a, int b) const;
  double determinant(int f) const;  // of the map from the flattened triangle
  double angle_at(int v) const;     // sum of the triangles' angles in the charts

  bool can_collapse(int h) const;  // keeps cones, pinned vertices, boundaries and features; says nothing of the map
  bool is_sharp(int h) const { return !sharp.empty() && sharp[mesh.edge[h]]; }
  bool slides_inside(int v) const { return (kind[v] == Kind::SlideU || kind[v] == Kind::SlideV) && !mesh.is_boundary(v); }
  // Would the triangles of from(h)'s star stay counter-clockwise, with determinants and 3D shapes not below the bounds?
  bool collapse_keeps_map(int h, double least_determinant, double least_shape) const;
  // Would they cover as much of the surface? Within the plane of a face, or of the two beside an edge, triangles that fold over each other have too
  // much area.
  bool collapse_keeps_area(int h) const;
  void collapse(int h);
  // Puts from(h) back, at a place where its triangles are counter-clockwise. Returns false if there is none: the vertex is back, but its star is
  // folded.
  bool undo_collapse(int h);

  // Walks around v: outgoing half-edge h of each face, neighbours in v's frame. v must not be a cone.
  template <class Visit>
  void for_star(int v, const Visit& visit) const {
    int h = mesh.out[v];
    do {
      visit(h, corner[h].back(at(EditMesh::next(h))), corner[h].back(at(EditMesh::prev(h))));
      h = mesh.ccw(h);
    } while (h >= 0 && h != mesh.out[v]);
  }

  EditMesh mesh;
  std::vector<Vec3> points;        // changed by move_point() alone
  std::vector<double> fineness;    // per vertex, of the surface's field of sizes, by which lengths count more there; empty: it has none
  std::vector<Complex> uv;         // per vertex, in its own frame
  std::vector<Kind> kind;          // per vertex
  std::vector<int> chart;          // per face: the patch whose square its chart continues
  std::vector<Transition> corner;  // per half-edge h: from the frame of from(h) to the chart of h's face
  std::vector<Transition> gluing;  // per half-edge: from the chart of its face to that of the face across
  std::vector<char> sharp;         // per name of an edge: is it on a feature? Empty: none is
  std::vector<char> held;          // per vertex: a corner of the boundary, pinned for good. Empty: none is
  double scale = 1;                // lengths are scaled so that the surface's area is the number of patches

 private:
  bool place(int v);
  double finer_on(int f) const;
  void hold_features(const std::vector<char>& corner);

  std::shared_ptr<const SizeField> sizes_;

  struct Flat {
    std::array<int, 3> corners{-1, -1, -1};
    FlatTriangle triangle;
  };
  // In the order in which they were first asked for: of the faces of a mesh that is to be uncollapsed few are alive.
  mutable std::vector<Flat> flat_;
  mutable std::vector<std::int32_t> flat_at_;  // per face, -1: never asked for
  mutable double flat_scale_ = 0;              // with which they were made
};

}  // namespace hybrid_mesh
