// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/disks/grid_region.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace hybrid_mesh {
namespace {

class GridRegion {
 public:
  explicit GridRegion(const GridWalk& walk) : walk_(walk), nodes_(static_cast<int>(walk.direction.size())) {}

  std::optional<std::vector<std::array<int, 4>>> cells() {
    if (!place() || !flood()) return std::nullopt;
    return std::move(cells_);
  }

 private:
  // A point, or the cell that has it as its least corner. In each quadrant x >= 0 and y >= 0 are counted from the centre.
  struct Place {
    int quadrant, x, y;
  };

  // Finds the quadrants of the walk's nodes. False if the walk does not go around once, or meets itself or the centre.
  bool place() {
    const int turns = walk_.turns;
    if (turns < 3 || turns > 5 || (turns == 4 && !walk_.closed())) return false;
    std::array<int, 2> centre{0, 0};
    if (turns == 4) {
      // One quadrant holds all.
      quadrants_ = 1;
      for (const auto& at : walk_.at) centre = {std::min(centre[0], at[0] - 1), std::min(centre[1], at[1] - 1)};
    } else {
      if ((walk_.at.back()[0] + walk_.at.back()[1]) % 2) return false;
      quadrants_ = turns;
      centre = walk_.centre();
    }
    std::vector<Place> places;
    int quadrant = 0, first = 0;  // counted on as the walk goes around
    for (int i = 0; i <= nodes_; ++i) {
      const int x = walk_.at[i][0] - centre[0], y = walk_.at[i][1] - centre[1];
      if (x == 0 && y == 0) return false;
      const int now = x > 0 && y >= 0 ? 0 : x <= 0 && y > 0 ? 1 : x < 0 ? 2 : 3;
      if (i == 0) first = quadrant = now;
      quadrant += (((now - quadrant + 1) % 4) + 4) % 4 - 1;
      const std::array<int, 2> from_centre = now == 0   ? std::array{x, y}
                                             : now == 1 ? std::array{y, -x}
                                             : now == 2 ? std::array{-x, -y}
                                                        : std::array{-y, x};
      places.push_back({((quadrant % quadrants_) + quadrants_) % quadrants_, from_centre[0], from_centre[1]});
      width_ = std::max({width_, from_centre[0] + 2, from_centre[1] + 2});
    }
    if (turns != 4 && quadrant - first != turns) return false;
    point_.assign(static_cast<std::size_t>(quadrants_) * width_ * width_, -1);
    reached_.assign(point_.size(), 0);
    for (int i = 0; i < nodes_; ++i) {
      if (point_[slot(places[i])] >= 0) return false;
      point_[slot(places[i])] = i;
    }
    start_ = places[0];
    return true;
  }

  std::size_t slot(const Place& p) const { return (static_cast<std::size_t>(p.quadrant) * width_ + p.x) * width_ + p.y; }
  bool in_range(const Place& cell) const { return cell.x + 1 < width_ && cell.y + 1 < width_; }

  // The point at a corner of a cell in range. One on the axis between two quadrants has y = 0, the centre quadrant 0.
  int& corner(const Place& cell, int i) {
    const int x = cell.x + (i == 1 || i == 2), y = cell.y + (i >= 2);
    if (x > 0) return point_[slot({cell.quadrant, x, y})];
    return point_[slot({y > 0 ? (cell.quadrant + 1) % quadrants_ : 0, y, 0})];
  }

  Place across(const Place& cell, int side) const {
    const auto [quadrant, x, y] = cell;
    if (side == 1) return {quadrant, x + 1, y};
    if (side == 2) return {quadrant, x, y + 1};
    if (side == 0) return y > 0 ? Place{quadrant, x, y - 1} : Place{(quadrant + quadrants_ - 1) % quadrants_, 0, x};
    return x > 0 ? Place{quadrant, x - 1, y} : Place{(quadrant + 1) % quadrants_, y, 0};
  }

  bool is_boundary(int from, int to) const { return from >= 0 && to >= 0 && from < nodes_ && to == (from + 1) % nodes_; }

  // Collects the cells to the left of the walk and all that they reach without crossing it. False if that leads out.
  bool flood() {
    std::vector<Place> stack;
    for (int side = 0; side < 4; ++side)
      for (int next = 0; next < 4; ++next)
        for (const Place& cell : {start_, across(start_, side), across(across(start_, side), next)})
          for (int i = 0; i < 4 && in_range(cell) && stack.empty(); ++i)
            if (corner(cell, i) == 0 && corner(cell, (i + 1) % 4) == 1) stack.push_back(cell);
    if (stack.empty()) return false;
    reached_[slot(stack[0])] = 1;
    int points = nodes_;
    while (!stack.empty()) {
      const Place cell = stack.back();
      stack.pop_back();
      std::array<int, 4> corners;
      for (int i = 0; i < 4; ++i) {
        int& point = corner(cell, i);
        if (point < 0) point = points++;
        corners[i] = point;
      }
      cells_.push_back(corners);
      for (int side = 0; side < 4; ++side) {
        const int a = corners[side], b = corners[(side + 1) % 4];
        if (is_boundary(a, b)) continue;
        const Place next = across(cell, side);
        if (is_boundary(b, a) || !in_range(next)) return false;
        if (reached_[slot(next)]++ == 0) stack.push_back(next);
      }
    }
    return true;
  }

  const GridWalk& walk_;
  int nodes_, quadrants_ = 1, width_ = 0;
  Place start_{};
  std::vector<int> point_;
  std::vector<char> reached_;
  std::vector<std::array<int, 4>> cells_;
};

}  // namespace

std::optional<std::vector<std::array<int, 4>>> cells_inside(const GridWalk& walk) { return GridRegion(walk).cells(); }

}  // namespace hybrid_mesh
