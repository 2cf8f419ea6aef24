// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/limits.h"
#include "layout/regions/region_pattern.h"

namespace hybrid_mesh {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "hybrid-mesh plan";
constexpr int kVersion = 1;
constexpr const char* kAutomatic = "automatic";

// A value of the plan and its place in it, for messages.
class Entry {
 public:
  Entry(const Json& json, std::string place) : json_(&json), place_(std::move(place)) {}

  [[noreturn]] void refuse(const std::string& what) const { throw Error(ErrorCode::InvalidInput, "the plan's " + place_ + " " + what); }

  bool has(const char* key) const { return object().json_->contains(key); }
  Entry at(const char* key) const {
    if (!has(key)) refuse(std::string("has no \"") + key + "\"");
    return {(*json_)[key], place_ == kTop ? std::string(key) : place_ + "." + key};
  }
  void only(const std::set<std::string>& keys) const {
    for (const auto& [key, value] : object().json_->items())
      if (!keys.count(key)) refuse("has \"" + key + "\", which means nothing");
  }
  std::vector<Entry> list() const {
    if (!json_->is_array()) refuse("must be a list");
    std::vector<Entry> out;
    for (std::size_t i = 0; i < json_->size(); ++i) out.push_back({(*json_)[i], place_ + "[" + std::to_string(i) + "]"});
    return out;
  }
  std::vector<Entry> list(std::size_t size) const {
    std::vector<Entry> out = list();
    if (out.size() != size) refuse("must have " + std::to_string(size) + " entries, not " + std::to_string(out.size()));
    return out;
  }
  std::int64_t integer(std::int64_t least, std::int64_t most) const {
    // What is larger than any signed number would become a negative one.
    const bool huge =
        json_->is_number_unsigned() && json_->get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    if (!json_->is_number_integer() || huge || json_->get<std::int64_t>() < least || json_->get<std::int64_t>() > most)
      refuse("must be a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    return json_->get<std::int64_t>();
  }
  int index(std::size_t count) const { return static_cast<int>(integer(0, static_cast<std::int64_t>(count) - 1)); }
  double number(double least) const {
    if (!json_->is_number() || !std::isfinite(json_->get<double>()) || json_->get<double>() < least)
      refuse("must be a finite number, at least " + Json(least).dump());
    return json_->get<double>();
  }
  std::string text() const {
    if (!json_->is_string()) refuse("must be text");
    return json_->get<std::string>();
  }
  bool is(const char* word) const { return json_->is_string() && json_->get<std::string>() == word; }
  Vec3 point() const {
    const std::vector<Entry> c = list(3);
    constexpr double any = -std::numeric_limits<double>::max();
    return {c[0].number(any), c[1].number(any), c[2].number(any)};
  }

  static constexpr const char* kTop = "top level";

 private:
  const Entry& object() const {
    if (!json_->is_object()) refuse("must be an object");
    return *this;
  }
  const Json* json_;
  std::string place_;
};

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

void curves_from_json(const Entry& entry, LayoutOutline& outline) {
  outline.sides.resize(outline.quads.size());
  for (const Entry& e : entry.list()) {
    e.only({"quad", "side", "points"});
    std::vector<Vec3>& side = outline.sides[e.at("quad").index(outline.quads.size())][e.at("side").index(4)];
    for (const Entry& p : e.at("points").list()) side.push_back(p.point());
    if (side.size() < 2) e.at("points").refuse("must have at least two points");
  }
}

Json tower_to_json(const BoundaryTower& tower) {
  Json nodes = Json::array();
  for (const Vec3& p : tower.nodes) nodes.push_back(to_json(p));
  return {{"boundary_nodes", tower.nodes.empty() ? Json(kAutomatic) : std::move(nodes)}, {"cubes", tower.cubes}};
}

BoundaryTower tower_from_json(const Entry& entry) {
  BoundaryTower tower;
  const Entry nodes = entry.at("boundary_nodes");
  if (!nodes.is(kAutomatic))
    for (const Entry& p : nodes.list(4)) tower.nodes.push_back(p.point());
  if (entry.has("cubes")) tower.cubes = static_cast<int>(entry.at("cubes").integer(0, limits::most_cubes));
  return tower;
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

LayoutOutline base_from_json(const Entry& entry) {
  entry.only({"nodes", "quads", "neighbours", "curves", "origin"});
  LayoutOutline base;
  for (const Entry& e : entry.at("nodes").list()) base.nodes.push_back(e.point());
  for (const Entry& e : entry.at("quads").list()) {
    const std::vector<Entry> corners = e.list(4);
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) quad[i] = corners[i].index(base.nodes.size());
    base.quads.push_back(quad);
  }
  if (base.quads.empty()) entry.refuse("has no quads");
  if (entry.has("neighbours"))
    for (const Entry& e : entry.at("neighbours").list(base.quads.size())) {
      const std::vector<Entry> sides = e.list(4);
      std::array<PatchSide, 4> of;
      for (int i = 0; i < 4; ++i) {
        const std::vector<Entry> link = sides[i].list(2);
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
// Kinds of edits: towers are told by their height, the rest by its quads.
const char* kind_of(const LayoutEdit& edit) { return edit.rings > 0 ? "add_cubes" : "repatch"; }

Json edit_to_json(const LayoutEdit& edit, const std::vector<std::string>& addresses) {
  Json quads = Json::array();
  for (const int q : edit.patches) quads.push_back(addresses[q]);
  Json out{{"kind", kind_of(edit)}, {"quads", std::move(quads)}, {"start", {addresses[edit.start.patch], edit.start.side}}};
  if (edit.rings > 0)
    out["height"] = edit.rings;
  else
    out["new_quads"] = edit.quads;
  return out;
}

std::array<int, 4> new_quad(const Entry& entry, std::int64_t most) {
  const std::vector<Entry> nodes = entry.list(4);
  std::array<int, 4> quad;
  for (int i = 0; i < 4; ++i) quad[i] = static_cast<int>(nodes[i].integer(0, most));
  return quad;
}

LayoutEdit edit_from_json(const Entry& entry, const PlanLayout& layout) {
  const auto quad = [&](const Entry& e) {
    const int q = layout.find(e.text());
    if (q < 0) e.refuse("names the quad " + e.text() + ", which that level does not have");
    return q;
  };
  std::vector<int> patches;
  for (const Entry& e : entry.at("quads").list()) patches.push_back(quad(e));
  PatchSide start;
  if (entry.has("start")) {
    const std::vector<Entry> s = entry.at("start").list(2);
    start = {quad(s[0]), s[1].index(4)};
    const auto inside = [&](int q) { return std::find(patches.begin(), patches.end(), q) != patches.end(); };
    if (!inside(start.patch) || inside(layout.layout().neighbours[start.patch][start.side].patch))
      entry.at("start").refuse("is no side of the quads' boundary");
  }
  const std::optional<PatchRegion> region = make_region(layout.layout(), patches, start);
  if (!region) entry.refuse("has quads that are no disk, or whose boundary does not have its start");
  const std::string kind = entry.at("kind").text();
  if (kind == "add_cubes") return tower_edit(layout.layout(), *region, static_cast<int>(entry.at("height").integer(1, limits::most_cubes)));
  if (kind != "repatch") entry.at("kind").refuse("must be \"repatch\" or \"add_cubes\"");
  LayoutEdit edit;
  edit.patches = region->patches;
  edit.start = region->boundary[0];
  const std::vector<Entry> quads = entry.at("new_quads").list();
  const int corners = static_cast<int>(region->corners.size());
  for (const Entry& e : quads) edit.quads.push_back(new_quad(e, 4 * static_cast<std::int64_t>(quads.size()) + corners));
  if (const std::string defect = find_filling_defect(edit.quads, corners); !defect.empty()) entry.at("new_quads").refuse(defect);
  for (const auto& q : edit.quads) edit.inner_nodes = std::max(edit.inner_nodes, *std::max_element(q.begin(), q.end()) + 1 - corners);
  return edit;
}

// Edits of the base level: all are named by numbers in the base domain as it was first, which the plan does not hold.
Json raw_edit(const LayoutEdit& edit) {
  return {{"patches", edit.patches},
          {"start", {edit.start.patch, edit.start.side}},
          {"quads", edit.quads},
          {"rings", edit.rings},
          {"inner_nodes", edit.inner_nodes}};
}
LayoutEdit raw_edit(const Entry& entry) {
  constexpr std::int64_t most = std::numeric_limits<int>::max();
  LayoutEdit edit;
  for (const Entry& e : entry.at("patches").list()) edit.patches.push_back(static_cast<int>(e.integer(0, most)));
  const std::vector<Entry> start = entry.at("start").list(2);
  edit.start = {static_cast<int>(start[0].integer(0, most)), start[1].index(4)};
  for (const Entry& e : entry.at("quads").list()) {
    const std::vector<Entry> nodes = e.list(4);
    std::array<int, 4> q;
    for (int i = 0; i < 4; ++i) q[i] = static_cast<int>(nodes[i].integer(0, most));
    edit.quads.push_back(q);
  }
  edit.rings = static_cast<int>(entry.at("rings").integer(0, most));
  edit.inner_nodes = static_cast<int>(entry.at("inner_nodes").integer(0, most));
  return edit;
}

Json origin_to_json(const Plan::Origin& origin) {
  if (origin.tower) {
    Json out = tower_to_json(*origin.tower);
    out["surface"] = origin.surface;
    return out;
  }
  Json rounds = Json::array();
  for (const auto& round : origin.level.rounds) {
    Json list = Json::array();
    for (const LayoutEdit& edit : round) list.push_back(raw_edit(edit));
    rounds.push_back(std::move(list));
  }
  return {{"surface", origin.surface},         {"faces", origin.faces},
          {"size", origin.base.size},          {"boundary_side", origin.base.boundary_side},
          {"least", origin.base.least},        {"seed", origin.base.seed},
          {"vertices", origin.level.vertices}, {"vertices_a_quad", origin.level.vertices_a_quad},
          {"rounds", std::move(rounds)}};
}

Plan::Origin origin_from_json(const Entry& entry) {
  if (entry.has("boundary_nodes")) {
    entry.only({"surface", "boundary_nodes", "cubes"});
    Plan::Origin origin;
    origin.surface = entry.at("surface").text();
    origin.tower = tower_from_json(entry);
    return origin;
  }
  entry.only({"surface", "faces", "size", "boundary_side", "least", "seed", "vertices", "vertices_a_quad", "rounds"});
  Plan::Origin origin;
  origin.surface = entry.at("surface").text();
  origin.faces = entry.at("faces").integer(0, std::numeric_limits<std::int64_t>::max());
  origin.base.size = entry.at("size").number(1);
  origin.base.boundary_side = entry.at("boundary_side").number(0);
  origin.base.least = static_cast<int>(entry.at("least").integer(0, std::numeric_limits<int>::max()));
  origin.base.seed = static_cast<std::uint64_t>(entry.at("seed").integer(0, std::numeric_limits<std::int64_t>::max()));
  origin.level.vertices = entry.at("vertices").number(0);
  origin.level.vertices_a_quad = entry.at("vertices_a_quad").number(0);
  for (const Entry& round : entry.at("rounds").list()) {
    origin.level.rounds.emplace_back();
    for (const Entry& e : round.list()) origin.level.rounds.back().push_back(raw_edit(e));
  }
  return origin;
}

// --- levels ----------------------------------------------------------------------------------------------------------------------------
PatchedSurface layout_of(const LayoutOutline& base) {
  PatchedSurface layout;
  layout.nodes = base.quads;
  layout.neighbours = base.neighbours;
  layout.node_count = static_cast<int>(base.nodes.size());
  if (!layout.neighbours.empty()) return layout;
  layout.neighbours.resize(base.quads.size());
  std::map<std::pair<int, int>, PatchSide> sides;
  for (int q = 0; q < layout.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) sides[{base.quads[q][i], base.quads[q][(i + 1) % 4]}] = {q, i};
  for (int q = 0; q < layout.patch_count(); ++q)
    for (int i = 0; i < 4; ++i)
      if (const auto it = sides.find({base.quads[q][(i + 1) % 4], base.quads[q][i]}); it != sides.end()) layout.neighbours[q][i] = it->second;
  return layout;
}

Json levels_to_json(const Plan& plan) {
  PlanLayout layout(layout_of(plan.base));
  Json out = Json::array();
  for (std::size_t level = 0; level < plan.levels.size(); ++level) {
    const LayoutScript::Level& of = plan.levels[level];
    layout.quadrisect();
    Json operations = Json::array();
    std::vector<LayoutEdit> round;
    for (const LayoutScript::EvenLayout& even : of.even) {
      operations.push_back(edit_to_json(even.edit, layout.addresses()));
      operations.back()["round"] = 0;
      operations.back()["even_quads"] = even.quads;
      operations.back()["nodes"] = nodes_to_json(even.outline);
      operations.back()["curves"] = curves_to_json(even.outline);
      round.push_back(even.edit);
    }
    layout.apply(round);
    for (std::size_t r = 0; r < of.rounds.size(); ++r) {
      for (const LayoutEdit& edit : of.rounds[r]) {
        operations.push_back(edit_to_json(edit, layout.addresses()));
        operations.back()["round"] = r + 1;
      }
      layout.apply(of.rounds[r]);
    }
    out.push_back({{"level", level + 1}, {"vertices", of.vertices}, {"vertices_a_quad", of.vertices_a_quad}, {"operations", std::move(operations)}});
  }
  return out;
}

std::vector<LayoutScript::Level> levels_from_json(const Entry& entry, const LayoutOutline& base) {
  PlanLayout layout(layout_of(base));
  std::vector<LayoutScript::Level> levels;
  for (const Entry& e : entry.list()) {
    e.only({"level", "vertices", "vertices_a_quad", "operations"});
    const auto level = static_cast<std::size_t>(e.at("level").integer(static_cast<std::int64_t>(levels.size()) + 1, limits::most_levels));
    while (levels.size() < level) {
      if (4 * static_cast<std::int64_t>(layout.addresses().size()) > kMostPlanQuads)
        e.at("level").refuse("would have more than " + std::to_string(kMostPlanQuads) + " quads");
      levels.emplace_back();
      layout.quadrisect();
    }
    LayoutScript::Level& of = levels.back();
    if (e.has("vertices")) of.vertices = e.at("vertices").number(0);
    if (e.has("vertices_a_quad")) of.vertices_a_quad = e.at("vertices_a_quad").number(0);
    // Operations of one round are named by the layout before it; without rounds each one is a round of its own.
    std::int64_t now = -1;
    std::vector<LayoutEdit> round;
    for (const Entry& op : e.at("operations").list()) {
      op.only({"kind", "quads", "start", "height", "new_quads", "round", "even_quads", "nodes", "curves"});
      const std::int64_t r = op.has("round") ? op.at("round").integer(std::max<std::int64_t>(0, now), 1000000) : now + 1;
      if (r != now) layout.apply(std::exchange(round, {}));
      LayoutEdit edit = edit_from_json(op, layout);
      for (const LayoutEdit& other : round)
        for (const int q : other.patches)
          if (std::find(edit.patches.begin(), edit.patches.end(), q) != edit.patches.end())
            op.refuse("has a quad that another operation of its round has");
      round.push_back(edit);
      if (op.has("even_quads")) {
        if (r > 0) op.at("even_quads").refuse("belongs to the first round, which is 0");
        LayoutOutline outline;
        if (op.has("nodes")) {
          // The region's corners, then the new ones.
          outline.quads = edit.quads;
          int count = 0;
          for (const auto& q : edit.quads) count = std::max(count, 1 + *std::max_element(q.begin(), q.end()));
          for (const Entry& p : op.at("nodes").list(count)) outline.nodes.push_back(p.point());
          if (op.has("curves")) curves_from_json(op.at("curves"), outline);
        }
        of.even.push_back({std::move(edit), op.at("even_quads").number(0), std::move(outline)});
      } else {
        if (r == 0 && !of.even.empty()) op.refuse("has no \"even_quads\", as others of its round have");
        if (of.rounds.empty() || r != now) of.rounds.emplace_back();
        of.rounds.back().push_back(std::move(edit));
      }
      now = r;
    }
    layout.apply(std::move(round));
  }
  return levels;
}

// --- regions -------------------------------------------------------------------------------------------------------------------------
using Pattern = RegionPattern::Kind;
constexpr std::array<std::pair<Pattern, const char*>, 3> kLayouts{
    {{Pattern::Automatic, kAutomatic}, {Pattern::Cubes, "cubes"}, {Pattern::Template, "template"}}};

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
    if (r.pattern.kind == Pattern::Drawn) region["curves"] = curves_to_json(r.pattern.strokes);
    for (const auto& [kind, name] : kLayouts)
      if (r.pattern.kind == kind) region["layout"] = name;
    if (r.pattern.height > 0) region["height"] = r.pattern.height;
    if (!r.start_quad.empty()) region["start"] = {r.start_quad, r.start_side};
    if (r.pattern.kind == Pattern::Template) region["new_quads"] = r.pattern.quads;
    region["buffer_rings"] = r.buffer_rings;
    out.push_back(std::move(region));
  }
  return out;
}

std::vector<DrawnStroke> strokes_from_json(const Entry& entry) {
  std::vector<DrawnStroke> strokes;
  for (const Entry& c : entry.list()) {
    c.only({"points", "fit"});
    DrawnStroke stroke;
    for (const Entry& p : c.at("points").list()) stroke.points.push_back(p.point());
    if (c.has("fit")) {
      const std::string fit = c.at("fit").text();
      if (fit != "tight" && fit != "drawn") c.at("fit").refuse("must be \"tight\" or \"drawn\"");
      stroke.fit = fit == "tight" ? DrawnStroke::Fit::Tight : DrawnStroke::Fit::AsDrawn;
    }
    strokes.push_back(std::move(stroke));
  }
  return strokes;
}

Plan::Region region_from_json(const Entry& entry) {
  Plan::Region r;
  std::set<std::string> keys{"level", "quads", "buffer_rings"};
  if (entry.has("layout")) {
    if (entry.has("curves")) entry.refuse("has \"curves\" and a \"layout\": it is laid out in one way");
    const std::string word = entry.at("layout").text();
    for (const auto& [kind, name] : kLayouts)
      if (word == name) r.pattern.kind = kind;
    if (r.pattern.kind == Pattern::Drawn) entry.at("layout").refuse("must be \"automatic\", \"cubes\" or \"template\"");
    keys.insert("layout");
    if (r.pattern.kind == Pattern::Cubes) keys.insert("height");
    if (r.pattern.kind == Pattern::Template) keys.insert({"start", "new_quads"});
  } else {
    if (!entry.has("curves")) entry.refuse("has neither \"curves\" nor a \"layout\"");
    keys.insert("curves");
  }
  entry.only(keys);
  r.level = static_cast<int>(entry.at("level").integer(1, limits::most_levels));
  for (const Entry& q : entry.at("quads").list()) r.quads.push_back(q.text());
  if (r.quads.empty()) entry.refuse("has no quads");
  if (entry.has("curves")) r.pattern.strokes = strokes_from_json(entry.at("curves"));
  if (entry.has("height")) r.pattern.height = static_cast<int>(entry.at("height").integer(0, limits::most_cubes));
  if (r.pattern.kind == Pattern::Template) {
    const std::vector<Entry> start = entry.at("start").list(2), quads = entry.at("new_quads").list();
    r.start_quad = start[0].text();
    r.start_side = start[1].index(4);
    for (const Entry& e : quads) r.pattern.quads.push_back(new_quad(e, 4 * static_cast<std::int64_t>(quads.size() + r.quads.size())));
  }
  if (entry.has("buffer_rings")) r.buffer_rings = static_cast<int>(entry.at("buffer_rings").integer(0, limits::most_buffer_rings));
  return r;
}

}  // namespace

PlanLayout::PlanLayout(const PatchedSurface& base) : roots_(base.patch_count()) {
  layout_.nodes = base.nodes;
  layout_.neighbours = base.neighbours;
  layout_.node_count = base.node_count;
  for (int q = 0; q < roots_; ++q) address_.push_back(std::to_string(q));
}

int PlanLayout::find(const std::string& address) const {
  const auto it = std::find(address_.begin(), address_.end(), address);
  return it == address_.end() ? -1 : static_cast<int>(it - address_.begin());
}

void PlanLayout::quadrisect() {
  layout_ = quadrisected(std::move(layout_));
  std::vector<std::string> finer;
  for (const std::string& a : address_)
    for (int k = 0; k < 4; ++k) finer.push_back(a + "." + std::to_string(k));
  address_ = std::move(finer);
}

void PlanLayout::apply(const LayoutScript::Level& level) {
  std::vector<LayoutEdit> even;
  for (const LayoutScript::EvenLayout& e : level.even) even.push_back(e.edit);
  apply(std::move(even));
  for (const auto& round : level.rounds) apply(round);
}

void PlanLayout::apply(std::vector<LayoutEdit> edits) {
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const LayoutChange change = change_layout(layout_, edits[i]);
    std::vector<std::string> addresses(layout_.patch_count());
    for (std::size_t q = 0; q < change.patch.size(); ++q)
      if (change.patch[q] >= 0) addresses[change.patch[q]] = std::move(address_[q]);
    for (const int q : change.added) addresses[q] = std::to_string(roots_++);
    address_ = std::move(addresses);
    for (std::size_t k = i + 1; k < edits.size(); ++k) edits[k] = renumbered(std::move(edits[k]), change);
  }
}

// FNV-1a.
std::string fingerprint(const TriangleSurface& surface) {
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&](std::uint64_t word) {
    for (int i = 0; i < 8; ++i) {
      hash ^= (word >> (8 * i)) & 255;
      hash *= 1099511628211ull;
    }
  };
  for (const Vec3& p : surface.points)
    for (int i = 0; i < 3; ++i) {
      std::uint64_t bits;
      std::memcpy(&bits, &p[i], sizeof bits);
      add(bits);
    }
  for (const auto& f : surface.faces)
    for (const int v : f) add(static_cast<std::uint64_t>(v));
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::string to_json(const Plan& plan) {
  Json base = base_to_json(plan);
  if (plan.origin) base["origin"] = origin_to_json(*plan.origin);
  Json out{{"format", kFormat}, {"version", kVersion}, {"base", std::move(base)}, {"levels", levels_to_json(plan)}};
  if (!plan.regions.empty()) out["operations"] = regions_to_json(plan);
  return out.dump();
}

Plan plan_from_json(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error(ErrorCode::InvalidInput, "the plan is not JSON");
  const Entry top(json, Entry::kTop);
  top.only({"format", "version", "base", "levels", "operations"});
  if (top.at("format").text() != kFormat) top.at("format").refuse(std::string("must be \"") + kFormat + "\"");
  if (const std::int64_t version = top.at("version").integer(1, 1000000); version > kVersion)
    throw Error(ErrorCode::Unsupported,
                "the plan has version " + std::to_string(version) + "; this program reads versions up to " + std::to_string(kVersion));
  const Entry base = top.at("base");
  Plan plan;
  if (base.has("boundary_nodes")) {
    base.only({"boundary_nodes", "cubes"});
    plan.tower = tower_from_json(base);
    if (top.has("levels") && !top.at("levels").list().empty())
      top.at("levels").refuse("must be empty: quads have addresses once the base has been made; \"operations\" may be given");
  } else {
    plan.base = base_from_json(base);
    if (base.has("origin")) plan.origin = origin_from_json(base.at("origin"));
  }
  if (top.has("levels") && !plan.tower) {
    try {
      plan.levels = levels_from_json(top.at("levels"), plan.base);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal) throw;
      throw Error(ErrorCode::InvalidInput, std::string("the plan's operations do not fit its base: ") + e.what());
    }
  }
  if (top.has("operations"))
    for (const Entry& e : top.at("operations").list()) plan.regions.push_back(region_from_json(e));
  return plan;
}

}  // namespace hybrid_mesh
