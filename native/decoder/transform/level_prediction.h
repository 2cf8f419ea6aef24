// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "decoder/forest/vertex_index.h"
#include "decoder/transform/refined_rows.h"
#include "decoder/transform/subdivision_masks.h"

namespace hybrid_mesh {

// What names the faces and vertices of a mesh taken out of a forest.
struct MeshNames {
  const std::vector<std::int32_t>& node;  // #F
  const std::vector<VertexId>& vertex;    // #V
  template <class Mesh>
  MeshNames(const Mesh& mesh) : node(mesh.node), vertex(mesh.vertex) {}  // NOLINT(google-explicit-constructor): any mesh of that kind
};

// What subdivision alone says of the vertices of M^j or N^j, from the positions of N^{j-1}. An operation's vertices it says nothing of.
class LevelPrediction {
 public:
  // A vertex in the mean of others.
  struct Mean {
    int vertex = -1;
    int count = 0;
    std::array<int, 4> of{-1, -1, -1, -1};
  };

  // `coarse` is the forest's level j - 1, however closed, `mesh` M^j or N^j; the faces under one node follow each other.
  LevelPrediction(const QuadForest& forest, const MeshNames& coarse, const MeshNames& mesh, int level, BoundaryRule boundary);
  // Of plain levels (PlainLevels), all quads of the coarse one being refined: `rows` says which vertex of the fine mesh each row is.
  LevelPrediction(LevelQuads quads, std::vector<int> rows);
  LevelPrediction(const LevelPrediction&) = delete;
  LevelPrediction& operator=(const LevelPrediction&) = delete;

  const LevelQuads& quads() const { return quads_; }  // of level j - 1
  const RefinedRows& rows() const { return rows_; }
  BoundaryRule boundary() const { return boundary_; }
  std::size_t coarse_count() const { return coarse_count_; }
  std::size_t count() const { return count_; }  // of the mesh's vertices

  std::vector<int> vertex_at;             // #rows: vertex of the mesh, -1 if it has it not
  std::vector<std::array<int, 2>> stays;  // vertex of N^{j-1} and of the mesh: not refined
  std::vector<Mean> closing;              // of the mesh: made by the closure of leaves, put in the mean of what they close
  std::vector<int> inserted;              // the mesh's other vertices

  // Of all vertices but the inserted ones, which are in the origin, and the closing ones, which close() puts in their places.
  void regular(const Point3* coarse, Point3* points) const;
  void close(Point3* points) const;

 private:
  LevelQuads quads_;
  RefinedRows rows_;
  BoundaryRule boundary_;
  std::size_t coarse_count_, count_;
};

// Where subdivision puts a vertex that the closure of leaves makes: in the mean of the ends of its edge or the corners of its leaf. Throws
// Error{Internal} if the mesh has them not.
LevelPrediction::Mean vertices_closed(const QuadForest& forest, const VertexIndex& find, VertexId closing, int vertex);
Point3 mean_of(const Point3* points, const LevelPrediction::Mean& mean);

}  // namespace hybrid_mesh
