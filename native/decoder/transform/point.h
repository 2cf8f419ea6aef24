// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

namespace hybrid_mesh {

// A point or a direction. Each operation rounds once and in this order, so that wherever doubles are those of IEEE 754 results are the same bits.
struct Point3 {
  double x = 0, y = 0, z = 0;

  friend Point3 operator+(const Point3& a, const Point3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Point3 operator-(const Point3& a, const Point3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Point3 operator*(double factor, const Point3& p) { return {factor * p.x, factor * p.y, factor * p.z}; }
  friend Point3 operator/(const Point3& p, double divisor) { return {p.x / divisor, p.y / divisor, p.z / divisor}; }
  Point3& operator+=(const Point3& p) { return *this = *this + p; }
  bool is_zero() const { return x == 0 && y == 0 && z == 0; }
  bool is_finite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(z); }
};

inline double dot(const Point3& a, const Point3& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }

inline Point3 cross(const Point3& a, const Point3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

}  // namespace hybrid_mesh
