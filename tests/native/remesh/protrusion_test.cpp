// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/protrusion.h"

#include <gtest/gtest.h>

#include "generated_surfaces.h"
#include "remesh/meshes.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::mesh_of;
using testing::repaired;

// A ball that is drawn out, or dented, above a height by so much.
PolygonSoup changed_ball(double by) {
  PolygonSoup soup = ball(24);
  for (Vec3& p : soup.points)
    if (p.z() > 0.85) p.z() += by * (p.z() - 0.85);
  return soup;
}

TEST(Protrusion, IsOfWhatSticksOutAlone) {
  const QuadMesh mesh = mesh_of(ball(24));
  const Placement here{};
  EXPECT_LT(protrusion(repaired(ball(24)), here, mesh), 1e-9);
  const TriangleSurface spiked = repaired(changed_ball(12)), dented = repaired(changed_ball(-4));
  double top = 0;
  for (const Vec3& p : spiked.points) top = std::max(top, p.z());
  double height = 0;
  for (const Vec3& p : mesh.points) height = std::max(height, p.z());
  EXPECT_NEAR(protrusion(spiked, here, mesh), top - height, 0.05 * (top - height));
  EXPECT_LT(protrusion(dented, here, mesh), 0.05);
  // The same of a surface that is turned inside out, and its mesh with it.
  TriangleSurface turned = spiked;
  for (auto& f : turned.faces) std::swap(f[1], f[2]);
  connect_half_edges(turned);
  QuadMesh other = mesh;
  for (std::size_t i = 0; i < other.indices.size(); i += 3) std::swap(other.indices[i + 1], other.indices[i + 2]);
  EXPECT_DOUBLE_EQ(protrusion(turned, here, other), protrusion(spiked, here, mesh));
}

TEST(Protrusion, WidthsAreThoseOfSquares) {
  QuadMesh mesh;
  mesh.points = {{0, 0, 0}, {3, 0, 0}, {6, 0, 0}, {0, 3, 0}, {3, 3, 0}, {6, 3, 0}};
  mesh.indices = {0, 1, 4, 3, 1, 2, 5, 4};
  mesh.offsets = {0, 4, 8};
  EXPECT_DOUBLE_EQ(mean_width(mesh), 3);
}

}  // namespace
}  // namespace hybrid_mesh
