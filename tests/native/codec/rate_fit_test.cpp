// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/rate_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "codec/level_chain.h"
#include "codec/stream.h"
#include "surface/distance.h"
#include "wavelets/hierarchies.h"

namespace hybrid_mesh {
namespace {

Context context;

// A wavy sheet, seen by a hierarchy whose vertices slide about on it at random.
Vec3 on_sheet(double x, double y) { return {x, y, 0.2 * std::sin(2.5 * x) * std::cos(2 * y)}; }

HybridMesh noisy_sheet(double noise) {
  HybridMesh mesh = grid(3, 2);
  for (int q = 0; q < mesh.base_count(); ++q) {
    const int column = q % 3, row = q / 3;
    mesh.set_map(q, make_map(16, 0, 1, [&](double u, double v) { return on_sheet(column + u, row + v); }));
  }
  mesh.refine_uniform(4);
  QuadMesh final = mesh.final_mesh();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-noise, noise);
  for (Vec3& p : final.points) {
    const double x = p.x(), y = p.y();
    const bool inside = x > 0.01 && x < 2.99 && y > 0.01 && y < 1.99;
    p = inside ? on_sheet(x + uniform(random), y + uniform(random)) : on_sheet(x, y);
  }
  mesh.set_final_positions(final);
  return mesh;
}

double l2(const PolygonSoup& a, const QuadMesh& b) { return surface_distance(a, to_soup(b), {50000, 1}, Progress(context)).l2; }

PolygonSoup sheet() {
  HybridMesh fine = noisy_sheet(0);
  fine.refine_uniform(6);
  QuadMesh mesh = fine.final_mesh();
  for (Vec3& p : mesh.points) p = on_sheet(p.x(), p.y());
  return to_soup(mesh);
}

// The sheet with a finger that leans over, thinner than coarse faces are. Quads are drawn together where it stands.
Vec3 on_finger(double x, double y) {
  const double dx = x - 1.6, dy = y - 0.9, near = std::exp(-6 * (dx * dx + dy * dy));
  return on_sheet(x - 0.9 * near * dx, y - 0.9 * near * dy) + near * near * Vec3(0.5 * near, 0.2, 1.5);
}

struct Scene {
  HybridMesh mesh;
  PolygonSoup surface;
};

Scene finger(double noise) {
  Scene scene = {noisy_sheet(noise), sheet()};
  QuadMesh final = scene.mesh.final_mesh();
  for (Vec3& p : final.points) p = on_finger(p.x(), p.y());
  scene.mesh.set_final_positions(final);
  for (Vec3& p : scene.surface.points) p = on_finger(p.x(), p.y());
  return scene;
}

TEST(RateFit, TransposedProductsAreTransposed) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    std::mt19937 random(1);
    LevelChain chain(tried.mesh);
    const std::vector<Vec3> points = randomly_placed(tried.mesh.final_mesh(), random).points;
    chain.analyse(points);
    std::srand(4);
    const Columns x = Columns::Random(chain.rows(), 3), y = Columns::Random(static_cast<Eigen::Index>(points.size()), 3);
    const double there = chain.product(x).cwiseProduct(y).sum(), back = chain.transposed_product(y).cwiseProduct(x).sum();
    EXPECT_NEAR(there, back, 1e-10 * (1 + std::abs(there)));
  }
}

// The same surface and levels whatever the frames are.
TEST(RateFit, TurningFramesMovesNothing) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    std::mt19937 random(2);
    LevelChain chain(tried.mesh);
    chain.analyse(randomly_placed(tried.mesh.final_mesh(), random).points);
    const Columns other = Columns::Random(chain.rows(), 3);
    const std::vector<Vec3> before = chain.synthesise(other);
    EXPECT_LT(farthest(chain.synthesise(chain.reframed(other)), before), 1e-10);
  }
}

TEST(RateFit, ComesAsCloseWithFewerBytes) {
  const HybridMesh mesh = noisy_sheet(0.02);
  const PolygonSoup surface = sheet();
  const QuadMesh fitted = fit_for_rate(mesh, surface, RateFitOptions(), Progress(context));
  EXPECT_EQ(fitted.indices, mesh.final_mesh().indices);
  EXPECT_LT(l2(surface, fitted), 1.5 * l2(surface, mesh.final_mesh()) + 1e-4);
  const auto size = [&](StreamFit fit) {
    StreamOptions options;
    options.error = 2e-4;
    options.fit = fit;
    options.surface = std::make_shared<const PolygonSoup>(surface);
    return encode_stream(mesh, options, Progress(context)).size();
  };
  EXPECT_LT(size(StreamFit::Auto), 0.7 * static_cast<double>(size(StreamFit::None)));
}

// Coarse levels miss the finger, or lie on its wrong side.
TEST(RateFit, WhatIsThinIsFoundAgain) {
  for (const double noise : {0.0, 0.01}) {
    const Scene scene = finger(noise);
    const double before = l2(scene.surface, scene.mesh.final_mesh());
    EXPECT_LT(l2(scene.surface, fit_for_rate(scene.mesh, scene.surface, RateFitOptions(), Progress(context))), 1.05 * before + 1e-5);
  }
}

TEST(RateFit, TheWholeOfAStreamIsAsNearAsTheExactOne) {
  for (const Scene& scene : {finger(0.01), Scene{noisy_sheet(0), sheet()}, Scene{noisy_sheet(0.02), sheet()}}) {
    const auto coded = [&](StreamFit fit, double error) {
      StreamOptions options;
      options.fit = fit;
      options.error = error;
      options.surface = std::make_shared<const PolygonSoup>(scene.surface);
      return encode_stream(scene.mesh, options, Progress(context));
    };
    const auto floor = [&](const std::vector<std::uint8_t>& bytes) {
      return l2(scene.surface, decode_stream(bytes.data(), bytes.size()).final_mesh());
    };
    const double exact = floor(coded(StreamFit::None, 0));
    EXPECT_LT(floor(coded(StreamFit::Auto, 0)), 1.07 * exact + 1e-5);
    EXPECT_LE(floor(coded(StreamFit::Auto, 1.1 * exact + 2e-5)), 1.12 * exact + 2e-5);
  }
}

TEST(RateFit, BoundariesStayWhereTheyAre) {
  const HybridMesh mesh = noisy_sheet(0.02);
  const QuadMesh before = mesh.final_mesh(), after = fit_for_rate(mesh, sheet(), RateFitOptions(), Progress(context));
  for (std::size_t v = 0; v < before.points.size(); ++v)
    if (const double x = before.points[v].x(); x < 1e-9 || x > 3 - 1e-9) {
      EXPECT_LT((after.points[v] - before.points[v]).norm(), 0.02);
    }
}

// Nothing is to be done but to stay finite. Surfaces at random run through themselves everywhere, which takes long: some of the hierarchies.
TEST(RateFit, HierarchiesOfAllKinds) {
  const std::vector<Hierarchy> all = hierarchies();
  for (std::size_t i = 0; i < all.size(); i += 7) {
    const Hierarchy& tried = all[i];
    SCOPED_TRACE(tried.name);
    std::mt19937 random(3);
    HybridMesh mesh = tried.mesh;
    const QuadMesh placed = randomly_placed(mesh.final_mesh(), random);
    mesh.set_final_positions(placed);
    RateFitOptions options;
    options.samples = 2;
    options.rounds = options.coarse_rounds = 1;
    for (const Vec3& p : fit_for_rate(mesh, to_soup(placed), options, Progress(context)).points) ASSERT_TRUE(p.allFinite());
  }
}

TEST(RateFit, AnEditedMeshLiesNotOnItsSurface) {
  HybridMesh mesh = noisy_sheet(0);
  EXPECT_TRUE(lies_on(mesh.final_mesh(), sheet(), Progress(context)));
  QuadMesh final = mesh.final_mesh();
  for (Vec3& p : final.points) p.z() += std::exp(-20 * ((p.x() - 1.5) * (p.x() - 1.5) + (p.y() - 1) * (p.y() - 1)));
  EXPECT_FALSE(lies_on(final, sheet(), Progress(context)));
  mesh.set_final_positions(final);
  const auto bytes = [&](StreamFit fit) {
    StreamOptions options;
    options.fit = fit;
    return encode_stream(mesh, options, Progress(context));
  };
  EXPECT_EQ(bytes(StreamFit::Auto), bytes(StreamFit::None));
}

}  // namespace
}  // namespace hybrid_mesh
