// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Rabinovich, Poranne, Panozzo, Sorkine-Hornung, Scalable locally injective mappings, 2017; Khodakovsky, Litke, Schroeder, Globally smooth
// parameterizations with low distortion, 2003.
#include "parameterization/global_map.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/found.h"
#include "parameterization/collapse_hierarchy.h"
#include "parameterization/cone_motion.h"
#include "parameterization/corner_motion.h"
#include "parameterization/insertion_merging.h"
#include "parameterization/newton_descent.h"

namespace hybrid_mesh {
namespace {

double mean_energy(const ChartMesh& charts, const StarRelaxation& stars) {
  double sum = 0, area = 0;
  for (int f = 0; f < static_cast<int>(charts.mesh.alive.size()); ++f) {
    if (!charts.mesh.alive[f]) continue;
    sum += stars.face_energy(f);
    area += charts.flat(f).area;
  }
  return sum / area;
}

}  // namespace

GlobalMapReport smooth_map(ChartMesh& charts, const PatchedSurface& surface, const GlobalMapOptions& options, const Progress& progress) {
  GlobalMapReport report;
  const Distortion density{options.theta};
  StarRelaxation stars(charts, density);
  CornerMotion corner_motion(charts, density);
  progress.check();
  InsertionMerging insertions(charts, density, surface);
  insertions.merge(0.01);
  progress(0.1);
  stars.relax_squeezed(0.02, 30, progress.part(0.1, 0.2));
  report.energy_before = mean_energy(charts, stars);
  CollapseHierarchy hierarchy(charts, options, insertions.original(), report);
  const auto descend = [&](int steps, const Progress& part) {
    NewtonOptions newton;
    newton.steps = steps;
    const int taken = newton_descent(charts, density, newton, part);
    if (taken > 0) report.newton_steps = taken;
  };
  // A map that has just been made is too distorted to be collapsed far: what is left would be thin triangles.
  constexpr double first = 4;  // times the coarse mesh's vertices
  const double coarse = options.vertices_a_quad * surface.patch_count();
  if (first * coarse < charts.mesh.vertex_count) {
    hierarchy.collapse(static_cast<int>(first * coarse));
    descend(options.newton_steps / 2, progress.part(0.2, 0.25));
  }
  hierarchy.collapse(static_cast<int>(std::min(coarse, 2e9)));
  progress(0.3);
  report.coarse_vertices = charts.mesh.vertex_count;
  descend(options.newton_steps, progress.part(0.3, 0.45));
  std::vector<int> corners = options.corners_move ? corner_motion.all() : std::vector<int>();
  for (int round = 0; round < options.cone_rounds; ++round) {
    // Those that stay are not tried again.
    corners = corner_motion.move_downhill(corners, insertions.original());
    const int moved = static_cast<int>(corners.size()) + move_cones(charts, density, insertions.original());
    report.cone_moves += moved;
    if (moved == 0) break;
    descend(2, progress.part(0.45, 0.6));
  }
  report.energy_coarse = mean_energy(charts, stars);
  hierarchy.refine(progress.part(0.6, 1));
  report.energy = mean_energy(charts, stars);
  return report;
}

GlobalMapReport smooth_map_surely(ChartMesh& charts, const PatchedSurface& surface, GlobalMapOptions options, const Progress& progress) {
  const double first = options.vertices_a_quad;
  Found<GlobalMapReport> report;
  for (const double vertices_a_quad : {first, 3 * first, std::numeric_limits<double>::infinity()}) {
    options.vertices_a_quad = vertices_a_quad;
    ChartMesh trial = charts;
    report = found([&] { return smooth_map(trial, surface, options, progress); });
    if (!report) continue;
    charts = std::move(trial);
    return *report;
  }
  throw NoMap(report.reason);
}

std::vector<int> uncut_map(ChartMesh& charts, const PatchedSurface& surface, const GlobalMapOptions& options, const Progress& progress) {
  progress.check();
  return InsertionMerging(charts, Distortion{options.theta}, surface).merge_all(progress);
}

GlobalMapReport carry_map(ChartMesh& charts, std::vector<int> log, const GlobalMapOptions& options, const Progress& progress) {
  GlobalMapReport report;
  const std::vector<char> all_allowed;
  CollapseHierarchy hierarchy(charts, options, all_allowed, report);
  hierarchy.resume(std::move(log));
  hierarchy.refine(progress);
  report.energy = mean_energy(charts, StarRelaxation(charts, Distortion{options.theta}));
  return report;
}

}  // namespace hybrid_mesh
