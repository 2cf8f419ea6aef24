// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>
#include <utility>

#include "layout/drawn/layout_transfer.h"
#include "layout/search/base_map.h"
#include "remesh/candidate.h"
#include "remesh/late_topology.h"
#include "remesh/outlines.h"
#include "remesh/plan_regions.h"

namespace hybrid_mesh {
namespace {

constexpr int kLikelyCubes = 8;  // of a tower whose height is left to the surface

Operations operations_of(const RemeshTask& task, const std::vector<Plan::Region>& planned) {
  return [&](Construction& made) {
    std::vector<Plan::Region> regions = repatch_regions(made, planned, task.source.placement, task.progress.part(0.55, 0.6));
    // What the plan has no operation for opens as it would without a plan.
    const LateTopology late = open_late(made, task, opening_bounds(task.options, plan_budget(task.options, task.source, {}).vertices));
    if (!late.unopened.empty())
      throw Error(ErrorCode::Unsupported, "the plan's topology[" + std::to_string(late.unopened.front().first) +
                                              "] cannot open on this surface: " + late.unopened.front().second);
    regions.insert(regions.end(), late.regions.begin(), late.regions.end());
    return regions;
  };
}

// How large the triangles of the surface are that a base of so many quads is laid out on.
std::int64_t faces_for(const RemeshTask& task, double base_quads) {
  return working_faces(base_quads, plan_budget(task.options, task.source, {}).vertices);
}

double likely_quads(const BoundaryTower& tower) { return 4 * std::max(kLikelyCubes, tower.cubes) + 1; }

Found<BaseMap> map_to_tower(const RemeshTask& task, BoundaryTower tower, std::int64_t faces, WorkingSurfaceInUse& in_use) {
  const Placement& placement = task.source.placement;
  task.progress.stage("base domain");
  task.watch.start("base");
  const WorkingSurface& working = in_use.of_size(task, faces);
  for (Vec3& p : tower.nodes) p = placement.to_unit(p);
  Found<PatchedSurface> base = found([&] { return grow_boundary_tower(working.mesh, tower, task.progress.part(0.05, 0.2)); });
  if (!base) return {std::nullopt, base.reason};
  task.progress.stage("map");
  task.watch.start("map");
  return map_to_base(working.mesh, std::move(*base), task.progress.part(0.2, 0.45));
}

Found<Candidate> assembled(const RemeshTask& task, const WorkingSurface& working, Found<BaseMap> map, const std::optional<Plan::Origin>& origin,
                           const Operations& operations) {
  if (!map) return {std::nullopt, map.reason};
  return found([&] { return assemble_candidate(task, working, construct(task, working, std::move(*map)), origin, operations); });
}

// A base on four points of the boundary. From then on the plan has its quads.
Candidate grow(const RemeshTask& task, const Plan& plan) {
  Plan::Origin origin;
  origin.surface = task.source.fingerprint;
  origin.tower = plan.tower;
  origin.faces = faces_for(task, likely_quads(*plan.tower));
  WorkingSurfaceInUse working;
  Found<BaseMap> map = map_to_tower(task, *plan.tower, origin.faces, working);
  Found<Candidate> grown = assembled(task, working.of_size(task, origin.faces), std::move(map), origin, operations_of(task, plan.regions));
  if (!grown) throw Error(ErrorCode::Unsupported, "no map to a chain of cubes on the boundary is found: " + grown.reason);
  return std::move(*grown);
}

// As it was made on the surface that the plan was made on; nothing if this is another one, or the base was changed by hand.
std::optional<Candidate> make_again(const RemeshTask& task, const Plan& plan) {
  if (!plan.origin || plan.origin->surface != task.source.fingerprint) return std::nullopt;
  if (plan.origin->faces == 0) return std::nullopt;  // a plan on a tower need not tell
  WorkingSurfaceInUse working;
  const std::int64_t faces = plan.origin->faces;
  Found<BaseMap> map;
  if (plan.origin->tower) {
    map = map_to_tower(task, *plan.origin->tower, faces, working);
  } else {
    Found<BaseDomain> base = found([&] { return make_base(task, *plan.origin, working); });
    if (!base) return std::nullopt;
    map = map_to_base(working.of(task, *plan.origin).mesh, *base.value, plan.origin->script, task.progress.part(0.15, 0.45));
  }
  Found<Candidate> c = assembled(task, working.of(task, *plan.origin), std::move(map), plan.origin, operations_of(task, plan.regions));
  if (!c) return std::nullopt;
  const LayoutOutline made = plan_from_json(c->plan).base;
  if (made.nodes != plan.base.nodes || made.quads != plan.base.quads) return std::nullopt;
  return std::move(c.value);
}

Candidate lay_out(const RemeshTask& task, const Plan& plan) {
  const Placement& placement = task.source.placement;
  task.progress.stage("base domain");
  task.watch.start("base");
  WorkingSurfaceInUse in_use;
  const WorkingSurface& working = in_use.of_size(task, faces_for(task, static_cast<double>(plan.base.quads.size())));
  LayoutOutline outline = plan.base;
  move_outline(outline, [&](const Vec3& p) { return placement.to_unit(p); });
  const TransferredLayout laid = transfer_layout(working.mesh, outline, task.progress.part(0.05, 0.2));
  if (!laid.failure.empty()) throw Error(ErrorCode::InvalidInput, "the plan's base cannot be laid out on this surface: " + laid.failure);
  task.progress.stage("map");
  task.watch.start("map");
  Found<BaseMap> map = map_to_base(working.mesh, to_patched_surface(laid.layout), task.progress.part(0.2, 0.45));
  // Even quads are not to be found again: on this surface they would be others.
  std::vector<Plan::Region> regions = plan.regions;
  for (Plan::Region& region : regions)
    if (!region.pattern.outline.quads.empty()) region.pattern.even_quads = 0;
  Found<Candidate> c = assembled(task, working, std::move(map), std::nullopt, operations_of(task, regions));
  if (!c) throw Error(ErrorCode::Unsupported, "no map to the plan's quads is found on this surface: " + c.reason);
  return std::move(*c);
}

}  // namespace

Candidate planned_candidate(const RemeshTask& task, const Plan& plan) {
  const RemeshOptions& options = task.options;
  std::optional<Candidate> again = make_again(task, plan);
  Candidate c = again ? std::move(*again) : plan.tower ? grow(task, plan) : lay_out(task, plan);
  // What was asked for is what was done, word for word; a chain of cubes alone has become quads.
  const auto by_level = [](const Plan::Region& a, const Plan::Region& b) { return a.level < b.level; };
  std::vector<Plan::Region> asked = plan.regions;
  std::stable_sort(asked.begin(), asked.end(), by_level);
  const std::vector<Plan::Region> done = plan_from_json(c.plan).regions;
  const bool all = std::equal(asked.begin(), asked.end(), done.begin(), done.end(),
                              [](const Plan::Region& a, const Plan::Region& b) { return a.level == b.level && a.quads == b.quads; });
  if ((again || !plan.tower) && all) c.plan = options.plan;
  const Budget budget = plan_budget(options, task.source, {});
  const std::int64_t euler = task.source.topology.euler;
  c.base_given = true;
  c.levels = budget.levels;
  if (options.refinement == Refinement::Uniform && options.levels < 0)
    c.levels = levels_within(budget.vertices, c.finest, c.finest_quads, euler, c.finest_boundary_sides);
  const std::int64_t needed = uniform_vertices(c.finest_quads, euler, c.finest_boundary_sides, std::max(c.finest, c.levels) - c.finest);
  if (options.vertices > 0 && options.refinement == Refinement::Uniform && needed > options.vertices)
    throw Error(ErrorCode::InvalidInput,
                "the plan needs at least " + std::to_string(needed) + " vertices, more than the " + std::to_string(options.vertices) + " allowed");
  return c;
}

}  // namespace hybrid_mesh
