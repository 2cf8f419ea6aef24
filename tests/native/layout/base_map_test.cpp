// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/base_map.h"

#include <gtest/gtest.h>

#include <random>

#include "generated_surfaces.h"
#include "layout/regions/region_layout.h"
#include "layouts.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_extraction.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::repaired;
using testing::torus;
using testing::unit;
using testing::whole_surface;

BaseDomain base_of(const TriangleSurface& surface, double size) {
  Context context;
  BaseDomainOptions options;
  options.size = size;
  return BaseDomain(surface, {}, options, Progress(context));
}

int irregular_nodes(const PatchedSurface& s) {
  const std::vector<int> valence = node_valences(s);
  const std::vector<char> on_boundary = boundary_nodes(s);
  int count = 0;
  for (int n = 0; n < s.node_count; ++n) count += !on_boundary[n] && valence[n] != 4;
  return count;
}

// No two sides join the same nodes.
void expect_simple(const PatchedSurface& s) {
  std::set<std::pair<int, int>> joined;
  for (int q = 0; q < s.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      const PatchSide other = s.neighbours[q][i];
      if (other.patch >= 0 && (other.patch < q || (other.patch == q && other.side < i))) continue;
      EXPECT_TRUE(joined.insert(std::minmax(s.nodes[q][i], s.nodes[q][(i + 1) % 4])).second);
    }
}

// A random edit of a random region: a side turned, a node turned, or a ring put in.
std::optional<LayoutEdit> random_edit(const PatchedSurface& s, std::mt19937& random) {
  const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const int q = pick(s.patch_count()), i = pick(4), kind = pick(4);
  std::vector<int> patches{q};
  if (kind == 0 || kind == 1) {
    const PatchSide other = s.neighbours[q][i];
    if (other.patch < 0 || other.patch == q) return std::nullopt;
    patches.push_back(other.patch);
  } else if (kind == 2) {
    patches.clear();
    for (int p = 0; p < s.patch_count(); ++p)
      if (std::count(s.nodes[p].begin(), s.nodes[p].end(), s.nodes[q][i]) > 0) patches.push_back(p);
  }
  const auto region = make_region(s, patches);
  if (!region) return std::nullopt;
  std::optional<LayoutEdit> edit;
  if (kind == 0 && region->corners.size() == 6)
    edit = chord_edit(*region, pick(3));
  else if (kind == 2 && region->inner_nodes.size() == 1)
    edit = star_edit(*region, pick(2));
  else
    edit = tower_edit(s, *region, 1 + pick(2));
  if (!edit || !irregular_growth(s, *region, *edit, node_valences(s), boundary_nodes(s))) return std::nullopt;
  return edit;
}

TEST(LayoutEdit, RandomEditsKeepALayoutAndAreTheSameOnCoarseAndFineSurfaces) {
  std::mt19937 random(5);
  for (const PolygonSoup& soup : {ball(12), ball(12, 0.4), torus(40, 20)}) {
    const TriangleSurface surface = unit(repaired(soup));
    BaseDomain base = base_of(surface, 40);
    Context context;
    MappedSurface fine{base.cut(whole_surface, Progress(context)).patches, {}};
    CutSurface cut = base.cut(12, Progress(context));
    MappedSurface coarse{cut.patches, {}};
    for (MappedSurface* m : {&fine, &coarse}) m->corners = map_patches(m->surface, Progress(context));
    int applied = 0;
    for (int tries = 0; tries < 60 && applied < 8; ++tries) {
      const std::optional<LayoutEdit> edit = random_edit(fine.surface, random);
      if (!edit) continue;
      ++applied;
      const int before = fine.surface.patch_count(), irregular = irregular_nodes(fine.surface);
      const int growth = *irregular_growth(fine.surface, *make_region(fine.surface, edit->patches, edit->starts), *edit, node_valences(fine.surface),
                                           boundary_nodes(fine.surface));
      PatchedSurface nodes_alone = fine.surface;
      change_layout(nodes_alone, *edit);
      for (MappedSurface* m : {&fine, &coarse}) {
        map_patches(m->surface, apply_edit(*m, *edit).added, m->corners, Progress(context));
        // The maps of old and new patches meet along their sides.
        testing::expect_bijective(ChartMesh(m->surface, m->corners));
      }
      EXPECT_EQ(fine.surface.patch_count(), before + edit->growth());
      EXPECT_EQ(irregular_nodes(fine.surface), irregular + growth);
      testing::expect_layout(surface, fine.surface);
      testing::expect_layout(cut.coarse, coarse.surface);
      EXPECT_EQ(coarse.surface.nodes, fine.surface.nodes);
      EXPECT_EQ(nodes_alone.nodes, fine.surface.nodes);
      for (const int v : node_valences(fine.surface)) EXPECT_LE(v, 6);
    }
    EXPECT_GE(applied, 6);
  }
}

TEST(PatchedPart, IsALayoutOfItsOwn) {
  const TriangleSurface surface = unit(repaired(torus(40, 20)));
  Context context;
  const PatchedSurface s = base_of(surface, 40).cut(whole_surface, Progress(context)).patches;
  std::mt19937 random(3);
  for (int tries = 0; tries < 20; ++tries) {
    std::vector<int> patches;
    for (int q = 0; q < s.patch_count(); ++q)
      if (random() % 3 == 0) patches.push_back(q);
    const PatchedPart part = part_of(s, patches);
    TriangleSurface alone = part.surface.mesh;
    connect_half_edges(alone);
    EXPECT_EQ(alone.opposite, part.surface.mesh.opposite);
    testing::expect_layout(part.surface.mesh, [&] {
      PatchedSurface p = part.surface;
      // Its points are its own, so that they are their own sources.
      for (std::size_t v = 0; v < p.source.size(); ++v) p.source[v] = {{static_cast<int>(v), -1, -1}, {1, 0, 0}};
      return p;
    }());
    for (std::size_t k = 0; k < patches.size(); ++k)
      for (int i = 0; i < 4; ++i) EXPECT_EQ(part.node[part.surface.nodes[k][i]], s.nodes[patches[k]][i]);
  }
}

TEST(GluePatchMaps, UndoesExtraction) {
  const TriangleSurface surface = unit(repaired(ball(14, 0.5)));
  Context context;
  PatchedSurface s = base_of(surface, 30).cut(whole_surface, Progress(context)).patches;
  const auto corners = map_patches(s, Progress(context));
  ChartMesh charts(s, corners);
  smooth_map(charts, s, GlobalMapOptions(), Progress(context));
  const std::vector<PatchMap> maps = extract_patch_maps(charts, s, surface.faces, Progress(context));
  const MappedSurface glued = glue_patch_maps(maps, s, surface.faces);
  // Sources are single precision in the maps.
  PatchedSurface layout = glued.surface;
  for (std::size_t v = 0; v < layout.source.size(); ++v) {
    Vec3 at = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (layout.source[v].vertices[k] >= 0) at += layout.source[v].weights[k] * surface.points[layout.source[v].vertices[k]];
    EXPECT_LT((at - layout.mesh.points[v]).norm(), 1e-6);
    layout.source[v] = {{static_cast<int>(v), -1, -1}, {1, 0, 0}};
  }
  testing::expect_layout(layout.mesh, layout);
  testing::expect_bijective(ChartMesh(glued.surface, glued.corners));
  EXPECT_EQ(layout.nodes, s.nodes);
}

TEST(BaseMap, IsBijectiveAndCarriedToEveryVertex) {
  for (const PolygonSoup& soup : {ball(22), ball(20, 0.5), torus(90, 40)}) {
    const TriangleSurface surface = unit(repaired(soup));
    BaseDomain base = base_of(surface, 40);
    Context context;
    LayoutSearchOptions options;
    options.quads = 44;
    options.vertices = 30.0 * base.quads();
    Found<BaseMap> mapped = map_to_base(surface, base, options, Progress(context));
    ASSERT_TRUE(mapped) << mapped.reason;
    BaseMap& map = *mapped;
    EXPECT_LE(map.layout.patch_count(), 44);
    EXPECT_GE(map.layout.patch_count(), base.quads());
    testing::expect_bijective(map.charts);
    expect_simple(map.layout);
    const std::vector<PatchMap> maps = extract_patch_maps(map.charts, map.layout, surface.faces, Progress(context));
    double area = 0, whole = 0;
    for (const PatchMap& m : maps) {
      EXPECT_STREQ(find_map_defect(m), "");
      for (const auto& t : m.triangles) area += (m.positions[t[1]] - m.positions[t[0]]).cross(m.positions[t[2]] - m.positions[t[0]]).norm();
    }
    for (const auto& f : surface.faces)
      whole += (surface.points[f[1]] - surface.points[f[0]]).cross(surface.points[f[2]] - surface.points[f[0]]).norm();
    EXPECT_NEAR(area, whole, 1e-9 * whole);
    // Without boundary the coarse surface serves: every vertex of the surface is one of the map's.
    if (soup.points.size() != ball(20, 0.5).points.size()) {
      EXPECT_EQ(static_cast<std::size_t>(map.charts.mesh.vertex_count), surface.points.size());
    }
  }
}

TEST(LayoutSearch, LowersTheEnergyWithinTheSizeAllowed) {
  // A ball with a spike, for which a base of few quads has no room.
  PolygonSoup soup = ball(24);
  for (Vec3& p : soup.points)
    if (p.z() > 0.9 * p.norm()) p.z() += 12 * (p.z() / p.norm() - 0.9) * p.norm();
  const TriangleSurface surface = unit(repaired(soup));
  BaseDomain base = base_of(surface, 40);
  Context context;
  const auto energy = [&](int rounds, int quads) {
    CutSurface cut = base.cut(30, Progress(context));
    LayoutSearchOptions options;
    options.rounds = rounds;
    options.quads = quads;
    const CarriedMap found = search_layout(CarriedMap(surface, std::move(cut)), options, Progress(context)).map;
    EXPECT_LE(found.layout.patch_count(), std::max(quads, base.quads()));
    testing::expect_bijective(found.charts);
    expect_simple(found.layout);
    Distortion density{options.map.theta};
    double sum = 0, area = 0;
    for (int f = 0; f < static_cast<int>(found.charts.mesh.alive.size()); ++f) {
      if (!found.charts.mesh.alive[f]) continue;
      const FlatTriangle t = found.charts.flat(f);
      Complex a(0, 0), b(0, 0);
      for (int k = 0; k < 3; ++k) a += t.alpha[k] * found.charts.at(3 * f + k), b += std::conj(t.alpha[k]) * found.charts.at(3 * f + k);
      sum += t.area * density.value(std::norm(a), std::norm(b));
      area += t.area;
    }
    return sum / area;
  };
  const double without = energy(0, base.quads()), turned = energy(3, base.quads()), grown = energy(3, base.quads() + 8);
  EXPECT_LT(turned, without);
  EXPECT_LE(grown, 1.02 * turned);
}

TEST(EvenEdit, LaysADiskOutAnewWithinItsBoundary) {
  const TriangleSurface surface = unit(repaired(ball(24)));
  Context context;
  const PatchedSurface s = base_of(surface, 80).cut(whole_surface, Progress(context)).patches;
  int applied = 0;
  for (int q = 0; q < s.patch_count() && applied < 6; q += 7) {
    // Two rings of quads around one.
    std::vector<char> in(s.patch_count(), 0);
    in[q] = 1;
    for (int ring = 0; ring < 2; ++ring) {
      std::vector<char> node(s.node_count, 0);
      for (int p = 0; p < s.patch_count(); ++p)
        if (in[p])
          for (const int n : s.nodes[p]) node[n] = 1;
      for (int p = 0; p < s.patch_count(); ++p)
        for (const int n : s.nodes[p]) in[p] |= node[n];
    }
    std::vector<int> patches;
    for (int p = 0; p < s.patch_count(); ++p)
      if (in[p]) patches.push_back(p);
    const auto region = make_region(s, patches);
    if (!region) continue;
    std::optional<DrawnEdit> drawn = even_edit(s, *region, surface_of(s, *region), 1.5 * static_cast<double>(patches.size()), 1, Progress(context));
    if (!drawn) continue;
    ++applied;
    const int growth = drawn->edit.growth();
    MappedSurface mapped{s, {}};
    mapped.corners = map_patches(mapped.surface, Progress(context));
    map_patches(mapped.surface, apply_edit(mapped, std::move(*drawn)).added, mapped.corners, Progress(context));
    EXPECT_EQ(mapped.surface.patch_count(), s.patch_count() + growth);
    EXPECT_GT(growth, 0);
    testing::expect_layout(surface, mapped.surface);
    expect_simple(mapped.surface);
    testing::expect_bijective(ChartMesh(mapped.surface, mapped.corners));
  }
  EXPECT_GE(applied, 3);
}

}  // namespace
}  // namespace hybrid_mesh
