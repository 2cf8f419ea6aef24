// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "layout/base/mesh_features.h"

namespace hybrid_mesh {

struct QuadLayout;

// Quads as pairs of triangles of a mesh, and how many of them meet at its vertices.
class QuadPairs {
 public:
  struct Corners {
    std::array<int, 4> v;
  };

  bool is_pair(int f) const { return mate_[f] != f; }
  int diagonal(int f) const;
  bool is_diagonal(int h) const { return mesh_.opposite[h] >= 0 && is_pair(h / 3) && mate_[h / 3] == mesh_.opposite[h] / 3; }
  // The quad's corners from `start` half-edge (not a diagonal), counter-clockwise.
  Corners corners(int h) const;
  // The half-edge from a corner of f's quad, in the quad.
  int half_at(int f, int v) const;

  // 0 for a square; grows with corners away from right angles, folds and elongation.
  double badness(const std::array<int, 4>& q) const;

  // Number of quads around a vertex less the regular number (4 inside, 2 at the boundary), feature curves left aside.
  int excess(int v) const;
  static double valence_energy(int excess) { return excess * excess + (excess > 2 || excess < -1 ? 4.0 : 0.0); }
  // The same for the sector of from(h) that holds h, with so many quads more: of a vertex on a feature each sector counts by itself.
  double sector_energy(int h, int change) const;
  // Would the sector with so many quads fewer have fewer than it should?
  bool lacks_quads(int h, int fewer) const;
  bool is_on_mirror(int v) const { return !on_mirror_.empty() && on_mirror_[v]; }
  // On the mirror, and no end of it: with its mirror image a quad alone there would have two sides in common.
  bool is_inside_mirror(int v) const { return is_on_mirror(v) && !features_.is_corner(v); }
  // On the boundary, where it is none of the feature curves, and the number of quads that are to meet there is not given.
  bool is_on_bare_boundary(int v) const;
  bool can_collapse_on_feature(int h) const { return features_.can_collapse(mesh_, h) && mesh_.can_collapse(h); }
  // What a pair of triangles across a feature's edge costs, more than any badness of a quad: least where that edge can be taken away with them.
  double cost_across(int h) const;
  // What it costs that a pair's diagonal goes to from(h).
  double diagonal_energy(int h) const;

 protected:
  // `features`: none if null; `boundary_quads`, `on_mirror`: see QuadLayoutOptions. References are kept.
  QuadPairs(EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures* features, const std::vector<int>& boundary_quads,
            const std::vector<char>& on_mirror)
      : mesh_(mesh), points_(points), features_(features ? *features : none_), boundary_quads_(boundary_quads), on_mirror_(on_mirror) {}

  template <class Visit>
  void for_faces_at(int v, const Visit& visit) const {
    int h = mesh_.out[v];
    do {
      visit(h / 3);
      h = mesh_.ccw(h);
    } while (h >= 0 && h != mesh_.out[v]);
  }
  // The quads of these faces and vertices, which are all that are alive.
  QuadLayout layout_of(const std::vector<int>& faces, const std::vector<int>& vertices) const;

  EditMesh& mesh_;
  const std::vector<Vec3>& points_;
  const MeshFeatures none_;
  const MeshFeatures& features_;
  std::vector<int> mate_;   // per face: the other triangle of its quad, or itself
  std::vector<int> split_;  // per face that is its own mate: the boundary half-edge that holds the fourth node

 private:
  int quads_in(const MeshFeatures::Sector& sector) const;
  int regular_quads(const MeshFeatures::Sector& sector) const;
  double boundary_energy(int v, int quads) const;  // of a vertex on a bare boundary with so many quads

  const std::vector<int>& boundary_quads_;
  const std::vector<char>& on_mirror_;
};

}  // namespace hybrid_mesh
