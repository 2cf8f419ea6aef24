// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base_map.h"

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <utility>

#include "parameterization/initial_map.h"

namespace hybrid_mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double area_of(const TriangleSurface& surface) {
  double area = 0;
  for (const auto& f : surface.faces) area += 0.5 * (surface.points[f[1]] - surface.points[f[0]]).cross(surface.points[f[2]] - surface.points[f[0]]).norm();
  return area;
}

// From the coarse surface's charts to the surface's.
BaseMap carry(const TriangleSurface& surface, const CutSurface& cut, PatchedSurface layout, ChartMesh& coarse, const GlobalMapOptions& options, const Progress& progress) {
  std::vector<int> vertex_of = uncut_map(coarse, layout, options, progress.part(0, 0.1));
  for (int& v : vertex_of)
    if (v >= 0) v = cut.vertex[v];
  BaseMap out{std::move(layout), ChartMesh(coarse, cut.collapsed, surface.points, area_of(surface), vertex_of)};
  carry_map(out.charts, cut.log, options, progress.part(0.1, 1));
  out.layout.mesh = surface;
  out.layout.patch.clear();
  out.layout.source.clear();
  for (std::size_t f = 0; f < surface.faces.size(); ++f) out.layout.mesh.source_face[f] = static_cast<int>(f);
  for (std::size_t v = 0; v < surface.points.size(); ++v) out.layout.source.push_back({{static_cast<int>(v), -1, -1}, {1, 0, 0}});
  return out;
}

// The map of a cut surface without any search, its layout edited as was found elsewhere. Where a vertex of the collapse hierarchy finds no place, a flatter
// hierarchy is tried, at last none: slower, but nothing can fail.
ChartMesh smooth_edited(PatchedSurface& surface, const std::vector<LayoutEdit>& edits, GlobalMapOptions options, const Progress& progress) {
  MappedSurface mapped{std::move(surface), {}};
  mapped.corners.resize(mapped.surface.mesh.faces.size());
  for (const LayoutEdit& edit : edits) apply_edit(mapped, edit);
  const std::vector<std::array<Vec2, 3>> corners = map_patches(mapped.surface, progress.part(0, 0.2));
  surface = std::move(mapped.surface);
  for (const double vertices_a_quad : {30.0, 90.0, kInfinity}) {
    ChartMesh charts(surface, corners);
    options.vertices_a_quad = vertices_a_quad;
    try {
      smooth_map(charts, surface, options, progress.part(0.2, 1));
      return charts;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal || vertices_a_quad == kInfinity) throw;
    }
  }
  throw Error(ErrorCode::Internal, "no map of the base was tried");
}

}  // namespace

BaseMap map_to_base(const TriangleSurface& surface, const BaseDomain& base, const LayoutSearchOptions& options, const Progress& progress) {
  std::vector<LayoutEdit> edits;
  bool searched = false;
  // A coarse surface may be too coarse for the map: its triangles would have to bend. Then a finer one is taken, at last the surface itself.
  for (const double vertices_a_quad : {30.0, 60.0, kInfinity}) {
    const double begin = vertices_a_quad == 30 ? 0 : 0.7;
    try {
      CutSurface cut = base.cut(vertices_a_quad, progress.part(begin, begin + 0.05));
      std::optional<ChartMesh> charts;
      if (!searched) {
        LayoutSearchResult found = search_layout(cut.patches, cut.coarse.faces, options, progress.part(begin + 0.05, 0.6));
        edits = std::move(found.edits);
        charts = std::move(found.charts);
        searched = true;
      } else {
        charts = smooth_edited(cut.patches, edits, options.map, progress.part(begin + 0.05, 0.8));
      }
      if (cut.log.empty()) return {std::move(cut.patches), std::move(*charts)};
      return carry(surface, cut, std::move(cut.patches), *charts, options.map, progress.part(0.8, 1));
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal || vertices_a_quad == kInfinity) throw;
    }
  }
  throw Error(ErrorCode::Internal, "no map of the base was tried");
}

}  // namespace hybrid_mesh
