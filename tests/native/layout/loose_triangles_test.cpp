// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/loose_triangles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "layout/base/triangle_pairing.h"

namespace hybrid_mesh {
namespace {

// Two copies of a convex polygon with so many corners, joined along all sides, which are curves: pieces with curves on both sides of every one.
TriangleSurface pillow(int corners) {
  TriangleSurface s;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    s.points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  s.points.push_back({0, 0, 0.1}), s.points.push_back({0, 0, -0.1});
  for (int i = 0; i < corners; ++i) {
    const int j = (i + 1) % corners;
    s.faces.push_back({i, j, corners});
    s.faces.push_back({j, i, corners + 1});
  }
  connect_half_edges(s);
  return s;
}

// One with a triangulation of its own on each side.
class Pillow {
 public:
  Pillow(int corners, std::mt19937& random) : surface_(pillow(corners)), mesh(surface_), features(surface_, rims(corners), mesh) {
    for (const int middle : {corners, corners + 1}) {
      int h = mesh.out[middle];
      for (int k = static_cast<int>(random() % corners); k > 0; --k) h = mesh.ccw(h);
      mesh.collapse(h);
    }
    for (int k = 0; k < 40 * corners; ++k) {
      const int h = static_cast<int>(random() % mesh.origin.size());
      if (mesh.alive[h / 3] && features.can_flip(mesh, h) && mesh.can_flip(h) && !folds(mesh, points(), h)) mesh.flip(h);
    }
    for (int f = 0; f < static_cast<int>(mesh.alive.size()); ++f)
      if (mesh.alive[f]) faces.push_back(f);
  }
  const std::vector<Vec3>& points() const { return surface_.points; }

  // Pairs as many triangles within pieces as there can be; the others across.
  std::vector<int> mates(int* across = nullptr) const {
    std::vector<int> index(mesh.alive.size(), -1), mate(mesh.alive.size(), -1);
    for (std::size_t i = 0; i < faces.size(); ++i) index[faces[i]] = static_cast<int>(i);
    std::vector<PairCandidate> candidates;
    for (const int f : faces)
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (mesh.opposite[h] > h) candidates.push_back({index[f], index[mesh.opposite[h] / 3], features.on(mesh, h) ? -1.0 : 0.0});
    const std::vector<int> choice = pair_triangles(static_cast<int>(faces.size()), candidates);
    int count = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const PairCandidate& c = candidates[choice[i]];
      mate[faces[i]] = faces[c.a == static_cast<int>(i) ? c.b : c.a];
      count += c.weight < 0;
    }
    if (across) *across = count;
    return mate;
  }

 private:
  FeatureGraph rims(int corners) const {
    FeatureGraph graph;
    graph.edges.assign(surface_.opposite.size(), 0);
    graph.corners.assign(surface_.points.size(), 1);
    for (int h = 0; h < static_cast<int>(graph.edges.size()); ++h) graph.edges[h] = surface_.from(h) < corners && surface_.to(h) < corners;
    return graph;
  }

  TriangleSurface surface_;

 public:
  EditMesh mesh;
  MeshFeatures features;
  std::vector<int> faces;
};

TEST(LooseTriangles, OfAnEvenPolygonAllFindMates) {
  std::mt19937 random(3);
  int loose = 0;
  for (int round = 0; round < 200; ++round) {
    Pillow pillow(6 + 2 * static_cast<int>(random() % 12), random);
    int across = 0;
    const std::vector<int> mates = pillow.mates(&across);
    std::vector<MeshEdit> log;
    const bool any = pair_loose_triangles(pillow.mesh, pillow.points(), pillow.features, pillow.faces, mates, log);
    EXPECT_EQ(any, across > 0);
    EXPECT_EQ(any, !log.empty());
    loose += across;
    pillow.mates(&across);
    ASSERT_EQ(across, 0);
  }
  EXPECT_GT(loose, 0);
}

// A polygon with an odd number of sides has no pairs for all of its triangles, and that is all that happens.
TEST(LooseTriangles, OfAnOddPolygonSomeAreLeft) {
  std::mt19937 random(4);
  for (int round = 0; round < 50; ++round) {
    Pillow pillow(7 + 2 * static_cast<int>(random() % 8), random);
    std::vector<MeshEdit> log;
    pair_loose_triangles(pillow.mesh, pillow.points(), pillow.features, pillow.faces, pillow.mates(), log);
    int across = 0;
    pillow.mates(&across);
    ASSERT_EQ(across % 4, 2);
  }
}

}  // namespace
}  // namespace hybrid_mesh
