// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/base_map.h"

#include <array>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "layout/search/layout_replay.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where a vertex of the collapse hierarchy finds no place, a flatter hierarchy is tried, at last none: slower, but nothing can fail.
ChartMesh smooth(const MappedSurface& mapped, GlobalMapOptions options, const Progress& progress) {
  std::string failure;
  for (const double vertices_a_quad : {30.0, 90.0, kInfinity}) {
    options.vertices_a_quad = vertices_a_quad;
    Found<ChartMesh> smoothed = found([&] {
      ChartMesh charts(mapped.surface, mapped.corners);
      smooth_map(charts, mapped.surface, options, progress);
      return charts;
    });
    if (smoothed) return std::move(*smoothed);
    failure = smoothed.reason;
  }
  throw NoMap(failure);
}

// The map of a base's layout that was found elsewhere, made anew on another version of the surface.
CarriedMap repeat_base(CarriedMap map, const LayoutScript::Level& base, const GlobalMapOptions& options, const Progress& progress) {
  MappedSurface mapped{std::move(map.layout), {}};
  mapped.corners.resize(mapped.surface.mesh.faces.size());
  for (const LayoutScript::Edit& of : base.edits) apply_edit(mapped, of.edit);
  mapped.corners = map_patches(mapped.surface, progress.part(0, 0.2));
  ChartMesh charts = smooth(mapped, options, progress.part(0.2, 1));
  map.replace(std::move(mapped.surface), std::move(charts));
  return map;
}

LevelMap on_surface(int level, CarriedMap map, const GlobalMapOptions& options, const Progress& progress) {
  map.carry(kInfinity, options, progress);
  return {level, std::move(map.layout), std::move(map.charts)};
}

// The map of a stage carried to the surface, unless it is known that it cannot be.
LevelMap on_surface(MappedLayouts::Stage stage, const GlobalMapOptions& options, const Progress& progress) {
  if (!stage.failure.empty()) throw NoMap(stage.failure);
  return on_surface(stage.level, std::move(stage.map), options, progress);
}

// A coarse surface may be too coarse for a map: its triangles would have to bend. Then a finer one is taken, at last the surface itself: for the
// whole search, or, where a base of more quads serves it better (`finer`: skin is to be grown), for the base's own map alone.
template <class Find>
BaseMap map_coarse_to_fine(const TriangleSurface& surface, const BaseDomain& base, double vertices, bool finer, const GlobalMapOptions& options,
                           const Progress& progress, const Find& find) {
  const std::array<double, 3> factors{1, 2, kInfinity};
  const auto version = [&](double factor, const Progress& part) { return CarriedMap(surface, base.cut(factor * vertices / base.quads(), part)); };
  Found<MappedLayouts> layouts;
  for (std::size_t k = 0; k < (finer ? 1 : factors.size()) && !layouts; ++k)
    layouts = found([&] { return find(version(factors[k], progress.part(0, 0.05)), progress.part(0.05, 0.6)); });
  if (!layouts) throw NoMap(layouts.reason);
  BaseMap out;
  for (MappedLayouts::Stage& stage : layouts->stages) {
    const int level = stage.level;
    Found<LevelMap> map = found([&] { return on_surface(std::move(stage), options, progress.part(0.6, 0.7)); });
    for (std::size_t k = 1; k < factors.size() && level == 0 && !map; ++k)
      map = found([&] {
        CarriedMap again = repeat_base(version(factors[k], progress.part(0.7, 0.75)), layouts->script.levels[0], options, progress.part(0.75, 0.9));
        return on_surface(level, std::move(again), options, progress.part(0.9, 1));
      });
    if (!map) throw NoMap(map.reason);
    out.levels.push_back(std::move(*map));
  }
  out.script = std::move(layouts->script);
  return out;
}

}  // namespace

Found<BaseMap> map_to_base(const TriangleSurface& surface, const BaseDomain& base, const LayoutSearchOptions& options, const Progress& progress) {
  return found([&] {
    return map_coarse_to_fine(surface, base, options.levels[0].vertices, options.levels.size() > 1, options.levels[0].map, progress,
                              [&](CarriedMap map, const Progress& part) { return search_layout(std::move(map), options, part); });
  });
}

Found<BaseMap> map_to_base(const TriangleSurface& surface, const BaseDomain& base, const LayoutScript& script, const Progress& progress) {
  GlobalMapOptions options;
  options.vertices_a_quad = script.levels.front().vertices_a_quad;
  return found([&] {
    return map_coarse_to_fine(surface, base, script.levels.front().vertices, script.levels.size() > 1, options, progress,
                              [&](CarriedMap map, const Progress& part) { return replay_layout(std::move(map), script, part); });
  });
}

Found<BaseMap> map_to_base(const TriangleSurface& surface, PatchedSurface base, const LayoutScript& script, const Progress& progress) {
  CutSurface cut;
  cut.coarse = surface;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) cut.coarse.source_face[f] = static_cast<int>(f);
  cut.collapsed = EditMesh(surface);
  cut.vertex.resize(surface.points.size());
  std::iota(cut.vertex.begin(), cut.vertex.end(), 0);
  cut.patches = std::move(base);
  return found([&] {
    MappedLayouts layouts = replay_layout(CarriedMap(surface, std::move(cut)), script, progress);
    BaseMap out;
    for (MappedLayouts::Stage& stage : layouts.stages) out.levels.push_back(on_surface(std::move(stage), GlobalMapOptions(), progress));
    out.script = std::move(layouts.script);
    return out;
  });
}

}  // namespace hybrid_mesh
