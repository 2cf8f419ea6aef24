// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/region_repatch.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "layout/drawn/face_filling.h"
#include "layout/operations/map_relaxation.h"
#include "layout/operations/region_exchange.h"
#include "layout/operations/region_outline.h"
#include "layout/operations/region_uncutting.h"
#include "layout/regions/disk_drawing.h"
#include "layout/regions/patch_sets.h"
#include "layout/regions/piece_drawing.h"
#include "layout/regions/region_layout.h"
#include "layout/regions/region_pattern.h"
#include "layout/regions/ring_drawing.h"
#include "parameterization/global_map.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_energy.h"
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

// A region within the part of the level that is worked on, whose first patches it is.
struct LocalRegion {
  const QuadGraph& level;
  const QuadGraph& graph;  // of the part
  PatchRegion in_level;    // by the level's numbers
  PatchRegion in_part;     // the same by those of the part: corner k is corner k
};

// An edit of the region by the part's numbers, by the level's; and back.
LayoutEdit in_level(LayoutEdit edit, const LocalRegion& region) {
  edit.patches = region.in_level.patches;
  edit.starts = region.in_level.starts();
  return edit;
}
LayoutEdit in_part(LayoutEdit edit, const LocalRegion& region) {
  edit.patches = region.in_part.patches;
  edit.starts = region.in_part.starts();
  return edit;
}

// The curves as an edit of the region, by the part's numbers.
DrawnEdit draw(const RegionSurface& surface, const LocalRegion& local, std::vector<DrawnStroke> strokes, const Progress& progress) {
  const PatchRegion& region = local.in_part;
  const TriangleSurface& disk = surface.mesh;
  DrawnLayoutOptions options;
  for (std::size_t k = 0; k < surface.sides.size(); ++k) options.boundary_nodes.push_back(surface.corner(static_cast<int>(k)));
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
  const FaceFillingOptions filling{regular_quads(local.level, local.in_level), joined_outside(local.level, local.in_level)};
  DrawnEdit out{edit_of(region), {}};
  out.piece = fill_faces(drawn, filling, progress);
  if (!drawn.problems.empty()) throw LayoutError(std::move(drawn.problems));
  out.edit.inner_nodes = out.piece.node_count - corners;
  out.edit.quads = out.piece.nodes;
  return out;
}

// Rows of quads for an annulus. Where its boundaries are joined with the fewest sides may leave no room: then there are more rows.
LayoutEdit rows_in(const RegionSurface& surface, const LocalRegion& local, int height, std::vector<int>& spoke, const Progress& progress) {
  constexpr int tries = 3;
  if (!is_annulus(local.in_level)) throw Error(ErrorCode::InvalidInput, "rows need a region that is a ring, with two boundaries and no handle");
  const RowsPlace place = place_rows(surface, local.in_part);
  const int least = height > 0 ? height : place.rows;
  for (int more = 0;; ++more) {
    LayoutEdit edit = rows_edit(local.level, local.in_level, least + more, place.shift, spoke, progress);
    const bool last = height > 0 || more + 1 == tries;
    if (last || (find_filling_defect(edit.quads, local.in_level).empty() && find_edit_defect(local.level, local.in_level, edit).empty())) return edit;
  }
}

// Those that it is known to have become, on another surface along their outline.
std::optional<DrawnEdit> even_in(const RegionSurface& surface, const LocalRegion& local, const RegionPattern& pattern, const Progress& progress) {
  const bool known = !pattern.outline.quads.empty();
  if (known && pattern.even_quads == 0) return std::nullopt;
  const int wanted = pattern.even_quads > 0 ? pattern.even_quads : static_cast<int>(local.in_part.patches.size());
  std::string defect = "no even quads with its boundary are found: try another number of them, or a larger region";
  constexpr std::uint64_t tries = 4;
  for (std::uint64_t seed = 1; seed <= tries; ++seed) {
    std::optional<DrawnEdit> drawn = even_edit(local.graph, local.in_part, surface, wanted, seed, progress);
    if (!drawn) continue;
    defect = find_edit_defect(local.level, local.in_level, in_level(drawn->edit, local));
    if (!defect.empty()) continue;
    if (!known || drawn->edit.quads == pattern.outline.quads) return drawn;
    break;
  }
  if (!known) throw Error(ErrorCode::InvalidInput, defect);
  return std::nullopt;
}

// The region cut along an edit's quads: along their outline where that is known, else drawn in its disks and rings. `spoke`: see rows_edit(); empty
// for other edits. `surface` may get further points.
PatchedSurface lay_out(RegionSurface& surface, const PatchRegion& region, const LayoutEdit& edit, const LayoutOutline& known, std::vector<int> spoke,
                       const Progress& progress) {
  if (known.nodes.empty() && region.is_disk()) return draw_quads(surface, edit);
  if (known.nodes.empty() && is_annulus(region)) {
    if (spoke.empty()) spoke = find_spoke(edit.quads, static_cast<int>(region.corners.size()), region.rims[1]);
    return draw_ring(surface, edit, spoke);
  }
  if (known.nodes.empty() && has_drawable_pieces(region)) return draw_pieces(surface, region, edit);
  PatchedSurface piece = lay_out_region(surface, known.nodes.empty() ? spread_outline(surface, edit) : known, progress);
  if (piece.patch.empty()) throw NoMap("there is no way to lay out its new quads");
  return piece;
}

// New quads that need no curves, by the part's numbers. `surface` may get further points.
DrawnEdit find_edit(RegionSurface& surface, const LocalRegion& local, const RegionPattern& pattern, const Progress& progress) {
  using Kind = RegionPattern::Kind;
  const QuadGraph& level = local.level;
  const PatchRegion& region = local.in_level;
  Kind kind = pattern.kind;
  // Rows between rims of different numbers of sides would be cut open somewhere, and are seldom even.
  const bool disks = std::all_of(region.pieces.begin(), region.pieces.end(),
                                 [](const RegionPiece& p) { return p.euler == 1 && p.rims.size() == 1 && p.open_loops == 0; });
  if (kind == Kind::Automatic && !disks) kind = has_rings(region) ? Kind::Rows : Kind::Even;
  if (kind == Kind::Even)
    if (std::optional<DrawnEdit> even = even_in(surface, local, pattern, progress)) return std::move(*even);
  LayoutEdit edit;
  std::vector<int> spoke;  // of a ring
  if (kind == Kind::Automatic) {
    edit = automatic_edit(level, region, progress);
  } else if (kind == Kind::Template || kind == Kind::Even) {
    edit = template_edit(region, kind == Kind::Even ? pattern.outline.quads : pattern.quads);
  } else if (kind == Kind::Rows) {
    edit = rows_in(surface, local, pattern.height, spoke, progress);
  } else {
    if (!region.is_disk()) throw Error(ErrorCode::InvalidInput, "cubes are grown on a disk of quads alone");
    edit = tower_edit(level, region, pattern.height > 0 ? pattern.height : std::max(1, tower_height(surface)));
  }
  if (const std::string defect = find_filling_defect(edit.quads, region); !defect.empty())
    throw Error(ErrorCode::InvalidInput, "its new quads " + defect);
  if (const std::string defect = find_edit_defect(level, region, edit); !defect.empty()) throw Error(ErrorCode::InvalidInput, defect);
  DrawnEdit out{in_part(std::move(edit), local), {}};
  out.piece = lay_out(surface, region, out.edit, pattern.outline, std::move(spoke), progress);
  return out;
}

// Which loops an edit of this pattern may lay out anew.
FreeLoops loops_of(const RegionRepatch& repatch) {
  const bool open =
      repatch.pattern.kind == RegionPattern::Kind::Rows || (repatch.pattern.kind == RegionPattern::Kind::Template && !repatch.starts.empty());
  return open ? FreeLoops::Open : FreeLoops::Rims;
}

// The given quads, and after them those in so many rings around.
std::vector<int> with_rings(const QuadGraph& level, const std::vector<int>& patches, int rings) {
  PatchSet in(level.patch_count(), 0);
  for (const int q : patches) in[q] = 1;
  PatchSet wide = in;
  for (int ring = 0; ring < rings; ++ring) wide = dilated(level, wide);
  std::vector<int> out = patches;
  for (int q = 0; q < level.patch_count(); ++q)
    if (wide[q] && !in[q]) out.push_back(q);
  return out;
}

// Has events of the level's surface open in the region, which gets the pieces that it has then.
void open_events(const LevelState& state, const std::vector<int>& events, LocalRegion& region, RegionSurface& surface, GluedMaps& glued) {
  if (events.empty()) return;
  for (const int e : events)
    if (e < 0 || e >= static_cast<int>(state.surface.open.size()) || state.surface.open[e])
      throw Error(ErrorCode::InvalidInput, "event " + std::to_string(e) + " of the topology cannot open: it is open, or there is none");
  surface = exchanged(surface, *state.surface.series, events, state.placement, glued);
  region.in_part.pieces = region.in_level.pieces = pieces_of(surface, region.in_part);
}

MappedEdit repatch_in_unit_size(const LevelState& state, const RegionRepatch& repatch, const Progress& progress) {
  const QuadGraph& level = state.quads;
  const FreeLoops loops = loops_of(repatch);
  std::optional<PatchRegion> region = make_region(level, repatch.patches, repatch.starts, loops);
  if (!region)
    throw Error(ErrorCode::InvalidInput,
                "the quads of a region must have a boundary that does not touch itself, and each of its starts must be on a part of it of its own");
  // One ring at least: sides that the new quads share with it follow its map.
  const std::vector<int> quads = with_rings(level, repatch.patches, std::max(1, repatch.buffer_rings));
  FaceSources roots;
  std::vector<PatchMap> maps = maps_of(state, quads, roots);
  for (PatchMap& map : maps)
    for (Vec3& p : map.positions) p = state.placement.to_unit(p);
  GluedMaps glued = glue_patch_maps(maps, part_of(level, quads));
  glued.mapped.surface.mesh.sizes = state.sizes;
  MappedSurface part = glued.mapped;
  progress(0.2);

  // The region's quads are the part's first.
  LocalRegion local{level, glued.mapped.surface, std::move(*region), {}};
  std::vector<int> first(repatch.patches.size());
  std::iota(first.begin(), first.end(), 0);
  std::vector<PatchSide> starts = local.in_level.starts();
  for (PatchSide& start : starts) start.patch = static_cast<int>(std::find(quads.begin(), quads.end(), start.patch) - quads.begin());
  local.in_part = *make_region(part.surface, first, starts, loops);
  RegionSurface surface = uncut_region(surface_of(part.surface, local.in_part), glued);
  roots.trace(glued.on);
  open_events(state, repatch.opens, local, surface, glued);
  surface.mesh.sizes = state.sizes;

  MappedEdit out;
  out.opens = repatch.opens;
  const std::vector<double> energies = patch_energies(part, unit_quad_scale(state, level), GlobalMapOptions().theta);
  for (std::size_t k = 0; k < energies.size(); ++k)
    if (repatch.buffer_rings > 0 || k < repatch.patches.size()) out.energy_before += energies[k];
  RegionPattern pattern = repatch.pattern;
  move_pattern(pattern, [&](const Vec3& p) { return state.placement.to_unit(p); });
  DrawnEdit edit = pattern.kind == RegionPattern::Kind::Drawn ? draw(surface, local, std::move(pattern.strokes), progress.part(0.2, 0.4))
                                                              : find_edit(surface, local, pattern, progress.part(0.2, 0.4));
  out.edit = in_level(edit.edit, local);
  if (pattern.kind == RegionPattern::Kind::Even) {
    out.outline = outline_of(edit, local.in_part);
    move_outline(out.outline, [&](const Vec3& p) { return state.placement.from_unit(p); });
  }
  const LayoutChange change = apply_edit(part, std::move(edit), std::move(surface));
  map_patches(part.surface, change.added, part.corners, progress.part(0.4, 0.5));

  // The numbers that the part's quads have in the level afterwards.
  QuadGraph after = level;
  const LayoutChange in_level = change_layout(after, out.edit);
  std::vector<int> number(part.surface.patch_count(), -1);
  for (std::size_t k = 0; k < quads.size(); ++k)
    if (change.patch[k] >= 0) number[change.patch[k]] = in_level.patch[quads[k]];
  for (std::size_t k = 0; k < change.added.size(); ++k) number[change.added[k]] = in_level.added[k];

  std::vector<int> relaxed = change.added;
  if (repatch.buffer_rings > 0) {
    relaxed.resize(number.size());
    std::iota(relaxed.begin(), relaxed.end(), 0);
  }
  std::vector<int> numbers;  // of these in the level
  for (const int k : relaxed) numbers.push_back(number[k]);
  // Even ones are what it is relaxed to.
  RelaxedMaps fresh = relaxed_maps(part, relaxed, after, numbers, unit_quad_scale(state, after), glued, repatch.map, progress.part(0.5, 1));
  out.energy_after = fresh.energy;
  for (std::size_t k = 0; k < relaxed.size(); ++k) {
    for (Vec3& p : fresh.maps[k].positions) p = state.placement.from_unit(p);
    out.maps.push_back({numbers[k], std::move(fresh.maps[k])});
  }
  return out;
}

}  // namespace

void move_pattern(RegionPattern& pattern, const PointMove& move) {
  for (DrawnStroke& s : pattern.strokes)
    for (Vec3& p : s.points) p = move(p);
  move_outline(pattern.outline, move);
}

MappedEdit repatch_region(const LevelState& state, const RegionRepatch& region, const Progress& progress) {
  try {
    return repatch_in_unit_size(state, region, progress);
  } catch (LayoutError& e) {
    for (LayoutProblem& p : e.problems)
      for (Vec3& w : p.where) w = state.placement.from_unit(w);
    throw;
  }
}

}  // namespace hybrid_mesh
