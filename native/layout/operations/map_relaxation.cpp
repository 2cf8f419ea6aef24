// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/map_relaxation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "parameterization/inserted_points.h"
#include "parameterization/patch_extraction.h"

namespace hybrid_mesh {
namespace {

// Has cutting put the point in? `source`: by the points that were glued, and new ones.
bool is_inserted(const GluedMaps& glued, const PointSource& source) {
  const auto first = static_cast<std::size_t>(source.vertices[0]);
  return source.vertices[1] >= 0 || (first < glued.inserted.size() && glued.inserted[first]);
}

// A surface as its own source, point by point and face by face, and where that lies on what the glued maps name.
FaceSources make_own_source(PatchedSurface& surface, const GluedMaps& glued) {
  FaceSources sources;
  for (std::size_t f = 0; f < surface.mesh.faces.size(); ++f) {
    const int named = surface.mesh.source_face[f];
    std::array<double, 9> part;
    for (int i = 0; i < 3; ++i) {
      const std::array<double, 3> w = weights_in_face(surface.source[surface.mesh.faces[f][i]], glued.faces[named]);
      std::copy(w.begin(), w.end(), part.begin() + 3 * i);
    }
    sources.face.push_back(glued.on.face[named]);
    sources.weights.push_back(glued.on.traced(named, part));
    surface.mesh.source_face[f] = static_cast<int>(f);
  }
  for (std::size_t v = 0; v < surface.source.size(); ++v) surface.source[v] = {{static_cast<int>(v), -1, -1}, {1, 0, 0}};
  return sources;
}

// A map's vertices are those of the faces that it names, or have been put in now. `inserted`: of those of the faces.
void mark_inserted(PatchMap& map, const std::vector<std::array<int, 3>>& faces, const std::vector<char>& inserted) {
  map.inserted.assign(map.uv.size(), 1);
  for (std::size_t t = 0; t < map.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        if (map.source[t][3 * i + k] == 1) map.inserted[map.triangles[t][i]] = inserted[faces[map.source_face[t]][k]];
}

}  // namespace

double unit_quad_scale(const LevelState& state, const QuadGraph& quads) {
  return state.placement.diagonal * std::sqrt(static_cast<double>(quads.patch_count()) / state.area);
}

RelaxedMaps relaxed_maps(const MappedSurface& part, const std::vector<int>& patches, const QuadGraph& level, const std::vector<int>& numbers,
                         double scale, const GluedMaps& glued, GlobalMapOptions options, const Progress& progress) {
  PatchedPart smoothed = part_of(part.surface, patches);
  PatchedSurface& surface = smoothed.surface;
  std::vector<std::array<Vec2, 3>> corners;
  for (const int f : smoothed.face) corners.push_back(part.corners[f]);
  for (const PointSource& source : surface.source) surface.inserted.push_back(is_inserted(glued, source));
  FaceSources sources = make_own_source(surface, glued);
  ChartMesh charts(surface, corners);
  charts.scale = scale;
  charts.held.resize(charts.points.size(), 0);
  for (std::size_t k = 0; k < patches.size(); ++k)
    for (int i = 0; i < 4; ++i)
      if (surface.neighbours[k][i].patch < 0 && level.neighbours[numbers[k]][i].patch >= 0)
        for (const int v : surface.sides[k][i]) charts.kind[v] = ChartMesh::Kind::Pinned, charts.held[v] = 1;
  double area = 0;
  for (int f = 0; f < charts.mesh.face_count; ++f) area += charts.flat(f).area;
  merge_inserted(charts, surface.inserted, sources);
  RelaxedMaps out;
  out.energy = (smooth_map_surely(charts, surface, options, progress.part(0, 0.6)).energy - 1) * area;
  merge_inserted(charts, surface.inserted, sources);
  std::vector<std::array<int, 3>> faces(surface.mesh.faces.size());
  for (std::size_t h = 0; h < charts.mesh.origin.size(); ++h) faces[h / 3][h % 3] = charts.mesh.origin[h];
  out.maps = extract_patch_maps(charts, surface, faces, progress.part(0.6, 1));
  for (PatchMap& map : out.maps) {
    if (const char* defect = find_map_defect(map); *defect) throw NoMap(std::string("the map of a quad of the region: ") + defect);
    mark_inserted(map, faces, surface.inserted);
    sources.trace(map);
  }
  return out;
}

}  // namespace hybrid_mesh
