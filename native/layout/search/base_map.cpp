// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/base_map.h"

#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "layout/regions/region_layout.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPatientVertices = 30;  // a quad: of a flatter hierarchy than where a map could not be carried

// The map of a layout that was found elsewhere, made anew on another version of the surface.
CarriedMap repeat(CarriedMap map, const LayoutScript& script, GlobalMapOptions options, const Progress& progress) {
  options.vertices_a_quad = kPatientVertices;
  MappedSurface mapped{std::move(map.layout), {}};
  mapped.corners.resize(mapped.surface.mesh.faces.size());
  for (const LayoutScript::Edit& of : script.edits) apply_edit(mapped, of.edit);
  mapped.corners = map_patches(mapped.surface, progress.part(0, 0.2));
  ChartMesh charts(mapped.surface, mapped.corners);
  smooth_map_surely(charts, mapped.surface, options, progress.part(0.2, 1));
  map.replace(std::move(mapped.surface), std::move(charts));
  return map;
}

// A coarse surface may be too coarse for a map: its triangles would have to bend. Then a finer one is taken, at last the surface itself: for the
// search, or, where the map that it found cannot be carried to the surface, for that map alone.
template <class Find>
BaseMap map_coarse_to_fine(const TriangleSurface& surface, BaseDomain& base, double vertices, const GlobalMapOptions& options,
                           const Progress& progress, const Find& find) {
  const std::array<double, 3> factors{1, 2, kInfinity};
  const auto version = [&](double factor, const Progress& part) { return CarriedMap(surface, base.cut(factor * vertices / base.quads(), part)); };
  Found<SearchedLayout> searched;
  for (std::size_t k = 0; k < factors.size() && !searched; ++k)
    searched = found([&] { return find(version(factors[k], progress.part(0, 0.05)), progress.part(0.05, 0.6)); });
  if (!searched) throw NoMap(searched.reason);
  const LayoutScript& script = searched->script;
  const auto on_surface = [&](CarriedMap map, const Progress& part) {
    map.carry(options, part);
    return BaseMap{std::move(map.layout), std::move(map.charts), script};
  };
  Found<BaseMap> map = found([&] { return on_surface(std::move(searched->map), progress.part(0.6, 0.7)); });
  for (std::size_t k = 1; k < factors.size() && !map; ++k)
    map = found([&] {
      CarriedMap again = repeat(version(factors[k], progress.part(0.7, 0.75)), script, options, progress.part(0.75, 0.9));
      return on_surface(std::move(again), progress.part(0.9, 1));
    });
  if (!map) throw NoMap(map.reason);
  return std::move(*map);
}

}  // namespace

Found<BaseMap> map_to_base(const TriangleSurface& surface, BaseDomain& base, const LayoutSearchOptions& options, const Progress& progress) {
  return found([&] {
    return map_coarse_to_fine(surface, base, options.vertices, options.map, progress,
                              [&](CarriedMap map, const Progress& part) { return search_layout(std::move(map), options, part); });
  });
}

Found<BaseMap> map_to_base(const TriangleSurface& surface, BaseDomain& base, const LayoutScript& script, const Progress& progress) {
  GlobalMapOptions options;
  options.vertices_a_quad = script.vertices_a_quad;
  return found([&] {
    return map_coarse_to_fine(surface, base, script.vertices, options, progress, [&](CarriedMap map, const Progress& part) {
      return SearchedLayout{replay_layout(std::move(map), script, part), script};
    });
  });
}

Found<BaseMap> map_to_base(const TriangleSurface& surface, PatchedSurface base, const Progress& progress) {
  CutSurface cut;
  cut.coarse = surface;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) cut.coarse.source_face[f] = static_cast<int>(f);
  cut.collapsed = EditMesh(surface);
  cut.vertex.resize(surface.points.size());
  std::iota(cut.vertex.begin(), cut.vertex.end(), 0);
  cut.patches = std::move(base);
  return found([&] {
    CarriedMap map = replay_layout(CarriedMap(surface, std::move(cut)), {}, progress);
    return BaseMap{std::move(map.layout), std::move(map.charts), {}};
  });
}

}  // namespace hybrid_mesh
