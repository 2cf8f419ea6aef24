// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/context.h"
#include "parameterization/chart_mesh.h"

namespace hybrid_mesh {

struct GlobalMapOptions {
  double theta = 0.5;           // see Distortion: small for right angles, large for even size
  double vertices_a_quad = 15;  // of the coarse mesh on which the map is found
  int newton_steps = 15;
  int cone_rounds = 10;      // of moving irregular nodes on the coarse mesh, at most; with one round they stay on the way back
  bool corners_move = true;  // irregular nodes on the boundary, along it
  int sweeps = 3;            // of vertex-wise relaxation a level, on the way back to the fine mesh
};

struct GlobalMapReport {
  int coarse_vertices = 0, newton_steps = 0, unplaced = 0, cone_moves = 0;
  double energy_before = 0, energy_coarse = 0, energy = 0;  // means over the area; 1 is an isometry
};

// Makes the map smooth across patches, even and right-angled: descends a barrier energy over all patches at once on a collapsed copy, and carries the
// result back to the fine mesh level by level. Bijectivity holds throughout: no step may fold a triangle. Points of `surface` that were inserted by
// cutting are merged away where the map allows (the surface stays the same set of points). Patch sides move with the map: afterwards `surface` is of
// no use. Throws NoMap where a vertex finds no place on the way back.
GlobalMapReport smooth_map(ChartMesh& charts, const PatchedSurface& surface, const GlobalMapOptions& options, const Progress& progress);
// The same, and where a vertex finds no place on a flatter hierarchy, at last on none: slower, but then nothing has to find one.
GlobalMapReport smooth_map_surely(ChartMesh& charts, const PatchedSurface& surface, GlobalMapOptions options, const Progress& progress);

// Merges all points of `surface` that were inserted by cutting, and moves cones from them to a neighbour: the charts' triangles are those of the
// surface that was cut. Returns the point of that surface for each vertex that is alive. Throws NoMap where the map refuses.
std::vector<int> uncut_map(ChartMesh& charts, const PatchedSurface& surface, const GlobalMapOptions& options, const Progress& progress);

// Undoes the half-edge collapses in `log`, last one first, and smooths the map on the way.
GlobalMapReport carry_map(ChartMesh& charts, std::vector<int> log, const GlobalMapOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
