// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/.
#pragma once

#include <vector>

#include "decoder/reader/stream_content.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// What a writer knows: everything to the last plane, from the points of the final mesh, one for each vertex of the geometry's last mesh. Adds the
// geometry's layouts. Throws Error{Unsupported} if numbers are too large for a stream.
StreamContent analyse(StreamGeometry& geometry, const std::vector<Vec3>& points);

}  // namespace hybrid_mesh
