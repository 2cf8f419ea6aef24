// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/carried_map.h"

#include <utility>

#include "parameterization/patch_extraction.h"

namespace hybrid_mesh {
namespace {

std::vector<std::array<int, 3>> faces_of(const EditMesh& mesh) {
  std::vector<std::array<int, 3>> faces(mesh.alive.size());
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = {mesh.origin[3 * f], mesh.origin[3 * f + 1], mesh.origin[3 * f + 2]};
  return faces;
}

PatchedSurface by_surface(PatchedSurface patches, const CutSurface& cut) {
  for (int& f : patches.mesh.source_face) f = cut.coarse.source_face[f];
  for (PointSource& s : patches.source)
    for (int& v : s.vertices)
      if (v >= 0) v = cut.vertex[v];
  return patches;
}

}  // namespace

CarriedMap::CarriedMap(const TriangleSurface& surface, CutSurface cut)
    : layout(by_surface(std::move(cut.patches), cut)),
      surface_(&surface),
      collapsed_(std::move(cut.collapsed)),
      log_(std::move(cut.log)),
      sharp_(std::move(cut.sharp)),
      faces_(faces_of(collapsed_)) {
  layout.mesh.sizes = surface.sizes;
}

void CarriedMap::replace(PatchedSurface cut_layout, ChartMesh cut_charts) {
  layout = std::move(cut_layout);
  charts = std::move(cut_charts);
}

void CarriedMap::carry(const GlobalMapOptions& options, const Progress& progress) {
  if (log_.empty()) return;
  {
    const std::vector<int> vertex_of = uncut_map(charts, layout, options, progress.part(0, 0.1));
    charts = ChartMesh(charts, std::move(collapsed_), *surface_, vertex_of, std::move(sharp_));
  }
  layout.mesh = {};
  layout.patch = {};
  layout.sides = {};
  layout.source = {};
  faces_ = {};
  carry_map(charts, std::move(log_), options, progress.part(0.1, 1));
  log_.clear();
  charts.forget_flat();
}

MappedSurface CarriedMap::cut(const Progress& progress) const {
  MappedSurface mapped = glue_patch_maps(extract_patch_maps(charts, layout, faces_, progress), layout, faces_);
  mapped.surface.mesh.sizes = surface_->sizes;
  return mapped;
}

}  // namespace hybrid_mesh
