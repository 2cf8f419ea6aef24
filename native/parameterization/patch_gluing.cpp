// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/patch_gluing.h"

#include <algorithm>

#include "base/error.h"
#include "decoder/disjoint_sets.h"

namespace hybrid_mesh {
namespace {

// The vertices of a map along one side, in its direction.
std::vector<int> side_chain(const PatchMap& map, int side) {
  const int across = (side + 1) % 2, along = side % 2;
  const double level = side == 1 || side == 2 ? 1 : 0;
  std::vector<int> chain;
  for (int v = 0; v < static_cast<int>(map.uv.size()); ++v)
    if (map.uv[v][across] == level) chain.push_back(v);
  std::sort(chain.begin(), chain.end(), [&](int a, int b) { return map.uv[a][along] < map.uv[b][along]; });
  if (side >= 2) std::reverse(chain.begin(), chain.end());
  return chain;
}

// The maps' points, triangles and sides, joined; the sources are left to the caller.
class Gluing {
 public:
  Gluing(const std::vector<PatchMap>& maps, const QuadGraph& graph) : maps_(maps), graph_(graph), offset_(maps.size() + 1, 0), chains_(maps.size()) {
    for (std::size_t q = 0; q < maps.size(); ++q) offset_[q + 1] = offset_[q] + static_cast<int>(maps[q].uv.size());
  }

  MappedSurface run() {
    find_chains();
    const std::vector<int> point = join_points();
    MappedSurface out;
    PatchedSurface& surface = out.surface;
    static_cast<QuadGraph&>(surface) = graph_;
    surface.mesh.points = std::move(points_);
    for (std::size_t q = 0; q < maps_.size(); ++q)
      for (const std::array<int, 3>& corners : maps_[q].triangles) {
        std::array<int, 3> face;
        std::array<Vec2, 3> uv;
        for (int i = 0; i < 3; ++i) {
          face[i] = point[offset_[q] + corners[i]];
          uv[i] = maps_[q].uv[corners[i]];
        }
        surface.mesh.faces.push_back(face);
        surface.patch.push_back(static_cast<int>(q));
        out.corners.push_back(uv);
      }
    connect_half_edges(surface.mesh);
    surface.sides.resize(maps_.size());
    for (std::size_t q = 0; q < maps_.size(); ++q)
      for (int i = 0; i < 4; ++i)
        for (const int v : chains_[q][i]) surface.sides[q][i].push_back(point[v]);
    return out;
  }

 private:
  void find_chains() {
    for (std::size_t q = 0; q < maps_.size(); ++q)
      for (int i = 0; i < 4; ++i) {
        chains_[q][i] = side_chain(maps_[q], i);
        for (int& v : chains_[q][i]) v += offset_[q];
      }
  }

  // Per vertex of a map, in their order, its point.
  std::vector<int> join_points() {
    DisjointSets joined(offset_.back());
    for (std::size_t q = 0; q < maps_.size(); ++q)
      for (int i = 0; i < 4; ++i) {
        const PatchSide other = graph_.neighbours[q][i];
        if (other.patch < 0) continue;
        const std::vector<int>&a = chains_[q][i], &b = chains_[other.patch][other.side];
        if (a.size() != b.size()) throw NoMap("the maps of two neighbouring patches do not share their side");
        for (std::size_t k = 0; k < a.size(); ++k) {
          const int x = joined.find(a[k]), y = joined.find(b[b.size() - 1 - k]);
          joined.join(std::max(x, y), std::min(x, y));
        }
      }
    std::vector<int> point(offset_.back(), -1);
    for (std::size_t q = 0; q < maps_.size(); ++q)
      for (int v = offset_[q]; v < offset_[q + 1]; ++v) {
        const int root = joined.find(v);
        if (point[root] < 0) {
          point[root] = static_cast<int>(points_.size());
          points_.push_back(maps_[q].positions[v - offset_[q]]);
        }
        point[v] = point[root];
      }
    return point;
  }

  const std::vector<PatchMap>& maps_;
  const QuadGraph& graph_;
  std::vector<int> offset_;  // of a map's vertices among all
  std::vector<std::array<std::vector<int>, 4>> chains_;
  std::vector<Vec3> points_;
};

}  // namespace

MappedSurface glue_patch_maps(const std::vector<PatchMap>& maps, const QuadGraph& graph, const std::vector<std::array<int, 3>>& repaired_faces) {
  MappedSurface out = Gluing(maps, graph).run();
  out.surface.source.resize(out.surface.mesh.points.size());
  std::vector<char> known(out.surface.mesh.points.size(), 0);
  std::size_t face = 0;
  for (const PatchMap& map : maps)
    for (std::size_t t = 0; t < map.triangles.size(); ++t, ++face) {
      const std::array<int, 3>& source = repaired_faces[map.source_face[t]];
      for (int i = 0; i < 3; ++i) {
        const int v = out.surface.mesh.faces[face][i];
        if (known[v]) continue;
        known[v] = 1;
        PointSource& s = out.surface.source[v];
        double sum = 0;
        int n = 0;
        for (int k = 0; k < 3; ++k) {
          const double w = map.source[t][3 * i + k];
          if (!(w > 0)) continue;
          s.vertices[n] = source[k];
          s.weights[n++] = w;
          sum += w;
        }
        for (double& w : s.weights) w /= sum;
      }
      out.surface.mesh.source_face.push_back(map.source_face[t]);
    }
  return out;
}

GluedMaps glue_patch_maps(const std::vector<PatchMap>& maps, const QuadGraph& graph) {
  GluedMaps out;
  out.mapped = Gluing(maps, graph).run();
  PatchedSurface& surface = out.mapped.surface;
  for (std::size_t v = 0; v < surface.mesh.points.size(); ++v) surface.source.push_back({{static_cast<int>(v), -1, -1}, {1, 0, 0}});
  for (std::size_t f = 0; f < surface.mesh.faces.size(); ++f) surface.mesh.source_face.push_back(static_cast<int>(f));
  out.faces = surface.mesh.faces;
  out.inserted.assign(surface.mesh.points.size(), 0);
  std::size_t face = 0;
  for (const PatchMap& map : maps) {
    for (std::size_t t = 0; t < map.triangles.size(); ++t, ++face)
      for (int i = 0; i < 3; ++i)
        if (map.is_inserted(map.triangles[t][i])) out.inserted[surface.mesh.faces[face][i]] = 1;
    out.on.face.insert(out.on.face.end(), map.source_face.begin(), map.source_face.end());
    out.on.weights.insert(out.on.weights.end(), map.source.begin(), map.source.end());
  }
  return out;
}

}  // namespace hybrid_mesh
