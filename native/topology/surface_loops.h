// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/found.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Where a loop's disk lies: that of a handle inside the solid, that of a tunnel outside. Told by the winding number's magnitude, so that a scan
// may be turned inside out.
enum class LoopKind { Handle, Tunnel };

struct SurfaceLoop {
  std::vector<int> points;  // a simple cycle along edges; the first point is not repeated
  double length = 0;
  LoopKind kind = LoopKind::Handle;
  int given = -1;  // its place among the loops that were given
};

// A loop that is there before others are looked for.
struct GivenLoop {
  std::vector<int> points;  // a cycle along edges, kept as it is
  std::string name;         // that an error about it begins with; without one, it is left out where it cannot be kept
};

struct LoopOptions {
  // Shortest-path trees from which loops are taken, each round; more find shorter loops. 0: from 3 to 12, more where the surface has few points.
  int starts = 0;
  int tightenings = 60;  // points of a loop around which a shorter one is looked for, at most
  // How many times longer than the shortest a loop may be if its cap meets the surface less; 1: the shortest loops are taken.
  double detour = 1.5;
  // Longer loops are left out; with 0, none are looked for. Infinite: there is a loop for each unit of genus.
  double longest = std::numeric_limits<double>::infinity();
};

// Short disjoint loops that separate nothing together, as many as the surface's genus, summed over its components: cut along them and capped, every
// component has genus 0. Boundary loops count as capped, and no loop touches one. Those that are given come first, in their order, then the shortest
// ones. The same for any number of threads.
// A given loop cannot be kept if it is no simple cycle of edges, meets a boundary or one before it, or separates the surface together with those
// before it. Throws Error{InvalidInput} if that is one with a name; NoMap if the triangles leave no room for as many disjoint loops: a finer surface
// has them.
std::vector<SurfaceLoop> find_loops(const TriangleSurface& surface, const std::vector<GivenLoop>& given, const LoopOptions& options,
                                    const Progress& progress);

enum class SnapTightening {
  None,
  // Replaced by shorter ones that run around the same handles, as long as there are; a loop that separates the surface stays as it is.
  Shortest
};

// A closed polyline in space (a user's stroke, or a loop of another version of the surface) as a simple cycle along edges near it, which touches no
// boundary; where the stroke crosses itself, the part that goes around a handle is kept, or the longer one. No value, and the reason, where the
// stroke leaves the surface, or shrinks to less than three points on it. Throws Error{InvalidInput} if the stroke has fewer than two points or
// one that is not finite.
Found<std::vector<int>> snap_loop(const TriangleSurface& surface, const std::vector<Vec3>& stroke, SnapTightening tightening,
                                  const Progress& progress);

struct LoopStroke {
  std::vector<Vec3> points;
  SnapTightening tightening = SnapTightening::None;
};
// snap_loop() for each of them.
std::vector<Found<std::vector<int>>> snap_loops(const TriangleSurface& surface, const std::vector<LoopStroke>& strokes, const Progress& progress);

// The boundary loops, each as the points that its half-edges (those without an opposite) leave, in their order.
std::vector<std::vector<int>> boundary_cycles(const TriangleSurface& surface);

// Of the edges between consecutive points, the last and the first included.
double cycle_length(const TriangleSurface& surface, const std::vector<int>& loop);

}  // namespace hybrid_mesh
