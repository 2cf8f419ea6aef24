// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/.
#pragma once

#include <memory>
#include <vector>

#include "codec/base_points.h"
#include "codec/plane_coder.h"
#include "codec/structure_coder.h"
#include "wavelets/wavelet_step.h"

namespace hybrid_mesh {

// Where the stream's coordinates have their origin and how long their unit is: few bits say it.
struct StreamPlacement {
  int mantissa = 128, exponent = -7;            // unit: mantissa * 2^exponent; mantissa in [128, 255]
  std::array<std::int64_t, 3> origin{0, 0, 0};  // in 1/16 of the unit

  double unit() const;
  Vec3 inward(const Vec3& point) const;  // to the stream's coordinates
  Vec3 outward(const Vec3& point) const;
};

// A hierarchy with what its transform goes by. The same for all prefixes of a stream.
struct StreamGeometry {
  HybridMesh mesh;
  std::vector<WaveletStep> steps;  // to level 1, 2, ...
  std::vector<CoefficientLayout> layouts;
};

// How far a stream is known.
struct StreamContent {
  StreamPlacement placement;
  std::vector<char> remainders;  // of each level: are there any?
  BasePoints base;
  int rough_bits = 0;  // of the base, before any details
  std::vector<Coefficients> levels;
};

// The last plane that is coded of level j of `depth`: then a coefficient is known to about 2^-26 units.
int last_plane(int depth, int level);
inline constexpr int base_bits = 26;

// Codes everything in the order of the stream. `given`: writers' hierarchy; `all`: what they know of it, once analyse() below has made it.
class StreamCoder {
 public:
  explicit StreamCoder(BitCoder& coder, const HybridMesh* given = nullptr) : coder_(coder), structure_(coder, given) {}
  // In this order.
  HybridMesh code_structure() { return structure_.code(); }
  VertexId given_vertex(VertexId vertex) const { return structure_.given_vertex(vertex); }
  void code_head(int depth, StreamContent& known, const StreamContent* all);
  void code_base(const StreamGeometry& geometry, StreamContent& known, const StreamContent* all);
  void code_planes(const StreamGeometry& geometry, StreamContent& known, const StreamContent* all);

 private:
  BitCoder& coder_;
  StructureCoder structure_;
};

// Steps and layouts of a hierarchy.
std::shared_ptr<StreamGeometry> stream_geometry(HybridMesh mesh);
void add_layouts(StreamGeometry& geometry, const std::vector<char>& remainders);

// Writers: everything to the last plane, from the points of the final mesh. Adds the layouts.
StreamContent analyse(StreamGeometry& geometry, const std::vector<Vec3>& points);
// The points of all levels, in the placement's units.
std::vector<std::vector<Vec3>> synthesise(const StreamGeometry& geometry, const StreamContent& content);

}  // namespace hybrid_mesh
