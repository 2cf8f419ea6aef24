// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "layout/curves/surface_paths.h"
#include "layout/drawn/drawn_layout.h"

namespace hybrid_mesh {

// A stroke on the surface, on its way to become curves.
struct StrokePath {
  int stroke = -1;
  DrawnStroke::Fit fit = DrawnStroke::Fit::Tight;
  std::vector<FacePoint> points;
  std::vector<double> at;  // arc length
  std::array<bool, 2> at_boundary{};
  std::array<int, 2> junction{-1, -1};
  struct Stop {
    double at;
    int junction;
  };
  std::vector<Stop> stops;  // junctions that it passes through
  bool dropped = false;

  double length() const { return at.back(); }
  // Its points between two arc lengths.
  std::vector<Vec3> line(double from = -std::numeric_limits<double>::infinity(), double to = std::numeric_limits<double>::infinity()) const {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (at[i] >= from && at[i] <= to) out.push_back(points[i].at);
    return out;
  }
};

// Ends of strokes that meet, or a node of the boundary.
struct StrokeJunction {
  std::vector<std::pair<int, int>> ends;  // path, 0: its start, 1: its end
  FacePoint place;
  bool boundary = false;
  int vertex = -1;
};

}  // namespace hybrid_mesh
