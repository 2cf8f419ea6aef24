// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/event_loops.h"

#include <algorithm>
#include <string>
#include <unordered_map>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

class EventLocator {
 public:
  EventLocator(const TriangleSurface& surface, std::vector<TopologyEvent> events);
  EventLoops locate();

 private:
  [[noreturn]] void refuse(std::size_t event, const std::string& why) const;
  int half_edge(int from, int to) const;
  void check_cycle(std::size_t event, const std::vector<int>& loop) const;
  void claim(std::size_t event, const std::vector<int>& points);
  std::vector<int> along(std::size_t event, const std::vector<int>& loop) const;
  void locate_boundary(std::size_t event);
  void locate_tube(std::size_t event);
  std::vector<int> smaller_side(const std::vector<int>& left, bool& at_left) const;
  bool is_disk(const std::vector<int>& faces, std::size_t rim, std::vector<int>& inner) const;

  const TriangleSurface& surface_;
  std::vector<int> out_;           // per point: a half-edge that leaves it, the one without a face at its right if there is one
  std::vector<char> at_boundary_;  // per point
  std::vector<int> owner_;         // per point: the event that it belongs to, or -1
  EventLoops found_;
};

EventLocator::EventLocator(const TriangleSurface& surface, std::vector<TopologyEvent> events)
    : surface_(surface), out_(surface.points.size(), -1), at_boundary_(surface.points.size(), 0), owner_(surface.points.size(), -1) {
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
    if (out_[surface.from(h)] < 0 || surface.opposite[h] < 0) out_[surface.from(h)] = h;
    if (surface.opposite[h] < 0) at_boundary_[surface.from(h)] = at_boundary_[surface.to(h)] = 1;
  }
  found_.events = std::move(events);
}

void EventLocator::refuse(std::size_t event, const std::string& why) const {
  throw Error(ErrorCode::InvalidInput, "topology event " + std::to_string(event) + ": " + why);
}

int EventLocator::half_edge(int from, int to) const {
  int h = out_[from];
  do {
    if (surface_.to(h) == to) return h;
    h = surface_.opposite[TriangleSurface::previous(h)];
  } while (h >= 0 && h != out_[from]);
  return -1;
}

void EventLocator::check_cycle(std::size_t event, const std::vector<int>& loop) const {
  if (loop.size() < 3) refuse(event, "a loop has fewer than three points");
  for (const int v : loop)
    if (v < 0 || v >= static_cast<int>(surface_.points.size())) refuse(event, "the point " + std::to_string(v) + " does not exist");
}

void EventLocator::claim(std::size_t event, const std::vector<int>& points) {
  for (const int v : points) {
    if (owner_[v] == static_cast<int>(event)) refuse(event, "it passes through the point " + std::to_string(v) + " twice");
    if (owner_[v] >= 0) refuse(event, "it meets event " + std::to_string(owner_[v]) + " at the point " + std::to_string(v));
    owner_[v] = static_cast<int>(event);
  }
}

std::vector<int> EventLocator::along(std::size_t event, const std::vector<int>& loop) const {
  std::vector<int> half_edges;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const int from = loop[i], to = loop[(i + 1) % loop.size()];
    if (at_boundary_[from]) refuse(event, "its loop meets a boundary at the point " + std::to_string(from));
    const int h = half_edge(from, to);
    if (h < 0) refuse(event, "there is no edge between the points " + std::to_string(from) + " and " + std::to_string(to));
    half_edges.push_back(h);
  }
  return half_edges;
}

void EventLocator::locate_boundary(std::size_t event) {
  std::vector<int>& loop = found_.events[event].loops[0];
  const auto edge_of_boundary = [&](int from, int to) {
    const int h = half_edge(from, to);
    return h >= 0 && surface_.opposite[h] < 0;
  };
  if (!edge_of_boundary(loop[0], loop[1])) std::reverse(loop.begin(), loop.end());
  std::vector<int>& half_edges = found_.half_edges[event][0];
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const int from = loop[i], to = loop[(i + 1) % loop.size()];
    if (!edge_of_boundary(from, to)) refuse(event, "it is no boundary between the points " + std::to_string(from) + " and " + std::to_string(to));
    half_edges.push_back(half_edge(from, to));
  }
}

// The faces at one side of a loop, whichever are fewer: both sides are flooded in turn.
std::vector<int> EventLocator::smaller_side(const std::vector<int>& left, bool& at_left) const {
  std::unordered_map<int, int> side;  // per face
  std::array<std::vector<int>, 2> flood;
  const auto enter = [&](int which, int face) {
    if (side.emplace(face, which).second) flood[which].push_back(face);
  };
  std::vector<int> walls = left;
  for (const int h : left) walls.push_back(surface_.opposite[h]);
  std::sort(walls.begin(), walls.end());
  for (const int h : left) enter(0, h / 3);
  for (const int h : left) enter(1, surface_.opposite[h] / 3);
  for (std::array<std::size_t, 2> done{0, 0};;)
    for (const int which : {0, 1}) {
      if (done[which] == flood[which].size()) {
        at_left = which == 0;
        return flood[which];
      }
      const int face = flood[which][done[which]++];
      for (int h = 3 * face; h < 3 * face + 3; ++h)
        if (surface_.opposite[h] >= 0 && !std::binary_search(walls.begin(), walls.end(), h)) enter(which, surface_.opposite[h] / 3);
    }
}

bool EventLocator::is_disk(const std::vector<int>& faces, std::size_t rim, std::vector<int>& points) const {
  for (const int f : faces)
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      points.push_back(surface_.from(h));
      if (surface_.opposite[h] < 0) return false;
    }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  // Of V - E + F = 1, with 2 E = 3 F + rim.
  return 2 * static_cast<long>(points.size()) == static_cast<long>(faces.size()) + static_cast<long>(rim) + 2;
}

void EventLocator::locate_tube(std::size_t event) {
  for (const int end : {0, 1}) {
    std::vector<int>& loop = found_.events[event].loops[end];
    std::vector<int>& half_edges = found_.half_edges[event][end];
    bool at_left = false;
    std::vector<int> faces = smaller_side(half_edges, at_left), points;
    if (!is_disk(faces, loop.size(), points)) refuse(event, "the smaller side of loop " + std::to_string(end) + " is no disk");
    if (at_left) {
      std::reverse(loop.begin(), loop.end());
      half_edges = along(event, loop);
    }
    for (const int v : loop) owner_[v] = -1;  // they are among the points
    claim(event, points);
    std::sort(faces.begin(), faces.end());
    found_.hidden[event][end] = std::move(faces);
  }
}

EventLoops EventLocator::locate() {
  const std::size_t count = found_.events.size();
  found_.half_edges.resize(count);
  found_.hidden.resize(count);
  for (std::size_t e = 0; e < count; ++e) {
    TopologyEvent& event = found_.events[e];
    if (event.kind != EventKind::Tube) event.loops[1].clear();
    for (int k = 0; k < (event.kind == EventKind::Tube ? 2 : 1); ++k) {
      check_cycle(e, event.loops[k]);
      claim(e, event.loops[k]);
      if (event.kind == EventKind::Boundary)
        locate_boundary(e);
      else
        found_.half_edges[e][k] = along(e, event.loops[k]);
    }
    if (event.kind == EventKind::Tube) locate_tube(e);
    event.length = cycle_length(surface_, event.loops[0]);
    if (event.kind == EventKind::Tube) event.length = (event.length + cycle_length(surface_, event.loops[1])) / 2;
  }
  return std::move(found_);
}

}  // namespace

EventLoops locate_events(const TriangleSurface& surface, std::vector<TopologyEvent> events) {
  return EventLocator(surface, std::move(events)).locate();
}

}  // namespace hybrid_mesh
