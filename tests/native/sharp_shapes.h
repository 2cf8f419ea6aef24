// SPDX-License-Identifier: GPL-3.0-or-later
// Solids with flat faces and sharp edges, made up so that tests need no files.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "shapes.h"

namespace hybrid_mesh::shapes {

// Upright walls on an outline, counter-clockwise, and the outline as floor and lid.
inline PolygonSoup prism(const std::vector<Vec2>& outline, double height) {
  const int n = static_cast<int>(outline.size());
  std::vector<Vec3> points;
  std::vector<std::vector<int>> polygons(2);
  for (const double z : {0.0, height})
    for (const Vec2& p : outline) points.push_back({p.x(), p.y(), z});
  for (int i = 0; i < n; ++i) {
    polygons.push_back({i, (i + 1) % n, (i + 1) % n + n, i + n});
    polygons[0].push_back(n - 1 - i);
    polygons[1].push_back(n + i);
  }
  return soup_of(points, polygons);
}

inline PolygonSoup l_prism() { return prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}}, 0.8); }

inline PolygonSoup cylinder(int n, double height) {
  std::vector<Vec2> circle;
  for (int i = 0; i < n; ++i) circle.push_back({std::cos(2 * std::numbers::pi * i / n), std::sin(2 * std::numbers::pi * i / n)});
  return prism(circle, height);
}

// A box with a bar of the same kind through its middle taken out: of genus 1.
inline PolygonSoup frame() {
  const std::vector<Vec2> outer{{0, 0}, {4, 0}, {4, 3}, {0, 3}}, inner{{1, 1}, {3, 1}, {3, 2}, {1, 2}};
  std::vector<Vec3> points;
  for (const double z : {0.0, 0.7})
    for (const auto& ring : {outer, inner})
      for (const Vec2& p : ring) points.push_back({p.x(), p.y(), z});
  std::vector<std::vector<int>> polygons;
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    polygons.push_back({i, j, j + 8, i + 8});
    polygons.push_back({j + 4, i + 4, i + 12, j + 12});
    polygons.push_back({j, i, i + 4, j + 4});
    polygons.push_back({i + 8, j + 8, j + 12, i + 12});
  }
  return soup_of(points, polygons);
}

// So many cubes apart from each other, each turned in its own way, with 2 x 2 squares a face.
inline PolygonSoup cubes(int count) {
  std::vector<Vec3> points;
  std::vector<std::vector<int>> polygons;
  for (int k = 0; k < count; ++k) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.4 * k, Vec3(1, 0.7 * k, -0.3).normalized()).toRotationMatrix();
    std::array<int, 27> number{};
    for (int i = 0; i < 27; ++i) {
      const int column = i % 3, row = i / 3 % 3, layer = i / 9;
      const Vec3 p(column - 1, row - 1, layer - 1);
      if (i == 13) continue;
      number[i] = static_cast<int>(points.size());
      points.push_back(turn * p + Vec3(5 * k, 0, 0));
    }
    const std::array<int, 3> step{1, 3, 9};
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 2})
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) {
            const int du = step[(axis + 1) % 3], dv = step[(axis + 2) % 3], at = side * step[axis] + i * du + j * dv;
            std::vector<int> square{number[at], number[at + du], number[at + du + dv], number[at + dv]};
            if (side == 0) std::reverse(square.begin(), square.end());
            polygons.push_back(square);
          }
  }
  return soup_of(points, polygons);
}

// A block with a hole through it that is wider above a ledge: circles of n points.
inline PolygonSoup stepped_hole(int n) {
  const std::vector<std::array<double, 2>> rings{{1.0, 0.0}, {1.0, 1.0}, {1.6, 1.0}, {1.6, 2.0}};  // radius and height, from below
  std::vector<Vec3> points;
  std::vector<std::vector<int>> polygons;
  for (const auto& [radius, z] : rings)
    for (int i = 0; i < n; ++i)
      points.push_back({radius * std::cos(2 * std::numbers::pi * i / n), radius * std::sin(2 * std::numbers::pi * i / n), z});
  for (std::size_t k = 0; k + 1 < rings.size(); ++k)
    for (int i = 0; i < n; ++i) {
      const int a = static_cast<int>(k) * n + i, b = static_cast<int>(k) * n + (i + 1) % n;
      polygons.push_back({b, a, a + n, b + n});
    }
  const int block = static_cast<int>(points.size());
  for (const double z : {0.0, 2.0})
    for (const Vec2& p : {Vec2(3, 3), Vec2(-3, 3), Vec2(-3, -3), Vec2(3, -3)}) points.push_back({p.x(), p.y(), z});
  // Floor and lid: from each quarter of a circle to a corner, and from each corner's side to the point between two quarters.
  for (const int lid : {0, 1}) {
    const int ring = lid ? 3 * n : 0, corners = block + 4 * lid;
    const auto add = [&](std::vector<int> polygon) {
      if (!lid) std::reverse(polygon.begin(), polygon.end());
      polygons.push_back(polygon);
    };
    for (int q = 0; q < 4; ++q) {
      for (int i = q * n / 4; i < (q + 1) * n / 4; ++i) add({ring + (i + 1) % n, ring + i, corners + q});
      add({ring + (q + 1) * n / 4 % n, corners + q, corners + (q + 1) % 4});
    }
  }
  for (int q = 0; q < 4; ++q) polygons.push_back({block + (q + 1) % 4, block + q, block + 4 + q, block + 4 + (q + 1) % 4});
  return soup_of(points, polygons);
}

// The edges of a mesh whose two faces meet at more than so many degrees, as pairs of points.
inline std::vector<std::pair<Vec3, Vec3>> sharp_edges(const std::vector<Vec3>& points, const std::vector<std::int32_t>& indices,
                                                      const std::vector<std::int64_t>& offsets, double degrees) {
  const auto face_normal = [&](std::size_t f) {
    Vec3 sum = Vec3::Zero();
    const Vec3& o = points[indices[offsets[f]]];
    for (std::int64_t i = offsets[f] + 1; i + 1 < offsets[f + 1]; ++i) {
      const Vec3 a = points[indices[i]] - o, b = points[indices[i + 1]] - o;
      sum += Vec3(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x());
    }
    return Vec3(sum / sum.norm());
  };
  std::vector<std::pair<std::pair<int, int>, std::size_t>> sides;
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f)
    for (std::int64_t i = offsets[f]; i < offsets[f + 1]; ++i)
      sides.push_back({std::minmax<int>(indices[i], indices[i + 1 < offsets[f + 1] ? i + 1 : offsets[f]]), f});
  std::sort(sides.begin(), sides.end());
  std::vector<std::pair<Vec3, Vec3>> edges;
  for (std::size_t k = 0; k + 1 < sides.size(); ++k)
    if (sides[k].first == sides[k + 1].first &&
        face_normal(sides[k].second).dot(face_normal(sides[k + 1].second)) < std::cos(degrees * std::numbers::pi / 180))
      edges.push_back({points[sides[k].first.first], points[sides[k].first.second]});
  return edges;
}

}  // namespace hybrid_mesh::shapes
