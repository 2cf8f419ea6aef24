// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "remesh/plan.h"
#include "remesh/plan_format.h"

namespace hybrid_mesh {
namespace {

using namespace plan_format;

Json to_json(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

// --- base domain -------------------------------------------------------------------------------------------------------------------
Json nodes_to_json(const LayoutOutline& outline) {
  Json nodes = Json::array();
  for (const Vec3& p : outline.nodes) nodes.push_back(to_json(p));
  return nodes;
}

Json curves_to_json(const LayoutOutline& outline) {
  Json curves = Json::array();
  for (std::size_t q = 0; q < outline.sides.size(); ++q)
    for (int i = 0; i < 4; ++i) {
      if (outline.sides[q][i].empty()) continue;
      Json points = Json::array();
      for (const Vec3& p : outline.sides[q][i]) points.push_back(to_json(p));
      curves.push_back({{"quad", q}, {"side", i}, {"points", std::move(points)}});
    }
  return curves;
}

Json tower_to_json(const BoundaryTower& tower) {
  Json nodes = Json::array();
  for (const Vec3& p : tower.nodes) nodes.push_back(to_json(p));
  return {{"boundary_nodes", tower.nodes.empty() ? Json(kAutomatic) : std::move(nodes)}, {"cubes", tower.cubes}};
}

Json base_to_json(const Plan& plan) {
  if (plan.tower) return tower_to_json(*plan.tower);
  const LayoutOutline& base = plan.base;
  Json neighbours = Json::array();
  for (const auto& n : base.neighbours) {
    Json sides = Json::array();
    for (const PatchSide& s : n) sides.push_back({s.patch, s.side});
    neighbours.push_back(std::move(sides));
  }
  return {{"nodes", nodes_to_json(base)}, {"quads", base.quads}, {"neighbours", std::move(neighbours)}, {"curves", curves_to_json(base)}};
}

// Quads, by number or address, and their sides. A disk has one rim, and the plan one "start".
template <class Quad>
void put_starts(Json& out, const std::vector<std::pair<Quad, int>>& starts) {
  if (starts.size() == 1)
    out["start"] = {starts[0].first, starts[0].second};
  else
    for (const auto& [quad, side] : starts) out["starts"].push_back({quad, side});
}

// Edits of the base: all are named by numbers in the base domain as it was first, which the plan does not hold.
Json raw_edit(const LayoutEdit& edit) {
  Json out{{"patches", edit.patches}};
  std::vector<std::pair<int, int>> starts;
  for (const PatchSide& s : edit.starts) starts.push_back({s.patch, s.side});
  put_starts(out, starts);
  out["quads"] = edit.quads;
  out["rings"] = edit.rings;
  out["inner_nodes"] = edit.inner_nodes;
  return out;
}

Json origin_to_json(const Plan::Origin& origin) {
  if (origin.tower) {
    Json out = tower_to_json(*origin.tower);
    out["surface"] = origin.surface;
    out["faces"] = origin.faces;
    return out;
  }
  Json rounds = Json::array();
  for (const std::vector<LayoutEdit>& round : rounds_of(origin.script)) {
    Json list = Json::array();
    for (const LayoutEdit& edit : round) list.push_back(raw_edit(edit));
    rounds.push_back(std::move(list));
  }
  Json out{{"surface", origin.surface},          {"faces", origin.faces},
           {"size", origin.base.size},           {"boundary_side", origin.base.boundary_side},
           {"least", origin.base.least},         {"seed", origin.base.seed},
           {"vertices", origin.script.vertices}, {"vertices_a_quad", origin.script.vertices_a_quad},
           {"rounds", std::move(rounds)}};
  if (origin.features == Features::Auto) out["features"] = kAutomatic;
  if (origin.features == Features::Given) out["features"] = origin.feature_angle;
  return out;
}

Json curves_to_json(const std::vector<DrawnStroke>& strokes) {
  Json curves = Json::array();
  for (const DrawnStroke& s : strokes) {
    Json points = Json::array();
    for (const Vec3& p : s.points) points.push_back(to_json(p));
    curves.push_back({{"points", std::move(points)}, {"fit", s.fit == DrawnStroke::Fit::Tight ? "tight" : "drawn"}});
  }
  return curves;
}

Json regions_to_json(const Plan& plan) {
  Json out = Json::array();
  for (const Plan::Region& r : plan.regions) {
    Json region{{"level", r.level}, {"quads", r.quads}};
    if (r.pattern.kind == RegionPattern::Kind::Drawn) region["curves"] = curves_to_json(r.pattern.strokes);
    for (const auto& [kind, name] : kRegionLayouts)
      if (r.pattern.kind == kind) region["layout"] = name;
    if (r.pattern.height > 0) region["height"] = r.pattern.height;
    if (r.pattern.even_quads > 0) region["even_quads"] = r.pattern.even_quads;
    put_starts(region, r.starts);
    const std::vector<std::array<int, 4>>& quads = r.pattern.kind == RegionPattern::Kind::Even ? r.pattern.outline.quads : r.pattern.quads;
    if (!quads.empty()) region["new_quads"] = quads;
    if (!r.pattern.outline.nodes.empty()) {
      region["nodes"] = nodes_to_json(r.pattern.outline);
      region["sides"] = curves_to_json(r.pattern.outline);
    }
    if (!r.opens.empty()) region["opens"] = r.opens;
    region["buffer_rings"] = r.buffer_rings;
    out.push_back(std::move(region));
  }
  return out;
}

Json topology_to_json(const Plan& plan) {
  Json out = Json::array();
  for (const Plan::Event& e : plan.topology) {
    Json event;
    for (const auto& [kind, name] : kEventKinds)
      if (e.kind == kind) event["kind"] = name;
    for (const std::vector<Vec3>& loop : e.loops) {
      Json points = Json::array();
      for (const Vec3& p : loop) points.push_back(to_json(p));
      event["loops"].push_back(std::move(points));
    }
    if (e.level >= 0) event["level"] = e.level;
    out.push_back(std::move(event));
  }
  return out;
}

}  // namespace

std::string to_json(const Plan& plan) {
  Json out{{"format", kFormat}, {"version", kVersion}};
  if (!plan.topology.empty()) out["topology"] = topology_to_json(plan);
  if (!plan.has_base()) return out.dump();
  Json base = base_to_json(plan);
  if (plan.origin) base["origin"] = origin_to_json(*plan.origin);
  out["base"] = std::move(base);
  if (!plan.regions.empty()) out["operations"] = regions_to_json(plan);
  return out.dump();
}

}  // namespace hybrid_mesh
