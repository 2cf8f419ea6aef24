// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// A point of the surface that the mesh is to come close to, and a face of the mesh near it.
struct FitSample {
  Vec3 position, normal;
  double weight = 1;  // the area it stands for, in any unit
  int face = 0;
};

struct FitOptions {
  int rounds = 4;                   // each finds closest points anew
  double tangential = 0.01;         // weight of the distance along the surface against that along its normal
  double smoothness = 0.03;         // weight of the Laplacian's tangential part, which keeps quads from folding
  double square_smoothness = 0.03;  // the same where quads are square: less lets their vertices slide to where the surface bends
  double poor = 0.3, square = 0.9;  // scaled Jacobians: of quads that need all of the smoothness, of those that count as square
  int iterations = 60;              // of conjugate gradients a round, at most
};

// Moves the vertices of a polygon mesh so that the weighted mean squared distance of the samples to it becomes least. Vertices with `fixed` set stay.
// Samples' faces are updated to those that hold their closest points. `share` is the part of the surface that each vertex is meant to stand for, in
// any unit (a quad's parameter area): the regulariser counts as much there; empty means equal shares. Based on: Hoppe, DeRose, Duchamp, McDonald,
// Stuetzle, Mesh optimization, 1993 (alternating projection and least squares). Where the mesh has sharp sides, no round folds a face: what would,
// goes back part of its way.
void fit_mesh(QuadMesh& mesh, const std::vector<char>& fixed, const std::vector<double>& share, std::vector<FitSample>& samples,
              const FitOptions& options, const Progress& progress);

// The point of a mesh that is closest to a sample: on a triangle between three of its vertices.
struct FitAnchor {
  std::array<int, 3> vertices;
  std::array<double, 3> weights;  // barycentric
  double squared_distance = 0;
};

// Of every sample, by walking from its face; updates the faces.
std::vector<FitAnchor> closest_anchors(const QuadMesh& mesh, std::vector<FitSample>& samples);

// Squared distance of every sample to the mesh, by walking from its face; updates the faces.
std::vector<double> squared_distances(const QuadMesh& mesh, std::vector<FitSample>& samples);

// Vertices on the mesh's boundary.
std::vector<char> boundary_vertices(const QuadMesh& mesh);
// Vertices on curves, which the maps hold there: the boundary and features.
std::vector<char> held_vertices(const QuadMesh& mesh);

}  // namespace hybrid_mesh
