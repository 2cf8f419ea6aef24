// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "decoder/transform/harmonic_extension.h"
#include "decoder/transform/level_prediction.h"
#include "decoder/transform/wavelet_columns.h"

namespace hybrid_mesh {

enum class DetailKind : char {
  Edge,      // a wavelet coefficient, of a side's midpoint
  Face,      // the same, of a quad's centre
  Inserted,  // of an operation
  Closing    // of the closure of leaves with hanging nodes
};
struct DetailVertex {
  int vertex = -1;  // of the fine mesh
  DetailKind kind = DetailKind::Edge;
};

// Synthesis of the wavelet transform, one step N^{j-1} -> N^j: x_j = S x_{j-1} + W d. S is Catmull-Clark subdivision, W its quadrature mirror.
// Vertices and their order are those of the two levels' meshes. What is not refined stays where it is; what the closure of leaves makes is stored
// relative to the mean of its edge's ends or leaf's corners; what operations make, relative to the harmonic extension of their boundaries.
class LevelStep {
 public:
  LevelStep(const QuadForest& forest, const MeshNames& coarse, const MeshNames& fine, int level, BoundaryRule boundary);

  // To level `level` of plain levels (PlainLevels): `quads` of the coarse one, `rows` as refine() gives them.
  LevelStep(LevelQuads quads, std::vector<int> rows, int level);

  const LevelPrediction& prediction() const { return prediction_; }
  const std::vector<DetailVertex>& details() const { return details_; }  // in the order of the fine mesh's vertices
  const std::vector<int>& detail_of() const { return detail_of_; }       // #rows: -1
  WaveletColumns columns() const { return WaveletColumns(prediction_.rows(), inside_); }
  const std::vector<char>& inside() const { return inside_; }  // far_inside() of the coarse quads
  // Of the operations' vertices; nothing if there are none.
  const std::optional<HarmonicExtension>& extension() const { return extension_; }

  // Whether the fine mesh is the children of the coarse one's quads and nothing else.
  bool is_regular() const { return is_regular_; }

  // Where subdivision alone puts the fine vertices.
  void subdivided(const Point3* coarse, Point3* fine) const;
  // Details, and a remainder for each vertex unless it is null, added to that.
  void add_details(Point3* fine, const Point3* details, const Point3* remainder) const;
  // Puts the operations' vertices in the harmonic extension of the others.
  void extend(Point3* points) const;

 private:
  void find_details();
  void find_operations(const QuadForest& forest, const MeshNames& fine, int level);

  LevelPrediction prediction_;
  std::vector<char> inside_;
  std::vector<DetailVertex> details_;
  std::vector<int> detail_of_;
  bool is_regular_ = false;
  std::optional<HarmonicExtension> extension_;
};

}  // namespace hybrid_mesh
