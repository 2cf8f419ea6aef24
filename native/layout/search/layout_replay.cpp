// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/layout_replay.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "layout/operations/region_outline.h"
#include "layout/regions/region_pattern.h"
#include "layout/search/even_regions.h"

namespace hybrid_mesh {
namespace {

// The region of an edit. Throws Error{Internal} for one that is none of this layout's: a script may have been made for another one.
PatchRegion fitting_region(const QuadGraph& s, const LayoutEdit& edit) {
  const auto fails = [] [[noreturn]] { throw NoMap("an edit does not fit its layout"); };
  const bool known = std::all_of(edit.patches.begin(), edit.patches.end(), [&](int q) { return q >= 0 && q < s.patch_count(); });
  if (!known || edit.starts.empty()) fails();
  std::optional<PatchRegion> region = make_region(s, edit.patches, edit.starts, FreeLoops::Open);
  if (!region || region->rim_count() != static_cast<int>(edit.starts.size())) fails();
  const int corners = static_cast<int>(region->corners.size());
  if (!find_filling_defect(edit.quads, *region).empty()) fails();
  int nodes = corners;
  for (const auto& quad : edit.quads) nodes = std::max(nodes, *std::max_element(quad.begin(), quad.end()) + 1);
  if (nodes - corners != edit.inner_nodes || edit.rings < 0 || static_cast<std::int64_t>(corners) * edit.rings > edit.inner_nodes) fails();
  return std::move(*region);
}

// A region's even quads, along the same lines if this is the surface that they were found on; else along their outline, or, without one, where the
// map puts them.
DrawnEdit even_again(const MappedSurface& mapped, const LayoutScript::Edit& even, const Progress& progress) {
  const PatchRegion region = fitting_region(mapped.surface, even.edit);
  std::optional<DrawnEdit> found =
      even.even_quads > 0 ? even_edit(mapped.surface, region, surface_of(mapped.surface, region), even.even_quads, 1, progress) : std::nullopt;
  if (found && found->edit.quads == even.edit.quads) return std::move(*found);
  DrawnEdit edit{even.edit, {}};
  if (!even.outline.nodes.empty()) edit.piece = lay_out_region(surface_of(mapped.surface, region), even.outline, progress);
  return edit;
}

void repeat_round(TrialMap& map, const std::vector<LayoutScript::Edit>& round, const GlobalMapOptions& options, const Progress& progress) {
  map.begin(options.theta, progress);
  if (round.front().even) {
    std::vector<DrawnEdit> drawn;
    for (const LayoutScript::Edit& even : round) drawn.push_back(even_again(map.mapped(), even, progress));
    apply_drawn_edits(map, std::move(drawn), options, progress);
  } else {
    std::vector<LayoutEdit> edits;
    for (const LayoutScript::Edit& of : round) {
      fitting_region(map.mapped().surface, of.edit);
      edits.push_back(of.edit);
    }
    apply_edits(map, edits, options, progress);
  }
  map.keep();
}

}  // namespace

MappedLayouts replay_layout(CarriedMap map, const LayoutScript& script, const Progress& progress) {
  if (script.levels.empty()) throw Error(ErrorCode::Internal, "a script has no level");
  std::vector<LevelVersion> versions(script.levels.size());
  for (std::size_t i = 0; i < versions.size(); ++i) {
    versions[i].vertices = script.levels[i].vertices;
    if (script.levels[i].vertices_a_quad > 0) versions[i].map.vertices_a_quad = script.levels[i].vertices_a_quad;
  }
  const LevelWork repeat = [&](TrialMap& trial, std::size_t level, const Progress& part) {
    for (const std::vector<LayoutScript::Edit>& round : rounds_of(script.levels[level])) repeat_round(trial, round, versions[level].map, part);
    return script.levels[level].edits;
  };
  return map_levels(std::move(map), versions, repeat, progress);
}

}  // namespace hybrid_mesh
