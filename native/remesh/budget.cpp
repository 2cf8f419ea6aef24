// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/budget.h"

#include <algorithm>
#include <cmath>

#include "base/limits.h"

namespace hybrid_mesh {
namespace {

constexpr int kMostPlannedLevels = 6;  // above a base whose size is free: more would leave it a few quads
// What is around a rod of unit length is its area long, and so many quads of a base at least belong there: of fewer than three none could be square.
constexpr double kQuadsAround = 3.5;

constexpr double kQuadsBetweenFeatures = 300;  // in a base between features, in which quads have less to choose from
constexpr double kQuadsACorner = 1.5;          // of a feature, each of which is a node

}  // namespace

std::int64_t uniform_vertices(std::int64_t quads, std::int64_t euler, std::int64_t boundary_sides, int levels) {
  const std::int64_t cells = std::int64_t{1} << (2 * levels);
  // At level 0: V = B + chi + E / 2, since 4 B = 2 E_all - E.
  return levels == 0 ? quads + euler + boundary_sides / 2 : quads * cells + euler + (boundary_sides << levels) / 2;
}

Budget plan_budget(const RemeshOptions& options, const Source& source, const Target& target) {
  Budget b;
  b.vertices = options.vertices > 0 ? options.vertices : source.points;
  if (target.vertices > 0) b.vertices = target.vertices;
  b.vertices /= source.copies();
  // Roughly what the topology asks for at least.
  const TopologySummary& topology = source.topology;
  const bool between = target.features && source.keeps_features && source.has_inner_features;
  const double least =
      6.0 * topology.components + 8 * topology.genus + 2.6 * topology.boundary_loops + (between ? kQuadsACorner * source.feature_corners : 0);
  const double for_rods = topology.boundary_loops > 0 ? 0 : kQuadsAround * kQuadsAround / source.area;  // a strip is none
  const double small = static_cast<double>(b.vertices) / (between ? 16 : 64), most = between ? kQuadsBetweenFeatures : 150.0;
  const double enough = std::max(std::clamp(small, 20.0, most), std::min(std::max(1.7 * least, for_rods), b.vertices / 4.0));
  if (options.levels >= 0 && options.refinement == Refinement::Uniform) {
    b.levels = options.levels;
  } else {
    while (b.levels < kMostPlannedLevels && static_cast<double>(b.vertices) / std::pow(4.0, b.levels + 1) >= enough) ++b.levels;
  }
  return with_levels(b, std::max(0, b.levels - target.levels_less), options, source);
}

Budget with_levels(Budget b, int levels, const RemeshOptions& options, const Source& source) {
  b.levels = levels;
  const double cells = std::pow(4.0, levels);
  b.boundary_side = 0.5 * std::pow(2.0, levels) / cells;
  const double copies = source.copies();
  b.base_size = (static_cast<double>(b.vertices) - static_cast<double>(source.made.euler) / copies) / cells;
  if (options.base == BaseSize::Given) b.base_size = options.base_quads / copies, b.boundary_side = 0;
  if (options.base == BaseSize::Minimal) b.base_size = 6, b.boundary_side = 0;
  return b;
}

int levels_within(std::int64_t vertices, int level, std::int64_t quads, std::int64_t euler, std::int64_t boundary_sides) {
  int levels = level;
  while (levels < limits::most_levels && uniform_vertices(quads, euler, boundary_sides, levels + 1 - level) <= vertices) ++levels;
  return levels;
}

}  // namespace hybrid_mesh
