// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace hybrid_mesh {

// The walk along a front whose nodes lack so many quads, on the regular grid.
struct GridWalk {
  int turns = 0;                       // right angles to the left, all in all
  std::vector<std::array<int, 2>> at;  // where each node lies, and where the walk ends
  std::vector<int> direction;          // of the edge after each node: 0 .. 3

  explicit GridWalk(const std::vector<int>& lacking) {
    at.reserve(lacking.size() + 1);
    direction.reserve(lacking.size());
    at.push_back({0, 0});
    int heading = 0;
    for (std::size_t i = 0; i < lacking.size(); ++i) {
      turns += 2 - lacking[i];
      if (i > 0) heading += 2 - lacking[i];
      direction.push_back(((heading % 4) + 4) % 4);
      at.push_back({at[i][0] + step(i)[0], at[i][1] + step(i)[1]});
    }
  }
  const std::array<int, 2>& step(std::size_t i) const {
    static constexpr std::array<int, 2> kSteps[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    return kSteps[direction[i]];
  }
  bool closed() const { return at.back() == at.front(); }
  // The point that the walk turns around, if it turns by 3 or 5 right angles.
  std::array<int, 2> centre() const {
    const auto [a, b] = at.back();
    return turns == 5 ? std::array{(a - b) / 2, (a + b) / 2} : std::array{(a + b) / 2, (b - a) / 2};
  }
  // How far to the left of the edge after node i a point lies.
  int height(std::size_t i, const std::array<int, 2>& point) const { return step(i)[0] * (point[1] - at[i][1]) - step(i)[1] * (point[0] - at[i][0]); }
};

// The cells that such a walk encloses: of the plane's grid or, for one that turns by 3 or 5, of the grid on three or five quadrants around a point.
// Corners counter-clockwise: the nodes of the walk, then the points inside. Nothing if the walk does not go around once, or meets itself or that
// point.
std::optional<std::vector<std::array<int, 4>>> cells_inside(const GridWalk& walk);

}  // namespace hybrid_mesh
