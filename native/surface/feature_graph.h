// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

struct FeatureOptions {
  double angle = 40;       // degrees between the normals of two faces, from which their edge begins a feature ...
  double weak_angle = 20;  // ... and from which it continues one
  // An edge is crisp if it bends so many times as much as the surface does across the faces beside it: a coarse sphere's edges are not.
  double crispness = 2.5;
  double least_length = 0.03;  // of a curve with a loose end, or closed and alone; below it is no feature. In the surface's unit
  double corner_angle = 40;    // degrees by which a curve turns at a corner
  // Whether a surface has features at all: a scan, or a coarse mesh of a smooth thing, bends everywhere. Length of the edges that bend by the weak
  // angle and are on no curve, at most, by that of the curves (machine parts: up to .07, scans and coarse animals: from .3 on); and the curves'
  // length by the root of the area, at least.
  double most_left = 0.15, least_total = 0.3;
  // Are boundary loops that are straight between corners curves, too? By the same bounds: what they turn, at the weak angle or more, at vertices that
  // are no corners between straight stretches of that least length, and their length.
  bool polygons = true;
};

// The sharp edges of a surface as curves that meet at corners, and what of its boundary is one. Nothing is in the lists where there are none.
struct FeatureGraph {
  std::vector<char> edges;    // per half-edge: its edge is on a curve. A boundary edge has one half-edge, and so one mark
  std::vector<char> corners;  // per point: a curve ends, branches, or turns there, or reaches the boundary

  bool empty() const { return edges.empty(); }
};

// The feature curves of a surface of unit size, by dihedral angle with hysteresis, and its polygonal boundary loops.
// Based on: Hubeli, Gross, Multiresolution feature extraction for unstructured meshes, 2001 (hysteresis on dihedral angles).
FeatureGraph find_features(const TriangleSurface& surface, const FeatureOptions& options);

// Corners of the curves made of the edges given.
FeatureGraph feature_graph(const TriangleSurface& surface, std::vector<char> edges, double corner_angle);

// The same curves, and all of the surface's boundary as curves of the same kind, with corners where it turns by so many degrees.
FeatureGraph with_boundary(const TriangleSurface& surface, const FeatureGraph& graph, double corner_angle);

// Per point the number of its connected set of feature and boundary edges, -1 for others.
std::vector<int> curve_components(const TriangleSurface& surface, const std::vector<char>& feature_edges);

}  // namespace hybrid_mesh
