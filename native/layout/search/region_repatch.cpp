// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/region_repatch.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "layout/drawn/face_filling.h"
#include "layout/regions/patch_sets.h"
#include "layout/regions/region_pattern.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_extraction.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {
namespace {

constexpr double kReach = 0.5;        // of the region's diagonal
constexpr double kCornerReach = 0.4;  // of the mean length of the region's boundary sides
constexpr double kSnap = 0.25;        // of the same: curves may run along the rim half a quad away from it

double diagonal_of(const TriangleSurface& mesh) {
  Vec3 low = mesh.points.front(), high = low;
  for (const Vec3& p : mesh.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

double mean_side(const std::vector<Vec3>& corners) {
  double length = 0;
  for (std::size_t k = 0; k < corners.size(); ++k)
    length += (corners[(k + 1) % corners.size()] - corners[k]).norm() / static_cast<double>(corners.size());
  return length;
}

// Ends that are meant to be at corners of the region: those of a level lie off the surface, and curves are drawn to them.
void snap_to_corners(std::vector<DrawnStroke>& strokes, const std::vector<Vec3>& corners) {
  const double length = mean_side(corners);
  for (DrawnStroke& s : strokes) {
    if (s.points.size() < 2) continue;
    for (Vec3* end : {&s.points.front(), &s.points.back()}) {
      const Vec3 p = *end;
      const auto nearest = std::min_element(corners.begin(), corners.end(),
                                            [&](const Vec3& a, const Vec3& b) { return (a - p).squaredNorm() < (b - p).squaredNorm(); });
      if ((*nearest - p).norm() < kCornerReach * length) *end = *nearest;
    }
  }
}

// The curves as an edit of the region.
DrawnEdit draw(const PatchedSurface& surface, const PatchRegion& region, std::vector<DrawnStroke> strokes, const Progress& progress) {
  const PatchedPart part = part_of(surface, region.patches);
  const TriangleSurface& disk = part.surface.mesh;
  DrawnLayoutOptions options;
  for (const PatchSide& s : region.boundary) {
    const auto local = std::find(region.patches.begin(), region.patches.end(), s.patch) - region.patches.begin();
    options.boundary_nodes.push_back(part.surface.sides[local][s.side].front());
  }
  std::vector<Vec3> corner;
  for (const int v : options.boundary_nodes) corner.push_back(disk.points[v]);
  snap_to_corners(strokes, corner);
  // What is near is so by the size of the whole surface, as far as the region has room for it.
  options.snap = std::clamp(std::min(DrawnLayoutOptions().snap, kSnap * mean_side(corner)) / std::max(diagonal_of(disk), 1e-9), 0.02, 0.12);
  // Curves are drawn on a level, which is the farther from the surface the coarser it is.
  options.reach = kReach;
  DrawnLayout drawn = make_layout(disk, strokes, options, progress);
  // The corners are the layout's first nodes, in their order: nodes have the numbers that an edit gives them.
  const int corners = static_cast<int>(region.corners.size());
  const FaceFillingOptions filling{regular_quads(surface, region), joined_outside(surface, region)};
  DrawnEdit out;
  out.piece = fill_faces(drawn, filling, progress);
  if (!drawn.problems.empty()) throw LayoutError(std::move(drawn.problems));
  out.edit.patches = region.patches;
  out.edit.start = region.boundary[0];
  out.edit.inner_nodes = out.piece.node_count - corners;
  out.edit.quads = out.piece.nodes;
  return out;
}

// New quads that need no curves.
LayoutEdit find_edit(const PatchedSurface& surface, const PatchRegion& region, const RegionPattern& pattern, const Progress& progress) {
  LayoutEdit edit;
  if (pattern.kind == RegionPattern::Kind::Automatic) {
    edit = automatic_edit(surface, region, progress);
  } else if (pattern.kind == RegionPattern::Kind::Template) {
    edit = template_edit(region, pattern.quads);
  } else {
    edit = tower_edit(surface, region, pattern.height > 0 ? pattern.height : std::max(1, tower_height(surface, region)));
  }
  if (const std::string defect = find_edit_defect(surface, region, edit); !defect.empty()) throw Error(ErrorCode::InvalidInput, defect);
  return edit;
}

// A level whose map was glued of patches has vertices along all their sides. They stay there: moved off and cut again, each operation would leave
// slivers beside the lines, thinner every time.
ChartMesh held_on_lines(ChartMesh charts) {
  const auto on_line = [](double x) { return x == std::round(x); };
  for (std::size_t v = 0; v < charts.uv.size(); ++v)
    if (charts.movable(static_cast<int>(v)) && (on_line(charts.uv[v].real()) || on_line(charts.uv[v].imag())))
      charts.kind[v] = ChartMesh::Kind::Pinned;
  return charts;
}

// The given patches and so many rings around them.
std::vector<int> with_rings(const PatchedSurface& s, const std::vector<int>& patches, int rings) {
  PatchSet in(s.patch_count(), 0);
  for (const int q : patches) in[q] = 1;
  for (int ring = 0; ring < rings; ++ring) in = dilated(s, in);
  std::vector<int> out;
  for (int q = 0; q < s.patch_count(); ++q)
    if (in[q]) out.push_back(q);
  return out;
}

}  // namespace

LayoutEdit repatch_region(const TriangleSurface& surface, LevelMap& map, const RegionRepatch& repatch, const Progress& progress) {
  ChartMesh rounded = held_on_lines(map.charts);
  std::vector<PatchMap> maps = extract_patch_maps(rounded, map.layout, surface.faces, progress.part(0, 0.2));
  MappedSurface mapped = glue_patch_maps(maps, map.layout, surface.faces);
  const std::optional<PatchRegion> region = make_region(mapped.surface, repatch.patches, repatch.start);
  if (!region)
    throw Error(ErrorCode::InvalidInput, "the quads of a region must form a disk whose boundary does not touch itself, and its start must be on it");
  LayoutEdit made;
  LayoutChange change;
  if (repatch.pattern.kind == RegionPattern::Kind::Drawn) {
    DrawnEdit edit = draw(mapped.surface, *region, repatch.pattern.strokes, progress.part(0.2, 0.4));
    made = edit.edit;
    change = apply_edit(mapped, std::move(edit));
  } else {
    made = find_edit(mapped.surface, *region, repatch.pattern, progress);
    change = apply_edit(mapped, made);
  }
  map_patches(mapped.surface, change.added, mapped.corners, progress.part(0.4, 0.5));

  // Relaxed with the rim held, so that the maps around it still fit.
  const std::vector<int> relaxed = with_rings(mapped.surface, change.added, repatch.buffer_rings);
  const PatchedPart part = part_of(mapped.surface, relaxed);
  std::vector<std::array<Vec2, 3>> corners;
  for (const int f : part.face) corners.push_back(mapped.corners[f]);
  ChartMesh charts(part.surface, corners);
  charts.scale = map.charts.scale;
  connect_half_edges(mapped.surface.mesh);
  for (int f = 0; f < static_cast<int>(part.face.size()); ++f)
    for (int i = 0; i < 3; ++i)
      if (part.surface.mesh.opposite[3 * f + i] < 0 && mapped.surface.mesh.opposite[3 * part.face[f] + i] >= 0)
        for (const int v : {part.surface.mesh.faces[f][i], part.surface.mesh.faces[f][(i + 1) % 3]}) charts.kind[v] = ChartMesh::Kind::Pinned;
  GlobalMapOptions options;
  options.corners_move = false;  // ends of the rim are among them
  smooth_map(charts, part.surface, options, progress.part(0.5, 0.8));

  std::vector<PatchMap> fresh(mapped.surface.patch_count());
  std::vector<char> changed(fresh.size(), 0);
  for (std::size_t q = 0; q < maps.size(); ++q)
    if (change.patch[q] >= 0) {
      fresh[change.patch[q]] = std::move(maps[q]);
      changed[change.patch[q]] = map.changed.empty() ? 1 : map.changed[q];
    }
  std::vector<PatchMap> local = extract_patch_maps(charts, part.surface, surface.faces, progress.part(0.8, 1));
  for (std::size_t k = 0; k < relaxed.size(); ++k) {
    fresh[relaxed[k]] = std::move(local[k]);
    changed[relaxed[k]] = 1;
  }
  MappedSurface glued = glue_patch_maps(fresh, mapped.surface, surface.faces);
  map.charts = ChartMesh(glued.surface, glued.corners);
  map.layout = std::move(glued.surface);
  map.changed = std::move(changed);
  return made;
}

}  // namespace hybrid_mesh
