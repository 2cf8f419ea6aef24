// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/edit_mesh.h"

namespace hybrid_mesh {

// A row of faces, each entered across an edge of the one before, laid out in the plane, and the shortest way through it.
class FaceStrip {
 public:
  // An edge between two faces of the strip; left and right as seen on the way.
  struct Portal {
    Vec2 right, left;              // the half-edge's start and end
    Vec2 right_bound, left_bound;  // the part of it that is free
  };
  // Where the way bends: at portals first .. last, at their left bound or their right one.
  struct Bend {
    int first, last;
    bool left;
    Vec2 at;
  };

  // `half_edges`: those across which the faces are left, at least one. `start` lies in the first face, `end` in the last.
  FaceStrip(const EditMesh& mesh, const std::vector<Vec3>& points, const std::vector<int>& half_edges, const Vec3& start, const Vec3& end);

  // Leaves the part of a portal between two fractions of it free, counted from its start.
  void narrow(int portal, double from, double to);
  void find_shortest();

  const std::vector<Portal>& portals() const { return portals_; }
  const std::vector<Bend>& bends() const { return bends_; }
  double length() const;
  double turn(std::size_t bend) const;    // the angle by which the way turns there
  std::vector<double> fractions() const;  // where the way crosses the portals, from their starts

 private:
  Vec2 start_, end_;
  std::vector<Portal> portals_;
  std::vector<Bend> bends_;
};

}  // namespace hybrid_mesh
