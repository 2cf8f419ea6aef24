// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "surface/edit_mesh.h"

namespace hybrid_mesh {

// What the costs of all collapses that take one vertex away have in common.
struct VertexStar {
  struct Spoke {
    Vec3 at;
    int half_edge;  // from the vertex, -1 for the last one at a boundary
    int end;
  };
  struct Face {
    Vec3 normal;  // the area's double long
    double area2 = 0;
  };
  std::vector<Spoke> spokes;  // counter-clockwise
  std::vector<Face> faces;    // face i between spokes i and i + 1
  std::vector<std::pair<double, int>> bounds;
  std::vector<int> around;

  void gather(const EditMesh& mesh, const std::vector<Vec3>& points, int v) {
    spokes.clear(), faces.clear();
    int g = mesh.out[v];
    do {
      spokes.push_back({points[mesh.to(g)], g, mesh.to(g)});
      const int n = mesh.ccw(g);
      if (n < 0) spokes.push_back({points[mesh.apex(g)], -1, mesh.apex(g)});
      g = n;
    } while (g >= 0 && g != mesh.out[v]);
    const std::size_t count = spokes.back().half_edge < 0 ? spokes.size() - 1 : spokes.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 normal = (points[v] - spokes[i].at).cross(points[v] - spokes[(i + 1) % spokes.size()].at);
      faces.push_back({normal, normal.norm()});
    }
  }

  // Calls visit(face, first spoke, second spoke) for the faces that moving the vertex along a spoke keeps.
  template <class Visit>
  void for_kept_faces(std::size_t spoke, const Visit& visit) const {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const std::size_t j = i + 1 == spokes.size() ? 0 : i + 1;
      if (i != spoke && j != spoke) visit(faces[i], spokes[i].at, spokes[j].at);
    }
  }
};

}  // namespace hybrid_mesh
