// SPDX-License-Identifier: GPL-3.0-or-later
#include "wavelets/region_motion.h"

#include <algorithm>
#include <array>

#include "decoder/disjoint_sets.h"
#include "subdivision/harmonic_extension.h"
#include "wavelets/star_motion.h"

namespace hybrid_mesh {

namespace {

using Edges = std::vector<std::array<int, 2>>;

// Edges with an end in a region, each once.
Edges region_edges(const QuadMesh& mesh, const std::vector<int>& place) {
  Edges edges;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int64_t begin = mesh.offsets[f], count = mesh.offsets[f + 1] - begin;
    for (std::int64_t i = 0; i < count; ++i) {
      const int a = mesh.indices[begin + i], b = mesh.indices[begin + (i + 1) % count];
      if (place[a] < 0 || place[b] < 0) edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

// Positions and motions, of the rims to begin with.
struct Fields {
  std::vector<Vec3> before, after;
  std::array<std::vector<Vec3>, 3> rotation;  // columns
  std::vector<Vec3> scale;                    // the same thrice

  explicit Fields(const std::vector<Vec3>& points) : before(points), after(points), scale(points.size(), Vec3::Ones()) {
    for (int i = 0; i < 3; ++i) rotation[i].assign(points.size(), Vec3::Unit(i));
  }
  void set(int vertex, const Motion& motion) {
    for (int i = 0; i < 3; ++i) rotation[i][vertex] = motion.rotation.col(i);
    scale[vertex].setConstant(motion.scale);
  }
  void extend(const Edges& edges, const std::vector<Known>& known) {
    for (std::vector<Vec3>* field : {&before, &after, &rotation[0], &rotation[1], &rotation[2], &scale}) extend_harmonically(edges, known, *field);
  }
  // A mean of rotations is none.
  Motion motion(int vertex) const {
    Eigen::Matrix3d mean;
    for (int i = 0; i < 3; ++i) mean.col(i) = rotation[i][vertex];
    return {nearest_rotation(mean), scale[vertex].x()};
  }
};

}  // namespace

void move_regions(const QuadMesh& mesh, const std::vector<int>& place, const QuadMesh& outer, const std::vector<Vec3>& outer_after,
                  std::vector<Vec3>& after) {
  const Edges edges = region_edges(mesh, place);
  if (edges.empty()) return;
  const auto count = static_cast<int>(place.size());
  DisjointSets regions(place.size());
  for (const auto& [a, b] : edges)
    if (place[a] < 0 && place[b] < 0) regions.join(a, b);
  std::vector<char> changed(outer.vertex_count());
  for (std::size_t v = 0; v < changed.size(); ++v) changed[v] = outer.points[v] != outer_after[v];

  const VertexStars stars(outer);
  Fields fields(mesh.points);
  std::vector<char> moves(place.size(), 0);  // by what stands for the region
  for (const auto& edge : edges)
    for (int i = 0; i < 2; ++i) {
      const int rim = edge[i], inside = edge[1 - i];
      if (place[rim] < 0 || !stars.any(changed, place[rim])) continue;
      moves[regions.find(inside)] = 1;
      fields.after[rim] = after[rim];
      fields.set(rim, stars.motion(place[rim], outer.points, outer_after));
    }
  std::vector<Known> known(place.size(), Known::Yes);
  for (int v = 0; v < count; ++v)
    if (place[v] < 0) known[v] = moves[regions.find(v)] ? Known::No : Known::Absent;
  fields.extend(edges, known);
  for (int v = 0; v < count; ++v)
    if (known[v] == Known::No) after[v] = fields.after[v] + fields.motion(v)(mesh.points[v] - fields.before[v]);
}

}  // namespace hybrid_mesh
