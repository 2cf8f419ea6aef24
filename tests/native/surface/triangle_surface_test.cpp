// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangle_surface.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

TriangleSurface surface_of(const PolygonSoup& soup) {
  TriangleSurface surface;
  surface.points = soup.points;
  for (std::size_t f = 0; f < soup.polygon_count(); ++f)
    surface.faces.push_back({soup.indices[3 * f], soup.indices[3 * f + 1], soup.indices[3 * f + 2]});
  return surface;
}

TEST(TriangleSurface, OppositesRunTheOtherWay) {
  for (const PolygonSoup& soup : {tetrahedron(), grid(4, 3), glued_rectangle(7, 5, false, true)}) {
    TriangleSurface surface = surface_of(soup);
    connect_half_edges(surface);
    ASSERT_EQ(surface.opposite.size(), 3 * surface.faces.size());
    int boundary = 0;
    for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
      EXPECT_EQ(TriangleSurface::previous(TriangleSurface::next(h)), h);
      EXPECT_EQ(surface.from(TriangleSurface::next(h)), surface.to(h));
      const int g = surface.opposite[h];
      boundary += g < 0;
      if (g < 0) continue;
      EXPECT_EQ(surface.opposite[g], h);
      EXPECT_EQ(surface.from(g), surface.to(h));
      EXPECT_EQ(surface.to(g), surface.from(h));
    }
    EXPECT_EQ(boundary, soup.points.size() == 20 ? 14 : 0);
  }
}

TEST(TriangleSurface, RefusesWhatIsNoOrientedManifold) {
  const auto refused = [](const std::vector<std::array<int, 3>>& faces) {
    TriangleSurface surface;
    surface.points.resize(5);
    surface.faces = faces;
    try {
      connect_half_edges(surface);
    } catch (const Error& error) {
      return error.code() == ErrorCode::InvalidInput;
    }
    return false;
  };
  EXPECT_TRUE(refused({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
  EXPECT_TRUE(refused({{0, 1, 2}, {0, 1, 3}}));
  EXPECT_TRUE(refused({{0, 1, 1}}));
  EXPECT_TRUE(refused({{0, 1, 5}}));
  EXPECT_TRUE(refused({{0, 1, -1}}));
  EXPECT_FALSE(refused({{0, 1, 2}, {1, 0, 3}}));
  EXPECT_FALSE(refused({}));
}

}  // namespace
}  // namespace hybrid_mesh
