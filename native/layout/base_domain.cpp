// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base_domain.h"

#include <algorithm>

#include "layout/curve_network.h"
#include "layout/decimation.h"
#include "layout/quad_layout.h"

namespace hybrid_mesh {

PatchedSurface make_base_domain(const TriangleSurface& surface, const BaseDomainOptions& options, const Progress& progress) {
  EditMesh mesh(surface);
  std::vector<MeshEdit> log;
  DecimationOptions decimation;
  // Room for the clean-up of the quads, which merges some of them.
  decimation.target_faces = std::max(4, static_cast<int>(2.6 * options.size));
  decimation.seed = options.seed;
  std::vector<VertexQuadric> quadrics = decimate(mesh, surface.points, decimation, log, progress.part(0, 0.7));
  QuadLayoutOptions layout_options;
  layout_options.size = options.size;
  layout_options.boundary_side = options.boundary_side;
  layout_options.seed = options.seed;
  const QuadLayout layout = make_quad_layout(mesh, surface.points, std::move(quadrics), layout_options, log, progress.part(0.7, 0.9));
  return cut_along_layout(surface, mesh, log, layout, progress.part(0.9, 1));
}

}  // namespace hybrid_mesh
