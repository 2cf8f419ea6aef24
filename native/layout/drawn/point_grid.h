// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Points by the cubic cell that holds them.
class PointGrid {
 public:
  explicit PointGrid(double cell) : cell_(cell) {}

  void add(const Vec3& p) {
    cells_[key(p)].push_back(static_cast<int>(points_.size()));
    points_.push_back(p);
  }
  // Forgets all but the first `count` points.
  void resize(int count) {
    while (static_cast<int>(points_.size()) > count) {
      cells_[key(points_.back())].pop_back();
      points_.pop_back();
    }
  }
  // Calls visit(number) for the points within a distance of p, in an order that depends on the points alone.
  template <class Visit>
  void near(const Vec3& p, double distance, const Visit& visit) const {
    const Key low = key(p - Vec3::Constant(distance)), high = key(p + Vec3::Constant(distance));
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto at = cells_.find({x, y, z});
          if (at == cells_.end()) continue;
          for (const int n : at->second)
            if ((points_[n] - p).squaredNorm() <= distance * distance) visit(n);
        }
  }

 private:
  using Key = std::array<std::int64_t, 3>;
  Key key(const Vec3& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x() / cell_)), static_cast<std::int64_t>(std::floor(p.y() / cell_)),
            static_cast<std::int64_t>(std::floor(p.z() / cell_))};
  }

  double cell_;
  std::vector<Vec3> points_;
  std::map<Key, std::vector<int>> cells_;
};

}  // namespace hybrid_mesh
