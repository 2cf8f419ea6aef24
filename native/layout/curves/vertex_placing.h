// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/curves/surface_paths.h"

namespace hybrid_mesh {

// Makes vertices where nodes are to be: one that is there already if it is near enough, else a new one. No vertex is given twice.
class VertexPlacing {
 public:
  explicit VertexPlacing(SurfaceCurves& curves);

  void take(int v) { taken(v) = 1; }
  bool is_taken(int v) { return taken(v); }
  // On a face, or on an inner edge.
  int inside(const FacePoint& place);
  // On one of the boundary's loops (-1: any).
  int on_boundary(const Vec3& place, int loop = -1);
  // The nearest point of the boundary that is no farther than `most`; face -1: none.
  FacePoint nearest_on_boundary(const Vec3& p, double most, int loop = -1) const;
  std::vector<int> boundary_edges() const;
  int loops() const { return loops_; }
  int vertex_of_loop(int loop) const;  // any

 private:
  char& taken(int v) {
    if (v >= static_cast<int>(taken_.size())) taken_.resize(curves_.points().size(), 0);
    return taken_[v];
  }
  struct BoundaryEdge {
    int edge, loop;
  };
  int nearest_edge(const Vec3& p, double most, int loop, double& fraction) const;

  SurfaceCurves& curves_;
  SurfacePaths paths_;
  std::vector<BoundaryEdge> boundary_;
  int loops_ = 0;
  std::vector<char> taken_;  // per vertex
};

}  // namespace hybrid_mesh
