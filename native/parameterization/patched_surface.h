// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parameterization/quad_graph.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A point of the repaired surface as a combination of one, two or three of its points (the corners of a face); unused ones are -1 with weight 0.
struct PointSource {
  std::array<int, 3> vertices{-1, -1, -1};
  std::array<double, 3> weights{0, 0, 0};
};

// Weights of `source` for the corners of a face that holds it.
inline std::array<double, 3> weights_in_face(const PointSource& source, const std::array<int, 3>& face) {
  std::array<double, 3> w{0, 0, 0};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (source.vertices[k] == face[i] && face[i] >= 0) w[i] += source.weights[k];
  return w;
}

// A weighted sum of points that lie on one face. Weights add up to 1.
PointSource combine(const std::array<const PointSource*, 3>& points, const std::array<double, 3>& weights);
// Half-way between two points that lie on one face.
PointSource middle_of(const PointSource& a, const PointSource& b);

// Splits the two faces beside inner half-edge h by a point in its middle. Two faces are appended, first the one beside h; their neighbours are left
// to the caller.
void split_inner_edge(TriangleSurface& mesh, std::vector<PointSource>& source, int h);

// A surface cut into disk-shaped quadrilateral patches along its own edges. It covers the repaired surface exactly: each face lies on one face of
// that.
struct PatchedSurface : QuadGraph {
  TriangleSurface mesh;                                // source_face: face of the repaired surface
  std::vector<PointSource> source;                     // per point
  std::vector<char> inserted;                          // per point: has an earlier cut put it in, see PatchMap? Empty: none has
  std::vector<int> patch;                              // per face
  std::vector<std::array<std::vector<int>, 4>> sides;  // per patch and side: the points along it, both ends included
  std::vector<std::array<char, 4>> sharp;              // per patch and side: does it run along a feature, as all of that curve does? Empty: none does
  std::vector<char> sharp_corner;                      // per point, later ones left out: a corner of features

  const QuadGraph& graph() const { return *this; }
};

// A part of a patched surface made of some of its patches. Patches are numbered in the order given; points and nodes where the part merely touches
// itself are doubled.
struct PatchedPart {
  PatchedSurface surface;
  std::vector<int> face;   // per face: that of the whole
  std::vector<int> point;  // per point
  std::vector<int> node;   // per node
};
PatchedPart part_of(const PatchedSurface& surface, const std::vector<int>& patches);

}  // namespace hybrid_mesh
