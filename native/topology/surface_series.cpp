// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/surface_series.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "topology/event_loops.h"

namespace hybrid_mesh {
namespace {

// One of the versions put together: which points it has, and its faces.
class Version {
 public:
  Version(const SurfaceSeries& series, const std::vector<bool>& open);

  TriangleSurface surface;
  std::vector<int> point_origin, face_origin, face_event;
  std::vector<signed char> face_side;

  // Names of points and faces that hold in every version; -1 where this one does not have it.
  std::vector<int> of_input;                           // per point of the input
  std::vector<std::vector<int>> second;                // per event: of a cut, per point of its loop, the copy at the right side
  std::vector<std::array<std::vector<int>, 2>> inner;  // per event and patch: the points inside
  std::vector<std::array<int, 2>> first_of_patch;      // per event and patch: its first face

 private:
  int add_point(const Vec3& at, int origin);
  void add_face(const std::array<int, 3>& corners, int origin, int event, int side);
  void number_points();
  void turn_to_second_copies(std::vector<std::array<int, 3>>& corners) const;
  void add_patch(int event, int side);

  const SurfaceSeries& series_;
  const std::vector<bool>& open_;
};

// Where patch `side` of an event joins the surface, in the direction of the patch's faces, as points of the input.
std::vector<int> rim_of(const TopologyEvent& event, int side) {
  std::vector<int> rim = event.loops[0];
  // Faces at the left of a loop run along it, so those of their cap run the other way.
  if (event.kind != EventKind::Cut || side == 0) std::reverse(rim.begin(), rim.end());
  if (event.kind == EventKind::Tube) rim.insert(rim.end(), event.loops[1].rbegin(), event.loops[1].rend());
  return rim;
}

int patch_count(const TopologyEvent& event) { return event.kind == EventKind::Cut ? 2 : 1; }

std::array<RimPatch, 2> patches_of(const TriangleSurface& surface, const TopologyEvent& event) {
  const auto places = [&](const std::vector<int>& points) {
    std::vector<Vec3> at;
    for (const int v : points) at.push_back(surface.points[v]);
    return at;
  };
  if (event.kind != EventKind::Tube) {
    std::array<RimPatch, 2> caps{cap_loop(places(rim_of(event, 0))), {}};
    if (event.kind == EventKind::Boundary) return caps;
    // The two caps of a cut coincide: the same triangles, turned over.
    caps[1] = caps[0];
    const int n = static_cast<int>(event.loops[0].size());
    for (auto& face : caps[1].faces) {
      for (int& v : face)
        if (v < n) v = n - 1 - v;
      std::swap(face[1], face[2]);
    }
    return caps;
  }
  const std::vector<int> first(event.loops[0].rbegin(), event.loops[0].rend()), second(event.loops[1].rbegin(), event.loops[1].rend());
  // An edge between the rims may be there already.
  return {tube_between(places(first), places(second), 2), RimPatch()};
}

Version::Version(const SurfaceSeries& series, const std::vector<bool>& open) : series_(series), open_(open) {
  const TriangleSurface& input = series.input;
  std::vector<char> visible(input.faces.size(), 1);
  for (std::size_t e = 0; e < open.size(); ++e)
    for (const auto& faces : series.hidden[e])
      for (const int f : faces) visible[f] = open[e];
  std::vector<std::array<int, 3>> corners = input.faces;
  of_input.assign(input.points.size(), -1);
  for (std::size_t f = 0; f < corners.size(); ++f)
    if (visible[f])
      for (const int v : corners[f]) of_input[v] = 0;
  number_points();
  for (auto& face : corners)
    for (int& v : face) v = of_input[v];
  turn_to_second_copies(corners);
  for (std::size_t f = 0; f < corners.size(); ++f)
    if (visible[f]) add_face(corners[f], static_cast<int>(f), -1, 0);
  first_of_patch.assign(open.size(), {-1, -1});
  for (std::size_t e = 0; e < open.size(); ++e)
    for (int side = 0; !open[e] && side < patch_count(series.events[e]); ++side) add_patch(static_cast<int>(e), side);
  connect_half_edges(surface);
}

int Version::add_point(const Vec3& at, int origin) {
  surface.points.push_back(at);
  point_origin.push_back(origin);
  return static_cast<int>(surface.points.size()) - 1;
}

void Version::add_face(const std::array<int, 3>& corners, int origin, int event, int side) {
  const std::vector<int>& source = series_.input.source_face;
  surface.faces.push_back(corners);
  surface.source_face.push_back(origin < 0 ? -1 : source.empty() ? origin : source[origin]);
  face_origin.push_back(origin);
  face_event.push_back(event);
  face_side.push_back(static_cast<signed char>(side));
}

void Version::number_points() {
  const std::vector<Vec3>& points = series_.input.points;
  for (std::size_t v = 0; v < points.size(); ++v)
    if (of_input[v] == 0) of_input[v] = add_point(points[v], static_cast<int>(v));
  const std::size_t count = open_.size();
  second.resize(count);
  inner.resize(count);
  for (std::size_t e = 0; e < count; ++e)
    if (!open_[e] && series_.events[e].kind == EventKind::Cut)
      for (const int v : series_.events[e].loops[0]) second[e].push_back(add_point(points[v], v));
  for (std::size_t e = 0; e < count; ++e)
    for (int side = 0; !open_[e] && side < patch_count(series_.events[e]); ++side)
      for (const Vec3& at : series_.patches[e][side].points) inner[e][side].push_back(add_point(at, -1));
}

// At the right of a cut, its points' second copies.
void Version::turn_to_second_copies(std::vector<std::array<int, 3>>& corners) const {
  const TriangleSurface& input = series_.input;
  for (std::size_t e = 0; e < second.size(); ++e)
    for (std::size_t i = 0; i < second[e].size(); ++i) {
      const std::vector<int>& loop = series_.events[e].loops[0];
      const int to = loop[(i + 1) % loop.size()], back = loop[(i + loop.size() - 1) % loop.size()];
      // Half-edges that leave the point, counter-clockwise, from the way back to the way on.
      int h = input.opposite[series_.half_edges[e][0][(i + loop.size() - 1) % loop.size()]];
      while (input.to(h) != to) {
        corners[h / 3][h % 3] = second[e][i];
        h = input.opposite[TriangleSurface::previous(h)];
        if (h < 0 || input.to(h) == back) throw Error(ErrorCode::Internal, "a cut does not pass through its point " + std::to_string(loop[i]));
      }
    }
}

void Version::add_patch(int event, int side) {
  std::vector<int> points;
  const TopologyEvent& what = series_.events[event];
  for (const int v : rim_of(what, side)) points.push_back(of_input[v]);
  if (what.kind == EventKind::Cut && side == 1) points = second[event];
  points.insert(points.end(), inner[event][side].begin(), inner[event][side].end());
  first_of_patch[event][side] = static_cast<int>(surface.faces.size());
  for (const auto& face : series_.patches[event][side].faces) add_face({points[face[0]], points[face[1]], points[face[2]]}, -1, event, side);
}

}  // namespace

SurfaceSeries close_topology(const TriangleSurface& surface, std::vector<TopologyEvent> events) {
  SurfaceSeries series;
  EventLoops located = locate_events(surface, std::move(events));
  series.input = surface;
  series.events = std::move(located.events);
  series.half_edges = std::move(located.half_edges);
  series.hidden = std::move(located.hidden);
  for (const TopologyEvent& event : series.events) series.patches.push_back(patches_of(surface, event));
  const std::vector<bool> open(series.events.size(), false);
  Version closed(series, open);
  series.closed = std::move(closed.surface);
  series.point_origin = std::move(closed.point_origin);
  series.face_origin = std::move(closed.face_origin);
  series.face_event = std::move(closed.face_event);
  series.face_side = std::move(closed.face_side);
  return series;
}

OpenedSurface open_topology(const SurfaceSeries& series, const std::vector<bool>& open) {
  if (open.size() != series.events.size())
    throw Error(ErrorCode::InvalidInput,
                "there are " + std::to_string(series.events.size()) + " topology events, not " + std::to_string(open.size()));
  Version version(series, open);
  OpenedSurface opened;
  opened.faces.resize(version.surface.faces.size());
  // The input's faces by their numbers in `closed`, or among the hidden ones.
  std::vector<int> number(series.input.faces.size(), -1);
  std::vector<std::array<int, 2>> first_of_patch(open.size(), {-1, -1});
  for (int f = 0; f < static_cast<int>(series.face_origin.size()); ++f) {
    if (series.face_origin[f] >= 0) number[series.face_origin[f]] = f;
    if (series.face_event[f] < 0) continue;
    int& first = first_of_patch[series.face_event[f]][series.face_side[f]];
    if (first < 0) first = f;
  }
  int next = static_cast<int>(series.face_origin.size());
  for (const auto& ends : series.hidden)
    for (const auto& faces : ends)
      for (const int f : faces) number[f] = next++;
  for (int f = 0; f < static_cast<int>(opened.faces.size()); ++f) {
    const int origin = version.face_origin[f], event = version.face_event[f], side = version.face_side[f];
    opened.faces[f] = origin >= 0 ? number[origin] : first_of_patch[event][side] + f - version.first_of_patch[event][side];
  }
  // Points of `closed`, in their order.
  std::vector<int>& of_closed = opened.of_closed;
  std::size_t p = 0;
  for (int last = -1; p < series.point_origin.size() && series.point_origin[p] > last; ++p) {
    last = series.point_origin[p];
    of_closed.push_back(version.of_input[last]);
  }
  for (std::size_t e = 0; e < open.size(); ++e)
    if (series.events[e].kind == EventKind::Cut)
      for (std::size_t i = 0; i < series.events[e].loops[0].size(); ++i)
        of_closed.push_back(open[e] ? version.of_input[series.events[e].loops[0][i]] : version.second[e][i]);
  for (std::size_t e = 0; e < open.size(); ++e)
    for (int side = 0; side < patch_count(series.events[e]); ++side)
      for (std::size_t i = 0; i < series.patches[e][side].points.size(); ++i) of_closed.push_back(open[e] ? -1 : version.inner[e][side][i]);
  opened.surface = std::move(version.surface);
  opened.point_origin = std::move(version.point_origin);
  return opened;
}

}  // namespace hybrid_mesh
