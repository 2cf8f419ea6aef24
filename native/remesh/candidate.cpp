// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/candidate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "construction/construction.h"
#include "hierarchy/coarsening.h"
#include "layout/search/base_map.h"
#include "parameterization/patch_extraction.h"
#include "remesh/adaptive_refinement.h"
#include "remesh/late_topology.h"
#include "remesh/layout_search_options.h"
#include "remesh/mirror_sides.h"
#include "remesh/outlines.h"
#include "remesh/quality.h"
#include "remesh/skin.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

constexpr int kRequests = 8;
constexpr std::size_t kFeatureRequests = 3;  // with features: what fails then is seldom a matter of near-ties
constexpr int kMostMisses = 3;               // requests with which a few quads too many are made up for, before a coarser mesh is kept
// A base of more quads than this has room for a ring around a feature that sticks out, so that it is sought of so many quads fewer.
constexpr double kRoomyBase = 280;
// The last triangles of a decimation are too few to choose quads from: below this size the base's is taken for the least.
constexpr double kSmallBase = 60;

// A cube for a ball, four quads around a hole, with which its boundary has no corners, and a dozen around a handle: with fewer a map to them holds on
// few surfaces.
int least_quads(const TopologySummary& topology) {
  return static_cast<int>(std::max(6.0 * topology.components, 12.0 * topology.genus) + 4.0 * topology.boundary_loops);
}

// More quads than this in a base, of which not even one level is within the budget, take long to map and leave nothing to refine.
constexpr int kMostQuads = 4000;

void check_size(const BaseDomain& base, const Budget& budget, const Source& source, bool features) {
  if (base.quads() <= kMostQuads || 4.0 * base.quads() <= static_cast<double>(budget.vertices)) return;
  const TopologySummary& t = source.topology;
  const std::string what = std::to_string(t.components) + " components, " + std::to_string(static_cast<std::int64_t>(t.genus)) + " handles and " +
                           std::to_string(t.boundary_loops) + " boundary loops ask for a base of " + std::to_string(base.quads()) +
                           " quads, too many for " + std::to_string(budget.vertices) +
                           " vertices: allow more vertices, drop small components (drop_components), or close small handles (remove_noise)";
  if (features) throw NoMap(what);
  throw Error(ErrorCode::InvalidInput, what);
}

// A corner of sharp edges with too few quads around has one with a straight angle, and so has the finest of its quads there. With so many of these,
// by the vertices allowed, a mesh is worse than one without sharp edges, and takes long to make.
constexpr double kMostLacking = 0.05;

void check_room(const BaseDomain& base, const Budget& budget) {
  if (static_cast<double>(base.lacking()) > kMostLacking * static_cast<double>(budget.vertices))
    throw NoMap("quads would have straight angles at " + std::to_string(base.lacking()) + " of the corners between sharp edges");
}

// Two quads with the same four corners are no faces of a mesh that others can read.
bool has_twins(const QuadGraph& base) {
  std::vector<std::array<int, 4>> corners = base.nodes;
  for (auto& c : corners) std::sort(c.begin(), c.end());
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

// Has the coarsest mesh with all that has opened no more vertices than are allowed?
bool is_within(const RemeshTask& task, const Candidate& c) {
  return task.options.vertices == 0 || whole_vertices(c.hierarchy, task.source) <= task.options.vertices;
}

void close(Candidate& c, int from_level, const std::string& why) {
  for (std::size_t e = 0; e < c.opened_on.size(); ++e)
    if (c.opened_on[e] >= from_level) c.unopened.push_back({static_cast<int>(e), why});
  std::sort(c.unopened.begin(), c.unopened.end());
}

// What opened on the finest level finds no room.
void close_finest(Candidate& c) {
  const int finest = c.opened_on.empty() ? 0 : *std::max_element(c.opened_on.begin(), c.opened_on.end());
  if (finest > 0) close(c, finest, "the quads around it would be more than the mesh may have");
}

Candidate make_candidate(const RemeshTask& task, const Budget& budget, const BaseRequest& request, bool features, WorkingSurfaceInUse& in_use) {
  const RemeshOptions& options = task.options;
  Plan::Origin origin;
  if (features) origin.features = options.features, origin.feature_angle = options.feature_angle;
  origin.surface = task.source.fingerprint;
  origin.faces = working_faces(budget.base_size, budget.vertices);
  BaseDomainOptions& base_options = origin.base;
  base_options.size = budget.base_size;
  base_options.boundary_side = budget.boundary_side;
  if (options.base == BaseSize::Minimal) {
    base_options.size = least_quads(task.base.topology) * request.size_factor;
    if (base_options.size < kSmallBase) base_options.least = static_cast<int>(base_options.size);
  }
  base_options.seed = request.seed;
  base_options.mirror = task.source.mirror;
  if (options.base == BaseSize::Auto && base_options.size > kRoomyBase) base_options.size -= kRoomForARing;
  BaseDomain base = make_base(task, origin, in_use);
  check_size(base, budget, task.source, features);
  check_room(base, budget);
  const WorkingSurface& working = in_use.of(task, origin);
  Found<BaseMap> map = map_to_base(working.mesh, base, layout_search_options(options, budget, base, request), task.progress.part(0.15, 0.5));
  if (!map) throw NoMap(map.reason);
  if (has_twins(map->layout.graph())) throw NoMap("two of the base's quads have the same corners");
  origin.script = map->script;
  // Tried with one operation and another, but of one map, which by then has made room.
  const Construction constructed = construct(task, working, std::move(*map));
  const auto made_with = [&](const OpeningBounds& bounds, bool skin) {
    LateTopology late;
    // What quads need is no part of a plan, which could not make the base again.
    const std::optional<Plan::Origin> again = task.need ? std::nullopt : std::optional(origin);
    Candidate c = assemble_candidate(task, working, constructed, again, [&](Construction& made) {
      if (!working.features.empty()) return std::vector<Plan::Region>();  // a region's quads would not keep them
      std::vector<Plan::Region> regions = grow_skin(made, task, skin ? skin_options(task, budget, base, request) : SkinOptions());
      late = open_late(made, task, bounds);
      regions.insert(regions.end(), late.regions.begin(), late.regions.end());
      return regions;
    });
    c.unopened = std::move(late.unopened);
    c.waited = std::move(late.waited);
    if (options.levels >= 0) close(c, options.levels + 1, "it would open above the last level that the mesh may have");
    return c;
  };
  const OpeningBounds bounds = opening_bounds(options, budget.vertices);
  Found<Candidate> with_skin = found([&] { return made_with(bounds, true); });
  // Beside its mirror image a half cannot have every operation.
  if (!with_skin && !(task.source.mirror && !options.semi_regular)) throw NoMap(with_skin.reason);
  Candidate c = with_skin ? std::move(*with_skin) : made_with(bounds, false);
  c.lost_operations = with_skin.reason;
  if (options.refinement == Refinement::Uniform) return c;
  // Of a level as fine as the last one that something opens on, or grows skin on, it may be too much.
  for (const bool skin : {true, false})
    if (!is_within(task, c)) c = made_with({budget.vertices, budget.vertices}, skin);
  if (!is_within(task, c)) close_finest(c);
  return c;
}

// Back to the coarsest hierarchy with its operations: an adaptive mesh is refined where that brings it nearer to the surface, and nowhere else.
void coarsen(Candidate& c) {
  Coarsened made = coarsened(c.hierarchy);
  for (std::vector<int>* of_node : {&c.plan_root, &c.opened}) {
    const std::vector<int> before = std::exchange(*of_node, std::vector<int>(made.mesh.node_count(), -1));
    for (std::size_t n = 0; n < made.node.size(); ++n)
      if (made.node[n] >= 0) (*of_node)[made.node[n]] = before[n];
  }
  std::vector<VertexId> irregular;
  for (const auto& [before, after] : made.vertex)
    if (std::binary_search(c.finest_irregular.begin(), c.finest_irregular.end(), before)) irregular.push_back(after);
  std::sort(irregular.begin(), irregular.end());
  c.finest_irregular = std::move(irregular);
  c.hierarchy = std::move(made.mesh);
  c.hierarchy.balance();
}

// The vertices of the coarsest uniform mesh that the candidate's hierarchy has, or of one with so many levels.
std::int64_t vertices_needed(const Candidate& c, const Source& source, int levels) {
  return uniform_vertices(c.finest_quads, source.made.euler, c.finest_boundary_sides, std::max(c.finest, levels) - c.finest);
}

// Would a uniform mesh one level finer use the vertices allowed, but for a few quads that have opened above the base? Then the budget shrinks by
// these.
bool just_misses(const RemeshTask& task, Budget& budget, const Candidate& c) {
  constexpr double enough = 0.98, few = 1.2;  // of the vertices allowed
  const RemeshOptions& options = task.options;
  if (!task.base.series || !c.unopened.empty() || options.base != BaseSize::Minimal || options.refinement != Refinement::Uniform ||
      options.levels >= 0 || options.error > 0)
    return false;
  const std::int64_t euler = task.source.made.euler, most = budget.vertices * task.source.copies();
  const int levels = levels_within(most, c.finest, c.finest_quads, euler, c.finest_boundary_sides);
  const auto vertices = [&](int more) {
    return static_cast<double>(uniform_vertices(c.finest_quads, euler, c.finest_boundary_sides, levels + more - c.finest));
  };
  const auto allowed = static_cast<double>(most);
  if (vertices(0) > allowed || vertices(0) >= enough * allowed || vertices(1) > few * allowed) return false;
  budget.shrink *= 0.997 * allowed / vertices(1);
  return true;
}

void set_levels(const RemeshTask& task, const Budget& budget, Candidate& c) {
  const RemeshOptions& options = task.options;
  c.levels = budget.levels;
  // With a base of any size the number of levels is what makes a mesh of the size asked for.
  if (options.base == BaseSize::Minimal && options.refinement == Refinement::Uniform && options.levels < 0 && options.error == 0)
    c.levels = levels_within(budget.vertices * task.source.copies(), c.finest, c.finest_quads, task.source.made.euler, c.finest_boundary_sides);
}

}  // namespace

std::vector<BaseRequest> base_requests(const RemeshOptions& options, bool another) {
  std::vector<BaseRequest> requests;
  for (int k = 0; k < kRequests; ++k) {
    BaseRequest& r = requests.emplace_back();
    // Nearby decisions differ.
    r.seed = options.seed + 1000003ull * static_cast<std::uint64_t>(k + (another ? kRequests : 0));
    // With edits the base may have sides that it cannot have beside its mirror image.
    if (options.symmetry != Symmetry::None && k > 1) r.base_edits = false;
    if (options.base != BaseSize::Minimal) continue;
    // The same size a few times, the cheapest way first, then larger bases, which are easier to map; at last without operations.
    constexpr std::array<int, kRequests> factor{1, 1, 1, 1, 2, 4, 16, 64};
    r.size_factor = factor[k];
    r.base_edits = k == 2 || k == 3;
    r.operations = k < 7;
  }
  return requests;
}

std::vector<VertexId> irregular_names(const QuadMesh& mesh) {
  const std::vector<char> irregular = irregular_vertices(mesh);
  std::vector<VertexId> names;
  for (std::size_t v = 0; v < irregular.size(); ++v)
    if (irregular[v]) names.push_back(mesh.vertex[v]);
  std::sort(names.begin(), names.end());
  return names;
}

Construction construct(const RemeshTask& task, const WorkingSurface& working, BaseMap map) {
  task.watch.start("extract");
  Construction made(map.layout.graph(), measured_area(working.mesh), task.base.version(), working.mesh.sizes);
  for (std::size_t q = 0; q < map.layout.sharp.size(); ++q)
    for (int i = 0; i < 4; ++i)
      if (map.layout.sharp[q][i]) made.set_sharp(static_cast<int>(q), i);
  std::vector<PatchMap> maps = extract_patch_maps(map.charts, map.layout, working.mesh.faces, task.progress.part(0.5, 0.55));
  map.charts = {};
  for (std::size_t q = 0; q < maps.size(); ++q) {
    const char* defect = find_map_defect(maps[q]);
    if (*defect) throw NoMap("the map of the base's quad " + std::to_string(q) + ": " + defect);
    working.to_repaired(maps[q], task.surface());
    made.set_map(static_cast<int>(q), std::move(maps[q]));
  }
  return made;
}

namespace {

// Where nothing is mended, see make_working_surface(): around the ends of a half's cut, too, which are to stay where they are, or around all of it.
std::vector<char> held_faces(const RemeshTask& task, bool all_of_cut) {
  std::vector<char> held = task.base.held();
  if (!task.source.half) return held;
  const HalfSurface& half = *task.source.half;
  held.resize(half.mesh.faces.size(), 0);
  for (std::size_t f = 0; f < held.size(); ++f)
    for (const int v : half.mesh.faces[f])
      if (half.corner[v] || (all_of_cut && half.on_plane[v])) held[f] = 1;
  return held;
}

// Of the boundary in the plane of a half.
double length_of_cut(const TriangleSurface& surface, const Vec3& normal) {
  double length = 0;
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
    const Vec3 &a = surface.points[surface.from(h)], &b = surface.points[surface.to(h)];
    if (surface.opposite[h] < 0 && is_in_mirror(a, normal) && is_in_mirror(b, normal)) length += (b - a).norm();
  }
  return length;
}

}  // namespace

const WorkingSurface& WorkingSurfaceInUse::made(const RemeshTask& task, std::int64_t faces, Features features, double angle) {
  if (faces != faces_ || features != features_) {
    faces_ = -1;
    surface_ = {};  // what it took is free for the next one
    const auto make = [&](bool all_of_cut) {
      surface_ = make_working_surface(task.surface(), task.source.placement, faces, task.progress.part(0.05, 0.05), held_faces(task, all_of_cut),
                                      feature_options(task.source, features, angle), task.sizes());
    };
    make(false);
    if (const std::optional<Vec3>& mirror = task.source.mirror) {
      // Mending may move a boundary by its tolerance: off the plane.
      const double wanted = length_of_cut(task.source.placement.to_unit(task.surface()), *mirror);
      if (std::abs(length_of_cut(surface_.mesh, *mirror) - wanted) > tolerance::same_place) make(true);
      hold_ends_of_cut(surface_, *mirror);
    }
    faces_ = faces;
    features_ = features;
  }
  return surface_;
}

const WorkingSurface& WorkingSurfaceInUse::of_size(const RemeshTask& task, std::int64_t faces) { return made(task, faces, Features::None, 0); }

const WorkingSurface& WorkingSurfaceInUse::of(const RemeshTask& task, const Plan::Origin& origin) {
  return made(task, origin.faces, origin.features, origin.feature_angle);
}

BaseDomain make_base(const RemeshTask& task, const Plan::Origin& origin, WorkingSurfaceInUse& working) {
  task.progress.stage("base domain");
  task.watch.start("base");
  const WorkingSurface& surface = working.of(task, origin);
  BaseDomain base(surface.mesh, surface.features, origin.base, task.progress.part(0.05, 0.15));
  task.progress.stage("map");
  task.watch.start("map");
  return base;
}

bool keeps_features(const RemeshTask& task) { return task.source.keeps_features && !task.base.series; }

CandidateSearch search_candidate(const RemeshTask& task, const Target& target, const std::vector<BaseRequest>& requests) {
  const RemeshOptions& options = task.options;
  Budget budget = plan_budget(options, task.source, target);
  std::string failure;
  std::int64_t least = -1;
  WorkingSurfaceInUse working;
  Found<Candidate> missing;  // leaves a level of the budget unused, for a few quads
  int misses = 0;
  const bool features = target.features && keeps_features(task);
  const std::size_t most = !features ? requests.size() : task.source.features_are_crowded ? 1 : kFeatureRequests;
  const std::size_t tried = std::min(requests.size(), most);
  for (const BaseRequest& request : std::span(requests).first(tried)) {
    Found<Candidate> c = found([&] { return make_candidate(task, budget, request, features, working); });
    if (c && just_misses(task, budget, *c)) {
      if (!missing) missing = std::move(c);
      c = found([&] { return make_candidate(task, budget, request, features, working); });
      if (!c || just_misses(task, budget, *c)) {
        if (++misses == kMostMisses) break;
        continue;
      }
    }
    if (!c) {
      failure = c.reason;
      continue;
    }
    set_levels(task, budget, *c);
    const std::int64_t needed = vertices_needed(*c, task.source, c->levels);
    const bool bound = options.vertices > 0 && options.refinement == Refinement::Uniform;
    if (!bound || needed <= options.vertices) return {std::move(c)};
    least = least < 0 ? needed : std::min(least, needed);
    if (c->levels == 0 || options.levels >= 0) break;
    budget = with_levels(budget, c->levels - 1, options, task.source);
  }
  if (missing) {
    set_levels(task, budget, *missing);
    return {std::move(missing)};
  }
  if (least >= 0)
    failure = "the surface needs at least " + std::to_string(least) + " vertices, more than the " + std::to_string(options.vertices) + " allowed";
  else
    failure = "no map of the surface to a base domain is found: " + failure;
  return {{std::nullopt, failure}, std::max<std::int64_t>(0, least)};
}

Candidate assemble_candidate(const RemeshTask& task, const WorkingSurface& working, Construction made, const std::optional<Plan::Origin>& origin,
                             const Operations& operations) {
  const Placement& placement = task.source.placement;
  const QuadGraph base = made.quads().graph();
  task.watch.start("map");
  const std::vector<Plan::Region> regions = operations(made);
  task.watch.start("extract");
  made.close();
  HybridMesh& hierarchy = made.hierarchy();
  hierarchy.set_closure(task.options.faces);
  Candidate c;
  const std::vector<char>& on_feature = working.features.edges;
  c.keeps_features = std::find(on_feature.begin(), on_feature.end(), 1) != on_feature.end();
  c.base_quads = base.patch_count();
  c.base_vertices = base.node_count;
  c.finest = made.level();
  const int copies = task.source.copies();
  c.finest_quads = copies * made.quads().graph().patch_count();
  for (const auto& n : made.quads().graph().neighbours)
    for (const PatchSide& s : n) c.finest_boundary_sides += copies * (s.patch < 0);
  if (task.source.mirror) {
    mark_mirror(hierarchy, *task.source.mirror);
    c.finest_boundary_sides -= copies * mirror_sides(hierarchy, c.finest);
  }
  c.finest_irregular = irregular_names(hierarchy.level_mesh(c.finest));
  c.plan_root = made.root_numbers();
  c.opened = made.opened();
  Plan plan;
  plan.base = outline_of_base(hierarchy, base);
  plan.origin = origin;
  plan.regions = regions;
  plan.topology = planned_events(task.base, task.source.repaired);
  for (const Plan::Region& region : regions)
    for (const int e : region.opens) plan.topology[e].level = region.level;
  c.opened_on.assign(plan.topology.size(), -1);
  for (std::size_t e = 0; e < plan.topology.size(); ++e) c.opened_on[e] = plan.topology[e].level;
  move_outline(plan.base, [&](const Vec3& p) { return placement.from_unit(p); });
  c.plan = to_json(plan);
  c.hierarchy = std::move(hierarchy);
  if (task.options.refinement == Refinement::Adaptive) {
    coarsen(c);
    if (task.source.mirror) mark_mirror(c.hierarchy, *task.source.mirror);
  }
  task.watch.stop();
  return c;
}

}  // namespace hybrid_mesh
