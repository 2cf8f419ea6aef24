// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/layout_search_options.h"

#include <algorithm>
#include <cmath>

namespace hybrid_mesh {
namespace {

// Irregular operations are on one level: the first with enough quads to follow the shape's features, or the last that is wanted, unless that has too
// few to choose from. Two levels with operations (towers on one of some hundred quads, even quads on the next) were tried: quads are inserted twice,
// and neither the distances nor the angles are better.
constexpr double kLeastQuads = 60, kEnoughQuads = 250;
constexpr int kFewQuads = 20;
// A level that is passed through: quadrisected, on so many vertices a quad.
LevelSearchOptions plain_level(double quads, double vertices) {
  LevelSearchOptions level;
  level.map.vertices_a_quad = std::max(15.0, 1000 / quads);
  level.vertices = std::max(1500.0, vertices * quads);
  level.rounds = 0;
  return level;
}

// The number near `quads`, with so many sides on the boundary, of which a whole number of levels makes a mesh of the size asked for.
double quads_for_budget(const Budget& budget, const TopologySummary& topology, double quads, double boundary_sides) {
  const auto vertices = static_cast<double>(budget.vertices - topology.euler);
  for (double parts = 1;; parts *= 2) {
    const double size = vertices / (parts * parts) - 0.5 * boundary_sides / parts;
    if (size <= 1.6 * quads) return size;
  }
}

void search_finer_levels(LayoutSearchOptions& search, const RemeshOptions& options, const Budget& budget, const TopologySummary& topology,
                         const BaseDomain& base, const BaseRequest& request) {
  LevelSearchOptions& first = search.levels.front();
  first.vertices = std::max(base.boundary_sides() > 0 ? 3000.0 : 1500.0, first.vertices);
  const bool finer = !options.semi_regular && request.operations && base.quads() < kEnoughQuads && options.levels != 0;
  // Quads far larger than the shape's features leave nothing yet to choose between layouts by.
  if ((finer && !request.base_edits) || base.quads() < kFewQuads) {
    first.rounds = 0;
    first.map.vertices_a_quad = std::max(first.map.vertices_a_quad, 1000.0 / base.quads());
  }
  if (!finer) return;
  double quads = base.quads(), sides = base.boundary_sides();
  while (quads < kEnoughQuads && static_cast<int>(search.levels.size()) - 1 != options.levels) {
    quads *= 4;
    sides *= 2;
    search.levels.push_back(plain_level(quads, request.vertices_a_quad > 0 ? request.vertices_a_quad : sides > 0 ? 30 : 15));
  }
  if (quads < kLeastQuads) return;
  LevelSearchOptions& last = search.levels.back();
  // Quads of even size first, which are to be refined regularly from there on, then what sticks out of them.
  const double size = budget.shrink * quads_for_budget(budget, topology, quads, sides);
  last.even_quads = size - kRoomForARing;
  last.vertices = std::max(1500.0, last.vertices * std::min(1.0, size / quads));
  last.uneven = excess_of_stretch(std::pow(options.stretch_threshold, 0.45));
  last.threshold = excess_of_stretch(options.stretch_threshold);
  last.quads = static_cast<int>(options.refinement == Refinement::Uniform ? size : 1.3 * quads);
  last.rounds = 1;
  last.trials = 30;
}

}  // namespace

double excess_of_stretch(double stretch) { return 0.5 * GlobalMapOptions().theta * (stretch + 1 / stretch - 2); }

LayoutSearchOptions layout_search_options(const RemeshOptions& options, const Budget& budget, const TopologySummary& topology, const BaseDomain& base,
                                          const BaseRequest& request) {
  LayoutSearchOptions search;
  LevelSearchOptions& first = search.levels.emplace_back();
  first.quads = std::max(base.quads(), static_cast<int>(budget.base_size - budget.boundary_side * base.boundary_sides()));
  first.vertices = 30.0 * base.quads();
  if (options.base == BaseSize::Minimal) search_finer_levels(search, options, budget, topology, base, request);
  return search;
}

}  // namespace hybrid_mesh
