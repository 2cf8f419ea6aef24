// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/loop_search.h"

#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

using Cycle = std::vector<int>;
using Place = std::array<double, 3>;

Place place_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

std::string name_of(const char* what, std::size_t number) { return std::string(what) + " " + std::to_string(number + 1); }

// The surface's points exactly where the loops' are, -1 where it has none.
std::vector<Cycle> points_at(const TriangleSurface& surface, const std::vector<EarlierLoop>& loops) {
  std::map<Place, int> number;
  for (const EarlierLoop& loop : loops)
    for (const Vec3& p : loop.points) number.insert({place_of(p), -1});
  for (std::size_t v = surface.points.size(); v-- > 0;)
    if (const auto at = number.find(place_of(surface.points[v])); at != number.end()) at->second = static_cast<int>(v);
  std::vector<Cycle> cycles;
  for (const EarlierLoop& loop : loops) {
    Cycle& cycle = cycles.emplace_back();
    for (const Vec3& p : loop.points) cycle.push_back(number[place_of(p)]);
  }
  return cycles;
}

// Per loop: its points, where they are a simple cycle of the surface's edges; else empty.
std::vector<Cycle> cycles_at(const TriangleSurface& surface, const std::vector<EarlierLoop>& loops) {
  std::vector<Cycle> cycles = points_at(surface, loops);
  std::vector<char> on_loop(surface.points.size(), 0);
  for (const Cycle& cycle : cycles)
    for (const int v : cycle)
      if (v >= 0) on_loop[v] = 1;
  std::set<std::pair<int, int>> edges;
  for (int h = 0; h < 3 * static_cast<int>(surface.faces.size()); ++h)
    if (on_loop[surface.from(h)] && on_loop[surface.to(h)]) edges.insert(std::minmax(surface.from(h), surface.to(h)));
  for (Cycle& cycle : cycles) {
    bool simple = cycle.size() >= 3 && std::set<int>(cycle.begin(), cycle.end()).size() == cycle.size();
    for (std::size_t i = 0; simple && i < cycle.size(); ++i) simple = edges.count(std::minmax(cycle[i], cycle[(i + 1) % cycle.size()])) > 0;
    if (!simple) cycle.clear();
  }
  return cycles;
}

}  // namespace

std::vector<RequestedLoop> search_loops(const TriangleSurface& surface, const LoopRequest& request, const Progress& progress) {
  progress.stage("finding loops");
  progress.check();
  std::vector<Cycle> cycles;
  if (!request.loops.empty()) cycles = cycles_at(surface, request.loops);
  progress.check();
  // All that is to be snapped at once: what it takes to do so is made but once.
  std::vector<LoopStroke> strokes;
  for (std::size_t i = 0; i < cycles.size(); ++i)
    if (cycles[i].empty()) strokes.push_back({request.loops[i].points, SnapTightening::None});
  for (const std::vector<Vec3>& stroke : request.strokes) strokes.push_back({stroke, SnapTightening::Shortest});
  std::vector<Found<Cycle>> snapped = snap_loops(surface, strokes, progress.part(0, 0.2));
  auto next = snapped.begin();
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (!cycles[i].empty()) continue;
    if (Found<Cycle>& found = *next++; found)
      cycles[i] = std::move(*found);
    else if (request.loops[i].drawn)
      throw Error(ErrorCode::Unsupported, name_of("loop", i) + " is not on the surface any more: " + found.reason);
  }

  std::vector<GivenLoop> given;
  std::vector<int> source;
  const auto give = [&](bool drawn) {
    for (std::size_t i = 0; i < cycles.size(); ++i)
      if (request.loops[i].drawn == drawn && !cycles[i].empty()) {
        given.push_back({cycles[i], drawn ? name_of("loop", i) : ""});
        source.push_back(static_cast<int>(i));
      }
  };
  // What is drawn comes first: of two that are in each other's way the second one has to go.
  give(true);
  for (std::size_t i = 0; i < request.strokes.size(); ++i, ++next) {
    if (!*next) throw Error(ErrorCode::Unsupported, name_of("stroke", i) + ": " + next->reason);
    given.push_back({**next, name_of("stroke", i)});
    source.push_back(-1);
  }
  give(false);

  std::vector<RequestedLoop> loops;
  for (SurfaceLoop& loop : find_loops(surface, given, request.options, progress.part(0.2, 1))) {
    const int from = loop.given;
    loops.push_back({std::move(loop), from >= 0 && !given[from].name.empty(), from >= 0 ? source[from] : -1});
  }
  return loops;
}

}  // namespace hybrid_mesh
