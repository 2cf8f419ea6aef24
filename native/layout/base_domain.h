// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "base/context.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

struct BaseDomainOptions {
  double size = 300;                // of the base domain: its quads, plus `boundary_side` for each side on the surface's boundary
  double boundary_side = 0;
  std::uint64_t seed = 1;
};

// Cuts a surface into quadrilateral patches, by decimating it to the base domain and pulling the base's edges back. The size is not exceeded unless the surface's topology asks for more.
// `surface` is scaled to a unit bounding-box diagonal. Any genus, components, boundary loops.
PatchedSurface make_base_domain(const TriangleSurface& surface, const BaseDomainOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
