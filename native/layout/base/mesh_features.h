// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/edit_mesh.h"
#include "surface/feature_graph.h"

namespace hybrid_mesh {

// The feature curves of a surface on its mesh, while that is decimated. A curve's edges go by their names, which stay as long as a curve's vertices
// are collapsed along it and its edges are not flipped; then a curve is left as a chain of fewer edges between the same corners.
class MeshFeatures {
 public:
  MeshFeatures() = default;
  // `mesh`: of the surface, as it was when nothing was collapsed.
  MeshFeatures(const TriangleSurface& surface, const FeatureGraph& graph, const EditMesh& mesh);

  bool empty() const { return curve_.empty(); }
  bool on(const EditMesh& mesh, int h) const { return !curve_.empty() && curve_[mesh.edge[h]] >= 0; }
  bool is_on_curve(int v) const { return !on_curve_.empty() && on_curve_[v]; }
  bool is_corner(int v) const { return !corner_.empty() && corner_[v]; }
  // Of an edge's name, -1: of none. A curve runs from corner to corner, or is closed.
  const std::vector<int>& curves() const { return curve_; }
  int curve_count() const { return curve_count_; }
  std::vector<char> marks() const;  // per edge name

  // Would the curves stay what they are?
  bool can_collapse(const EditMesh& mesh, int h) const;
  // Would no triangle get two edges of one curve? Its corner between them would have a straight angle.
  bool keeps_room(const EditMesh& mesh, int h) const;
  bool can_flip(const EditMesh& mesh, int h) const;  // both
  // The half-edges from v along its curve.
  std::vector<int> along(const EditMesh& mesh, int v) const;
  // The half-edges from `v` that bound the sector of a half-edge from it, counter-clockwise from the first to the second (-1 behind the boundary);
  // the half-edge itself twice if no curve goes through v.
  struct Sector {
    int first, last;
  };
  Sector sector(const EditMesh& mesh, int h) const;
  // Its angle in radians, pi where the curve goes on, and its triangles.
  double sector_angle(const EditMesh& mesh, const std::vector<Vec3>& points, const Sector& sector) const;
  // How many quads belong there: one a right angle, at least one.
  int regular_quads(const EditMesh& mesh, const std::vector<Vec3>& points, const Sector& sector) const;
  static int sector_triangles(const EditMesh& mesh, const Sector& sector);

 private:
  std::vector<int> curve_;               // per edge name
  std::vector<char> on_curve_, corner_;  // per vertex
  int curve_count_ = 0;
};

}  // namespace hybrid_mesh
