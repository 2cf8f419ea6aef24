// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/base_domain.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>
#include <set>

#include "generated_surfaces.h"
#include "layout/base/decimation.h"
#include "layouts.h"
#include "models.h"
#include "remesh/working_surface.h"
#include "surface/edit_mesh.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::repaired;
using testing::torus;
using testing::unit;
using testing::whole_surface;

long euler(const EditMesh& m) {
  long halves = 0, boundary = 0;
  for (std::size_t h = 0; h < m.origin.size(); ++h)
    if (m.alive[h / 3]) ++halves, boundary += m.opposite[h] < 0;
  return m.vertex_count - (halves + boundary) / 2 + m.face_count;
}

// Links symmetric, outgoing half-edges right, one fan a vertex, no double edges.
void expect_sound(const EditMesh& m) {
  std::set<std::pair<int, int>> directed;
  std::vector<int> corners(m.out.size(), 0);
  for (int h = 0; h < static_cast<int>(m.origin.size()); ++h) {
    if (!m.alive[h / 3]) continue;
    ++corners[m.from(h)];
    ASSERT_TRUE(m.vertex_alive(m.from(h)));
    ASSERT_TRUE(directed.insert({m.from(h), m.to(h)}).second);
    const int o = m.opposite[h];
    if (o < 0) continue;
    ASSERT_EQ(m.opposite[o], h);
    ASSERT_EQ(m.from(o), m.to(h));
    ASSERT_EQ(m.to(o), m.from(h));
    ASSERT_EQ(m.edge[o], m.edge[h]);
  }
  for (int v = 0; v < static_cast<int>(m.out.size()); ++v) {
    if (!m.vertex_alive(v)) continue;
    int fan = 0, h = m.out[v];
    ASSERT_EQ(m.from(h), v);
    do {
      ++fan;
      h = m.ccw(h);
    } while (h >= 0 && h != m.out[v]);
    ASSERT_EQ(fan, corners[v]);
    if (h < 0) {
      ASSERT_LT(m.opposite[m.out[v]], 0);
    }
  }
}

TEST(EditMesh, RandomOperationsKeepTheTopologyAndUndoExactly) {
  for (const TriangleSurface& surface : {repaired(torus(12, 9)), repaired(ball(5, 0.3)), repaired(ball(4))}) {
    EditMesh mesh(surface);
    const EditMesh before = mesh;
    const long chi = euler(mesh);
    std::mt19937 random(7);
    std::vector<MeshEdit> log;
    for (int i = 0; i < 4000; ++i) {
      const int h = static_cast<int>(random() % mesh.origin.size());
      if (!mesh.alive[h / 3]) continue;
      if (random() % 3 == 0) {
        if (!mesh.can_flip(h)) continue;
        mesh.flip(h);
        log.push_back({MeshEdit::Kind::Flip, h});
      } else {
        if (!mesh.can_collapse(h)) continue;
        mesh.collapse(h);
        log.push_back({MeshEdit::Kind::Collapse, h});
      }
      if (i % 50 == 0) expect_sound(mesh);
    }
    expect_sound(mesh);
    EXPECT_EQ(euler(mesh), chi);
    EXPECT_GT(log.size(), 50u);
    for (std::size_t i = log.size(); i-- > 0;)
      log[i].kind == MeshEdit::Kind::Flip ? mesh.undo_flip(log[i].half_edge) : mesh.undo_collapse(log[i].half_edge);
    EXPECT_EQ(mesh.origin, before.origin);
    EXPECT_EQ(mesh.opposite, before.opposite);
    EXPECT_EQ(mesh.edge, before.edge);
  }
}

TEST(BaseDomain, TilesSurfacesOfEveryKindAtEverySize) {
  PolygonSoup several = ball(6);
  testing::add(several, ball(5, 0.5, Vec3(4, 0, 0), 0.5));
  testing::add(several, torus(20, 12));
  for (const PolygonSoup& soup : {ball(8), ball(8, 0.4), torus(40, 18), several}) {
    const TriangleSurface surface = unit(repaired(soup));
    for (const double size : {1.0, 12.0, 60.0, 200.0}) {
      Context context;
      BaseDomainOptions options;
      options.size = size;
      BaseDomain base(surface, {}, options, Progress(context));
      const PatchedSurface p = base.cut(whole_surface, Progress(context)).patches;
      testing::expect_layout(surface, p);
      // A coarser version of the surface has the same layout.
      const CutSurface coarse = base.cut(12, Progress(context));
      testing::expect_layout(coarse.coarse, coarse.patches);
      EXPECT_EQ(coarse.patches.nodes, p.nodes);
      EXPECT_EQ(static_cast<std::size_t>(coarse.collapsed.vertex_count), coarse.coarse.points.size());
      EXPECT_EQ(coarse.log.size() + coarse.coarse.points.size(), surface.points.size());
      for (std::size_t v = 0; v < coarse.vertex.size(); ++v) EXPECT_EQ(coarse.coarse.points[v], surface.points[coarse.vertex[v]]);
      if (size >= 60) {
        EXPECT_LE(p.patch_count(), size);
      }
      EXPECT_GT(p.patch_count(), 0);
    }
  }
}

// The first cut takes the mesh with it, and a further one makes it again.
TEST(BaseDomain, IsCutTheSameAtAnyTime) {
  for (const PolygonSoup& soup : {ball(12), ball(12, 0.4), torus(40, 20)}) {
    const TriangleSurface surface = unit(repaired(soup));
    Context context;
    BaseDomainOptions options;
    options.size = 40;
    BaseDomain base(surface, {}, options, Progress(context));
    const CutSurface first = base.cut(12, Progress(context)), again = base.cut(12, Progress(context));
    EXPECT_EQ(first.log, again.log);
    EXPECT_EQ(first.vertex, again.vertex);
    EXPECT_EQ(first.coarse.faces, again.coarse.faces);
    EXPECT_EQ(first.collapsed.origin, again.collapsed.origin);
    EXPECT_EQ(first.collapsed.opposite, again.collapsed.opposite);
    EXPECT_EQ(first.collapsed.edge, again.collapsed.edge);
    for (const int v : first.vertex) EXPECT_EQ(first.collapsed.out[v], again.collapsed.out[v]);
    EXPECT_EQ(first.patches.nodes, again.patches.nodes);
    EXPECT_EQ(first.patches.sides, again.patches.sides);
    EXPECT_EQ(first.patches.mesh.faces, again.patches.mesh.faces);
  }
}

TEST(BaseDomain, ReachesTheSizeAskedForWithCleanValences) {
  const TriangleSurface surface = unit(repaired(torus(60, 30)));
  Context context;
  BaseDomainOptions options;
  options.size = 100;
  const PatchedSurface p = BaseDomain(surface, {}, options, Progress(context)).cut(whole_surface, Progress(context)).patches;
  EXPECT_LE(p.patch_count(), 100);
  EXPECT_GE(p.patch_count(), 98);
  std::vector<int> valence(p.node_count, 0);
  for (const auto& n : p.nodes)
    for (const int v : n) ++valence[v];
  for (const int k : valence) {
    EXPECT_GE(k, 3);
    EXPECT_LE(k, 6);
  }
}

TEST(BaseDomain, ASeedDecidesNearTiesAndNothingElse) {
  const TriangleSurface surface = unit(repaired(ball(10)));
  Context context;
  BaseDomainOptions options;
  options.size = 40;
  const auto make = [&] { return BaseDomain(surface, {}, options, Progress(context)).cut(whole_surface, Progress(context)).patches; };
  const PatchedSurface a = make(), b = make();
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.mesh.faces, b.mesh.faces);
}

TEST(BaseDomain, CancelEndsIt) {
  const TriangleSurface surface = unit(repaired(ball(20)));
  Context context;
  context.cancel();
  try {
    BaseDomain(surface, {}, BaseDomainOptions(), Progress(context));
    FAIL() << "not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::Cancelled);
  }
}

}  // namespace
}  // namespace hybrid_mesh
