// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/closed_components.h"

namespace hybrid_mesh {

ClosedComponents closed_components(const EditMesh& mesh) {
  constexpr int unseen = -2, open = -1;
  ClosedComponents out;
  out.of.assign(mesh.out.size(), unseen);
  for (int first = 0; first < static_cast<int>(mesh.alive.size()); ++first) {
    if (!mesh.alive[first] || out.of[mesh.origin[3 * first]] != unseen) continue;
    const int number = static_cast<int>(out.faces.size());
    std::vector<int> vertices{mesh.origin[3 * first]}, ring;
    out.of[vertices[0]] = number;
    int corners = 0;
    bool closed = true;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      closed &= !mesh.is_boundary(vertices[i]);
      mesh.ring(vertices[i], ring);
      corners += static_cast<int>(ring.size());  // as many faces where it is closed
      for (const int w : ring)
        if (out.of[w] == unseen) {
          out.of[w] = number;
          vertices.push_back(w);
        }
    }
    if (closed) {
      out.faces.push_back(corners / 3);
      continue;
    }
    for (const int v : vertices) out.of[v] = open;
  }
  for (int& c : out.of)
    if (c == unseen) c = open;  // no vertex of a face
  return out;
}

}  // namespace hybrid_mesh
