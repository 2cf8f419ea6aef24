// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "decoder/planes/base_points.h"
#include "decoder/planes/plane_coder.h"

namespace hybrid_mesh {

// Where the stream's coordinates have their origin and how long their unit is: few bits say it.
struct StreamPlacement {
  int mantissa = 128, exponent = -7;            // unit: mantissa * 2^exponent; mantissa in [128, 255]
  std::array<std::int64_t, 3> origin{0, 0, 0};  // in 1/16 of the unit

  double unit() const;
  Point3 inward(const Point3& point) const;  // to the stream's coordinates
};

// A hierarchy with what its transform goes by. The same for all prefixes of a stream.
struct StreamGeometry {
  QuadForest forest;                              // if it is plain, the base alone
  bool is_plain = false;                          // all quads are refined down to the depth, and there are no operations
  std::vector<LevelMesh> meshes;                  // of levels 0, 1, ...
  std::vector<std::unique_ptr<LevelStep>> steps;  // to level 1, 2, ...
  std::vector<CoefficientLayout> layouts;

  int depth() const { return static_cast<int>(steps.size()); }
};

// The hierarchy's forest, whole.
QuadForest whole_forest(const StreamGeometry& geometry);

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
// Of the bits of the base's coordinates, as many as the details' steps make worth while.
int bits_at(int plane, int depth);

// Meshes and steps of plain levels from a base.
std::shared_ptr<StreamGeometry> plain_geometry(QuadForest base, int depth);
// Meshes and steps of a hierarchy; layouts by add_layouts(), as it takes `remainders` of a content for these.
std::shared_ptr<StreamGeometry> stream_geometry(QuadForest forest);
void add_layouts(StreamGeometry& geometry, const std::vector<char>& remainders);

// Level 0, in the stream's coordinates.
std::vector<Point3> base_points(const StreamContent& content);
// Level j + 1 from level j, by the step to it.
std::vector<Point3> next_points(const StreamGeometry& geometry, const StreamContent& content, int j, const std::vector<Point3>& points);
// From there to where the surface stands. Throws Error{CorruptStream} for points farther away than numbers go.
void place_points(const StreamPlacement& placement, std::vector<Point3>& points);

}  // namespace hybrid_mesh
