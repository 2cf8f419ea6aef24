// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/remesh.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "hierarchy/stretch.h"
#include "layout/search/base_map.h"
#include "parameterization/patch_extraction.h"
#include "remesh/adaptive_refinement.h"
#include "remesh/layout_hierarchy.h"
#include "remesh/layout_search_options.h"
#include "remesh/plan.h"
#include "remesh/plan_regions.h"
#include "remesh/quality.h"
#include "remesh/surface_fit.h"
#include "remesh/working_surface.h"
#include "surface/distance.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {
namespace {

using Json = nlohmann::ordered_json;

class Stopwatch {
 public:
  void start(const char* stage) {
    stop();
    stage_ = stage;
    begin_ = Clock::now();
  }
  void stop() {
    if (!stage_) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    total_ += seconds;
    json_[stage_] = json_.value(stage_, 0.0) + seconds;
    stage_ = nullptr;
  }
  Json json() const {
    Json j = json_;
    j["total"] = total_;
    return j;
  }

 private:
  using Clock = std::chrono::steady_clock;
  const char* stage_ = nullptr;
  Clock::time_point begin_;
  double total_ = 0;
  Json json_ = Json::object();
};

// The last level with operations (0: none), all of whose quads have a map of their own.
struct Finest {
  int level = 0;
  std::int64_t quads = 0, boundary_sides = 0;
  std::vector<VertexId> irregular;  // sorted
};

// Vertices of a uniform mesh: base quads B, Euler number chi, boundary sides E.
std::int64_t uniform_vertices(std::int64_t quads, std::int64_t euler, std::int64_t sides, int levels) {
  const std::int64_t cells = std::int64_t{1} << (2 * levels);
  // At level 0: V = B + chi + E / 2, since 4 B = 2 E_all - E.
  return levels == 0 ? quads + euler + sides / 2 : quads * cells + euler + (sides << levels) / 2;
}

class Remesher {
 public:
  Remesher(const PolygonSoup& input, const RemeshOptions& options, Context& context) : input_(input), options_(options), progress_(context) {}

  RemeshResult run() {
    check_options();
    if (!options_.plan.empty()) plan_ = plan_from_json(options_.plan);
    read_surface();
    plan_ ? build_planned_base() : build_base();
    build_levels();
    if (!plan_) try_another_base();
    finish();
    return std::move(result_);
  }

 private:
  void check_options() const {
    const auto refuse = [](const std::string& what) { throw Error(ErrorCode::InvalidInput, what); };
    if (options_.vertices < 0) refuse("vertices must not be negative");
    if (!(options_.error >= 0)) refuse("error must not be negative");
    if (options_.levels > 12) refuse("levels must be at most 12");
    if (!(options_.drop_components >= 0 && options_.drop_components < 1)) refuse("drop_components must be in [0, 1)");
    if (options_.base == BaseSize::Given && options_.base_quads < 1) refuse("base_quads must be positive");
  }

  void read_surface() {
    progress_.stage("repair");
    watch_.start("repair");
    RepairOptions repair_options;
    repair_options.drop_components = options_.drop_components;
    RepairReport repaired;
    result_.repaired = repair(input_, repair_options, repaired, progress_.part(0, 0.05));
    if (options_.strict && repaired.changed())
      throw Error(ErrorCode::InvalidInput, "the input needs repair, which strict mode refuses: " + describe(repaired));
    topology_ = summarize_topology(to_soup(result_.repaired));
    placement_ = placement_of(result_.repaired.points);
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
    report_["input"] = {{"vertices", input_.points.size()},           {"faces", input_.polygon_count()}, {"components", topology_.components},
                        {"boundary_loops", topology_.boundary_loops}, {"genus", topology_.genus},        {"repaired", r}};
    report_["topology"] = {{"loops", Json::array()}, {"tubes", Json::array()}};
  }

  static std::string describe(const RepairReport& r) {
    std::string text;
    const auto add = [&](std::int64_t n, const char* what) {
      if (n > 0) text += (text.empty() ? "" : ", ") + std::to_string(n) + " " + what;
    };
    add(r.merged_points, "points to merge");
    add(r.isolated_points, "isolated points");
    add(r.duplicate_faces, "duplicate faces");
    add(r.degenerate_faces, "degenerate faces");
    add(r.reoriented_faces, "misoriented faces");
    add(r.nonmanifold_edges, "non-manifold edges");
    add(r.nonmanifold_vertices, "non-manifold vertices");
    add(r.one_sided_cuts, "one-sided edges");
    add(r.dropped_components, "components to drop");
    return text;
  }

  // --- base domain and map -------------------------------------------------------------------------------------------------------
  Budget plan_budget() const {
    Budget b;
    b.vertices = options_.vertices > 0 ? options_.vertices : static_cast<std::int64_t>(result_.repaired.points.size());
    if (aim_ > 0) b.vertices = aim_;
    // Roughly what the topology asks for at least.
    const double least = 6.0 * topology_.components + 8 * topology_.genus + 2.6 * topology_.boundary_loops;
    const double enough = std::max(std::clamp(static_cast<double>(b.vertices) / 64, 20.0, 150.0), std::min(1.7 * least, b.vertices / 4.0));
    if (options_.levels >= 0 && options_.refinement == Refinement::Uniform) {
      b.levels = options_.levels;
    } else {
      while (b.levels < 6 && static_cast<double>(b.vertices) / std::pow(4.0, b.levels + 1) >= enough) ++b.levels;
    }
    set_levels(b, std::max(0, b.levels - levels_less_));
    return b;
  }
  void set_levels(Budget& b, int levels) const {
    b.levels = levels;
    const double cells = std::pow(4.0, levels);
    b.boundary_side = 0.5 * std::pow(2.0, levels) / cells;
    b.base_size = (static_cast<double>(b.vertices) - static_cast<double>(topology_.euler)) / cells;
    if (options_.base == BaseSize::Given) b.base_size = options_.base_quads, b.boundary_side = 0;
    if (options_.base == BaseSize::Minimal) b.base_size = 6, b.boundary_side = 0;
  }

  void build_base() {
    budget_ = plan_budget();
    std::string failure;
    std::int64_t least = -1;
    for (int attempt = 0; attempt < 8; ++attempt) {
      try {
        try_base(attempt);
        // With a base of any size the number of levels is what makes a mesh of the size asked for.
        if (options_.base == BaseSize::Minimal && options_.refinement == Refinement::Uniform && options_.levels < 0 && options_.error == 0) {
          budget_.levels = finest_.level;
          while (budget_.levels < 12 && vertices_at(budget_.levels + 1) <= budget_.vertices) ++budget_.levels;
        }
        const std::int64_t needed = vertices_at(std::max(finest_.level, budget_.levels));
        const bool bound = options_.vertices > 0 && options_.refinement == Refinement::Uniform;
        if (bound && needed > options_.vertices) {
          least = least < 0 ? needed : std::min(least, needed);
          if (budget_.levels == 0 || (options_.levels >= 0)) break;
          set_levels(budget_, budget_.levels - 1);
          continue;
        }
        return;
      } catch (const Error& e) {
        if (e.code() != ErrorCode::Internal) throw;
        // Another base: nearby decisions differ, and a larger one is easier to map.
        failure = e.what();
      }
    }
    if (least >= 0)
      throw Error(ErrorCode::InvalidInput, "the surface needs at least " + std::to_string(least) + " vertices, more than the " +
                                               std::to_string(options_.vertices) + " allowed");
    throw Error(ErrorCode::Internal, failure);
  }

  std::int64_t vertices_at(int level) const {
    return uniform_vertices(finest_.quads, topology_.euler, finest_.boundary_sides, level - finest_.level);
  }

  // A cube for a ball, and four quads around a hole, with which its boundary has no corners; around a handle it takes some forty quads until a map to
  // them holds.
  int least_quads() const { return static_cast<int>(std::max(6.0 * topology_.components, 39.0 * topology_.genus) + 4.0 * topology_.boundary_loops); }

  void try_base(int attempt) {
    Plan::Origin origin;
    origin.surface = fingerprint(result_.repaired);
    // As large as halves of the final quads, and small enough for the base to choose from.
    origin.faces = static_cast<std::int64_t>(std::min(std::max(30.0 * budget_.base_size, 2.0 * static_cast<double>(budget_.vertices)), 2e6));
    BaseDomainOptions& base_options = origin.base;
    base_options.size = budget_.base_size;
    base_options.boundary_side = budget_.boundary_side;
    if (options_.base == BaseSize::Minimal) {
      // More quads where a map to so few cannot be had.
      base_options.size = least_quads() << (attempt < 2 ? 0 : 2 * std::min(attempt - 1, 3));
      // The last triangles of a decimation are too few to choose quads from.
      if (base_options.size < 60) base_options.least = static_cast<int>(base_options.size);
    }
    base_options.seed = options_.seed + 1000003ull * (attempt + first_attempt_);
    if (options_.base == BaseSize::Auto && base_options.size > 280) base_options.size -= kRoomForARing;
    const BaseDomain base = make_base(origin);
    BaseMap map = map_to_base(working_.mesh, base, layout_search_options(options_, budget_, topology_, base, attempt), progress_.part(0.15, 0.5));
    origin.level = map.script.levels.front();
    install(std::move(map), origin);
  }

  BaseDomain make_base(const Plan::Origin& origin) {
    progress_.stage("base domain");
    watch_.start("base");
    working_ = make_working_surface(result_.repaired, placement_, origin.faces, progress_.part(0.05, 0.05));
    BaseDomain base(working_.mesh, origin.base, progress_.part(0.05, 0.15));
    progress_.stage("map");
    watch_.start("map");
    return base;
  }

  // Makes the hierarchy of a map.
  void install(BaseMap map, const std::optional<Plan::Origin>& origin) {
    watch_.start("extract");
    const PatchedSurface& first = map.levels.front().layout;
    report_["base"] = {{"quads", first.patch_count()}, {"vertices", first.node_count}};
    LayoutHierarchy made = make_hierarchy(first, map.edits);
    const double parts = static_cast<double>(map.levels.size());
    for (std::size_t i = 0; i < map.levels.size(); ++i) {
      LevelMap& level = map.levels[i];
      std::vector<PatchMap> maps =
          extract_patch_maps(level.charts, level.layout, working_.mesh.faces, progress_.part(0.5 + 0.05 * i / parts, 0.5 + 0.05 * (i + 1) / parts));
      for (int q = 0; q < level.layout.patch_count(); ++q) {
        if (!level.changed.empty() && !level.changed[q]) continue;
        const char* defect = find_map_defect(maps[q]);
        if (*defect)
          throw Error(ErrorCode::Internal, "the map of quad " + std::to_string(q) + " of level " + std::to_string(level.level) + ": " + defect);
        working_.to_repaired(maps[q], result_.repaired);
        made.mesh.set_map(made.node_of[level.level][q], std::move(maps[q]));
      }
    }
    made.mesh.set_closure(options_.faces);
    const LevelMap& finest = map.levels.back();
    finest_.level = finest.level;
    finest_.quads = finest.layout.patch_count();
    finest_.boundary_sides = 0;
    for (const auto& n : finest.layout.neighbours)
      for (const PatchSide& s : n) finest_.boundary_sides += s.patch < 0;
    result_.hierarchy = std::move(made.mesh);
    finest_.irregular = irregular_names(result_.hierarchy.level_mesh(finest_.level));
    name_roots(map, first, made.node_of);
    Plan plan;
    plan.base = outline_of(first);
    plan.origin = origin;
    plan.levels.assign(map.script.levels.begin() + 1, map.script.levels.end());
    if (plan_) plan.regions = plan_->regions;
    for_outlines(plan.levels, [&](const Vec3& p) { return placement_.from_unit(p); });
    result_.plan = to_json(plan);
    watch_.stop();
  }

  template <class Move>
  static void move_outline(LayoutOutline& outline, const Move& move) {
    for (Vec3& p : outline.nodes) p = move(p);
    for (auto& sides : outline.sides)
      for (auto& side : sides)
        for (Vec3& p : side) p = move(p);
  }
  template <class Move>
  static void for_outlines(std::vector<LayoutScript::Level>& levels, const Move& move) {
    for (LayoutScript::Level& level : levels)
      for (LayoutScript::EvenLayout& even : level.even) move_outline(even.outline, move);
  }

  // Where the base domain's nodes and sides lie, in the input's space.
  LayoutOutline outline_of(const PatchedSurface& base) const {
    constexpr int parts = 4;
    LayoutOutline outline;
    outline.quads = base.nodes;
    outline.neighbours = base.neighbours;
    outline.nodes.resize(base.node_count);
    outline.sides.resize(base.patch_count());
    constexpr std::array<std::array<double, 2>, 4> corner{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (int q = 0; q < base.patch_count(); ++q)
      for (int i = 0; i < 4; ++i) {
        const auto &from = corner[i], &to = corner[(i + 1) % 4];
        const auto at = [&](double t) {
          return placement_.from_unit(result_.hierarchy.sample({q, (1 - t) * from[0] + t * to[0], (1 - t) * from[1] + t * to[1]}).position);
        };
        outline.nodes[base.nodes[q][i]] = at(0);
        const PatchSide& other = base.neighbours[q][i];
        // Each line once.
        if (other.patch >= 0 && std::pair(other.patch, other.side) < std::pair(q, i)) continue;
        for (int k = 0; k <= parts; ++k) outline.sides[q][i].push_back(at(static_cast<double>(k) / parts));
      }
    return outline;
  }

  // The base and the operations of a plan: made again as they were on the surface that the plan was made on, or laid out on this one.
  void build_planned_base() {
    budget_ = plan_budget();
    if (!make_again()) plan_->tower ? grow() : lay_out();
    if (options_.refinement == Refinement::Uniform && options_.levels < 0) {
      budget_.levels = finest_.level;
      while (budget_.levels < 12 && vertices_at(budget_.levels + 1) <= budget_.vertices) ++budget_.levels;
    }
    const std::int64_t needed = vertices_at(std::max(finest_.level, budget_.levels));
    if (options_.vertices > 0 && options_.refinement == Refinement::Uniform && needed > options_.vertices)
      throw Error(ErrorCode::InvalidInput,
                  "the plan needs at least " + std::to_string(needed) + " vertices, more than the " + std::to_string(options_.vertices) + " allowed");
  }

  // The numbers of root quads in addresses.
  void name_roots(const BaseMap& map, const PatchedSurface& base, const std::vector<std::vector<int>>& node_of) {
    const HybridMesh& h = result_.hierarchy;
    result_.plan_root.assign(h.node_count(), -1);
    PlanLayout layout(base);
    for (std::size_t level = 0; level < node_of.size(); ++level) {
      if (level > 0) {
        layout.quadrisect();
        if (level < map.script.levels.size()) layout.apply(map.script.levels[level]);
        for (const RegionEdit& region : region_edits_)
          if (region.level == static_cast<int>(level)) layout.apply({region.edit});
      }
      for (std::size_t q = 0; q < node_of[level].size(); ++q)
        if (h.is_root(node_of[level][q])) result_.plan_root[node_of[level][q]] = std::stoi(layout.addresses()[q]);
    }
  }

  void repatch(BaseMap& map) { region_edits_ = repatch_regions(working_.mesh, map, plan_->regions, placement_, progress_.part(0.45, 0.5)); }

  // A base's level, and then those that the plan has above it.
  LayoutScript script_over(LayoutScript::Level base) const {
    LayoutScript script{{std::move(base)}};
    script.levels.insert(script.levels.end(), plan_->levels.begin(), plan_->levels.end());
    return script;
  }

  BaseMap map_to_searched_base(const Plan::Origin& origin) {
    const BaseDomain base = make_base(origin);
    return map_to_base(working_.mesh, base, script_over(origin.level), progress_.part(0.15, 0.45));
  }

  BaseMap map_to_tower(BoundaryTower tower) {
    progress_.stage("base domain");
    watch_.start("base");
    constexpr int likely = 8;
    working_ = make_working_surface(result_.repaired, placement_, 30 * (4 * std::max(likely, tower.cubes) + 1), progress_.part(0.05, 0.05));
    for (Vec3& p : tower.nodes) p = placement_.to_unit(p);
    PatchedSurface base = grow_boundary_tower(working_.mesh, tower, progress_.part(0.05, 0.2));
    progress_.stage("map");
    watch_.start("map");
    return map_to_base(working_.mesh, std::move(base), script_over({}), progress_.part(0.2, 0.45));
  }

  // A base on four points of the boundary. From then on the plan has its quads.
  void grow() {
    try {
      BaseMap map = map_to_tower(*plan_->tower);
      repatch(map);
      Plan::Origin origin;
      origin.surface = fingerprint(result_.repaired);
      origin.tower = plan_->tower;
      install(std::move(map), origin);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal) throw;
      throw Error(ErrorCode::Unsupported, std::string("no map to a chain of cubes on the boundary is found: ") + e.what());
    }
  }

  bool make_again() {
    if (!plan_->origin || plan_->origin->surface != fingerprint(result_.repaired)) return false;
    try {
      BaseMap map = plan_->origin->tower ? map_to_tower(*plan_->origin->tower) : map_to_searched_base(*plan_->origin);
      repatch(map);
      install(std::move(map), plan_->origin);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal) throw;
      return false;
    }
    // A base that was changed by hand is another one.
    const LayoutOutline made = plan_from_json(result_.plan).base;
    if (made.nodes != plan_->base.nodes || made.quads != plan_->base.quads) return false;
    result_.plan = options_.plan;
    return true;
  }

  void lay_out() {
    progress_.stage("base domain");
    watch_.start("base");
    working_ = make_working_surface(result_.repaired, placement_, 30 * static_cast<std::int64_t>(plan_->base.quads.size()), progress_.part(0.05, 0.05));
    LayoutOutline outline = plan_->base;
    const auto to_unit = [&](const Vec3& p) { return placement_.to_unit(p); };
    move_outline(outline, to_unit);
    const TransferredLayout laid = transfer_layout(working_.mesh, outline, progress_.part(0.05, 0.2));
    if (!laid.failure.empty()) throw Error(ErrorCode::InvalidInput, "the plan's base cannot be laid out on this surface: " + laid.failure);
    progress_.stage("map");
    watch_.start("map");
    LayoutScript script = script_over({});
    for_outlines(script.levels, to_unit);
    for (LayoutScript::Level& level : script.levels)
      for (LayoutScript::EvenLayout& even : level.even) even.quads = 0;
    try {
      BaseMap map = map_to_base(working_.mesh, to_patched_surface(laid.layout), script, progress_.part(0.2, 0.45));
      repatch(map);
      install(std::move(map), std::nullopt);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal) throw;
      throw Error(ErrorCode::Unsupported, std::string("no map to the plan's quads is found on this surface: ") + e.what());
    }
    result_.plan = options_.plan;
  }

  static std::vector<VertexId> irregular_names(const QuadMesh& mesh) {
    const std::vector<char> irregular = irregular_vertices(mesh);
    std::vector<VertexId> names;
    for (std::size_t v = 0; v < irregular.size(); ++v)
      if (irregular[v]) names.push_back(mesh.vertex[v]);
    std::sort(names.begin(), names.end());
    return names;
  }

  // --- levels ----------------------------------------------------------------------------------------------------------------------
  void build_levels() {
    HybridMesh& h = result_.hierarchy;
    if (!reference_) {
      PolygonSoup unit = input_;
      for (Vec3& p : unit.points) p = placement_.to_unit(p);
      reference_.emplace(unit);
    }
    if (options_.refinement == Refinement::Uniform)
      refine_uniformly();
    else
      refine_adaptively();
    progress_.stage("levels");
    watch_.start("levels");
    report_["levels"] = Json::array();
    const int depth = h.depth();
    final_vertices_.clear();
    for (std::size_t v = 0; v < result_.final_mesh.vertex.size(); ++v) final_vertices_.push_back({result_.final_mesh.vertex[v], v});
    std::sort(final_vertices_.begin(), final_vertices_.end());
    std::vector<QuadMesh> meshes(depth + 1);
    std::vector<Json> descriptions(depth + 1);
    // The finest, which take the longest, first.
    tbb::parallel_for(0, depth + 1, [&](int k) {
      const int j = depth - k;
      const bool last = j == depth;
      const Progress part = progress_.part(0.8, last ? 0.95 : 0.8);
      meshes[j] = last ? result_.final_mesh : h.level_mesh(j);
      if (!last) {
        // Quads much larger than the shape's features: held closer to where the map puts them, or corners overshoot tips.
        FitOptions coarse;
        coarse.rounds = 1;
        coarse.tangential = 0.1;
        // A level that is nearly the final mesh begins with that and has little left to do.
        fit(meshes[j], coarse, start_from_final(meshes[j]) ? 0 : 1, j, part);
      }
      descriptions[j] = describe_level(j, last, meshes[j], part);
    });
    for (int j = 0; j <= depth; ++j) {
      h.set_level_positions(j, meshes[j]);
      report_["levels"].push_back(std::move(descriptions[j]));
    }
    watch_.stop();
  }

  // Puts the vertices of a level where they are in the final mesh, if it has most of that mesh's.
  bool start_from_final(QuadMesh& mesh) const {
    std::vector<std::pair<std::size_t, std::size_t>> shared;
    for (std::size_t v = 0; v < mesh.vertex.size(); ++v) {
      const auto at = std::lower_bound(final_vertices_.begin(), final_vertices_.end(), std::pair(mesh.vertex[v], std::size_t{0}));
      if (at != final_vertices_.end() && at->first == mesh.vertex[v]) shared.push_back({v, at->second});
    }
    if (2 * shared.size() < final_vertices_.size()) return false;
    for (const auto& [v, w] : shared) mesh.points[v] = result_.final_mesh.points[w];
    return true;
  }

  static FitOptions final_fit() {
    FitOptions options;
    options.rounds = 2;
    // Only where quads are as good as square: elsewhere the shape would suffer more than the distance gains.
    options.square_smoothness = 0.012;
    options.poor = 0.96;
    options.square = 0.985;
    return options;
  }

  void fit(QuadMesh& mesh, const FitOptions& fit_options, int turns, int level, const Progress& progress) {
    SurfaceFitOptions options;
    options.first = fit_options;
    options.turns = turns;
    options.finest = level;
    fit_to_surface(mesh, result_.hierarchy, options, progress);
  }

  double measured_l2(const QuadMesh& mesh, std::int64_t samples) {
    DistanceOptions distance;
    distance.samples = samples;
    return reference_->distance(to_soup(mesh), distance, progress_.part(0.6, 0.6)).l2;
  }

  // Measured as the report does, so that it says the same; fewer samples are enough to see that a mesh is far off.
  double l2_against_bound(const QuadMesh& mesh) {
    const double l2 = measured_l2(mesh, 20000);
    return l2 > 1.1 * options_.error ? l2 : measured_l2(mesh, DistanceOptions().samples);
  }

  void fit_level(int level) {
    watch_.start("fit");
    result_.hierarchy.refine_uniform(std::max(level, finest_.level));
    result_.final_mesh = result_.hierarchy.level_mesh(level);
    fit(result_.final_mesh, final_fit(), 2, level, progress_.part(0.6, 0.8));
  }

  void refine_uniformly() {
    progress_.stage("fit");
    if (options_.error > 0)
      meet_error();
    else
      fit_level(budget_.levels);
    watch_.stop();
  }

  struct Attempt {
    std::int64_t vertices = 0;
    double l2 = 0;
  };

  Attempt measured_attempt() { return {static_cast<std::int64_t>(result_.final_mesh.points.size()), l2_against_bound(result_.final_mesh)}; }

  std::int64_t most_vertices() const {
    return options_.vertices > 0 ? options_.vertices : std::max<std::int64_t>(1000000, static_cast<std::int64_t>(result_.repaired.points.size()));
  }

  // A remesh that is set aside while another is tried.
  struct Made {
    HybridMesh hierarchy;
    QuadMesh mesh;
    Json base, levels;
    SurfaceDistance distance;
    Finest finest;
    std::string plan;
  };
  Made set_aside() {
    return {std::move(result_.hierarchy), std::move(result_.final_mesh), report_["base"], report_["levels"], final_distance_, finest_, result_.plan};
  }
  void put_back(Made made) {
    result_.hierarchy = std::move(made.hierarchy);
    result_.final_mesh = std::move(made.mesh);
    report_["base"] = std::move(made.base);
    report_["levels"] = std::move(made.levels);
    final_distance_ = made.distance;
    finest_ = std::move(made.finest);
    result_.plan = std::move(made.plan);
  }

  // The first of the base's levels that meets the error bound, else the last one that the other bounds allow.
  Attempt climb() {
    const bool one_level = options_.levels >= 0;
    const int last = options_.vertices > 0 || one_level ? budget_.levels : 12;
    for (int level = one_level ? last : 0;; ++level) {
      fit_level(level);
      const Attempt made = measured_attempt();
      if (made.l2 <= options_.error || level == last || 4 * made.vertices > most_vertices()) return made;
      // Not worth the wait if even errors that fall faster than they do would not fall enough.
      if (options_.vertices == 0 &&
          made.l2 * std::pow(static_cast<double>(made.vertices) / static_cast<double>(most_vertices()), 1.2) > options_.error)
        return made;
    }
  }

  // About the fewest vertices that meet the error bound. The levels of a base differ fourfold in vertices, so that the first one that meets
  // the bound may have four times too many; the size of the base, though, can be chosen almost freely. The error falls about as 1 / vertices
  // (fitted quads follow a smooth surface to second order in their size), by which the meshes made so far tell the size of the next. A base
  // costs as much as all its levels, and bases of about one size differ by some per cent in their errors: hence a few steps, each of which
  // promises to save some vertices, and not a search to the end.
  void meet_error() {
    Attempt enough, too_few;  // the fewest vertices that met the bound and the most that did not; 0 vertices: none yet
    const Attempt first = climb();
    (first.l2 <= options_.error ? enough : too_few) = first;
    const bool any_base = options_.base == BaseSize::Auto && !plan_, one_level = options_.levels >= 0;
    const bool may_grow = options_.vertices == 0 && one_level;
    for (int step = 0; step < 4 && any_base && (enough.vertices > 0 || may_grow); ++step) {
      aim_ = next_aim(enough, too_few);
      if (aim_ > most_vertices() || (enough.vertices > 0 && (aim_ > 0.93 * enough.vertices || aim_ < 1.03 * too_few.vertices))) break;
      Made before = set_aside();
      const Attempt made = attempt_aim();
      const bool met = made.vertices > 0 && made.l2 <= options_.error;
      const bool better = enough.vertices == 0 ? made.vertices > 0 : met && made.vertices < enough.vertices;
      if (!better) put_back(std::move(before));
      if (made.vertices == 0 || (met && !better)) break;
      (met ? enough : too_few) = made;
    }
    if (enough.vertices == 0 && options_.vertices == 0 && (any_base || !one_level))
      throw Error(ErrorCode::InvalidInput, "the error bound " + scientific(options_.error) + " is out of reach: " + std::to_string(too_few.vertices) +
                                               " vertices have an L2 distance of " + scientific(too_few.l2) + ", and " +
                                               std::to_string(most_vertices()) + ", the most that are tried unless a number is given, would not do");
  }

  std::int64_t next_aim(const Attempt& enough, const Attempt& too_few) const {
    double vertices = 0;
    if (enough.vertices == 0 || too_few.vertices == 0) {
      const Attempt& known = enough.vertices > 0 ? enough : too_few;
      // Too far rather than not far enough when it is to grow: from above it comes closer, from below it is in danger of never arriving.
      vertices = static_cast<double>(known.vertices) * std::pow(known.l2 / options_.error, enough.vertices > 0 ? 1.0 : 1.3);
    } else {
      const double part = std::log(too_few.l2 / options_.error) / std::log(too_few.l2 / enough.l2);
      vertices = static_cast<double>(too_few.vertices) * std::pow(static_cast<double>(enough.vertices) / static_cast<double>(too_few.vertices), part);
    }
    return static_cast<std::int64_t>(1.03 * vertices);  // rather met than just missed
  }

  // A mesh on a base that is planned for `aim_` vertices; no vertices if no base of that size can be made. Where the error is far above what
  // the size promises, the base is too coarse for the shape and has lost a tip: then the same on a base of four times as many quads, from now on.
  Attempt attempt_aim() {
    for (;;) {
      try {
        build_base();
      } catch (const Error& e) {
        if (e.code() == ErrorCode::Cancelled) throw;
        return {};
      }
      fit_level(budget_.levels);
      const Attempt made = measured_attempt();
      if (made.l2 < 1.3 * options_.error || options_.levels >= 0 || budget_.levels == 0 || levels_less_ == 1) return made;
      levels_less_ = 1;
    }
  }

  static std::string scientific(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2e", value);
    return text;
  }

  void refine_adaptively() {
    progress_.stage("adaptive refinement");
    watch_.start("adaptive");
    AdaptiveOptions adaptive;
    // An error bound alone asks for as few vertices as meet it, however many that are.
    adaptive.vertices = options_.error > 0 && options_.vertices == 0 ? 0 : budget_.vertices;
    adaptive.error = options_.error;
    if (options_.levels >= 0) adaptive.deepest = options_.levels;
    result_.final_mesh = hybrid_mesh::refine_adaptively(result_.hierarchy, *reference_, adaptive, progress_.part(0.55, 0.8));
    watch_.stop();
  }

  // A base may have missed a tip by bad luck, which shows in the fit: a point of the surface is farther off than a quad is wide. Then another base is
  // tried, and the better one kept.
  void try_another_base() {
    if (options_.error > 0) return;
    const QuadMesh& mesh = result_.final_mesh;
    double area = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      for (std::int64_t i = mesh.offsets[f] + 1; i + 1 < mesh.offsets[f + 1]; ++i) {
        const Vec3& origin = mesh.points[mesh.indices[mesh.offsets[f]]];
        area += 0.5 * (mesh.points[mesh.indices[i]] - origin).cross(mesh.points[mesh.indices[i + 1]] - origin).norm();
      }
    if (final_distance_.hausdorff < 1.25 * std::sqrt(area / static_cast<double>(mesh.face_count()))) return;
    Made before = set_aside();
    bool better = false;
    first_attempt_ = 8;
    try {
      build_base();
      build_levels();
      better = final_distance_.hausdorff < before.distance.hausdorff;
    } catch (const Error& e) {
      if (e.code() == ErrorCode::Cancelled) throw;
    }
    if (!better) put_back(std::move(before));
  }

  // --- report ------------------------------------------------------------------------------------------------------------------------
  // The last level is the final mesh, which is measured this once.
  Json describe_level(int j, bool last, const QuadMesh& mesh, const Progress& progress) {
    const TopologySummary t = summarize_topology(to_soup(mesh));
    DistanceOptions distance;
    if (!last) distance.samples = 30000;
    const SurfaceDistance d = reference_->distance(to_soup(mesh), distance, progress);
    if (last) final_distance_ = d;
    const LevelStretch s = level_stretch(result_.hierarchy, mesh);
    std::vector<double> sorted = s.stretch;
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double p) { return sorted.empty() ? 0.0 : sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(p * sorted.size()))]; };
    const std::vector<char> irregular = irregular_vertices(mesh);
    return {{"level", j},
            {"vertices", mesh.points.size()},
            {"quads", quad_quality(mesh).quads},
            {"genus", t.genus},
            {"components", t.components},
            {"boundary_loops", t.boundary_loops},
            {"l2", d.l2},
            {"hausdorff", d.hausdorff},
            {"stretch", {{"p05", at(0.05)}, {"p50", at(0.5)}, {"p95", at(0.95)}, {"max", sorted.empty() ? 0.0 : sorted.back()}}},
            {"irregular_vertices", std::count(irregular.begin(), irregular.end(), 1)},
            {"irregular_ops", operations_of(j)}};
  }

  Json operations_of(int level) const {
    Json list = Json::array();
    for (int i = 0; i < result_.hierarchy.operation_count(); ++i) {
      const HybridMesh::Operation& op = result_.hierarchy.operation(i);
      if (op.repatch.level == level)
        list.push_back({{"kind", op.repatch.kind}, {"removed_quads", op.repatch.removed.size()}, {"new_quads", op.roots.size()}});
    }
    return list;
  }

  void finish() {
    HybridMesh& h = result_.hierarchy;
    QuadMesh& mesh = result_.final_mesh;
    progress_.stage("measure");
    watch_.start("measure");
    const SurfaceDistance& d = final_distance_;
    const TopologySummary t = summarize_topology(to_soup(mesh));
    if (t.nonmanifold_edges || t.nonmanifold_vertices || t.misoriented_edges || t.components != topology_.components ||
        t.boundary_loops != topology_.boundary_loops || t.euler != topology_.euler)
      throw Error(ErrorCode::Internal, "the final mesh does not have the surface's topology");
    const QuadQuality q = quad_quality(mesh);
    const std::vector<char> irregular = irregular_vertices(mesh);
    std::int64_t of_base = 0, of_operations = 0, of_transitions = 0;
    for (const VertexId id : irregular_names(mesh)) {
      if (id.kind() == VertexId::Kind::Free && id.index() < h.base_vertex_count())
        ++of_base;
      else
        ++(std::binary_search(finest_.irregular.begin(), finest_.irregular.end(), id) ? of_operations : of_transitions);
    }
    std::int64_t inserted = h.base_count();
    for (int i = 0; i < h.operation_count(); ++i) inserted += static_cast<std::int64_t>(h.operation(i).roots.size());
    // Quads where sizes meet are neither regular nor inserted.
    std::int64_t regular = 0;
    for (const std::int32_t node : mesh.node) {
      bool transition = false;
      for (int side = 0; side < 4; ++side) transition |= h.has_finer_neighbour(node, side);
      regular += !transition;
    }
    report_["final"] = {
        {"vertices", mesh.points.size()},
        {"quads", q.quads},
        {"triangles", q.triangles},
        {"l2", d.l2},
        {"hausdorff", d.hausdorff},
        {"boundary_hausdorff", d.boundary_hausdorff < 0 ? Json(nullptr) : Json(d.boundary_hausdorff)},
        {"genus", t.genus},
        {"components", t.components},
        {"boundary_loops", t.boundary_loops},
        {"regular_fraction", 1.0 - static_cast<double>(inserted) / static_cast<double>(std::max<std::int64_t>(1, regular))},
        {"irregular_vertices", {{"base", of_base}, {"operations", of_operations}, {"transitions", of_transitions}}},
        {"scaled_jacobian", {{"min", q.jacobian_min}, {"p05", q.jacobian_p05}, {"p50", q.jacobian_median}, {"inverted", q.inverted}}}};
    if (options_.error > 0) report_["final"]["error_bound_met"] = d.l2 <= options_.error;
    report_["warnings"] = warnings(d.l2);
    h.set_final_positions(mesh);
    watch_.stop();
    place_result();
    report_["seconds"] = watch_.json();
    result_.report = std::move(report_);
    progress_(1);
  }

  // What was asked for and could not be had.
  Json warnings(double l2) const {
    Json list = Json::array();
    if (options_.error > 0 && l2 > options_.error)
      list.push_back("the error bound of " + scientific(options_.error) + " is not met: the L2 distance is " + scientific(l2));
    return list;
  }

  // Everything was computed around the origin: bring maps and meshes to where the input stands.
  void place_result() {
    HybridMesh& h = result_.hierarchy;
    std::vector<QuadMesh> levels;
    for (int j = 0; j <= h.depth(); ++j) levels.push_back(h.level_mesh(j));
    for (int n = 0; n < h.node_count(); ++n)
      if (const PatchMap* map = h.map(n)) {
        PatchMap placed = *map;
        for (Vec3& p : placed.positions) p = placement_.from_unit(p);
        h.set_map(n, std::move(placed));
      }
    h.clear_positions();
    for (int j = 0; j < static_cast<int>(levels.size()); ++j) {
      for (Vec3& p : levels[j].points) p = placement_.from_unit(p);
      h.set_level_positions(j, levels[j]);
    }
    for (Vec3& p : result_.final_mesh.points) p = placement_.from_unit(p);
    h.set_final_positions(result_.final_mesh);
  }

  const PolygonSoup& input_;
  const RemeshOptions& options_;
  Progress progress_;
  Stopwatch watch_;
  RemeshResult result_;
  Json report_;
  TopologySummary topology_;
  Placement placement_;
  WorkingSurface working_;
  std::optional<DistanceReference> reference_;  // the input, of unit size
  SurfaceDistance final_distance_;
  std::vector<std::pair<VertexId, std::size_t>> final_vertices_;  // of the final mesh, sorted
  Budget budget_;
  Finest finest_;
  std::optional<Plan> plan_;              // that was given
  std::vector<RegionEdit> region_edits_;  // of its regions
  // While a bound on the error is being met: the vertices that a base is planned for, and how many levels less than usual it has above it.
  std::int64_t aim_ = 0;
  int levels_less_ = 0;
  int first_attempt_ = 0;  // of try_base(): decides near-ties
};

}  // namespace

RemeshResult remesh(const PolygonSoup& input, const RemeshOptions& options, Context& context) {
  const tbb::global_control threads(
      tbb::global_control::max_allowed_parallelism,
      options.threads > 0 ? static_cast<std::size_t>(options.threads) : static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
  return Remesher(input, options, context).run();
}

}  // namespace hybrid_mesh
