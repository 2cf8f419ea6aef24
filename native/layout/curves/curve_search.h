// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "layout/curves/surface_curves.h"

namespace hybrid_mesh {

// The directions at a vertex between two neighbouring curve ends.
struct CurveSector {
  std::set<std::pair<int, int>> corners;  // spoke and rank of a CornerGap
  std::set<int> spokes;                   // half-edges whose edge is free
};

struct CurveWay {
  std::vector<SurfaceCurves::Gap> gaps;
  std::set<int> crossed;  // curves
};

// Finds short ways between the curves on a surface of unit size. Keeps a reference to the curves, which may change between searches.
class CurveSearch {
 public:
  enum class Barriers {
    Respect,  // the way crosses no curve
    Cross     // it crosses curves where it has to
  };
  explicit CurveSearch(const SurfaceCurves& curves) : curves_(curves) {}

  // From vertex a to b, leaving and arriving in the given sectors; near a line in space if one is given. Nothing if there is no way.
  std::optional<CurveWay> operator()(int a, int b, const CurveSector& leaving, const CurveSector& arriving, std::vector<Vec3> guide,
                                     Barriers barriers);

 private:
  // A gap that the way goes through, at one of a few points of it.
  struct State {
    SurfaceCurves::Gap gap;
    int sample;
    Vec3 at;
    double cost;
    int previous;
    int crossed;  // curve, -1: none
  };
  struct Entry {
    double estimate;
    int state;
    bool operator>(const Entry& e) const { return estimate != e.estimate ? estimate > e.estimate : state > e.state; }
  };

  int& best(const SurfaceCurves::Gap& gap, int sample);
  double price(const Vec3& from, const Vec3& to) const;
  void reach(const SurfaceCurves::Gap& gap, int previous, const Vec3& from, double cost, int crossed);
  void reach_over(int h, int previous, const Vec3& from, double cost);
  void leave(int a, const CurveSector& sector);
  bool arrives(const State& state, int b, const CurveSector& sector) const;
  void go_on(int i);
  void erase_loops(std::vector<SurfaceCurves::Gap>& gaps) const;

  const SurfaceCurves& curves_;
  // Of the search at hand.
  Barriers barriers_ = Barriers::Respect;
  std::vector<Vec3> guide_;
  Vec3 target_;
  double crossing_cost_ = 0;
  std::vector<State> states_;
  std::vector<Entry> queue_;        // a heap
  SurfaceCurves::FaceCells cells_;  // of the face that was entered last
  int cell_ = -1;
  int number_ = 0;
  std::vector<std::pair<int, int>> best_first_;  // per half-edge and sample, for the first gap of an edge: number of the search, state
  std::unordered_map<std::uint64_t, int> best_;  // for others
};

}  // namespace hybrid_mesh
