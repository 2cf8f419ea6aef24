// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/remesh.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/limits.h"
#include "remesh/best_candidate.h"
#include "remesh/candidate.h"
#include "remesh/report.h"
#include "remesh/symmetry.h"

namespace hybrid_mesh {
namespace {

void check_options(const RemeshOptions& options) {
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::InvalidInput, what); };
  if (options.vertices < 0) refuse("vertices must not be negative");
  if (!(options.error >= 0)) refuse("error must not be negative");
  if (options.levels > limits::most_levels) refuse("levels must be at most " + std::to_string(limits::most_levels));
  if (!(options.drop_components >= 0 && options.drop_components < 1)) refuse("drop_components must be in [0, 1)");
  if (!(options.remove_noise >= 0 && options.remove_noise < 1)) refuse("remove_noise must be in [0, 1)");
  if (options.base == BaseSize::Given && options.base_quads < 1) refuse("base_quads must be positive");
  check_symmetry(options);
}

// What finds no room to open above the base opens in it: then the base is another one.
Candidate searched_remesh(const RemeshOptions& options, const Source& source, std::vector<LateEvent> events, BaseSurface& base,
                          const Progress& progress, Stopwatch& watch) {
  std::vector<BaseSurface::Unopened> unopened;
  for (;;) {
    base = base_surface(source.repaired, source.placement, events);
    base.unopened = unopened;
    const RemeshTask task{options, source, base, progress, watch};
    Found<Candidate> best = best_candidate(task);
    if (best && best->unopened.empty()) return std::move(*best);
    std::vector<std::pair<int, std::string>> without;
    if (best)
      without = std::move(best->unopened);
    else
      for (std::size_t e = 0; e < events.size(); ++e) without.push_back({static_cast<int>(e), best.reason});
    for (auto at = without.rbegin(); at != without.rend(); ++at) {
      unopened.push_back({base.series->events[at->first], std::move(at->second)});
      events.erase(events.begin() + at->first);
    }
  }
}

Candidate planned_remesh(const RemeshOptions& options, const Source& source, const Plan& plan, std::vector<LateEvent> events, BaseSurface& base,
                         const Progress& progress, Stopwatch& watch) {
  base = base_surface(source.repaired, source.placement, events);
  const RemeshTask task{options, source, base, progress, watch};
  return fitted(task, planned_candidate(task, plan), false);
}

// Of a surface that is to be symmetric: its half is remeshed and mirrored. Nothing where no symmetry is asked for, or none is found; the source then
// says so. Afterwards the source is placed so that the plane goes through the origin.
Found<Candidate> symmetric_remesh(const RemeshOptions& options, Source& source, BaseSurface& base, const Progress& progress, Stopwatch& watch) {
  if (options.symmetry == Symmetry::None) return {};
  progress.stage("symmetry");
  watch.start("symmetry");
  const std::optional<Source> half = half_source(source, options, progress.part(0.04, 0.05));
  watch.stop();
  if (!half) return {};
  RemeshOptions of_half = options_of_half(options);
  Found<Candidate> whole;
  // Operations that do not go together with their mirror images are done without.
  for (;;) {
    const Candidate made = searched_remesh(of_half, *half, {}, base, progress.part(0.05, 0.9), watch);
    whole = found([&] { return mirrored_candidate({options, source, base, progress.part(0.9, 0.95), watch}, *half, made, source.symmetry); });
    if (whole) return whole;
    if (of_half.semi_regular) throw Error(ErrorCode::Unsupported, "the half of the mesh cannot be mirrored: " + whole.reason);
    of_half.semi_regular = true;
    source.symmetry["switched_off"].push_back("irregular operations: " + whole.reason);
  }
}

// Everything was computed around the origin: brings maps and meshes to where the input stands.
void place(Candidate& c, const Placement& placement, const SurfaceSeries* series) {
  HybridMesh& h = c.hierarchy;
  for (int n = 0; n < h.node_count(); ++n)
    if (const PatchMap* map = h.map(n)) {
      PatchMap placed = *map;
      if (series) name_input(placed, *series);
      for (Vec3& p : placed.positions) p = placement.from_unit(p);
      h.set_map(n, std::move(placed));
    }
  h.clear_positions();
  for (std::size_t j = 0; j < c.level_meshes.size(); ++j) {
    for (Vec3& p : c.level_meshes[j].points) p = placement.from_unit(p);
    h.set_level_positions(static_cast<int>(j), c.level_meshes[j]);
  }
  for (Vec3& p : c.final_mesh.points) p = placement.from_unit(p);
  h.set_final_positions(c.final_mesh);
}

RemeshResult remesh_in_arena(PolygonSoup input, const RemeshOptions& options, Context& context) {
  check_options(options);
  const Progress progress(context);
  std::optional<Plan> plan;
  if (!options.plan.empty()) plan = plan_from_json(options.plan);
  Stopwatch watch;
  Source source = read_source(std::move(input), options, progress.part(0, 0.04), watch);
  BaseSurface base;
  Found<Candidate> symmetric = symmetric_remesh(options, source, base, progress, watch);
  watch.start("topology");
  std::vector<LateEvent> events;
  if (!symmetric)
    events = plan ? late_events_of(*plan, source.repaired, progress.part(0.04, 0.05))
                  : find_late_events(source.repaired, source.topology, options, progress.part(0.04, 0.05));
  watch.stop();
  Candidate best = symmetric                  ? std::move(*symmetric)
                   : plan && plan->has_base() ? planned_remesh(options, source, *plan, std::move(events), base, progress, watch)
                                              : searched_remesh(options, source, std::move(events), base, progress, watch);
  const RemeshTask task{options, source, base, progress, watch};
  progress.stage("measure");
  watch.start("measure");
  nlohmann::ordered_json report = describe_remesh(task, best);
  watch.stop();
  place(best, source.placement, base.series.get());
  report["seconds"] = watch.json();
  progress(1);
  return {std::move(best.hierarchy), std::move(best.final_mesh), std::move(source.repaired), std::move(best.plan),
          std::move(best.plan_root), std::move(best.opened),     std::move(report)};
}

}  // namespace

RemeshResult remesh(PolygonSoup input, const RemeshOptions& options, Context& context) {
  // An arena of its own: Blender, in whose process this may run, has threads of its own kind to think of.
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return remesh_in_arena(std::move(input), options, context); });
}

}  // namespace hybrid_mesh
