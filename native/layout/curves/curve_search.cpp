// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/curves/curve_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "layout/curves/surface_paths.h"

namespace hybrid_mesh {
namespace {

constexpr std::array<double, 3> kSamples{0.15, 0.5, 0.85};  // of a gap
constexpr double kCrossingCost =
    0.3;  // of the diagonal, at most the guide's length: a way that has to cross curves crosses no more than that makes worth while
constexpr double kMostDetour =
    4;  // guides' lengths: a longer way that respects the curves is not looked for, or the whole surface would be searched wherever there is none
constexpr double kDetourCost = 8;  // a way far from its guide counts as so many times longer
constexpr double kFar = 0.05;      // of the diagonal

}  // namespace

// The best state known for a gap, -1: none yet.
int& CurveSearch::best(const SurfaceCurves::Gap& gap, int sample) {
  if (gap.rank > 0) {
    const std::uint64_t key =
        (static_cast<std::uint64_t>(gap.half_edge) << 26) | (static_cast<std::uint64_t>(gap.rank) << 2) | static_cast<std::uint64_t>(sample);
    return best_.insert({key, -1}).first->second;
  }
  auto& [search, state] = best_first_[kSamples.size() * gap.half_edge + sample];
  if (search != number_) search = number_, state = -1;
  return state;
}

double CurveSearch::price(const Vec3& from, const Vec3& to) const {
  const double length = (to - from).norm();
  if (guide_.empty()) return length;
  double nearest = kFar * kFar;
  for (std::size_t i = 1; i < guide_.size(); ++i) {
    const double t = nearest_on_segment(to, guide_[i - 1], guide_[i]);
    nearest = std::min(nearest, (to - guide_[i - 1] - t * (guide_[i] - guide_[i - 1])).squaredNorm());
  }
  return length * (1 + kDetourCost * std::sqrt(nearest) / kFar);
}

void CurveSearch::reach(const SurfaceCurves::Gap& gap, int previous, const Vec3& from, double cost, int crossed) {
  const Vec3 &start = curves_.points()[curves_.mesh().from(gap.half_edge)], &end = curves_.points()[curves_.mesh().to(gap.half_edge)];
  for (int s = 0; s < static_cast<int>(kSamples.size()); ++s) {
    const Vec3 at = start + (gap.from + kSamples[s] * (gap.to - gap.from)) * (end - start);
    const double c = cost + price(from, at);
    int& state = best(gap, s);
    if (state >= 0 && states_[state].cost <= c) continue;
    state = static_cast<int>(states_.size());
    states_.push_back({gap, s, at, c, previous, crossed});
    queue_.push_back({c + (target_ - at).norm(), state});
    std::push_heap(queue_.begin(), queue_.end(), std::greater<Entry>());
  }
}

// Over a side that is a curve.
void CurveSearch::reach_over(int h, int previous, const Vec3& from, double cost) {
  const int c = curves_.along(curves_.mesh().edge[h]);
  if (barriers_ == Barriers::Cross && c >= 0 && curves_.mesh().opposite[h] >= 0)
    reach({h, 0, -1, 0, 1, -1}, previous, from, cost + crossing_cost_, c);
}

void CurveSearch::leave(int a, const CurveSector& sector) {
  const Vec3 from = curves_.points()[a];
  for (const auto& [spoke, rank] : sector.corners) {
    curves_.find_cells(spoke / 3, cells_);
    const int side = EditMesh::next(spoke);
    for (const SurfaceCurves::CornerGap& corner : cells_.corners) {
      if (corner.spoke != spoke || corner.rank != rank) continue;
      for (const SurfaceCurves::Gap& gap : cells_.gaps)
        if (gap.half_edge == side && gap.cell == corner.cell) reach(gap, -1, from, 0, -1);
      reach_over(side, -1, from, 0);
    }
  }
}

// Does the cell that was entered have a corner at b in the sector?
bool CurveSearch::arrives(const State& state, int b, const CurveSector& sector) const {
  const int o = curves_.mesh().opposite[state.gap.half_edge];
  if (curves_.mesh().apex(o) != b) return false;
  return std::any_of(cells_.corners.begin(), cells_.corners.end(), [&](const SurfaceCurves::CornerGap& corner) {
    return corner.cell == cell_ && corner.spoke == EditMesh::prev(o) && sector.corners.count({corner.spoke, corner.rank}) > 0;
  });
}

void CurveSearch::go_on(int i) {
  const State state = states_[i];
  const int h = state.gap.half_edge, o = curves_.mesh().opposite[h];
  for (const SurfaceCurves::Gap& gap : cells_.gaps) {
    if (gap.half_edge != o) {
      if (gap.cell == cell_) reach(gap, i, state.at, state.cost, -1);
      continue;
    }
    // Over the curve beside the gap, to the next gap of the edge.
    if (barriers_ != Barriers::Cross || std::abs(gap.rank - state.gap.rank) != 1) continue;
    SurfaceCurves::Gap beside = gap;
    beside.half_edge = h;
    beside.from = 1 - gap.to, beside.to = 1 - gap.from;
    reach(beside, i, state.at, state.cost + crossing_cost_, curves_.crossing(gap.rank > state.gap.rank ? gap.below : state.gap.below).curve);
  }
  for (const int side : {EditMesh::next(o), EditMesh::prev(o)}) reach_over(side, i, state.at, state.cost);
}

std::optional<CurveWay> CurveSearch::operator()(int a, int b, const CurveSector& leaving, const CurveSector& arriving, std::vector<Vec3> guide,
                                                Barriers barriers) {
  const EditMesh& mesh = curves_.mesh();
  barriers_ = barriers;
  guide_ = std::move(guide);
  target_ = curves_.points()[b];
  states_.clear(), queue_.clear(), best_.clear();
  ++number_;
  best_first_.resize(kSamples.size() * mesh.origin.size(), {0, 0});

  double shortest = std::numeric_limits<double>::infinity();
  crossing_cost_ = kCrossingCost;
  double most = shortest;
  if (!guide_.empty()) {
    double length = (guide_.front() - curves_.points()[a]).norm() + (guide_.back() - target_).norm();
    for (std::size_t i = 1; i < guide_.size(); ++i) length += (guide_[i] - guide_[i - 1]).norm();
    crossing_cost_ = std::min(crossing_cost_, length);
    if (barriers_ == Barriers::Respect) most = kMostDetour * length;
  }
  int last = -1;
  for (const int g : leaving.spokes)
    if (mesh.to(g) == b && arriving.spokes.count(mesh.opposite[g])) shortest = price(curves_.points()[a], target_);
  leave(a, leaving);
  while (!queue_.empty() && queue_.front().estimate < std::min(shortest, most)) {
    const int i = queue_.front().state;
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<Entry>());
    queue_.pop_back();
    const State state = states_[i];
    if (best(state.gap, state.sample) != i) continue;  // there is a shorter way to it
    const int o = mesh.opposite[state.gap.half_edge];
    curves_.find_cells(o / 3, cells_);
    cell_ = -1;
    for (const SurfaceCurves::Gap& gap : cells_.gaps)
      if (gap.half_edge == o && gap.rank == state.gap.rank) cell_ = gap.cell;
    if (curves_.along(mesh.edge[o]) >= 0)  // a side without gaps: beside it lies the corner before all curves that end there
      for (const SurfaceCurves::CornerGap& corner : cells_.corners)
        if (corner.spoke == o && corner.rank == 0) cell_ = corner.cell;
    if (const double cost = state.cost + (target_ - state.at).norm(); cost < shortest && arrives(state, b, arriving)) shortest = cost, last = i;
    go_on(i);
  }
  if (!(shortest < std::numeric_limits<double>::infinity())) return std::nullopt;
  CurveWay way;
  for (int i = last; i >= 0; i = states_[i].previous) {
    way.gaps.push_back(states_[i].gap);
    if (states_[i].crossed >= 0) way.crossed.insert(states_[i].crossed);
  }
  std::reverse(way.gaps.begin(), way.gaps.end());
  if (way.crossed.empty()) erase_loops(way.gaps);
  return way;
}

// Along a guide the cheapest way may come through a gap once more: what lies between is left out.
void CurveSearch::erase_loops(std::vector<SurfaceCurves::Gap>& gaps) const {
  std::vector<SurfaceCurves::Gap> kept;
  std::map<std::pair<int, int>, std::size_t> place;  // edge, rank
  const auto key = [&](const SurfaceCurves::Gap& g) { return std::pair(curves_.mesh().edge[g.half_edge], g.rank); };
  for (const SurfaceCurves::Gap& gap : gaps) {
    const auto [before, fresh] = place.insert({key(gap), kept.size()});
    if (fresh) {
      kept.push_back(gap);
      continue;
    }
    // The same way through, or back.
    const std::size_t left = before->second + (kept[before->second].half_edge == gap.half_edge ? 1 : 0);
    while (kept.size() > left) {
      place.erase(key(kept.back()));
      kept.pop_back();
    }
  }
  gaps = std::move(kept);
}

}  // namespace hybrid_mesh
