// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/base_surface.h"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/found.h"
#include "surface/polygon_soup.h"
#include "topology/component_tubes.h"
#include "topology/loop_kind.h"
#include "topology/surface_loops.h"
#include "topology/topological_noise.h"

namespace hybrid_mesh {

namespace {

constexpr int kMostBoundaries = 200;  // that open late: each takes a third of a second, and a surface with more of them is in shreds
constexpr double kDetour = 1.5;       // times as long a loop may be whose caps do not meet the surface

}  // namespace

SurfaceVersion BaseSurface::version() const { return {series, std::vector<bool>(series ? series->events.size() : 0, false)}; }

std::vector<char> BaseSurface::held() const {
  if (!series) return {};
  const TriangleSurface& mesh = *closed;
  std::vector<char> on_rim(mesh.points.size(), 0), held(mesh.faces.size(), 0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (series->face_event[f] >= 0)
      for (const int v : mesh.faces[f]) on_rim[v] = 1;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    held[f] = std::any_of(mesh.faces[f].begin(), mesh.faces[f].end(), [&](int v) { return on_rim[v] != 0; });
  return held;
}

BaseSurface base_surface(const TriangleSurface& repaired, const Placement& placement, const std::vector<LateEvent>& late) {
  BaseSurface out;
  if (!late.empty()) {
    std::vector<TopologyEvent> events;
    for (const LateEvent& e : late) {
      events.push_back(e.event);
      out.levels.push_back(e.level);
    }
    SurfaceSeries series = close_topology(repaired, std::move(events));
    out.closed = series.closed;
    for (TriangleSurface* s : {&series.input, &series.closed}) *s = placement.to_unit(std::move(*s));
    for (auto& of_event : series.patches)
      for (RimPatch& patch : of_event)
        for (Vec3& p : patch.points) p = placement.to_unit(p);
    out.series = std::make_shared<const SurfaceSeries>(std::move(series));
  }
  out.topology = summarize_topology(to_soup(out.closed ? *out.closed : repaired));
  return out;
}

std::vector<LateEvent> find_late_events(const TriangleSurface& repaired, const TopologySummary& topology, const RemeshOptions& options,
                                        const Progress& progress) {
  const bool late = options.topology == TopologyMode::Late || (options.topology == TopologyMode::Auto && options.base == BaseSize::Minimal);
  std::vector<LateEvent> events;
  if (!late || options.semi_regular) return events;
  if (topology.genus > 0) {
    LoopOptions search;
    search.detour = kDetour;
    const Found<std::vector<SurfaceLoop>> loops = found([&] { return find_loops(repaired, {}, search, progress); });
    // Where the triangles leave no room for disjoint loops, handles are the base's.
    if (loops)
      for (const SurfaceLoop& loop : *loops) events.push_back({{EventKind::Cut, {loop.points, {}}, loop.length, loop.kind}, -1});
  }
  if (options.components == Components::Joined && topology.components > 1) {
    std::vector<TopologyEvent> others;
    for (const LateEvent& e : events) others.push_back(e.event);
    for (TopologyEvent& tube : find_tubes(repaired, others, progress)) events.push_back({std::move(tube), -1});
  }
  if (topology.boundary_loops <= kMostBoundaries)
    for (TopologyEvent& boundary : find_boundary_events(repaired)) events.push_back({std::move(boundary), -1});
  return events;
}

namespace {

using Cycle = std::vector<int>;

// Points of a surface by their places.
class PointIndex {
 public:
  explicit PointIndex(const TriangleSurface& surface) : surface_(surface) {
    for (std::size_t v = 0; v < surface.points.size(); ++v) index_.push_back(static_cast<int>(v));
    std::sort(index_.begin(), index_.end(), [&](int a, int b) { return before(surface_.points[a], surface_.points[b]); });
  }
  // The cycle exactly there; empty if the surface has none.
  Cycle cycle_at(const std::vector<Vec3>& loop) const {
    Cycle cycle;
    for (const Vec3& p : loop) {
      const auto at = std::lower_bound(index_.begin(), index_.end(), p, [&](int v, const Vec3& q) { return before(surface_.points[v], q); });
      if (at == index_.end() || surface_.points[*at] != p) return {};
      cycle.push_back(*at);
    }
    return cycle;
  }

 private:
  static bool before(const Vec3& a, const Vec3& b) { return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z()); }
  const TriangleSurface& surface_;
  std::vector<int> index_;
};

// Are all sides of the cycle edges?
bool is_cycle(const TriangleSurface& surface, const Cycle& cycle) {
  std::set<std::pair<int, int>> edges;
  const std::set<int> points(cycle.begin(), cycle.end());
  for (const auto& f : surface.faces)
    for (int i = 0; i < 3; ++i)
      if (points.count(f[i]) && points.count(f[(i + 1) % 3])) edges.insert(std::minmax(f[i], f[(i + 1) % 3]));
  for (std::size_t k = 0; k < cycle.size(); ++k)
    if (!edges.count(std::minmax(cycle[k], cycle[(k + 1) % cycle.size()]))) return false;
  return cycle.size() >= 3 && points.size() == cycle.size();
}

// The boundary loop that is nearest to a line, on average over its points.
Cycle nearest_boundary(const TriangleSurface& surface, const std::vector<Vec3>& line) {
  Cycle best;
  double least = std::numeric_limits<double>::infinity();
  for (Cycle& cycle : boundary_cycles(surface)) {
    double sum = 0;
    for (const Vec3& p : line) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const int v : cycle) nearest = std::min(nearest, (surface.points[v] - p).norm());
      sum += nearest;
    }
    if (sum < least) least = sum, best = std::move(cycle);
  }
  return best;
}

}  // namespace

std::vector<LateEvent> late_events_of(const Plan& plan, const TriangleSurface& repaired, const Progress& progress) {
  std::vector<LateEvent> events;
  if (plan.topology.empty()) return events;
  const PointIndex index(repaired);
  for (std::size_t e = 0; e < plan.topology.size(); ++e) {
    const Plan::Event& planned = plan.topology[e];
    const auto refuse = [&](const std::string& why) {
      throw Error(ErrorCode::InvalidInput, "the plan's topology[" + std::to_string(e) + "] is not on this surface: " + why);
    };
    LateEvent& late = events.emplace_back();
    late.level = planned.level;
    late.event.kind = planned.kind;
    for (std::size_t i = 0; i < planned.loops.size(); ++i) {
      Cycle cycle = index.cycle_at(planned.loops[i]);
      if (planned.kind == EventKind::Boundary) {
        cycle = nearest_boundary(repaired, planned.loops[i]);
        if (cycle.empty()) refuse("it has no boundary");
      } else if (!is_cycle(repaired, cycle)) {
        Found<Cycle> snapped = snap_loop(repaired, planned.loops[i], SnapTightening::None, progress);
        if (!snapped) refuse(snapped.reason);
        cycle = std::move(*snapped);
      }
      late.event.loops[i] = std::move(cycle);
    }
  }
  std::vector<SurfaceLoop> cuts;
  for (const LateEvent& late : events)
    if (late.event.kind == EventKind::Cut) cuts.push_back({late.event.loops[0], cycle_length(repaired, late.event.loops[0]), LoopKind::Handle});
  tell_kinds(repaired, cuts, progress);
  auto cut = cuts.begin();
  for (LateEvent& late : events)
    if (late.event.kind == EventKind::Cut) late.event.loop_kind = (cut++)->kind;
  return events;
}

std::vector<Plan::Event> planned_events(const BaseSurface& base, const TriangleSurface& repaired) {
  std::vector<Plan::Event> events;
  if (!base.series) return events;
  for (std::size_t e = 0; e < base.levels.size(); ++e) {
    const TopologyEvent& event = base.series->events[e];
    Plan::Event& planned = events.emplace_back();
    planned.kind = event.kind;
    planned.level = base.levels[e];
    for (int i = 0; i < (event.kind == EventKind::Tube ? 2 : 1); ++i) {
      std::vector<Vec3>& loop = planned.loops.emplace_back();
      for (const int v : event.loops[i]) loop.push_back(repaired.points[v]);
    }
  }
  return events;
}

void name_input(PatchMap& map, const SurfaceSeries& series) {
  const int closed = static_cast<int>(series.closed.faces.size());
  std::vector<int> hidden;
  for (const auto& ends : series.hidden)
    for (const auto& end : ends) hidden.insert(hidden.end(), end.begin(), end.end());
  std::vector<int> face_of_point;
  for (std::size_t t = 0; t < map.triangles.size(); ++t) {
    int& face = map.source_face[t];
    if (face >= closed) {
      face = hidden[face - closed];
      continue;
    }
    if (series.face_origin[face] >= 0) {
      face = series.face_origin[face];
      continue;
    }
    if (face_of_point.empty()) {
      face_of_point.assign(series.input.points.size(), -1);
      for (std::size_t f = 0; f < series.input.faces.size(); ++f)
        for (const int v : series.input.faces[f]) face_of_point[v] = static_cast<int>(f);
    }
    Vec3 middle = Vec3::Zero();
    for (const int v : series.closed.faces[face]) middle += series.closed.points[v] / 3;
    const TopologyEvent& event = series.events[series.face_event[face]];
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& loop : event.loops)
      for (const int v : loop)
        if (const double d = (series.input.points[v] - middle).squaredNorm(); d < least) least = d, nearest = v;
    face = face_of_point[nearest];
    std::array<float, 9>& weights = map.source[t];
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < 3; ++c) weights[3 * c + i] = series.input.faces[face][i] == nearest ? 1.0F : 0.0F;
  }
}

}  // namespace hybrid_mesh
