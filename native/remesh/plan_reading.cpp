// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "base/limits.h"
#include "remesh/plan.h"
#include "remesh/plan_format.h"

namespace hybrid_mesh {
namespace {

using namespace plan_format;

void curves_from_json(const PlanEntry& entry, LayoutOutline& outline) {
  outline.sides.resize(outline.quads.size());
  for (const PlanEntry& e : entry.list()) {
    e.only({"quad", "side", "points"});
    std::vector<Vec3>& side = outline.sides[e.at("quad").index(outline.quads.size())][e.at("side").index(4)];
    for (const PlanEntry& p : e.at("points").list()) side.push_back(p.point());
    if (side.size() < 2) e.at("points").refuse("must have at least two points");
  }
}

BoundaryTower tower_from_json(const PlanEntry& entry) {
  BoundaryTower tower;
  const PlanEntry nodes = entry.at("boundary_nodes");
  if (!nodes.is(kAutomatic))
    for (const PlanEntry& p : nodes.list(4)) tower.nodes.push_back(p.point());
  if (entry.has("cubes")) tower.cubes = static_cast<int>(entry.at("cubes").integer(0, limits::most_cubes));
  return tower;
}

LayoutOutline base_from_json(const PlanEntry& entry) {
  entry.only({"nodes", "quads", "neighbours", "curves", "origin"});
  LayoutOutline base;
  for (const PlanEntry& e : entry.at("nodes").list()) base.nodes.push_back(e.point());
  for (const PlanEntry& e : entry.at("quads").list()) {
    const std::vector<PlanEntry> corners = e.list(4);
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) quad[i] = corners[i].index(base.nodes.size());
    base.quads.push_back(quad);
  }
  if (base.quads.empty()) entry.refuse("has no quads");
  if (entry.has("neighbours"))
    for (const PlanEntry& e : entry.at("neighbours").list(base.quads.size())) {
      const std::vector<PlanEntry> sides = e.list(4);
      std::array<PatchSide, 4> of;
      for (int i = 0; i < 4; ++i) {
        const std::vector<PlanEntry> link = sides[i].list(2);
        of[i] = {static_cast<int>(link[0].integer(-1, static_cast<std::int64_t>(base.quads.size()) - 1)), link[1].index(4)};
      }
      base.neighbours.push_back(of);
    }
  for (std::size_t q = 0; q < base.neighbours.size(); ++q)
    for (int i = 0; i < 4; ++i) {
      const PatchSide& s = base.neighbours[q][i];
      if (s.patch < 0) continue;
      const PatchSide& back = base.neighbours[s.patch][s.side];
      if (back.patch != static_cast<int>(q) || back.side != i)
        entry.at("neighbours").list()[q].list()[i].refuse("names a side that does not name this one");
    }
  if (entry.has("curves")) curves_from_json(entry.at("curves"), base);
  return base;
}

// --- edits ---------------------------------------------------------------------------------------------------------------------------
std::array<int, 4> new_quad(const PlanEntry& entry, std::int64_t most) {
  const std::vector<PlanEntry> nodes = entry.list(4);
  std::array<int, 4> quad;
  for (int i = 0; i < 4; ++i) quad[i] = static_cast<int>(nodes[i].integer(0, most));
  return quad;
}

// Where the numbering of a region's corners starts: one side for a region with one rim, or a list of them.
std::vector<PlanEntry> starts_of(const PlanEntry& entry) {
  if (entry.has("starts")) {
    if (entry.has("start")) entry.refuse("has a \"start\" and \"starts\": one of them is enough");
    return entry.at("starts").list();
  }
  std::vector<PlanEntry> starts;
  if (entry.has("start")) starts.push_back(entry.at("start"));
  return starts;
}

LayoutEdit raw_edit(const PlanEntry& entry) {
  constexpr std::int64_t most = std::numeric_limits<int>::max();
  LayoutEdit edit;
  for (const PlanEntry& e : entry.at("patches").list()) edit.patches.push_back(static_cast<int>(e.integer(0, most)));
  for (const PlanEntry& e : starts_of(entry)) {
    const std::vector<PlanEntry> start = e.list(2);
    edit.starts.push_back({static_cast<int>(start[0].integer(0, most)), start[1].index(4)});
  }
  for (const PlanEntry& e : entry.at("quads").list()) {
    const std::vector<PlanEntry> nodes = e.list(4);
    std::array<int, 4> q;
    for (int i = 0; i < 4; ++i) q[i] = static_cast<int>(nodes[i].integer(0, most));
    edit.quads.push_back(q);
  }
  edit.rings = static_cast<int>(entry.at("rings").integer(0, most));
  edit.inner_nodes = static_cast<int>(entry.at("inner_nodes").integer(0, most));
  return edit;
}

Plan::Origin origin_from_json(const PlanEntry& entry) {
  if (entry.has("boundary_nodes")) {
    entry.only({"surface", "faces", "boundary_nodes", "cubes"});
    Plan::Origin origin;
    origin.surface = entry.at("surface").text();
    if (entry.has("faces")) origin.faces = entry.at("faces").integer(0, std::numeric_limits<std::int64_t>::max());
    origin.tower = tower_from_json(entry);
    return origin;
  }
  entry.only({"surface", "faces", "size", "boundary_side", "least", "seed", "vertices", "vertices_a_quad", "rounds", "features"});
  Plan::Origin origin;
  if (entry.has("features")) {
    const PlanEntry features = entry.at("features");
    origin.features = features.is(kAutomatic) ? Features::Auto : Features::Given;
    if (origin.features == Features::Given) origin.feature_angle = features.number(0);
  }
  origin.surface = entry.at("surface").text();
  origin.faces = entry.at("faces").integer(0, std::numeric_limits<std::int64_t>::max());
  origin.base.size = entry.at("size").number(1);
  origin.base.boundary_side = entry.at("boundary_side").number(0);
  origin.base.least = static_cast<int>(entry.at("least").integer(0, std::numeric_limits<int>::max()));
  origin.base.seed = static_cast<std::uint64_t>(entry.at("seed").integer(0, std::numeric_limits<std::int64_t>::max()));
  origin.script.vertices = entry.at("vertices").number(0);
  origin.script.vertices_a_quad = entry.at("vertices_a_quad").number(0);
  int number = 0;
  for (const PlanEntry& round : entry.at("rounds").list()) {
    ++number;
    for (const PlanEntry& e : round.list()) origin.script.edits.push_back({raw_edit(e), number});
  }
  return origin;
}

// --- regions -------------------------------------------------------------------------------------------------------------------------
std::vector<DrawnStroke> strokes_from_json(const PlanEntry& entry) {
  std::vector<DrawnStroke> strokes;
  for (const PlanEntry& c : entry.list()) {
    c.only({"points", "fit"});
    DrawnStroke stroke;
    for (const PlanEntry& p : c.at("points").list()) stroke.points.push_back(p.point());
    if (c.has("fit")) {
      const std::string fit = c.at("fit").text();
      if (fit != "tight" && fit != "drawn") c.at("fit").refuse("must be \"tight\" or \"drawn\"");
      stroke.fit = fit == "tight" ? DrawnStroke::Fit::Tight : DrawnStroke::Fit::AsDrawn;
    }
    strokes.push_back(std::move(stroke));
  }
  return strokes;
}

Plan::Region region_from_json(const PlanEntry& entry) {
  Plan::Region r;
  std::set<std::string> keys{"level", "quads", "opens", "buffer_rings"};
  if (entry.has("layout")) {
    if (entry.has("curves")) entry.refuse("has \"curves\" and a \"layout\": it is laid out in one way");
    const std::string word = entry.at("layout").text();
    for (const auto& [kind, name] : kRegionLayouts)
      if (word == name) r.pattern.kind = kind;
    if (r.pattern.kind == RegionPattern::Kind::Drawn)
      entry.at("layout").refuse("must be \"automatic\", \"cubes\", \"rows\", \"even\" or \"template\"");
    keys.insert("layout");
    if (r.pattern.kind == RegionPattern::Kind::Cubes || r.pattern.kind == RegionPattern::Kind::Rows) keys.insert("height");
    if (r.pattern.kind == RegionPattern::Kind::Even) keys.insert({"even_quads", "new_quads", "nodes", "sides"});
    if (r.pattern.kind == RegionPattern::Kind::Template) keys.insert("new_quads");
    keys.insert("start");
    keys.insert("starts");
  } else {
    if (!entry.has("curves")) entry.refuse("has neither \"curves\" nor a \"layout\"");
    keys.insert("curves");
  }
  entry.only(keys);
  r.level = static_cast<int>(entry.at("level").integer(1, limits::most_levels));
  for (const PlanEntry& q : entry.at("quads").list()) r.quads.push_back(q.text());
  if (r.quads.empty()) entry.refuse("has no quads");
  if (entry.has("curves")) r.pattern.strokes = strokes_from_json(entry.at("curves"));
  if (entry.has("height")) r.pattern.height = static_cast<int>(entry.at("height").integer(0, limits::most_cubes));
  if (entry.has("even_quads")) r.pattern.even_quads = static_cast<int>(entry.at("even_quads").integer(0, limits::most_even_quads));
  for (const PlanEntry& e : starts_of(entry)) {
    const std::vector<PlanEntry> start = e.list(2);
    r.starts.push_back({start[0].text(), start[1].index(4)});
  }
  const bool has_quads = r.pattern.kind == RegionPattern::Kind::Template || entry.has("new_quads");
  if (has_quads && r.starts.empty()) entry.at("start");
  if (has_quads) {
    const std::vector<PlanEntry> quads = entry.at("new_quads").list();
    std::vector<std::array<int, 4>>& numbers = r.pattern.kind == RegionPattern::Kind::Even ? r.pattern.outline.quads : r.pattern.quads;
    for (const PlanEntry& e : quads) numbers.push_back(new_quad(e, 4 * static_cast<std::int64_t>(quads.size() + r.quads.size())));
  }
  if (entry.has("nodes")) {
    // The region's corners, then the new ones.
    LayoutOutline& outline = r.pattern.outline;
    int count = 0;
    for (const auto& q : outline.quads) count = std::max(count, 1 + *std::max_element(q.begin(), q.end()));
    for (const PlanEntry& p : entry.at("nodes").list(count)) outline.nodes.push_back(p.point());
    if (entry.has("sides")) curves_from_json(entry.at("sides"), outline);
  }
  if (entry.has("opens"))
    for (const PlanEntry& e : entry.at("opens").list()) r.opens.push_back(static_cast<int>(e.integer(0, std::numeric_limits<int>::max())));
  if (entry.has("buffer_rings")) r.buffer_rings = static_cast<int>(entry.at("buffer_rings").integer(0, limits::most_buffer_rings));
  return r;
}

// --- topology ------------------------------------------------------------------------------------------------------------------------
Plan::Event event_from_json(const PlanEntry& entry) {
  entry.only({"kind", "loops", "level"});
  Plan::Event event;
  const std::string word = entry.at("kind").text();
  const auto named = std::find_if(kEventKinds.begin(), kEventKinds.end(), [&](const auto& kind) { return word == kind.second; });
  if (named == kEventKinds.end()) entry.at("kind").refuse("must be \"cut\", \"tube\" or \"boundary\"");
  event.kind = named->first;
  for (const PlanEntry& loop : entry.at("loops").list(event.kind == EventKind::Tube ? 2 : 1)) {
    std::vector<Vec3>& points = event.loops.emplace_back();
    for (const PlanEntry& p : loop.list()) points.push_back(p.point());
    if (points.size() < 3) loop.refuse("must have three points at least");
  }
  if (entry.has("level")) event.level = static_cast<int>(entry.at("level").integer(1, limits::most_levels));
  return event;
}

}  // namespace

Plan plan_from_json(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error(ErrorCode::InvalidInput, "the plan is not JSON");
  const PlanEntry top(json, PlanEntry::kTop);
  top.only({"format", "version", "topology", "base", "operations"});
  if (top.at("format").text() != kFormat) top.at("format").refuse(std::string("must be \"") + kFormat + "\"");
  if (const std::int64_t version = top.at("version").integer(1, 1000000); version > kVersion)
    throw Error(ErrorCode::Unsupported,
                "the plan has version " + std::to_string(version) + "; this program reads versions up to " + std::to_string(kVersion));
  Plan plan;
  if (top.has("topology"))
    for (const PlanEntry& e : top.at("topology").list()) plan.topology.push_back(event_from_json(e));
  if (!top.has("base") && top.has("topology")) {
    top.only({"format", "version", "topology"});
    return plan;
  }
  const PlanEntry base = top.at("base");
  if (base.has("boundary_nodes")) {
    base.only({"boundary_nodes", "cubes"});
    plan.tower = tower_from_json(base);
  } else {
    plan.base = base_from_json(base);
    if (base.has("origin")) plan.origin = origin_from_json(base.at("origin"));
  }
  if (top.has("operations"))
    for (const PlanEntry& e : top.at("operations").list()) {
      plan.regions.push_back(region_from_json(e));
      for (const int opens : plan.regions.back().opens)
        if (opens >= static_cast<int>(plan.topology.size())) e.at("opens").refuse("names an event that the plan's \"topology\" does not have");
    }
  return plan;
}

Plan::Region plan_region_from_json(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error(ErrorCode::InvalidInput, "the operation is not JSON");
  return region_from_json(PlanEntry(json, "operation"));
}

}  // namespace hybrid_mesh
