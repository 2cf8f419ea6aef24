// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "base/context.h"
#include "parameterization/corner_motion.h"
#include "parameterization/global_map.h"
#include "parameterization/star_relaxation.h"

namespace hybrid_mesh {

// Charts under half-edge collapses, and the way back, on which the map is smoothed.
class CollapseHierarchy {
 public:
  // `allowed`: per vertex whether it may take a cone (empty: all may). What happens is counted in `report`.
  CollapseHierarchy(ChartMesh& charts, const GlobalMapOptions& options, const std::vector<char>& allowed, GlobalMapReport& report);

  // Collapses down to `target` vertices.
  void collapse(int target);
  // Takes over collapses that were made elsewhere, the last one last.
  void resume(const std::vector<int>& log);
  // Undoes all collapses. Throws Error{Internal} where a vertex finds no place.
  void refine(const Progress& progress);

 private:
  void sweep(int count, const std::vector<int>& vertices, const Progress& progress);
  void make_room(int v);
  bool unfolds_around(int v, int rings, int sweeps);
  void untangle(int v);

  ChartMesh& c_;
  const GlobalMapOptions& options_;
  const std::vector<char>& allowed_;
  GlobalMapReport& report_;
  Distortion density_;
  StarRelaxation stars_;
  CornerMotion corners_;
  std::vector<int> log_;
  std::vector<std::size_t> levels_;  // lengths of the log, increasing: where the map may be swept
};

}  // namespace hybrid_mesh
