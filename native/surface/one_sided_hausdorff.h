// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "surface/closest_point.h"

namespace hybrid_mesh {

struct SurfaceFaces {
  const std::vector<Vec3>& points;
  const std::vector<std::array<int, 3>>& faces;  // triangles, or edges {a, b, b}
  const std::vector<char>& rim;                  // of each face: 0 if an even number of faces meets at each of its edges; empty if not known
};

struct HausdorffOptions {
  double known = 0;                  // a distance that is reached elsewhere: only larger ones are looked for
  Vec3 known_at = Vec3::Zero();      // by that point
  double tolerance = 0.01;           // relative
  double least_tolerance = 1e-9;     // absolute
  std::int64_t most_splits = 50000;  // of faces and parts of faces
};

struct HausdorffBounds {
  double reached = 0;      // `known`, or the distance of some point of `from`
  Vec3 at = Vec3::Zero();  // that point
  double at_most = 0;      // no point of `from` is farther away; within the tolerance of `reached` unless the splits ran out
};

// The largest distance of a point of `from` to `to`, for which `query` stands. In parallel; the result does not depend on the number of
// threads.
HausdorffBounds one_sided_hausdorff(const SurfaceFaces& from, const SurfaceFaces& to, const SurfaceDistanceQuery& query,
                                    const HausdorffOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
