// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/symmetry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/parallel.h"
#include "hierarchy/mirrored.h"
#include "layout/base/base_domain.h"
#include "remesh/figures.h"
#include "remesh/level_fits.h"
#include "remesh/outlines.h"
#include "remesh/symmetric_maps.h"

namespace hybrid_mesh {
namespace {

using Json = nlohmann::ordered_json;

// Beyond these, as fractions of the diagonal, the mean of both sides would be neither of them.
constexpr double kMostForAverage = 0.03, kFarthestForAverage = 0.12;

const char* side_name(SymmetrySide side) {
  return side == SymmetrySide::Positive ? "positive" : side == SymmetrySide::Negative ? "negative" : "average";
}

std::string plane_name(const MirrorPlane& plane) {
  if (const int axis = plane.axis(); axis >= 0) return std::string(1, "xyz"[axis]) + " = " + formatted("%g", plane.offset * plane.normal[axis]);
  return "of symmetry";
}

Json report_of(const RemeshOptions& options, const std::optional<MirrorPlane>& plane, const Asymmetry& asymmetry) {
  Json report;
  report["plane"] = nullptr;
  if (plane) report["plane"] = {plane->normal.x(), plane->normal.y(), plane->normal.z(), plane->offset};
  report["asymmetry"] = asymmetry.rms;
  report["largest_asymmetry"] = asymmetry.largest;
  const bool is_axis = options.symmetry == Symmetry::Given && plane && plane->axis() >= 0 && plane->offset == 0;
  report["from"] = options.symmetry == Symmetry::Auto ? "auto" : is_axis ? std::string(1, "xyz"[plane->axis()]) : "plane";
  if (plane) report["side"] = side_name(options.symmetry_side);
  return report;
}

HalfSurface half_of(const TriangleSurface& whole, const MirrorPlane& plane, SymmetrySide side, const Asymmetry& asymmetry, const Progress& progress) {
  if (side != SymmetrySide::Average) return cut_in_half(whole, plane);
  if (asymmetry.rms > kMostForAverage || asymmetry.largest > kFarthestForAverage)
    throw Error(ErrorCode::InvalidInput, "the surface is too asymmetric for an average of its sides: they differ by " + scientific(asymmetry.rms) +
                                             " of the diagonal in the mean and by " + scientific(asymmetry.largest) + " at most, more than " +
                                             scientific(kMostForAverage) + " and " + scientific(kFarthestForAverage) +
                                             "; take one side, positive or negative");
  return cut_in_half(averaged_with_image(whole, plane, progress), plane);
}

// An edge in the plane is sharp if the surface turns at it.
class SharpCut {
 public:
  SharpCut(const RemeshTask& task, const Candidate& made) {
    const RemeshOptions& options = task.options;
    if (options.features == Features::None || (options.features == Features::Auto && !made.keeps_features)) return;
    const double angle = options.features == Features::Given ? options.feature_angle : FeatureOptions().angle;
    least_ = std::sin(0.5 * angle * std::numbers::pi / 180);
  }
  // The side of a map that is in the plane across a normal.
  bool operator()(const PatchMap& map, int side, const Vec3& normal) const {
    if (least_ > 1) return false;
    double sharp = 0, all = 0;
    for (const auto& t : map.triangles)
      for (int i = 0; i < 3; ++i) {
        const int a = t[i], b = t[(i + 1) % 3], c = t[(i + 2) % 3];
        if (!map.is_on_side(a, side) || !map.is_on_side(b, side)) continue;
        const Vec3 edge = map.positions[b] - map.positions[a], up = edge.cross(map.positions[c] - map.positions[a]);
        const double length = edge.norm();
        all += length;
        if (std::abs(up.dot(normal)) >= least_ * up.norm()) sharp += length;
      }
    constexpr double nearly_all = 0.9;
    return all > 0 && sharp >= nearly_all * all;
  }

 private:
  double least_ = 2;  // sine of half the angle; above 1: nothing is sharp
};

// A mesh of the half's, joined with its image.
void place_points(QuadMesh& mesh, const QuadMesh& half, const Mirrored& m, const MirrorPlane& plane) {
  std::vector<std::pair<VertexId, int>> at;
  for (std::size_t v = 0; v < half.vertex.size(); ++v) at.push_back({half.vertex[v], static_cast<int>(v)});
  std::sort(at.begin(), at.end());
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v) {
    const Mirrored::Origin& origin = m.origin(mesh.vertex[v]);
    const auto found = std::lower_bound(at.begin(), at.end(), std::pair(origin.of, 0));
    if (found == at.end() || found->first != origin.of) throw Error(ErrorCode::Internal, "a mirrored level has a vertex that its half does not have");
    Vec3 p = half.points[found->second];
    if (is_in_mirror(p, plane.normal)) p = plane.onto(p);
    mesh.points[v] = origin.is_image ? plane.reflected(p) : p;
  }
}

}  // namespace

void check_symmetry(const RemeshOptions& options) {
  if (options.symmetry == Symmetry::None) return;
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::InvalidInput, what); };
  if (!options.plan.empty()) refuse("a plan and symmetry do not go together: the plan decides both sides");
  if (options.topology == TopologyMode::Late) refuse("late topology and symmetry do not go together; with topology in the base they do");
  if (!options.density.empty()) refuse("density and symmetry do not go together");
  if (options.components == Components::Joined) refuse("joined components and symmetry do not go together");
  if (options.symmetry == Symmetry::Given &&
      !(options.mirror.normal.allFinite() && std::isfinite(options.mirror.offset) && std::abs(options.mirror.normal.norm() - 1) < 1e-9))
    refuse("the plane of symmetry must have a normal of unit length and a finite offset");
}

RemeshOptions options_of_half(const RemeshOptions& options) {
  RemeshOptions half = options;
  half.topology = TopologyMode::Base;
  return half;
}

std::optional<Source> half_source(Source& whole, const RemeshOptions& options, const Progress& progress) {
  std::optional<MirrorPlane> plane;
  Asymmetry asymmetric;
  if (options.symmetry == Symmetry::Auto) {
    const ReflectionSearch found = find_reflection(whole.repaired, progress);
    plane = found.plane;
    asymmetric = found.asymmetry;
  } else {
    plane = options.mirror;
    asymmetric = asymmetry(whole.repaired, *plane, progress);
  }
  whole.symmetry = report_of(options, plane, asymmetric);
  if (!plane) {
    whole.symmetry["reason"] = "the surface is not symmetric in any plane through its centroid: it is remeshed without symmetry";
    return {};
  }
  // The half is always on the side of the normal.
  if (options.symmetry_side == SymmetrySide::Negative) plane = MirrorPlane{-plane->normal, -plane->offset};
  Source half;
  try {
    half.half = std::make_shared<const HalfSurface>(half_of(whole.repaired, *plane, options.symmetry_side, asymmetric, progress));
  } catch (const Error& e) {
    if (e.code() != ErrorCode::InvalidInput || options.symmetry != Symmetry::Given) throw;
    throw Error(ErrorCode::InvalidInput, std::string(e.what()) + " (" + plane_name(*plane) + ")");
  }
  whole.placement.center = plane->onto(whole.placement.center);
  half.repaired = half.half->mesh;
  half.placement = whole.placement;
  half.mirror = plane->normal;
  half.repairs = whole.repairs;
  half.fingerprint = whole.fingerprint;
  half.topology = summarize_topology(to_soup(half.repaired));
  half.area = surface_area(half.repaired) / (half.placement.diagonal * half.placement.diagonal);
  const TriangleSurface joined = joined_with_image(*half.half, *plane);
  half.made = whole.made = summarize_topology(to_soup(joined));
  half.points = whole.points = static_cast<std::int64_t>(joined.points.size());
  whole.symmetric = std::make_shared<const DistanceReference>(to_soup(whole.placement.to_unit(joined)), 1.0);
  look_for_features(half, options);
  whole.has_features = half.has_features;
  whole.keeps_features = half.keeps_features;
  half.reference = std::make_unique<const DistanceReference>(to_soup(half.placement.to_unit(half.repaired)), 1.0);
  const TopologySummary &made = whole.made, &given = whole.topology;
  if (made.components != given.components || made.boundary_loops != given.boundary_loops || made.genus != given.genus)
    whole.symmetry["topology"] = {{"components", made.components}, {"boundary_loops", made.boundary_loops}, {"genus", made.genus}};
  whole.symmetry["switched_off"] = Json::array();
  if (options.base == BaseSize::Minimal && !options.semi_regular && (given.genus > 0 || given.boundary_loops > 0))
    whole.symmetry["switched_off"].push_back("late topology: handles and boundaries are in the base");
  return half;
}

Candidate mirrored_candidate(const RemeshTask& task, const Source& half, const Candidate& made, nlohmann::ordered_json& report) {
  const MirrorPlane plane{*half.mirror, 0};
  task.watch.start("mirror");
  Json& switched_off = report["switched_off"];
  if (!made.lost_operations.empty()) switched_off.push_back("irregular operations: " + made.lost_operations);
  Mirrored m = mirrored(made.hierarchy);
  HybridMesh& mesh = m.mesh;
  const SymmetricMaps maps(task.source, half);
  std::vector<int> owners;
  for (int n = 0; n < made.hierarchy.node_count(); ++n)
    if (made.hierarchy.map(n)) owners.push_back(n);
  std::vector<std::array<PatchMap, 2>> both(owners.size());
  parallel_for_each_index(static_cast<std::int64_t>(owners.size()), [&](std::int64_t k) {
    task.progress.check();
    both[k] = maps(*made.hierarchy.map(owners[k]));
  });
  for (std::size_t k = 0; k < owners.size(); ++k) {
    mesh.set_map(m.node[owners[k]], std::move(both[k][0]));
    mesh.set_map(m.image[owners[k]], std::move(both[k][1]));
  }
  const SharpCut is_sharp(task, made);
  for (int q = 0; q < made.hierarchy.base_count(); ++q)
    for (int s = 0; s < 4; ++s)
      if (made.hierarchy.is_on_mirror(q, s) && is_sharp(*mesh.map(q), s, plane.normal)) mesh.set_sharp(q, s);

  Candidate c;
  const auto doubled = [&](const std::vector<int>& of_node) {
    int count = 0;
    for (const int number : of_node) count = std::max(count, number + 1);
    std::vector<int> out(mesh.node_count(), -1);
    for (std::size_t n = 0; n < of_node.size(); ++n)
      if (of_node[n] >= 0) {
        out[m.node[n]] = of_node[n];
        out[m.image[n]] = of_node[n] + count;
      }
    return out;
  };
  c.plan_root = doubled(made.plan_root);
  c.opened.assign(mesh.node_count(), -1);
  c.base_quads = mesh.base_count();
  c.base_vertices = mesh.base_vertex_count();
  c.levels = made.levels;
  c.finest = made.finest;
  c.finest_quads = made.finest_quads;
  c.finest_boundary_sides = made.finest_boundary_sides;
  for (const Mirrored::Origin& o : m.origins)
    if (std::binary_search(made.finest_irregular.begin(), made.finest_irregular.end(), o.of)) c.finest_irregular.push_back(o.vertex);
  c.keeps_features = made.keeps_features;
  c.lost_features = made.lost_features;
  c.final_mesh = mesh.final_mesh();
  place_points(c.final_mesh, made.final_mesh, m, plane);
  const TopologySummary t = summarize_topology(to_soup(c.final_mesh)), &wanted = task.source.made;
  if (t.nonmanifold_edges || t.nonmanifold_vertices || t.components != wanted.components || t.boundary_loops != wanted.boundary_loops ||
      t.euler != wanted.euler)
    throw NoMap("with its mirror image it does not have the surface's topology");
  const int levels = static_cast<int>(made.level_meshes.size());
  for (int j = 0; j < levels; ++j) {
    c.level_meshes.push_back(j + 1 == levels ? c.final_mesh : mesh.level_mesh(j));
    place_points(c.level_meshes[j], made.level_meshes[j], m, plane);
  }
  Plan plan;
  QuadGraph base;
  base.node_count = mesh.base_vertex_count();
  for (int q = 0; q < mesh.base_count(); ++q) {
    base.nodes.emplace_back();
    base.neighbours.emplace_back();
    for (int s = 0; s < 4; ++s) {
      base.nodes[q][s] = mesh.corner(q, s).index();
      const SideLink link = mesh.root_neighbour(q, s);
      base.neighbours[q][s] = {link.node, link.side};
    }
  }
  plan.base = outline_of_base(mesh, base);
  move_outline(plan.base, [&](const Vec3& p) { return task.source.placement.from_unit(p); });
  c.plan = to_json(plan);
  c.hierarchy = std::move(mesh);
  task.watch.start("levels");
  c.level_reports.assign(levels, {});
  parallel_for_each_index(levels, [&](std::int64_t k) { measure_level(task, c, levels - 1 - static_cast<int>(k), nullptr, task.progress); });
  task.watch.stop();
  return c;
}

}  // namespace hybrid_mesh
