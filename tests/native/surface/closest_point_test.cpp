// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/closest_point.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <thread>

#include "base/error.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

struct Triangles {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
};

Triangles random_triangles(std::uint64_t seed, int count) {
  TestRandom random(seed);
  Triangles t;
  for (int f = 0; f < count; ++f) {
    const int base = static_cast<int>(t.points.size());
    const Vec3 at(random.unit() * 5, random.unit() * 5, random.unit() * 5);
    for (int i = 0; i < 3; ++i) t.points.push_back(at + Vec3(random.unit(), random.unit(), random.unit()));
    t.faces.push_back({base, base + 1, random.below(6) ? base + 2 : base + random.below(2)});  // some are segments
  }
  return t;
}

Vec3 place(const Triangles& t, const ClosestPoint& c) {
  Vec3 p = Vec3::Zero();
  for (int i = 0; i < 3; ++i) p += c.weights[i] * t.points[t.faces[c.face][i]];
  return p;
}

TEST(ClosestPoint, IsTheClosestOfAllFaces) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Triangles t = random_triangles(seed, 1 + static_cast<int>(seed * seed) * 3);
    const SurfaceDistanceQuery query(t.points, t.faces);
    std::vector<SurfaceDistanceQuery> single;
    for (const auto& face : t.faces) single.emplace_back(t.points, std::vector<std::array<int, 3>>{face});
    TestRandom random(seed + 100);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p(random.unit() * 8 - 1, random.unit() * 8 - 1, random.unit() * 8 - 1);
      const ClosestPoint c = query.closest(p);
      double best = 1e300;
      for (const auto& one : single) best = std::min(best, one.closest(p).squared_distance);
      EXPECT_NEAR(c.squared_distance, best, 1e-12);
      EXPECT_NEAR(c.weights[0] + c.weights[1] + c.weights[2], 1, 1e-12);
      for (const double w : c.weights) EXPECT_GE(w, 0);
      EXPECT_NEAR((place(t, c) - p).squaredNorm(), c.squared_distance, 1e-12);
      const ClosestPoint guessed = query.closest(p, random.below(static_cast<int>(t.faces.size())));
      EXPECT_EQ(guessed.face, c.face);
      EXPECT_EQ(guessed.weights, c.weights);
    }
  }
}

// The closest point of one triangle against a fine lattice of its points.
TEST(ClosestPoint, OfATriangle) {
  TestRandom random(5);
  for (int round = 0; round < 300; ++round) {
    Triangles t;
    for (int i = 0; i < 3; ++i) t.points.push_back({random.unit(), random.unit(), random.unit()});
    t.faces = {{0, 1, 2}};
    const Vec3 p(random.unit() * 3 - 1, random.unit() * 3 - 1, random.unit() * 3 - 1);
    const ClosestPoint c = SurfaceDistanceQuery(t.points, t.faces).closest(p);
    double best = 1e300;
    constexpr int n = 60;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) best = std::min(best, (p - (i * t.points[0] + j * t.points[1] + (n - i - j) * t.points[2]) / n).norm());
    EXPECT_LE(std::sqrt(c.squared_distance), best + 1e-12);
    EXPECT_GE(std::sqrt(c.squared_distance), best - 0.05);
  }
}

TEST(ClosestPoint, GivesTheFirstOfEqualFaces) {
  PolygonSoup soup = grid(6, 6);
  std::vector<std::array<int, 3>> faces;
  for (std::size_t f = 0; f < soup.polygon_count(); ++f) faces.push_back({soup.indices[3 * f], soup.indices[3 * f + 1], soup.indices[3 * f + 2]});
  const SurfaceDistanceQuery query(soup.points, faces);
  for (int v = 0; v < static_cast<int>(soup.points.size()); ++v) {
    int first = 0;
    while (std::find(faces[first].begin(), faces[first].end(), v) == faces[first].end()) ++first;
    for (int guess = -1; guess < static_cast<int>(faces.size()); guess += 7) EXPECT_EQ(query.closest(soup.points[v], guess).face, first);
  }
}

TEST(ClosestPoint, FromSeveralThreads) {
  const Triangles t = random_triangles(3, 500);
  const SurfaceDistanceQuery query(t.points, t.faces);
  std::vector<std::vector<int>> found(4);
  std::vector<std::thread> threads;
  for (auto& faces : found)
    threads.emplace_back([&query, &faces] {
      TestRandom random(9);
      for (int i = 0; i < 2000; ++i) faces.push_back(query.closest({random.unit() * 5, random.unit() * 5, random.unit() * 5}).face);
    });
  for (auto& thread : threads) thread.join();
  for (const auto& faces : found) EXPECT_EQ(faces, found[0]);
}

TEST(ClosestPoint, OfNothingIsRefused) { EXPECT_THROW(SurfaceDistanceQuery({}, {}), Error); }

}  // namespace
}  // namespace hybrid_mesh
