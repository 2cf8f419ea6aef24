// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

namespace hybrid_mesh::tolerance {

// A triangle is degenerate if its height is below this multiple of its largest coordinate: the rounding of its corners alone may have given
// it the area it has. The same for a shape wherever it stands and however large it is, as far as the numbers can hold it.
inline constexpr double degenerate_height = 4 * std::numeric_limits<double>::epsilon();

// The normals of some faces, weighted by area, cancel each other out if their sum is below this fraction of the sum of their lengths: rounding alone
// may then have given it its direction.
inline constexpr double cancelled_normals = 1e-12;

// Points on a surface of unit size that are nearer to each other are the same place.
inline constexpr double same_place = 1e-9;

}  // namespace hybrid_mesh::tolerance
