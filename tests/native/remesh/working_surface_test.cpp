// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/working_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "generated_surfaces.h"
#include "surface/distance.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {
namespace {

using Corners = std::array<std::array<double, 3>, 3>;

TriangleSurface of_unit_size(const PolygonSoup& soup) {
  TriangleSurface surface = testing::repaired(soup);
  const Placement placement = placement_of(surface.points);
  for (Vec3& p : surface.points) p = placement.to_unit(p);
  return surface;
}

WorkingSurface working(const TriangleSurface& surface, std::int64_t faces) {
  Context context;
  return make_working_surface(surface, Placement(), faces, Progress(context));
}

Corners corners(const TriangleSurface& surface, int f) {
  Corners c;
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = surface.points[surface.faces[f][i]];
    c[i] = {p.x(), p.y(), p.z()};
  }
  std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
  return c;
}

double smallest_angle(const TriangleSurface& surface, int f) {
  double smallest = 180;
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = surface.points[surface.faces[f][i]];
    const Vec3 a = surface.points[surface.faces[f][(i + 1) % 3]] - p, b = surface.points[surface.faces[f][(i + 2) % 3]] - p;
    smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi);
  }
  return smallest;
}

// The lower half of a dented ball in triangles that are thin in places, as of a scan; `lid`: closed by a flat fan of needles.
PolygonSoup bowl(bool lid) {
  PolygonSoup soup = to_soup(testing::repaired(testing::ball(24, 0)));
  for (Vec3& p : soup.points) p = Vec3(p.x(), 0.25 * p.y(), p.z());
  if (!lid) return soup;
  const TriangleSurface open = testing::repaired(soup);
  soup = to_soup(open);
  const int middle = static_cast<int>(soup.points.size());
  soup.points.push_back(Vec3::Zero());
  for (int h = 0; h < static_cast<int>(open.opposite.size()); ++h) {
    if (open.opposite[h] >= 0) continue;
    soup.indices.insert(soup.indices.end(), {open.to(h), open.from(h), middle});
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  return soup;
}

bool is_on_lid(const TriangleSurface& surface, int f) {
  const auto& [a, b, c] = surface.faces[f];
  return std::abs(surface.points[a].z() - surface.points[b].z()) + std::abs(surface.points[a].z() - surface.points[c].z()) < 1e-9;
}

TEST(WorkingSurface, LeavesScansAlone) {
  for (const PolygonSoup& soup : {testing::ball(24), bowl(false)}) {
    const TriangleSurface scan = of_unit_size(soup);
    const WorkingSurface made = working(scan, static_cast<std::int64_t>(scan.faces.size()) / 4);
    EXPECT_EQ(made.mesh.points, scan.points);
    EXPECT_EQ(made.mesh.faces, scan.faces);
    for (std::size_t f = 0; f < scan.faces.size(); ++f) ASSERT_EQ(made.mesh.source_face[f], static_cast<int>(f));
  }
}

TEST(WorkingSurface, MendsNeedlesWhereTheyAre) {
  const TriangleSurface scan = of_unit_size(bowl(true));
  const auto count = static_cast<int>(scan.faces.size());
  int thin = 0;
  double lid = 0;
  for (int f = 0; f < count; ++f) {
    const auto& [a, b, c] = scan.faces[f];
    if (is_on_lid(scan, f))
      lid += 0.5 * (scan.points[b] - scan.points[a]).cross(scan.points[c] - scan.points[a]).norm();
    else
      thin += smallest_angle(scan, f) < 22;
  }
  ASSERT_GT(thin, 50);  // on the bowl there is something to leave alone
  const WorkingSurface made = working(scan, count / 2);

  std::set<Corners> kept;
  int needles = 0;
  double lid_after = 0;
  for (int f = 0; f < static_cast<int>(made.mesh.faces.size()); ++f) {
    kept.insert(corners(made.mesh, f));
    if (!is_on_lid(made.mesh, f)) continue;
    const auto& [a, b, c] = made.mesh.faces[f];
    lid_after += 0.5 * (made.mesh.points[b] - made.mesh.points[a]).cross(made.mesh.points[c] - made.mesh.points[a]).norm();
    needles += smallest_angle(made.mesh, f) < 10;
  }
  EXPECT_LE(needles, 8);
  EXPECT_NEAR(lid_after, lid, 1e-9);
  // All faces of the bowl are there, but for splits of edges that it shares with the lid.
  for (int f = 0; f < count; ++f) {
    bool beside_lid = is_on_lid(scan, f);
    for (int h = 3 * f; h < 3 * f + 3; ++h) beside_lid |= is_on_lid(scan, scan.opposite[h] / 3);
    if (!beside_lid) {
      ASSERT_TRUE(kept.contains(corners(scan, f))) << f;
    }
  }
  const TopologySummary before = summarize_topology(to_soup(scan)), after = summarize_topology(to_soup(made.mesh));
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.components, before.components);
  Context context;
  EXPECT_LE(surface_distance(to_soup(scan), to_soup(made.mesh), {20000, 1}, Progress(context)).hausdorff, 1e-9);
}

}  // namespace
}  // namespace hybrid_mesh
