// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/face_filling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "drawn_strokes.h"
#include "layout/drawn/layout_transfer.h"
#include "layout/drawn/quad_complex.h"
#include "layouts.h"
#include "parameterization/initial_map.h"

namespace hybrid_mesh {
namespace {

std::vector<DiskLayout> find_fillings(const PatchLayout& layout, const FaceFillingOptions& options = {}) {
  Context context;
  return hybrid_mesh::find_fillings(layout, options, Progress(context));
}

PatchedSurface fill_faces(DrawnLayout& drawn, const FaceFillingOptions& options = {}) {
  Context context;
  return hybrid_mesh::fill_faces(drawn, options, Progress(context));
}

using testing::cube_edges;
using testing::expect_layout;
using testing::layout_of;
using testing::repaired;
using testing::sphere;

std::vector<DrawnStroke> chords(const std::vector<Vec3>& nodes, const std::vector<std::pair<int, int>>& edges, bool on_sphere = true) {
  TestRandom random(1);
  std::vector<DrawnStroke> strokes;
  for (const auto& [a, b] : edges)
    strokes.push_back(testing::stroke(
        [&, a = a, b = b](double t) {
          const Vec3 p = nodes[a] + t * (nodes[b] - nodes[a]);
          return on_sphere ? Vec3(p.normalized()) : p;
        },
        9, 0, 0, random));
  return strokes;
}

std::vector<Vec3> cube_corners() {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  return corners;
}

// A polygon around the equator, its corners up and down in turn.
std::vector<DrawnStroke> equator(int n, double zigzag) {
  std::vector<Vec3> nodes;
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    nodes.push_back(Vec3(std::cos(angle), std::sin(angle), i % 2 ? zigzag : -zigzag));
    edges.push_back({i, (i + 1) % n});
  }
  return chords(nodes, edges);
}

// The squares and hexagons of a truncated octahedron.
std::vector<DrawnStroke> truncated_octahedron() {
  std::set<std::array<int, 3>> found;
  for (const int a : {-1, 1})
    for (const int b : {-2, 2}) {
      std::array<int, 3> p{0, a, b};
      std::sort(p.begin(), p.end());
      do found.insert(p);
      while (std::next_permutation(p.begin(), p.end()));
    }
  std::vector<Vec3> nodes;
  for (const auto& p : found) nodes.push_back(Vec3(p[0], p[1], p[2]));
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i)
    for (int j = 0; j < i; ++j)
      if (std::abs((nodes[i] - nodes[j]).squaredNorm() - 2) < 1e-9) edges.push_back({i, j});
  return chords(nodes, edges);
}

// Fills a layout, and checks that its quads are what a base domain is made of.
PatchedSurface expect_filled(const TriangleSurface& surface, DrawnLayout drawn) {
  EXPECT_TRUE(drawn.problems.empty());
  const std::vector<DiskLayout> fillings = find_fillings(drawn.layout);
  int quads = 0;
  for (const DiskLayout& filling : fillings) quads += static_cast<int>(filling.quads.size());
  const PatchedSurface filled = fill_faces(drawn);
  for (const LayoutProblem& p : drawn.problems) ADD_FAILURE() << p.message;
  EXPECT_EQ(filled.patch_count(), quads);
  expect_layout(surface, filled);
  const int nodes = static_cast<int>(drawn.layout.nodes.size());
  std::map<std::pair<int, int>, int> joined;
  std::vector<int> valence(filled.node_count, 0);
  std::vector<char> on_boundary(filled.node_count, 0);
  for (int q = 0; q < filled.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      const int a = filled.nodes[q][i], b = filled.nodes[q][(i + 1) % 4];
      EXPECT_EQ(++joined[std::make_pair(a, b)], 1);
      ++valence[a];
      if (filled.neighbours[q][i].patch < 0) on_boundary[a] = on_boundary[b] = 1;
      if (a < nodes) {
        EXPECT_EQ(filled.mesh.points[filled.sides[q][i].front()], drawn.layout.mesh.points[drawn.layout.nodes[a]]);
      }
    }
  for (int n = 0; n < filled.node_count; ++n)
    EXPECT_TRUE(valence[n] >= (on_boundary[n] ? 1 : 3) && valence[n] <= (on_boundary[n] ? 4 : 6)) << n << ": " << valence[n];
  const LayoutOutline outline = outline_of(filled);
  EXPECT_NO_THROW(QuadComplex{outline});
  PatchedSurface mapped = filled;
  Context context;
  EXPECT_NO_THROW(map_patches(mapped, Progress(context)));
  return filled;
}

TEST(FaceFilling, RestoresACubesEdges) {
  const TriangleSurface surface = sphere(16);
  const std::vector<DrawnStroke> all = chords(cube_corners(), cube_edges());
  for (std::size_t left_out = 0; left_out < all.size(); ++left_out) {
    std::vector<DrawnStroke> strokes = all;
    strokes.erase(strokes.begin() + static_cast<std::ptrdiff_t>(left_out));
    EXPECT_EQ(expect_filled(surface, layout_of(surface, strokes)).patch_count(), 6);
  }
  EXPECT_EQ(expect_filled(surface, layout_of(surface, all)).patch_count(), 6);
  // Without two edges that are far from each other.
  std::vector<DrawnStroke> strokes = all;
  strokes.erase(strokes.begin() + 3);
  strokes.erase(strokes.begin());
  EXPECT_EQ(expect_filled(surface, layout_of(surface, strokes)).patch_count(), 6);
}

TEST(FaceFilling, MakesBasesOfPolygons) {
  const TriangleSurface surface = sphere(16);
  for (int n = 6; n <= 16; n += 2)
    for (const double zigzag : {0.0, 0.25, 0.5}) expect_filled(surface, layout_of(surface, equator(n, zigzag)));
  const PatchedSurface filled = expect_filled(surface, layout_of(surface, truncated_octahedron()));
  EXPECT_GE(filled.patch_count(), 6 + 2 * 8);
}

TEST(FaceFilling, KeepsBoundaries) {
  // A hexagon in a square, joined to two of its corners.
  const TriangleSurface sheet = repaired(grid(12, 12));
  std::vector<Vec3> nodes{Vec3(0, 0, 0), Vec3(12, 12, 0)};
  std::vector<std::pair<int, int>> edges{{0, 4}, {1, 2}};
  for (int i = 0; i < 6; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.75) / 6;
    nodes.push_back(Vec3(6 + 3 * std::cos(angle), 6 + 3 * std::sin(angle), 0));
    edges.push_back({2 + i, 2 + (i + 1) % 6});
  }
  const DrawnLayout drawn = layout_of(sheet, chords(nodes, edges, false));
  std::vector<int> sides;
  for (const PatchLayout::Face& face : drawn.layout.faces) sides.push_back(face.side_count());
  std::sort(sides.begin(), sides.end());
  EXPECT_EQ(sides, (std::vector<int>{6, 6, 8}));
  expect_filled(sheet, drawn);
}

TEST(FaceFilling, JoinsNoTwoNodesThatAreJoinedElsewhere) {
  const TriangleSurface surface = sphere(16);
  std::vector<DrawnStroke> strokes = chords(cube_corners(), cube_edges());
  strokes.erase(strokes.begin());
  DrawnLayout drawn = layout_of(surface, strokes);
  const std::vector<DiskLayout> plain = find_fillings(drawn.layout);
  int at = 0;
  while (drawn.layout.faces[at].side_count() == 4) ++at;
  ASSERT_EQ(plain[at].quads.size(), 2u);
  // The side between the two quads is forbidden.
  FaceFillingOptions options;
  const auto node = [&](int c) { return drawn.layout.start(drawn.layout.faces[at].cycles[0][c]); };
  for (const auto& quad : plain[at].quads)
    for (int i = 0; i < 4; ++i)
      if (quad[(i + 1) % 4] != (quad[i] + 1) % 6) options.joined.insert({node(quad[i]), node(quad[(i + 1) % 4])});
  EXPECT_EQ(options.joined.size(), 2u);
  const std::vector<DiskLayout> other = find_fillings(drawn.layout, options);
  for (const auto& quad : other[at].quads)
    for (int i = 0; i < 4; ++i) {
      const int a = quad[i], b = quad[(i + 1) % 4];
      if (a < 6 && b < 6) {
        EXPECT_FALSE(options.joined.count({node(a), node(b)}));
      }
    }
  EXPECT_GT(fill_faces(drawn, options).patch_count(), 6);
}

TEST(FaceFilling, PutsAsManyQuadsAtANodeAsAreAskedFor) {
  const TriangleSurface surface = sphere(16);
  const DrawnLayout drawn = layout_of(surface, equator(8, 0));
  FaceFillingOptions options;
  options.quads_at.assign(drawn.layout.nodes.size(), 0);
  options.quads_at[2] = 3;
  const std::vector<DiskLayout> fillings = find_fillings(drawn.layout, options);
  std::vector<int> around(drawn.layout.nodes.size(), 0);
  for (std::size_t f = 0; f < fillings.size(); ++f)
    for (const auto& quad : fillings[f].quads)
      for (const int c : quad)
        if (c < 8) ++around[drawn.layout.start(drawn.layout.faces[f].cycles[0][c])];
  EXPECT_EQ(around[2], 3);
}

TEST(FaceFilling, LeavesOtherFacesAlone) {
  const TriangleSurface surface = sphere(16);
  std::vector<DrawnStroke> strokes = chords(cube_corners(), cube_edges());
  // A diagonal makes two triangles of a face; without an edge far from it there is a face of six sides as well.
  const std::vector<DrawnStroke> diagonal = chords(cube_corners(), {{0, 3}});
  strokes.erase(std::find_if(cube_edges().begin(), cube_edges().end(), [](const auto& e) { return e == std::pair(5, 7); }) - cube_edges().begin() +
                strokes.begin());
  strokes.push_back(diagonal.front());
  DrawnLayout drawn = layout_of(surface, strokes);
  ASSERT_EQ(drawn.problems.size(), 2u);
  const std::vector<DiskLayout> fillings = find_fillings(drawn.layout);
  for (std::size_t f = 0; f < fillings.size(); ++f)
    EXPECT_EQ(fillings[f].quads.size(), std::vector<std::size_t>({0, 1, 0, 2})[drawn.layout.faces[f].side_count() - 3]);
  EXPECT_EQ(fill_faces(drawn).patch_count(), 0);
  EXPECT_EQ(drawn.problems.size(), 2u);
  // A closed curve: two faces that touch themselves, or have too few sides.
  const DrawnLayout loop = layout_of(surface, {equator(4, 0)[0]});
  for (const DiskLayout& filling : find_fillings(loop.layout)) EXPECT_TRUE(filling.quads.empty());
}

}  // namespace
}  // namespace hybrid_mesh
