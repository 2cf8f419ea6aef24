// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/mirrored.h"

#include <gtest/gtest.h>

#include "base/found.h"
#include "bases.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {
namespace {

// A grid whose lower side is on the mirror.
HybridMesh half_grid(int columns, int rows) {
  HybridMesh mesh = grid(columns, rows);
  for (int x = 0; x < columns; ++x) mesh.set_on_mirror(x, 0);
  return mesh;
}

// Every vertex and face of the mesh has its mirror image, and is that one's.
void expect_symmetric(const Mirrored& m, const QuadMesh& mesh) {
  std::map<std::pair<VertexId, bool>, int> at;
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v) at[{m.origin(mesh.vertex[v]).of, m.origin(mesh.vertex[v]).is_image}] = static_cast<int>(v);
  const auto image = [&](int v) {
    const Mirrored::Origin& o = m.origin(mesh.vertex[v]);
    const auto found = at.find({o.of, !o.is_image});
    return found == at.end() ? v : found->second;
  };
  std::set<std::set<int>> faces, images;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    std::set<int> face, mirrored;
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) face.insert(mesh.indices[i]), mirrored.insert(image(mesh.indices[i]));
    faces.insert(face);
    images.insert(mirrored);
  }
  EXPECT_EQ(faces, images);
  EXPECT_EQ(faces.size(), mesh.face_count());
}

TEST(Mirrored, SharesTheVerticesOfMarkedSides) {
  HybridMesh half = half_grid(3, 2);
  half.set_sharp(1, 1);
  half.refine_uniform(2);
  const Mirrored m = mirrored(half);
  EXPECT_TRUE(find_defects(m.mesh).empty());
  EXPECT_EQ(m.mesh.base_count(), 12);
  EXPECT_EQ(m.mesh.base_vertex_count(), 4 * 5);
  EXPECT_EQ(m.mesh.leaf_counts().vertices, 13 * 17);
  EXPECT_EQ(count_mirror_sides(half), 12);
  EXPECT_EQ(m.mesh.root_neighbour(1, 0), (SideLink{7, 3}));
  EXPECT_TRUE(m.mesh.is_sharp(1, 1));
  EXPECT_TRUE(m.mesh.is_sharp(7, 2));
  for (int j = 0; j <= 2; ++j) expect_symmetric(m, m.mesh.level_mesh(j));
}

TEST(Mirrored, AdaptiveLeavesAreBalancedAndClosedOnBothSides) {
  for (const FaceClosure closure : {FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles}) {
    HybridMesh half = half_grid(4, 3);
    half.set_closure(closure);
    half.refine_balanced(0);
    half.refine_balanced(half.first_child(0));
    const Mirrored m = mirrored(half);
    EXPECT_TRUE(find_defects(m.mesh).empty());
    const QuadMesh mesh = m.mesh.final_mesh();
    expect_symmetric(m, mesh);
    const TopologySummary t = summarize_topology(to_soup(mesh));
    EXPECT_EQ(t.nonmanifold_edges + t.nonmanifold_vertices + t.misoriented_edges, 0);
    EXPECT_EQ(t.euler, 1);
    EXPECT_EQ(m.mesh.closed_vertex_count(),
              closure == FaceClosure::Quads ? static_cast<std::int64_t>(mesh.vertex_count()) : m.mesh.closed_vertex_count());
  }
}

TEST(Mirrored, WithoutMarkedSidesIsTwoPieces) {
  const Mirrored m = mirrored(cube());
  EXPECT_TRUE(find_defects(m.mesh).empty());
  EXPECT_EQ(m.mesh.base_vertex_count(), 16);
}

TEST(Mirrored, OperationsAreDoneOnBothSidesAsOne) {
  // A quad becomes five: one within a ring. In the second case it is beside the mirror.
  for (const int quad : {4, 1}) {
    HybridMesh half = half_grid(3, 3);
    half.refine_uniform(1);
    const int node = half.first_child(quad) + (quad == 1 ? 0 : 2);
    Repatch repatch;
    repatch.level = 1;
    repatch.removed = {node};
    repatch.new_vertices = 4;
    for (int i = 0; i < 4; ++i) repatch.boundary.push_back(half.corner(node, i));
    for (int i = 0; i < 4; ++i) repatch.quads.push_back({i, (i + 1) % 4, -1 - (i + 1) % 4, -1 - i});
    repatch.quads.push_back({-1, -2, -3, -4});
    ASSERT_EQ(half.apply(repatch), "");
    half.refine_uniform(2);
    const Mirrored m = mirrored(half);
    EXPECT_TRUE(find_defects(m.mesh).empty());
    ASSERT_EQ(m.mesh.operation_count(), 1);
    EXPECT_EQ(m.mesh.operation(0).roots.size(), 10U);
    EXPECT_EQ(m.mesh.operation(0).repatch.removed.size(), 2U);
    for (int j = 0; j <= 2; ++j) expect_symmetric(m, m.mesh.level_mesh(j));
    EXPECT_EQ(m.mesh.leaf_counts().faces, 2 * half.leaf_counts().faces);
    EXPECT_EQ(m.mesh.leaf_counts().euler, 1);
  }
}

}  // namespace
}  // namespace hybrid_mesh
