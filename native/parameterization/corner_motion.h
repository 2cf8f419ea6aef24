// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parameterization/star_relaxation.h"

namespace hybrid_mesh {

// Moves corners, irregular base nodes on the boundary (pinned vertices of the charts), to neighbouring vertices along it.
class CornerMotion {
 public:
  CornerMotion(ChartMesh& charts, const Distortion& density) : c_(charts), stars_(charts, density) {}

  std::vector<int> all() const;
  std::vector<int> near(int v) const;  // within two rings

  // The neighbour of a boundary vertex along it: the surface is on the left of the way forward.
  int next(int v, bool forward) const;

  // The next vertex becomes the corner in its place, and the corner a vertex of the side that is longer now. A corner in the way moves on first.
  // Returns the vertex, or -1 where the map does not unfold in so many sweeps.
  int move(int corner, bool forward, int sweeps = 24) { return move(corner, forward, sweeps, 0); }

  // Moves those of the corners for which that lowers the energy; returns where to. `allowed`: per vertex whether it may become a corner (empty: all
  // may).
  std::vector<int> move_downhill(const std::vector<int>& corners, const std::vector<char>& allowed);

  // The corners near v go along the boundary, a few vertices to either side, until done(corner). Returns whether that was.
  template <class Done>
  bool move_near(int v, const Done& done) {
    for (int corner : near(v))
      for (const bool forward : {true, false})
        for (int steps = forward ? 3 : 6; steps > 0; --steps) {
          const int moved = move(corner, forward);
          if (moved < 0) break;
          corner = moved;
          if (done(corner)) return true;
        }
    return false;
  }

 private:
  bool is_corner(int v) const;
  int move(int corner, bool forward, int sweeps, int others);
  int step_downhill(int corner, bool forward, const std::vector<char>& allowed);
  int last_half_edge(int v) const;
  double energy_around(const std::vector<int>& region) const;

  ChartMesh& c_;
  StarRelaxation stars_;
};

}  // namespace hybrid_mesh
