// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/report.h"

#include <algorithm>
#include <string>

#include "hierarchy/stretch.h"
#include "remesh/quality.h"
#include "remesh/verdict.h"

namespace hybrid_mesh {
namespace {

using Json = nlohmann::ordered_json;

Json operations_of(const HybridMesh& hierarchy, int level) {
  Json list = Json::array();
  for (int i = 0; i < hierarchy.operation_count(); ++i) {
    const HybridMesh::Operation& op = hierarchy.operation(i);
    if (op.repatch.level == level)
      list.push_back({{"kind", op.repatch.kind}, {"removed_quads", op.repatch.removed.size()}, {"new_quads", op.roots.size()}});
  }
  return list;
}

Json describe_input(const Source& source) {
  const RepairReport& repaired = source.repairs;
  Json r;
  r["merged_points"] = repaired.merged_points;
  r["isolated_points"] = repaired.isolated_points;
  r["duplicate_faces"] = repaired.duplicate_faces;
  r["degenerate_faces"] = repaired.degenerate_faces;
  r["reoriented_faces"] = repaired.reoriented_faces;
  r["nonmanifold_edges"] = repaired.nonmanifold_edges;
  r["nonmanifold_vertices"] = repaired.nonmanifold_vertices;
  r["one_sided_cuts"] = repaired.one_sided_cuts;
  r["dropped_components"] = repaired.dropped_components;
  return {{"vertices", source.read_points},           {"faces", source.read_polygons},
          {"components", source.topology.components}, {"boundary_loops", source.topology.boundary_loops},
          {"genus", source.topology.genus},           {"repaired", r}};
}

// What has opened, and on which level: 0 is the base. What opens above it has a number, its place in the plan's topology from 1 on.
Json describe_topology(const RemeshTask& task, const Candidate& c) {
  Json out{{"loops", Json::array()}, {"tubes", Json::array()}, {"boundaries", Json::array()}};
  const auto add = [&](const TopologyEvent& event, double diagonal, int level, const std::string& reason, std::size_t number) {
    Json entry{{"length", event.length / diagonal}};
    if (number > 0) entry["number"] = number;
    if (event.kind == EventKind::Cut) entry["kind"] = event.loop_kind == LoopKind::Handle ? "handle" : "tunnel";
    entry["level"] = level;
    if (!reason.empty()) entry["reason"] = reason;
    out[event.kind == EventKind::Cut ? "loops" : event.kind == EventKind::Tube ? "tubes" : "boundaries"].push_back(std::move(entry));
  };
  out["removed_handles"] = task.source.removed_handles;
  const double diagonal = task.source.placement.diagonal;
  for (std::size_t e = 0; e < c.opened_on.size(); ++e) {
    const bool later = task.base.levels[e] >= 0 && c.opened_on[e] > task.base.levels[e] && e < c.waited.size();
    add(task.base.series->events[e], diagonal, c.opened_on[e], later ? c.waited[e] : "", e + 1);
  }
  for (const BaseSurface::Unopened& u : task.base.unopened) add(u.event, diagonal, 0, u.reason, 0);
  return out;
}

// Irregular vertices of the final mesh, by what made them.
Json irregular_counts(const Candidate& c) {
  std::int64_t of_base = 0, of_operations = 0, of_transitions = 0;
  for (const VertexId id : irregular_names(c.final_mesh)) {
    if (id.kind() == VertexId::Kind::Free && id.index() < c.hierarchy.base_vertex_count())
      ++of_base;
    else
      ++(std::binary_search(c.finest_irregular.begin(), c.finest_irregular.end(), id) ? of_operations : of_transitions);
  }
  return {{"base", of_base}, {"operations", of_operations}, {"transitions", of_transitions}};
}

double regular_fraction(const Candidate& c) {
  const HybridMesh& h = c.hierarchy;
  std::int64_t inserted = h.base_count();
  for (int i = 0; i < h.operation_count(); ++i) inserted += static_cast<std::int64_t>(h.operation(i).roots.size());
  // Quads where sizes meet are neither regular nor inserted.
  std::int64_t regular = 0;
  for (const std::int32_t node : c.final_mesh.node) {
    bool transition = false;
    for (int side = 0; side < 4; ++side) transition |= h.has_finer_neighbour(node, side);
    regular += !transition;
  }
  return 1.0 - static_cast<double>(inserted) / static_cast<double>(std::max<std::int64_t>(1, regular));
}

Json describe_shapes(const QuadQuality& q) {
  return {{"min", q.jacobian_min}, {"p05", q.jacobian_p05}, {"p50", q.jacobian_median}, {"inverted", q.inverted}};
}

Json describe_verdict(const std::vector<Reason>& reasons, const Placement& placement) {
  Json list = Json::array();
  for (const Reason& reason : reasons) {
    Json entry{{"what", reason.what}, {"text", reason.text}};
    if (reason.where) {
      const Vec3 p = placement.from_unit(*reason.where);
      entry["where"] = {p.x(), p.y(), p.z()};
    }
    list.push_back(std::move(entry));
  }
  return {{"result", reasons.empty() ? "good" : "poor"}, {"reasons", std::move(list)}};
}

}  // namespace

Json describe_level(const HybridMesh& hierarchy, int level, const QuadMesh& mesh, const SurfaceDistance& d,
                    const std::optional<SurfaceDistance>& to_closed) {
  const TopologySummary t = summarize_topology(to_soup(mesh));
  const LevelStretch s = level_stretch(hierarchy, mesh);
  std::vector<double> sorted = s.stretch;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double p) { return sorted.empty() ? 0.0 : sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(p * sorted.size()))]; };
  const std::vector<char> irregular = irregular_vertices(mesh);
  const QuadQuality q = quad_quality(mesh);
  return {{"level", level},
          {"vertices", mesh.points.size()},
          {"quads", q.quads},
          {"genus", t.genus},
          {"components", t.components},
          {"boundary_loops", t.boundary_loops},
          {"l2", d.l2},
          {"hausdorff", d.hausdorff},
          {"closed_surface", to_closed ? Json{{"l2", to_closed->l2}, {"hausdorff", to_closed->hausdorff}} : Json(nullptr)},
          {"scaled_jacobian", describe_shapes(q)},
          {"stretch", {{"p05", at(0.05)}, {"p50", at(0.5)}, {"p95", at(0.95)}, {"max", sorted.empty() ? 0.0 : sorted.back()}}},
          {"irregular_vertices", std::count(irregular.begin(), irregular.end(), 1)},
          {"irregular_ops", operations_of(hierarchy, level)}};
}

// The input's sharp edges; null where it has none.
Json describe_features(const RemeshTask& task, const Candidate& c) {
  if (!task.source.has_features) return nullptr;
  Json features{{"corners", task.source.feature_corners}, {"kept", c.keeps_features}};
  if (const std::string reason = why_features_are_lost(task, c); !reason.empty()) features["reason"] = reason;
  return features;
}

Json describe_remesh(const RemeshTask& task, const Candidate& c) {
  const TopologySummary t = summarize_topology(to_soup(c.final_mesh)), &topology = task.source.made;
  if (t.nonmanifold_edges || t.nonmanifold_vertices || t.misoriented_edges || t.components != topology.components ||
      t.boundary_loops != topology.boundary_loops || t.euler != topology.euler)
    throw Error(ErrorCode::Internal, "the final mesh does not have the surface's topology");
  const SurfaceDistance& d = c.distance;
  const Finished finished = measured(task, c, task.progress.part(0.95, 1));
  const QuadQuality& q = finished.quality;
  Json report;
  report["input"] = describe_input(task.source);
  report["topology"] = describe_topology(task, c);
  report["features"] = describe_features(task, c);
  if (!task.source.density.name.empty()) report["density"] = describe_density(task.source.density, c.final_mesh);
  report["base"] = {{"quads", c.base_quads}, {"vertices", c.base_vertices}, {"by_need", c.by_need}};
  report["levels"] = c.level_reports;
  report["final"] = {{"vertices", c.final_mesh.points.size()},
                     {"quads", q.quads},
                     {"triangles", q.triangles},
                     {"l2", d.l2},
                     {"hausdorff", d.hausdorff},
                     {"boundary_hausdorff", d.boundary_hausdorff < 0 ? Json(nullptr) : Json(d.boundary_hausdorff)},
                     {"genus", t.genus},
                     {"components", t.components},
                     {"boundary_loops", t.boundary_loops},
                     {"regular_fraction", regular_fraction(c)},
                     {"irregular_vertices", irregular_counts(c)},
                     {"scaled_jacobian", describe_shapes(q)},
                     {"self_intersections", finished.intersections.pairs},
                     {"self_intersections_of_input", finished.intersections.pairs_of_input}};
  if (task.options.error > 0) report["final"]["error_bound_met"] = d.l2 <= task.options.error;
  if (!task.source.symmetry.is_null()) report["symmetry"] = task.source.symmetry;
  if (task.source.symmetric) report["symmetry"].update(Json{{"l2", finished.distance.l2}, {"hausdorff", finished.distance.hausdorff}});
  report["verdict"] = describe_verdict(reasons_against(finished), task.source.placement);
  report["warnings"] = warnings(finished);
  return report;
}

}  // namespace hybrid_mesh
