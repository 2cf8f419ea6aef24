// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "topology/surface_loops.h"

namespace hybrid_mesh {

// A loop that a surface had, as it is now or was: where it is none of its cycles of edges any more, it is snapped to the edges nearby.
struct EarlierLoop {
  std::vector<Vec3> points;
  bool drawn = false;  // by hand: one that cannot be kept is an error. Others give way to what is drawn
};

struct LoopRequest {
  std::vector<EarlierLoop> loops;
  std::vector<std::vector<Vec3>> strokes;  // closed, drawn by hand: each becomes the shortest loop around what it goes around
  LoopOptions options;                     // of the search for those that are missing to make the genus
};

struct RequestedLoop {
  SurfaceLoop loop;
  bool drawn = false;
  int source = -1;  // its place in the request's `loops`; -1: it is new
};

// Loops as find_loops() gives them: those drawn before, those of strokes, of the others those that can be kept, and then those that are missing.
// Throws as find_loops() and snap_loop() do, and Error{Unsupported} for a stroke that leaves the surface and a drawn loop that is on it no more; the
// messages count from 1, "loop 2", "stroke 1".
std::vector<RequestedLoop> search_loops(const TriangleSurface& surface, const LoopRequest& request, const Progress& progress);

}  // namespace hybrid_mesh
