// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "topology/loop_cap.h"
#include "topology/surface_loops.h"

namespace hybrid_mesh {

enum class EventKind { Cut, Tube, Boundary };

// Something that the topology of a surface changes by: while it is closed, the surface is cut along a loop and capped on both sides (Cut), joined by
// a tube (Tube), or capped at one of its boundary loops (Boundary).
struct TopologyEvent {
  EventKind kind = EventKind::Cut;
  // Points of the input surface, simple cycles along edges; Cut and Boundary have one. Those of a tube each go around a disk that it takes away.
  std::array<std::vector<int>, 2> loops;
  double length = 0;  // of the loop; of a tube, the mean of its two
  LoopKind loop_kind = LoopKind::Handle;
};

// A surface with all of its events closed, K^0, and what it takes to open each.
//
// Points of `closed`: those of the input that are left, in its order, then the second copies of those along cuts, event by event, then those inside
// caps and tubes, event by event. Faces: those of the input that are left, in its order, then those of caps and tubes, event by event, a cut's first
// side first.
struct SurfaceSeries {
  TriangleSurface input;   // K^J
  TriangleSurface closed;  // K^0. source_face: the input's, and -1 for faces of caps and tubes
  // Per point of `closed`: the point of the input, -1 for one inside a cap or tube. Two points of one origin: the two sides of a cut.
  std::vector<int> point_origin;
  std::vector<int> face_origin;        // per face of `closed`: the face of the input, -1 for a cap's or tube's
  std::vector<int> face_event;         // per face of `closed`: -1, or the event whose cap or tube it is
  std::vector<signed char> face_side;  // per face of `closed`: which of a cut's two caps, else 0. Cap 0 joins the faces left of the loop
  // As given, but that boundary loops have the direction of their half-edges, and tubes' loops have the faces that stay at their left.
  std::vector<TopologyEvent> events;
  std::vector<std::array<std::vector<int>, 2>> half_edges;  // per event: of the input, those along its loops
  // Per event: the faces of the input that a tube takes away, at either end, ascending; empty for others.
  std::vector<std::array<std::vector<int>, 2>> hidden;
  std::vector<std::array<RimPatch, 2>> patches;  // per event: its caps or tube
};

// A version K^j of the surface: some events are open.
struct OpenedSurface {
  TriangleSurface surface;
  // Per face, one number over all versions: that of `closed`, or, for a face that a tube hides there, the number of faces of `closed` plus its place
  // in `hidden`, event by event, end by end.
  std::vector<int> faces;
  std::vector<int> point_origin;  // per point: of the input, or -1
  std::vector<int> of_closed;     // per point of `closed`: the point here, -1 where it is gone. The two points across a cut that is open are one
};

// Closes all events. Throws Error{InvalidInput} that names the event if a loop is no simple cycle of edges, a cut meets a boundary, a boundary's loop
// is none, a tube's loop bounds no disk, or two events meet: no point is on the loops or in the hidden disks of both.
SurfaceSeries close_topology(const TriangleSurface& surface, std::vector<TopologyEvent> events);

// `open` has a value an event. With all of them open it is the input, point for point and face for face; with none, `closed`.
OpenedSurface open_topology(const SurfaceSeries& series, const std::vector<bool>& open);

}  // namespace hybrid_mesh
