// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/repair.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "models.h"
#include "shapes.h"
#include "surface/topology_summary.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {
namespace {

struct Repaired {
  TriangleSurface surface;
  RepairReport report;
  TopologySummary topology;
};

double area_of(const std::vector<Vec3>& points, const std::array<int, 3>& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).norm() / 2;
}

double area_of(const TriangleSurface& surface) {
  double area = 0;
  for (const auto& face : surface.faces) area += area_of(surface.points, face);
  return area;
}

// The area of the soup, every set of three positions once.
double area_without_duplicates(const PolygonSoup& soup) {
  std::set<std::array<std::array<double, 3>, 3>> seen;
  double area = 0;
  for (const auto& t : triangulate(soup).triangles) {
    std::array<std::array<double, 3>, 3> key;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) key[i][k] = soup.points[t[i]][k] + 0.0;
    std::sort(key.begin(), key.end());
    if (seen.insert(key).second) area += area_of(soup.points, {t[0], t[1], t[2]});
  }
  return area;
}

// What holds after every repair.
void expect_sound(const PolygonSoup& soup, const TriangleSurface& surface) {
  ASSERT_FALSE(surface.empty());
  ASSERT_EQ(surface.opposite.size(), 3 * surface.faces.size());
  ASSERT_EQ(surface.source_face.size(), surface.faces.size());
  const TopologySummary t = summarize_topology(to_soup(surface));
  EXPECT_EQ(t.nonmanifold_edges, 0);
  EXPECT_EQ(t.nonmanifold_vertices, 0);  // one fan a point
  EXPECT_EQ(t.misoriented_edges, 0);
  EXPECT_EQ(t.vertices, static_cast<std::int64_t>(surface.points.size()));  // no isolated points
  EXPECT_EQ(t.genus, std::floor(t.genus));
  EXPECT_GE(t.genus, 0);
  std::set<std::pair<int, int>> edges;
  std::set<std::array<int, 3>> faces;
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
    const int g = surface.opposite[h];
    if (g >= 0) {
      EXPECT_EQ(surface.opposite[g], h);
      EXPECT_EQ(surface.from(g), surface.to(h));
      EXPECT_EQ(surface.to(g), surface.from(h));
    }
    // Simplicial: an edge is named by its ends.
    if (g < h) {
      EXPECT_TRUE(edges.insert(std::minmax(surface.from(h), surface.to(h))).second);
    }
  }
  for (auto face : surface.faces) {
    std::sort(face.begin(), face.end());
    EXPECT_TRUE(faces.insert(face).second);
  }
  // No point has moved.
  const auto less = [](const Vec3& a, const Vec3& b) { return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3); };
  std::set<Vec3, decltype(less)> positions(soup.points.begin(), soup.points.end(), less);
  for (const Vec3& p : surface.points) EXPECT_TRUE(positions.count(p));
  const int triangle_count = static_cast<int>(triangulate(soup).triangles.size());
  for (const int s : surface.source_face) EXPECT_TRUE(s >= 0 && s < triangle_count);
}

Repaired repaired(const PolygonSoup& soup, const RepairOptions& options = {}) {
  Repaired r;
  Context context;
  r.surface = repair(soup, options, r.report, Progress(context));
  EXPECT_EQ(context.progress(), 1);
  expect_sound(soup, r.surface);
  r.topology = summarize_topology(to_soup(r.surface));
  RepairReport again;
  const TriangleSurface twice = repair(soup, options, again, Progress(context));
  EXPECT_EQ(twice.faces, r.surface.faces);
  EXPECT_EQ(twice.points, r.surface.points);
  EXPECT_EQ(twice.source_face, r.surface.source_face);
  return r;
}

void expect_clean(const RepairReport& r) {
  EXPECT_FALSE(r.changed());
  EXPECT_EQ(r.merged_points + r.isolated_points + r.duplicate_faces + r.degenerate_faces + r.reoriented_faces + r.nonmanifold_edges +
                r.nonmanifold_vertices + r.one_sided_cuts + r.dropped_components,
            0);
}

TEST(Repair, LeavesCleanSurfacesAlone) {
  for (const PolygonSoup& soup : {tetrahedron(), grid(5, 3), glued_rectangle(8, 6, false, true), glued_rectangle(8, 2, false, false)}) {
    const Repaired r = repaired(soup);
    expect_clean(r.report);
    EXPECT_EQ(r.surface.points, soup.points);
    EXPECT_EQ(to_soup(r.surface).indices, soup.indices);
    for (std::size_t f = 0; f < r.surface.faces.size(); ++f) EXPECT_EQ(r.surface.source_face[f], static_cast<int>(f));
  }
}

TEST(Repair, TriangulatesPolygons) {
  const Repaired r = repaired(cube());
  expect_clean(r.report);
  EXPECT_EQ(r.topology.faces, 12);
  EXPECT_DOUBLE_EQ(area_of(r.surface), 6);
}

TEST(Repair, MergesCoincidentPointsAndDropsIsolatedOnes) {
  PolygonSoup soup;  // every face with points of its own, zeros of both signs
  const PolygonSoup whole = cube();
  for (std::size_t p = 0; p < whole.polygon_count(); ++p) {
    for (std::int64_t c = whole.offsets[p]; c < whole.offsets[p + 1]; ++c) {
      soup.indices.push_back(static_cast<int>(soup.points.size()));
      Vec3 q = whole.points[whole.indices[c]];
      for (int i = 0; i < 3; ++i)
        if (q[i] == 0 && (c + i) % 2) q[i] = -0.0;
      soup.points.push_back(q);
    }
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  soup.points.push_back({7, 7, 7});
  const Repaired r = repaired(soup);
  EXPECT_EQ(r.report.merged_points, 16);
  EXPECT_EQ(r.report.isolated_points, 1);
  EXPECT_EQ(r.topology.boundary_loops, 0);
  EXPECT_EQ(r.topology.euler, 2);
}

TEST(Repair, ClosesCracksThatRoundingMade) {
  PolygonSoup soup = cube();  // every face with points of its own, some off by what a computation is off, others by what is meant
  const std::vector<Vec3> corners = soup.points;
  for (const double off : {1e-17, 1e-13}) {
    soup.points.clear();
    for (std::size_t i = 0; i < soup.indices.size(); ++i) {
      const Vec3& p = corners[cube().indices[i]];
      soup.points.push_back(i % 2 ? p : Vec3(p + off * Vec3(1, -1, 1)));
      soup.indices[i] = static_cast<int>(i);
    }
    const Repaired r = repaired(soup);
    EXPECT_EQ(r.topology.boundary_loops == 0, off < 1e-15);
    EXPECT_EQ(r.report.merged_points == 16, off < 1e-15);
  }
}

TEST(Repair, TurnsAsFewFacesAsPossible) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PolygonSoup soup = glued_rectangle(10, 8, false, true);
    append(soup, tetrahedron({9, 9, 9}));
    const std::vector<std::int32_t> original = soup.indices;
    TestRandom random(seed);
    std::int64_t turned = 0;
    for (std::size_t f = 0; f < soup.polygon_count(); ++f)
      if (random.below(4) == 0 && f < 160) ++turned, std::swap(soup.indices[3 * f], soup.indices[3 * f + 1]);
    const Repaired r = repaired(soup);
    EXPECT_EQ(r.report.reoriented_faces, turned);
    EXPECT_EQ(r.topology.genus, 1);
    EXPECT_EQ(r.topology.components, 2);
    EXPECT_DOUBLE_EQ(area_of(r.surface), area_without_duplicates(soup));
  }
}

// A tetrahedron each side of an edge, or of a corner: they come apart and stay closed.
TEST(Repair, SeparatesSolidsThatTouch) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const std::vector<std::vector<int>> first{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  auto at_corner = first, at_edge = first;
  for (const auto& f : std::vector<std::vector<int>>{{0, 5, 4}, {0, 4, 6}, {4, 5, 6}, {5, 0, 6}}) at_corner.push_back(f);
  for (const auto& f : std::vector<std::vector<int>>{{0, 5, 3}, {0, 3, 4}, {3, 5, 4}, {5, 0, 4}}) at_edge.push_back(f);
  const Repaired corner = repaired(soup_of(points, at_corner));
  EXPECT_EQ(corner.report.nonmanifold_vertices, 1);
  EXPECT_EQ(corner.report.nonmanifold_edges, 0);
  EXPECT_EQ(corner.surface.points.size(), 8u);
  const Repaired edge = repaired(soup_of(points, at_edge));
  EXPECT_EQ(edge.report.nonmanifold_edges, 1);
  for (const Repaired* r : {&corner, &edge}) {
    EXPECT_EQ(r->topology.components, 2);
    EXPECT_EQ(r->topology.boundary_loops, 0);
    EXPECT_EQ(r->topology.genus, 0);
    EXPECT_EQ(r->report.reoriented_faces, 0);
  }
}

TEST(Repair, SeparatesGridsThatTouchAlongAChainOfEdges) {
  // Two rows of cubes along x, which share a chain of edges; one component with the ends of the chain inside of it.
  PolygonSoup soup;
  for (int i = 0; i < 4; ++i) {
    const PolygonSoup a = cube({double(i), 0, 0}), b = cube({double(i), 1, 1});
    for (const PolygonSoup* c : {&a, &b}) {
      PolygonSoup open = *c;  // no walls between the cubes of a row
      PolygonSoup kept;
      kept.points = open.points;
      for (std::size_t p = 0; p < 6; ++p) {
        if ((p == 4 && i > 0) || (p == 5 && i < 3)) continue;
        for (std::int64_t k = open.offsets[p]; k < open.offsets[p + 1]; ++k) kept.indices.push_back(open.indices[k]);
        kept.offsets.push_back(static_cast<std::int64_t>(kept.indices.size()));
      }
      append(soup, kept);
    }
  }
  const Repaired r = repaired(soup);
  EXPECT_EQ(r.report.nonmanifold_edges, 4);
  EXPECT_EQ(r.topology.components, 2);
  EXPECT_EQ(r.topology.boundary_loops, 0);
  EXPECT_EQ(r.topology.genus, 0);
}

TEST(Repair, PairsTheFlatSheetAtAnEdgeOfThreeFaces) {
  // A floor with a wall on its middle line: the floor stays whole.
  PolygonSoup soup = grid(4, 2);
  const int first = static_cast<int>(soup.points.size());
  for (int i = 0; i <= 4; ++i) soup.points.push_back({double(i), 1, 1});
  for (int i = 0; i < 4; ++i)
    for (const auto& t : {std::array<int, 3>{5 + i, 6 + i, first + i + 1}, std::array<int, 3>{5 + i, first + i + 1, first + i}}) {
      soup.indices.insert(soup.indices.end(), t.begin(), t.end());
      soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
    }
  const Repaired r = repaired(soup);
  EXPECT_EQ(r.report.nonmanifold_edges, 4);
  EXPECT_EQ(r.topology.components, 2);
  EXPECT_EQ(r.topology.boundary_loops, 2);
  EXPECT_EQ(r.topology.vertices, 20 + 5);
  EXPECT_DOUBLE_EQ(area_of(r.surface), 12);
}

TEST(Repair, CutsOneSidedSurfacesAlongFewEdges) {
  for (const int width : {1, 3, 6}) {
    const PolygonSoup moebius = glued_rectangle(24, width, true, false);
    const Repaired r = repaired(moebius);
    EXPECT_GE(r.report.one_sided_cuts, width);
    EXPECT_LE(r.report.one_sided_cuts, 2 * width + 1);
    EXPECT_EQ(r.topology.components, 1);
    EXPECT_EQ(r.topology.boundary_loops, 1);
    EXPECT_EQ(r.topology.genus, 0);
    EXPECT_NEAR(area_of(r.surface), area_without_duplicates(moebius), 1e-12 * area_of(r.surface));
  }
  const PolygonSoup klein = glued_rectangle(20, 12, true, true);
  const Repaired r = repaired(klein);
  EXPECT_GT(r.report.one_sided_cuts, 0);
  EXPECT_EQ(r.topology.components, 1);
  EXPECT_GT(r.topology.boundary_loops, 0);
  EXPECT_NEAR(area_of(r.surface), area_without_duplicates(klein), 1e-12 * area_of(r.surface));
}

TEST(Repair, DropsDuplicateFacesOfBothOrientations) {
  PolygonSoup soup = glued_rectangle(8, 6, false, true);
  const std::size_t faces = soup.polygon_count();
  for (const std::size_t f : {3u, 40u, 41u}) {  // a copy in the same orientation
    for (int i = 0; i < 3; ++i) soup.indices.push_back(soup.indices[3 * f + i]);
    soup.offsets.push_back(soup.offsets.back() + 3);
  }
  for (const std::size_t f : {5u, 9u})  // two copies, one turned
    for (const bool turned : {true, false}) {
      for (int i = 0; i < 3; ++i) soup.indices.push_back(soup.indices[3 * f + (turned ? 2 - i : i)]);
      soup.offsets.push_back(soup.offsets.back() + 3);
    }
  const Repaired r = repaired(soup);
  EXPECT_EQ(r.report.duplicate_faces, 7);
  EXPECT_EQ(r.report.reoriented_faces, 0);
  EXPECT_EQ(r.surface.faces.size(), faces);
  EXPECT_EQ(r.topology.genus, 1);
}

TEST(Repair, MakesOneLayerOfATwoSidedSheet) {
  PolygonSoup soup = grid(4, 4);
  const std::size_t faces = soup.polygon_count();
  for (std::size_t f = 0; f < faces; ++f) {
    for (int i = 0; i < 3; ++i) soup.indices.push_back(soup.indices[3 * f + 2 - i]);
    soup.offsets.push_back(soup.offsets.back() + 3);
  }
  const Repaired r = repaired(soup);
  EXPECT_EQ(r.surface.faces.size(), faces);
  EXPECT_EQ(r.topology.boundary_loops, 1);
}

TEST(Repair, UnitesSolidsGluedAtAWall) {
  PolygonSoup soup = tetrahedron();
  soup.points.push_back({-1, -1, -1});
  // A second tetrahedron on the face 1 2 3, seen from its other side.
  for (const auto& t : {std::array<int, 3>{1, 3, 2}, std::array<int, 3>{1, 4, 3}, std::array<int, 3>{3, 4, 2}, std::array<int, 3>{2, 4, 1}}) {
    soup.indices.insert(soup.indices.end(), t.begin(), t.end());
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  const Repaired r = repaired(soup);
  EXPECT_EQ(r.report.duplicate_faces, 2);
  EXPECT_EQ(r.topology.components, 1);
  EXPECT_EQ(r.topology.boundary_loops, 0);
  EXPECT_EQ(r.topology.genus, 0);
}

TEST(Repair, TakesOutAPairOfFacesThatSticksOut) {
  PolygonSoup soup = glued_rectangle(8, 6, false, true);
  const std::size_t faces = soup.polygon_count();
  const int a = soup.indices[0], b = soup.indices[1], tip = static_cast<int>(soup.points.size());
  soup.points.push_back({5, 5, 5});
  for (const auto& t : {std::array<int, 3>{a, b, tip}, std::array<int, 3>{b, a, tip}}) {
    soup.indices.insert(soup.indices.end(), t.begin(), t.end());
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  const Repaired r = repaired(soup);
  EXPECT_EQ(r.surface.faces.size(), faces);
  EXPECT_EQ(r.topology.boundary_loops, 0);
  EXPECT_EQ(r.topology.components, 1);
}

// A face without area fills a T-junction: without it the surface would be open there.
TEST(Repair, FlipsDegenerateFacesSoThatNoCrackOpens) {
  PolygonSoup soup = soup_of({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, -2, 0}, {0.5, 0, 0}},
                             {{0, 1, 3}, {1, 0, 2}, {0, 4, 5}, {4, 2, 5}, {0, 5, 2}, {2, 4, 1}});
  const Repaired r = repaired(soup);
  EXPECT_EQ(r.report.degenerate_faces, 2);
  EXPECT_EQ(r.topology.boundary_loops, 1);
  EXPECT_EQ(r.topology.genus, 0);
  EXPECT_EQ(r.topology.components, 1);
  EXPECT_EQ(r.topology.vertices, 6);
  EXPECT_DOUBLE_EQ(area_of(r.surface), 4);
  for (const auto& face : r.surface.faces) EXPECT_GT(area_of(r.surface.points, face), 0.1);
  // The pieces of a flipped face come from the neighbour that holds them.
  for (std::size_t f = 0; f < r.surface.faces.size(); ++f) EXPECT_NE(r.surface.source_face[f], 1);
}

TEST(Repair, DegenerateFacesAtBoundariesAreLeftOut) {
  PolygonSoup soup = grid(2, 2);
  soup.points.push_back({0.5, 0, 0});
  soup.indices.insert(soup.indices.end(), {0, 9, 1, 3, 3, 4});
  soup.offsets.push_back(soup.offsets.back() + 3);
  soup.offsets.push_back(soup.offsets.back() + 3);
  const Repaired r = repaired(soup);
  EXPECT_GE(r.report.degenerate_faces, 1);
  EXPECT_EQ(r.topology.boundary_loops, 1);
  EXPECT_DOUBLE_EQ(area_of(r.surface), 4);
}

TEST(Repair, RefusesWhatHasNoFacesLeft) {
  const auto message = [](const PolygonSoup& soup, const RepairOptions& options = {}) -> std::string {
    RepairReport report;
    Context context;
    try {
      repair(soup, options, report, Progress(context));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message(soup_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {1, 2, 3}, {0, 0, 1}})), "all 3 faces are degenerate");
  EXPECT_EQ(message(soup_of({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}})), "all 1 faces are degenerate");
  EXPECT_EQ(message({}), "no faces");
  EXPECT_NE(message(tetrahedron(), {.drop_components = 1.5}), "accepted");
}

TEST(Repair, DropsSmallComponents) {
  PolygonSoup soup = glued_rectangle(10, 8, false, true);
  PolygonSoup crumb = tetrahedron();
  for (Vec3& p : crumb.points) p = p * 0.01 + Vec3(5, 5, 5);
  append(soup, crumb);
  EXPECT_EQ(repaired(soup).topology.components, 2);
  const Repaired r = repaired(soup, {.drop_components = 0.001});
  EXPECT_EQ(r.report.dropped_components, 1);
  EXPECT_EQ(r.topology.components, 1);
  EXPECT_EQ(r.topology.genus, 1);
}

TEST(Repair, CanBeCancelled) {
  Context context;
  context.cancel();
  RepairReport report;
  try {
    repair(tetrahedron(), {}, report, Progress(context));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Cancelled);
  }
}

// Powers of two change no mantissa: nothing may change but the scale, however extreme.
TEST(Repair, IsTheSameAtEveryScale) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const PolygonSoup soup = random_soup(seed, 30, 60);
    const Repaired r = repaired(soup);
    for (const int exponent : {-1000, -500, 500, 1000}) {
      PolygonSoup other = soup;
      for (Vec3& p : other.points)
        for (int i = 0; i < 3; ++i) p[i] = std::ldexp(p[i], exponent);
      const Repaired s = repaired(other);
      EXPECT_EQ(s.surface.faces, r.surface.faces);
      EXPECT_EQ(s.report.degenerate_faces, r.report.degenerate_faces);
    }
  }
}

TEST(Repair, AnyRandomSoup) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    const PolygonSoup soup = random_soup(seed, 4 + static_cast<int>(seed % 40), 1 + static_cast<int>(seed % 97));
    RepairReport report;
    Context context;
    try {
      const TriangleSurface surface = repair(soup, {}, report, Progress(context));
      expect_sound(soup, surface);
      // Duplicates that balance may take surface away, nothing may add some.
      EXPECT_LE(area_of(surface), area_without_duplicates(soup) * (1 + 1e-12));
      if (report.duplicate_faces == 0) {
        EXPECT_NEAR(area_of(surface), area_without_duplicates(soup), 1e-9);
      }
      // Points that were cut apart fall together again, but that is all that is left to repair.
      RepairReport second;
      expect_sound(soup, repair(to_soup(surface), {}, second, Progress(context)));
      EXPECT_EQ(second.isolated_points, 0);
      EXPECT_EQ(second.reoriented_faces == 0 || second.nonmanifold_edges > 0, true);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << error.what();
      EXPECT_NE(std::string(error.what()).find("degenerate"), std::string::npos) << error.what();
    }
  }
}

TEST(Repair, ManySheetsAtOneEdge) {
  for (const int sheets : {3, 4, 7, 8, 150}) {
    PolygonSoup soup;
    soup.points = {{0, 0, 0}, {0, 0, 1}};
    for (int i = 0; i < sheets; ++i) {
      const double angle = 2 * M_PI * i / sheets;
      soup.points.push_back({std::cos(angle), std::sin(angle), 0});
      soup.indices.insert(soup.indices.end(), {0, 1, i + 2});
      soup.offsets.push_back(soup.offsets.back() + 3);
    }
    const Repaired r = repaired(soup);
    EXPECT_EQ(r.report.nonmanifold_edges, 1);
    EXPECT_EQ(r.surface.faces.size(), static_cast<std::size_t>(sheets));
    EXPECT_EQ(r.topology.components, (sheets + 1) / 2);
  }
}

TEST(Repair, RealModels) {
  const auto models = real_models();
  if (models.empty()) GTEST_SKIP() << no_models();
  for (const auto& path : models) {
    SCOPED_TRACE(path.string());
    const PolygonSoup soup = read_polygon_soup(path.string());
    const TopologySummary before = summarize_topology(soup);
    const Repaired r = repaired(soup);
    if (before.nonmanifold_edges || before.nonmanifold_vertices) continue;
    EXPECT_EQ(r.topology.components, before.components);
    EXPECT_EQ(r.topology.boundary_loops, before.boundary_loops);
    EXPECT_EQ(r.topology.genus, before.genus);
    EXPECT_EQ(r.report.reoriented_faces, 0);
  }
}

}  // namespace
}  // namespace hybrid_mesh
