// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "decoder/transform/level_quads.h"
#include "decoder/transform/point.h"

namespace hybrid_mesh {

// What becomes of the boundary. Its edges are creases in either case.
enum class BoundaryRule {
  EdgesOnly,       // boundaries become smooth curves, cubic B-splines
  EdgesAndCorners  // vertices of one quad stay where they are
};

// Catmull-Clark subdivision of the quads of a level, with sharp sides as infinitely sharp creases.
class SubdivisionMasks {
 public:
  SubdivisionMasks(const LevelQuads& quads, std::size_t mesh_vertices, BoundaryRule boundary)
      : quads_(&quads), place_(mesh_vertices, -1), boundary_(boundary) {}

  // Weights of vertices of the mesh, each once, by ascending number.
  using Mask = std::vector<std::pair<int, double>>;
  // Where a vertex goes, the midpoint of an edge, the centre of a quad. Valid until the next one.
  const Mask& vertex_mask(int v);
  const Mask& edge_mask(int e);
  const Mask& quad_mask(int q);

  // What these give, summed up in the order of the weights. `points`: of the mesh.
  Point3 vertex_point(int v, const Point3* points);
  Point3 edge_point(int e, const Point3* points);
  Point3 quad_point(int q, const Point3* points);

 private:
  void add(int v, double weight);
  void add_quad(int q, double weight);
  const Mask& finished();
  Point3 summed(const Mask& mask, const Point3* points) const;

  const LevelQuads* quads_;
  std::vector<int> place_;  // of a vertex in mask_, -1
  BoundaryRule boundary_;
  Mask mask_;
};

}  // namespace hybrid_mesh
