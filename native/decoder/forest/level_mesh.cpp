// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/forest/level_mesh.h"

#include <algorithm>

#include "decoder/forest/leaf_polygons.h"

namespace hybrid_mesh {

namespace {

// Numbers vertices as they are met.
class VertexNumbering {
 public:
  VertexNumbering(const QuadForest& forest, LevelMesh& mesh, std::vector<PlaceInFace>* places)
      : forest_(forest), mesh_(mesh), places_(places), index_(forest.vertex_slots(), -1) {}
  int operator()(VertexId id, int node, int side, double t) {
    int& i = index_[forest_.vertex_slot(id)];
    if (i < 0) {
      i = static_cast<int>(mesh_.vertex.size());
      mesh_.vertex.push_back(id);
      if (places_) places_->push_back({node, side, t});
    }
    return i;
  }

 private:
  const QuadForest& forest_;
  LevelMesh& mesh_;
  std::vector<PlaceInFace>* places_;
  std::vector<int> index_;
};

}  // namespace

LevelMesh QuadForest::connectivity(int cap, LevelKind kind, FaceClosure closure, std::vector<PlaceInFace>* places) const {
  LevelMesh mesh;
  std::vector<int> faces = level_faces(cap, kind);
  VertexNumbering vertex(*this, mesh, places);
  const bool sharp = has_sharp_sides();
  const auto end_face = [&](int node) {
    mesh.offsets.push_back(static_cast<std::int64_t>(mesh.indices.size()));
    mesh.node.push_back(node);
  };
  const auto of_one_level = [&] { return std::all_of(faces.begin(), faces.end(), [&](int n) { return nodes_[n].level == nodes_[faces[0]].level; }); };
  if (of_one_level()) {
    mesh.indices.reserve(4 * faces.size());
    mesh.offsets.reserve(faces.size() + 1);
    mesh.vertex.reserve(faces.size() + 64);
    for (const int n : faces) {
      for (int s = 0; s < 4; ++s) {
        mesh.indices.push_back(vertex(from(nodes_[n].half[s]), n, s, 0));
        if (sharp) mesh.sharp.push_back(is_sharp(n, s));
      }
      mesh.offsets.push_back(static_cast<std::int64_t>(mesh.indices.size()));
    }
    mesh.node = std::move(faces);
    return mesh;
  }
  const Polygons polygons = this->polygons(std::move(faces));
  mesh.conforming = polygons.conforming();
  const bool split = closure == FaceClosure::Quads && !mesh.conforming;
  const std::size_t expected_faces = split ? polygons.corners.size() : polygons.faces.size();
  mesh.indices.reserve((split ? 4 : 1) * polygons.corners.size());
  mesh.offsets.reserve(expected_faces + 1);
  mesh.node.reserve(expected_faces);
  mesh.vertex.reserve(polygons.faces.size() + 64);
  std::vector<int> loop, middles;
  std::vector<char> sharp_side;
  for (std::size_t f = 0; f < polygons.faces.size(); ++f) {
    const int node = polygons.faces[f];
    const int begin = polygons.offsets[f], count = polygons.offsets[f + 1] - begin;
    loop.clear();
    for (int i = 0; i < count; ++i) {
      const auto& corner = polygons.corners[begin + i];
      loop.push_back(vertex(corner.vertex, node, corner.side, corner.begin));
    }
    sharp_side.clear();
    for (int i = 0; i < count && sharp; ++i) sharp_side.push_back(edges_[polygons.corners[begin + i].half >> 1].sharp);
    if (split) {
      middles.clear();
      for (int i = 0; i < count; ++i) {
        const auto& corner = polygons.corners[begin + i];
        middles.push_back(vertex(VertexId(VertexId::Kind::Edge, corner.half >> 1), node, corner.side, 0.5 * (corner.begin + corner.end)));
      }
      const int centre = vertex(VertexId(VertexId::Kind::Node, node), node, -1, 0);
      for (int i = 0; i < count; ++i) {
        mesh.indices.insert(mesh.indices.end(), {loop[i], middles[i], centre, middles[(i + count - 1) % count]});
        if (sharp) mesh.sharp.insert(mesh.sharp.end(), {sharp_side[i], 0, 0, sharp_side[(i + count - 1) % count]});
        end_face(node);
      }
      continue;
    }
    // A fan from a hanging node has no triangle without area, unless a side has several. The n-gon starts there too: a fan from its first corner is
    // how many a program triangulates it.
    int apex = 0;
    for (int i = 0; i < count && count > 4 && apex == 0; ++i) {
      bool hanging = true;
      for (HalfEdge h : nodes_[node].half) hanging &= from(h) != polygons.corners[begin + i].vertex;
      if (hanging) apex = i;
    }
    std::rotate(loop.begin(), loop.begin() + apex, loop.end());
    if (sharp) std::rotate(sharp_side.begin(), sharp_side.begin() + apex, sharp_side.end());
    if (closure == FaceClosure::Triangles && count > 4) {
      for (int i = 1; i + 1 < count; ++i) {
        mesh.indices.insert(mesh.indices.end(), {loop[0], loop[i], loop[i + 1]});
        if (sharp) {
          const char first = i == 1 ? sharp_side[0] : 0, last = i + 2 == count ? sharp_side[i + 1] : 0;
          mesh.sharp.insert(mesh.sharp.end(), {first, sharp_side[i], last});
        }
        end_face(node);
      }
    } else {
      mesh.indices.insert(mesh.indices.end(), loop.begin(), loop.end());
      if (sharp) mesh.sharp.insert(mesh.sharp.end(), sharp_side.begin(), sharp_side.end());
      end_face(node);
    }
  }
  return mesh;
}

}  // namespace hybrid_mesh
