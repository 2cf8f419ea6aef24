// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "base/context.h"
#include "parameterization/corner_motion.h"
#include "parameterization/global_map.h"
#include "parameterization/star_relaxation.h"

namespace hybrid_mesh {

// How the charts are collapsed.
struct CollapseOptions {
  std::size_t ways = 3;       // the shortest edges of a vertex, along which it may go; longer ones make thin triangles
  double determinant = 0.05;  // that new triangles must have in the map, which has to unfold again on the way back, ...
  double shape = 0.03;        // ... and in space: their doubled area by the sum of their squared sides (0.29 for an equilateral one)
  double least_gone = 0.005;  // of the vertices, in a pass: with fewer the rest is too thin to go on
};

// What is done for a vertex that comes back and finds no place, or little of it. All of it is rare, so that the numbers are generous.
struct PlacementOptions {
  double growth = 1.5;      // of the mesh, between sweeps over all of it: their cost stays a few times that of the last one
  int cone_tries = 3;       // to move a cone out of the way
  int ring_tries = 3;       // to make the ring rounder, with one more ring of neighbours each time
  int ring_sweeps = 10;     // of relaxation, each time: by then it has nearly come to rest
  int rings = 2;            // of neighbours that move with it at first, ...
  int most_rings = 6;       // ... and at last
  int patience = 24;        // sweeps to unfold so many rings, ...
  int long_patience = 150;  // ... and from `patient_rings` on, where it is a last resort
  int patient_rings = 4;
  double room = 0.1;   // determinant of its triangles, below which its neighbours are relaxed with it ...
  int room_tries = 6;  // ... at most so many times
};

// Charts under half-edge collapses, and the way back, on which the map is smoothed.
class CollapseHierarchy {
 public:
  // `allowed`: per vertex whether it may take a cone (empty: all may). What happens is counted in `report`.
  CollapseHierarchy(ChartMesh& charts, const GlobalMapOptions& options, const std::vector<char>& allowed, GlobalMapReport& report);

  // Collapses down to `target` vertices.
  void collapse(int target);
  // Takes over collapses that were made elsewhere, the last one last.
  void resume(std::vector<int> log);
  // Undoes all collapses. Throws NoMap where a vertex finds no place.
  void refine(const Progress& progress);

 private:
  void undo_last();
  bool undo_past_cone(int h);
  bool undo_with_rounder_ring(int h);
  bool undo_past_corners(int h, std::vector<Complex> before);
  void make_room(int v);
  bool unfolds_around(int v, int rings, int sweeps);
  void untangle(int v);

  ChartMesh& c_;
  const GlobalMapOptions& options_;
  const CollapseOptions collapses_;
  const PlacementOptions placement_;
  const std::vector<char>& allowed_;
  GlobalMapReport& report_;
  Distortion density_;
  StarRelaxation stars_;
  CornerMotion corners_;
  std::vector<int> log_;
  std::vector<std::size_t> levels_;  // lengths of the log, increasing: where the map may be swept
};

}  // namespace hybrid_mesh
