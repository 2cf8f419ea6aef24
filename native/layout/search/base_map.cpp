// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/base_map.h"

#include <limits>
#include <numeric>
#include <utility>

#include "layout/search/layout_replay.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where a vertex of the collapse hierarchy finds no place, a flatter hierarchy is tried, at last none: slower, but nothing can fail.
ChartMesh smooth(const MappedSurface& mapped, GlobalMapOptions options, const Progress& progress) {
  for (const double vertices_a_quad : {30.0, 90.0, kInfinity}) {
    ChartMesh charts(mapped.surface, mapped.corners);
    options.vertices_a_quad = vertices_a_quad;
    try {
      smooth_map(charts, mapped.surface, options, progress);
      return charts;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal || vertices_a_quad == kInfinity) throw;
    }
  }
  throw Error(ErrorCode::Internal, "no map of the base was tried");
}

// A base's layout that was found elsewhere, made anew on another version of the surface.
MappedLayouts repeat_base(CarriedMap map, const LayoutScript::Level& base, const GlobalMapOptions& options, const Progress& progress) {
  MappedSurface mapped{std::move(map.layout), {}};
  mapped.corners.resize(mapped.surface.mesh.faces.size());
  for (const LayoutScript::Edit& of : base.edits) apply_edit(mapped, of.edit);
  mapped.corners = map_patches(mapped.surface, progress.part(0, 0.2));
  map.charts = smooth(mapped, options, progress.part(0.2, 1));
  map.layout = std::move(mapped.surface);
  MappedLayouts result;
  result.script.levels.push_back(base);
  result.stages.push_back({0, std::move(map)});
  return result;
}

BaseMap carried(MappedLayouts found, const GlobalMapOptions& options, const Progress& progress) {
  BaseMap out;
  for (MappedLayouts::Stage& stage : found.stages) {
    stage.map.carry(kInfinity, options, progress);
    out.levels.push_back({stage.level, std::move(stage.map.layout), std::move(stage.map.charts)});
  }
  out.script = std::move(found.script);
  return out;
}

// A coarse surface may be too coarse for the map: its triangles would have to bend. Then a finer one is taken, at last the surface itself. Where skin
// is to be grown (`finer`), a base of more quads serves better: that is left to the caller.
template <class Find>
BaseMap map_coarse_to_fine(const TriangleSurface& surface, const BaseDomain& base, double vertices, bool finer, const GlobalMapOptions& options,
                           const Progress& progress, const Find& find) {
  LayoutScript script;  // what was found on a coarser surface
  for (const double factor : {1.0, 2.0, kInfinity}) {
    const double begin = factor == 1 ? 0 : 0.7;
    try {
      CarriedMap map(surface, base.cut(factor * vertices / base.quads(), progress.part(begin, begin + 0.05)));
      const Progress part = progress.part(begin + 0.05, begin == 0 ? 0.6 : 0.8);
      MappedLayouts found = script.levels.empty() ? find(std::move(map), part) : repeat_base(std::move(map), script.levels[0], options, part);
      script = found.script;
      return carried(std::move(found), options, progress.part(0.8, 1));
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal || factor == kInfinity || finer) throw;
    }
  }
  throw Error(ErrorCode::Internal, "no map of the base was tried");
}

}  // namespace

BaseMap map_to_base(const TriangleSurface& surface, const BaseDomain& base, const LayoutSearchOptions& options, const Progress& progress) {
  return map_coarse_to_fine(surface, base, options.levels[0].vertices, options.levels.size() > 1, options.levels[0].map, progress,
                            [&](CarriedMap map, const Progress& part) { return search_layout(std::move(map), options, part); });
}

BaseMap map_to_base(const TriangleSurface& surface, const BaseDomain& base, const LayoutScript& script, const Progress& progress) {
  GlobalMapOptions options;
  options.vertices_a_quad = script.levels.front().vertices_a_quad;
  return map_coarse_to_fine(surface, base, script.levels.front().vertices, false, options, progress,
                            [&](CarriedMap map, const Progress& part) { return replay_layout(std::move(map), script, part); });
}

BaseMap map_to_base(const TriangleSurface& surface, PatchedSurface base, const LayoutScript& script, const Progress& progress) {
  CutSurface cut;
  cut.coarse = surface;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) cut.coarse.source_face[f] = static_cast<int>(f);
  cut.collapsed = EditMesh(surface);
  cut.vertex.resize(surface.points.size());
  std::iota(cut.vertex.begin(), cut.vertex.end(), 0);
  cut.patches = std::move(base);
  return carried(replay_layout(CarriedMap(surface, std::move(cut)), script, progress), GlobalMapOptions(), progress);
}

}  // namespace hybrid_mesh
