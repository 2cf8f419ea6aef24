// SPDX-License-Identifier: GPL-3.0-or-later
// Regions that are no disks: rings, with rims or a free boundary, and pieces with handles.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "codec/container.h"
#include "remesh/plans.h"
#include "remesh/region_update.h"
#include "remesh/soundness.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::expect_maps_without_defects;
using testing::expect_sound;
using testing::Json;
using testing::refusal_of;
using testing::run;
using testing::torus;

constexpr int kLevel = 2;

RemeshOptions options(int base_quads) {
  RemeshOptions options;
  options.levels = 3;
  options.base = BaseSize::Given;
  options.base_quads = base_quads;
  options.semi_regular = true;
  return options;
}

std::string address_of(const RemeshResult& r, int node) {
  const HybridMesh& h = r.hierarchy;
  std::string path;
  for (; !h.is_root(node); node = h.parent(node)) path = "." + std::to_string(node - h.first_child(h.parent(node))) + path;
  return std::to_string(r.plan_root[node]) + path;
}

// The quads of a level whose middle is where `where` says.
Json quads_where(const RemeshResult& r, const std::function<bool(const Vec3&)>& where) {
  const QuadMesh mesh = r.hierarchy.level_mesh(kLevel);
  Json quads = Json::array();
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    Vec3 middle = Vec3::Zero();
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) middle += r.hierarchy.sample(mesh.vertex[mesh.indices[i]]).position / 4;
    if (where(middle)) quads.push_back(address_of(r, mesh.node[f]));
  }
  return quads;
}

RemeshResult with_operation(const PolygonSoup& soup, const RemeshOptions& how, const RemeshResult& plain, const Json& operation) {
  Json plan = Json::parse(plain.plan);
  plan["operations"] = Json::array({operation});
  return run(soup, how, plan.dump());
}

// Does an operation on some quads, from a plan and on the finished hierarchy, and expects that both are sound. Returns the number of its new quads, 0
// where it is refused as the quads are no region or have no such layout.
int try_operation(const PolygonSoup& soup, const RemeshOptions& how, const RemeshResult& plain, const Json& quads, Json operation) {
  operation["level"] = kLevel;
  operation["quads"] = quads;
  RemeshResult made;
  const std::string refusal = refusal_of([&] { made = with_operation(soup, how, plain, operation); });
  Context context;
  RegionUpdate update;
  const std::string other =
      refusal_of([&] { update = repatch_hierarchy(plain.hierarchy, plain.plan_root, plan_region_from_json(operation.dump()), Progress(context)); });
  EXPECT_EQ(refusal.empty(), other.empty()) << refusal << other;
  if (!refusal.empty()) return 0;
  expect_sound(made);
  expect_maps_without_defects(made.hierarchy);
  EXPECT_EQ(made.hierarchy.operation_count(), 1);
  const auto bytes = encode_hierarchy(made.hierarchy, "{}");
  EXPECT_EQ(bytes, encode_hierarchy(run(soup, how, made.plan).hierarchy, "{}"));
  EXPECT_TRUE(find_defects(update.hierarchy).empty());
  expect_maps_without_defects(update.hierarchy);
  EXPECT_EQ(made.hierarchy.operation(0).roots.size(), update.hierarchy.operation(update.operation).roots.size());
  return static_cast<int>(made.hierarchy.operation(0).roots.size());
}

double angle_of(const Vec3& p) { return std::atan2(p.y(), p.x()); }

// Of a torus: its tube between two angles.
const auto in_part = [](double width) { return [=](const Vec3& p) { return std::abs(angle_of(p)) < width; }; };

TEST(RegionTopology, RowsBetweenTwoRims) {
  const PolygonSoup soup = torus(40, 16);
  const RemeshOptions how = options(40);
  const RemeshResult plain = run(soup, how);
  int done = 0;
  for (const double width : {0.5, 1.1}) {
    const Json quads = quads_where(plain, in_part(width));
    for (const Json& layout : {Json{{"layout", "rows"}}, Json{{"layout", "rows"}, {"height", 5}}, Json{{"layout", "automatic"}}})
      done += try_operation(soup, how, plain, quads, layout) > 0;
  }
  EXPECT_GE(done, 4);
}

TEST(RegionTopology, EvenQuadsWhateverTheTopology) {
  const PolygonSoup soup = torus(40, 16);
  const RemeshOptions how = options(40);
  const RemeshResult plain = run(soup, how);
  // A disk, a part of the tube, and all but a disk, which has the handle.
  const std::vector<std::function<bool(const Vec3&)>> parts{[](const Vec3& p) { return (p - Vec3(1.4, 0, 0)).norm() < 0.5; }, in_part(0.9),
                                                            [](const Vec3& p) { return (p - Vec3(1.4, 0, 0)).norm() > 0.6; }};
  for (const auto& part : parts) {
    const Json quads = quads_where(plain, part);
    const int as_many = try_operation(soup, how, plain, quads, {{"layout", "even"}});
    EXPECT_NEAR(as_many, static_cast<double>(quads.size()), 0.4 * quads.size());
    if (quads.size() > 100) continue;
    const int fewer = try_operation(soup, how, plain, quads, {{"layout", "even"}, {"even_quads", quads.size() / 2}});
    EXPECT_LT(fewer, as_many);
    EXPECT_GT(fewer, 0);
  }
}

TEST(RegionTopology, RowsFromARimToTheBoundary) {
  const PolygonSoup soup = ball(24, 0.4);
  const RemeshOptions how = options(30);
  const RemeshResult plain = run(soup, how);
  int done = 0;
  for (const double height : {0.1, 0.2}) {
    const Json quads = quads_where(plain, [&](const Vec3& p) { return p.z() > height; });
    for (const int rows : {0, 3}) done += try_operation(soup, how, plain, quads, {{"layout", "rows"}, {"height", rows}}) > 0;
  }
  EXPECT_GE(done, 2);
}

TEST(RegionTopology, RefusesWhatARingAloneCanHave) {
  const PolygonSoup soup = torus(40, 16);
  const RemeshOptions how = options(40);
  const RemeshResult plain = run(soup, how);
  const Json disk = quads_where(plain, [](const Vec3& p) { return (p - Vec3(1.4, 0, 0)).norm() < 0.5; });
  const Json ring = quads_where(plain, in_part(0.9));
  const auto refusal = [&](const Json& quads, Json operation) {
    operation["level"] = kLevel;
    operation["quads"] = quads;
    return refusal_of([&] { with_operation(soup, how, plain, operation); });
  };
  EXPECT_NE(refusal(disk, {{"layout", "rows"}}).find("ring"), std::string::npos);
  EXPECT_NE(refusal(ring, {{"layout", "cubes"}}).find("disk"), std::string::npos);
  Json all = quads_where(plain, [](const Vec3&) { return true; });
  EXPECT_NE(refusal(all, {{"layout", "even"}}).find("boundary"), std::string::npos);
}

// A base of few quads around each handle; on a finer level most of the surface, with all its handles, is laid out anew.
TEST(RegionTopology, MinimalBasesOfSurfacesWithHandles) {
  for (const int windows : {2, 3}) {
    const PolygonSoup soup = testing::plate_with_windows(windows, 6);
    RemeshOptions how;
    how.base = BaseSize::Minimal;
    how.vertices = 3000;
    const RemeshResult made = run(soup, how);
    expect_sound(made);
    expect_maps_without_defects(made.hierarchy);
    EXPECT_EQ(summarize_topology(to_soup(made.repaired)).genus, windows);
    EXPECT_LE(made.hierarchy.base_count(), 15 * windows);
    EXPECT_GE(made.hierarchy.operation_count(), 1);
    EXPECT_EQ(encode_hierarchy(made.hierarchy, "{}"), encode_hierarchy(run(soup, how, made.plan).hierarchy, "{}"));
  }
}

}  // namespace
}  // namespace hybrid_mesh
