// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/layout_search_options.h"

#include <algorithm>

#include "remesh/skin.h"

namespace hybrid_mesh {
namespace {

// Quads far larger than the shape's features leave nothing yet to choose between layouts by.
constexpr int kFewQuads = 20;
// A base of more is what the surface's topology asks for: each round of edits would map all of it anew, and change little of it.
constexpr int kManyQuads = 1500;

}  // namespace

LayoutSearchOptions layout_search_options(const RemeshOptions& options, const Budget& budget, const BaseDomain& base, const BaseRequest& request) {
  LayoutSearchOptions search;
  search.quads = std::max(base.quads(), static_cast<int>(budget.base_size - budget.boundary_side * base.boundary_sides()));
  search.vertices = 30.0 * base.quads();
  if (base.has_features()) search.rounds = 0;  // edits would not keep them
  if (base.quads() > kManyQuads) search.rounds = 0;
  if (options.symmetry != Symmetry::None && !request.base_edits) search.rounds = 0;
  if (options.base != BaseSize::Minimal) return search;
  search.vertices = std::max(base.boundary_sides() > 0 ? 3000.0 : 1500.0, search.vertices);
  if ((has_finer_operations(options, base, request) && !request.base_edits) || base.quads() < kFewQuads) {
    search.rounds = 0;
    search.map.vertices_a_quad = std::max(search.map.vertices_a_quad, 1000.0 / base.quads());
  }
  return search;
}

}  // namespace hybrid_mesh
