// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/topology_opening.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "layout/regions/patch_sets.h"

namespace hybrid_mesh {
namespace {

constexpr int kMostGrowth = 24;  // steps in which a rim is made longer, two sides at least each
constexpr int kMostRings = 4;    // by which a set grows until its boundary does not touch itself
constexpr int kRoom = 8;         // times as many quads as cover what opens, and so many more, may be laid out anew

std::vector<int> members(const PatchSet& in) {
  std::vector<int> out;
  for (std::size_t q = 0; q < in.size(); ++q)
    if (in[q]) out.push_back(static_cast<int>(q));
  return out;
}

class OpeningSearch {
 public:
  OpeningSearch(const LevelState& state, const CoveringQuads& covering, int event, const OpeningRoom& room)
      : graph_(state.quads), kind_(state.surface.series->events[event].kind), covering_(covering[event]), event_(event), room_(room) {}

  RegionRepatch run() {
    RegionRepatch out;
    out.opens = {event_};
    out.buffer_rings = 2;
    out.pattern.kind = RegionPattern::Kind::Rows;
    most_ = std::min(kRoom * (1 + room_.margin) * (static_cast<int>(covering_[0].size() + covering_[1].size()) + 4), graph_.patch_count() - 1);
    if (covering_[0].empty() || (kind_ == EventKind::Cut && covering_[1].empty())) throw NoMap("no quads cover what opens");
    if (kind_ == EventKind::Cut && room_.together)
      find_one_disk(out);
    else if (kind_ == EventKind::Cut)
      find_disks(out);
    else
      take(out, region_over(around(covering_[0]), kind_ == EventKind::Tube ? 2 : 1));
    if (kind_ == EventKind::Tube) out.pattern.kind = RegionPattern::Kind::Automatic;
    return out;
  }

 private:
  PatchSet set_of(const std::vector<int>& quads) const {
    PatchSet in(graph_.patch_count(), 0);
    for (const int q : quads) in[q] = 1;
    return in;
  }
  PatchSet around(const std::vector<int>& quads) const {
    PatchSet in = set_of(quads);
    for (int ring = 0; ring < room_.margin; ++ring) in = dilated(graph_, in);
    return in;
  }

  static int size(const PatchSet& in) { return static_cast<int>(std::count(in.begin(), in.end(), 1)); }

  // With the quads in its reflex corners, so that in a regular part it is a rectangle; as it is where that would take too many.
  PatchSet rounded(const PatchSet& in) const {
    PatchSet out = in;
    std::vector<int> stack = members(in);
    for (int count = static_cast<int>(stack.size()); !stack.empty();) {
      const int q = stack.back();
      stack.pop_back();
      for (const PatchSide& other : graph_.neighbours[q]) {
        if (other.patch < 0 || out[other.patch]) continue;
        int inside = 0;
        for (const PatchSide& s : graph_.neighbours[other.patch]) inside += s.patch >= 0 && out[s.patch];
        if (inside < 2) continue;
        if (++count > most_) return in;
        out[other.patch] = 1;
        stack.push_back(other.patch);
      }
    }
    return out;
  }

  // The one region, with so many rims and no handle, that a set makes once it has been rounded; what it encloses is of it.
  std::optional<PatchRegion> one_region(const PatchSet& in, int rims) const {
    for (PatchSet set : {rounded(in), in})
      for (int ring = 0; ring < kMostRings; ++ring) {
        fill(set, rims);
        if (size(set) > most_) break;
        std::optional<PatchRegion> region = make_region(graph_, members(set));
        if (region && region->rim_count() == rims && region->pieces.size() == 1 && region->pieces[0].euler == 2 - rims) return region;
        set = dilated(graph_, set);
      }
    return std::nullopt;
  }

  // Takes in what a set encloses: all that is beside it but for the largest parts, one a rim.
  void fill(PatchSet& in, int rims) const {
    std::vector<std::vector<int>> outside = components(graph_, in, 0);
    std::erase_if(outside, [&](const std::vector<int>& part) {
      return std::none_of(part.begin(), part.end(), [&](int q) {
        return std::any_of(graph_.neighbours[q].begin(), graph_.neighbours[q].end(), [&](const PatchSide& s) { return s.patch >= 0 && in[s.patch]; });
      });
    });
    std::stable_sort(outside.begin(), outside.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
    for (std::size_t k = rims; k < outside.size(); ++k)
      for (const int q : outside[k]) in[q] = 1;
  }

  PatchRegion region_over(const PatchSet& in, int rims) const {
    std::optional<PatchRegion> region = one_region(in, rims);
    if (!region) throw NoMap("the quads over what opens are too few, or go too far around");
    return std::move(*region);
  }

  static void take(RegionRepatch& out, const PatchRegion& region) {
    out.patches.insert(out.patches.end(), region.patches.begin(), region.patches.end());
    const std::vector<PatchSide> starts = region.starts();
    out.starts.insert(out.starts.end(), starts.begin(), starts.end());
  }

  bool are_apart(const PatchRegion& a, const PatchRegion& b) const {
    std::vector<char> node(graph_.node_count, 0);
    for (const int q : a.patches)
      for (const int n : graph_.nodes[q]) node[n] = 1;
    return std::none_of(b.patches.begin(), b.patches.end(),
                        [&](int q) { return std::any_of(graph_.nodes[q].begin(), graph_.nodes[q].end(), [&](int n) { return node[n] != 0; }); });
  }

  // A disk with a rim longer than the region's, the least, that keeps apart from another one.
  std::optional<PatchRegion> grown(const PatchRegion& region, const PatchRegion& other) const {
    const PatchSet in = set_of(region.patches);
    std::set<int> around;
    for (const PatchSide& s : region.boundary)
      if (const int q = graph_.neighbours[s.patch][s.side].patch; q >= 0) around.insert(q);
    std::optional<PatchRegion> best;
    const auto rank = [](const PatchRegion& r) { return std::pair(r.corners.size(), r.patches.size()); };
    for (const int q : around) {
      PatchSet wider = in;
      wider[q] = 1;
      std::optional<PatchRegion> made = one_region(wider, 1);
      if (!made || made->corners.size() <= region.corners.size() || !are_apart(*made, other)) continue;
      if (!best || rank(*made) < rank(*best)) best = std::move(made);
    }
    return best;
  }

  void find_disks(RegionRepatch& out) const {
    PatchRegion a = region_over(around(covering_[0]), 1), b = region_over(around(covering_[1]), 1);
    if (!are_apart(a, b)) throw NoMap("its two sides have no room beside each other");
    for (int step = 0; step < kMostGrowth && a.corners.size() != b.corners.size(); ++step) {
      PatchRegion &small = a.corners.size() < b.corners.size() ? a : b, &large = &small == &a ? b : a;
      std::optional<PatchRegion> made = grown(small, large);
      if (!made) break;
      small = std::move(*made);
    }
    take(out, a);
    take(out, b);
    if (a.corners.size() != b.corners.size()) out.pattern.kind = RegionPattern::Kind::Even;
  }

  void find_one_disk(RegionRepatch& out) const {
    std::vector<int> both = covering_[0];
    both.insert(both.end(), covering_[1].begin(), covering_[1].end());
    take(out, region_over(around(both), 1));
    out.pattern.kind = RegionPattern::Kind::Even;
  }

  const QuadGraph& graph_;
  EventKind kind_;
  const std::array<std::vector<int>, 2>& covering_;
  int event_;
  OpeningRoom room_;
  int most_ = 0;
};

}  // namespace

CoveringQuads CoveringSearch::quads_of(const LevelState& state) {
  const SurfaceVersion& version = state.surface;
  CoveringQuads out(version.open.size());
  if (!version.series) return out;
  const SurfaceSeries& series = *version.series;
  const auto event_of = [&](int face) { return face < static_cast<int>(series.face_event.size()) ? series.face_event[face] : -1; };
  std::vector<Covered*> covered;  // per quad of a map that covers any
  std::vector<int> quads, fresh;
  for (int q = 0; q < state.quads.patch_count(); ++q) {
    const QuadMap& of = state.maps[q];
    const auto [at, new_map] = known_.insert({of.map, {}});
    if (new_map) at->second.covers_any = std::any_of(of.map->source_face.begin(), of.map->source_face.end(), [&](int f) { return event_of(f) >= 0; });
    if (!at->second.covers_any) continue;
    const auto [part, new_part] = at->second.parts[{of.square.u, of.square.v}].insert({of.square.width, {}});
    quads.push_back(q);
    covered.push_back(&part->second);
    if (new_part) fresh.push_back(static_cast<int>(quads.size()) - 1);
  }
  std::vector<int> unknown;
  for (const int k : fresh) unknown.push_back(quads[k]);
  const std::vector<PatchMap> maps = maps_of(state, unknown);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    std::set<std::pair<int, int>> events;
    for (const int f : maps[i].source_face)
      if (event_of(f) >= 0) events.insert({event_of(f), series.face_side[f]});
    covered[fresh[i]]->assign(events.begin(), events.end());
  }
  for (std::size_t k = 0; k < quads.size(); ++k)
    for (const auto& [event, side] : *covered[k]) out[event][side].push_back(quads[k]);
  return out;
}

Found<RegionRepatch> find_opening(const LevelState& state, const CoveringQuads& covering, int event, const OpeningRoom& room) {
  return found([&] { return OpeningSearch(state, covering, event, room).run(); });
}

}  // namespace hybrid_mesh
