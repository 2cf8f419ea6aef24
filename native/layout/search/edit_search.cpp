// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/edit_search.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/found.h"
#include "base/parallel.h"
#include "parameterization/initial_map.h"

namespace hybrid_mesh {
namespace {

class EditSearch {
 public:
  EditSearch(const TrialMap& map, const EditSearchOptions& options) : map_(map), options_(options) {}

  std::vector<LayoutEdit> run(const Progress& progress) const {
    const PatchedSurface& s = map_.mapped().surface;
    std::vector<EditCandidate> candidates =
        find_edit_candidates(s, map_.energy(), options_.candidates, [&](const PatchRegion& region) { return tower_height(surface_of(s, region)); });
    parallel_for_each_index(static_cast<std::int64_t>(candidates.size()), [&](std::int64_t i) {
      progress.check();
      candidates[i].gain = measure_gain(candidates[i], progress.part(0, 0));
    });
    std::vector<LayoutEdit> edits;
    for (EditCandidate& c : choose_edits(s, std::move(candidates), options_.candidates)) edits.push_back(std::move(c.edit));
    return edits;
  }

 private:
  // How much energy the edit saves in the region and its surroundings, once they have relaxed within their rim.
  double measure_gain(const EditCandidate& candidate, const Progress& progress) const {
    const std::vector<int> patches = with_surroundings(map_.mapped().surface, candidate.region);
    double before = 0;
    for (const int q : patches) before += map_.energy()[q];
    MappedSurface local;
    PatchedPart part = part_of(map_.mapped().surface, patches);
    local.surface = std::move(part.surface);
    for (const int f : part.face) local.corners.push_back(map_.mapped().corners[f]);
    // The region's patches come first in the part.
    LayoutEdit edit = candidate.edit;
    for (std::size_t k = 0; k < edit.patches.size(); ++k) edit.patches[k] = static_cast<int>(k);
    for (PatchSide& start : edit.starts)
      start.patch =
          static_cast<int>(std::find(candidate.edit.patches.begin(), candidate.edit.patches.end(), start.patch) - candidate.edit.patches.begin());
    const Found<double> after = found([&] {
      const std::vector<int> fresh = apply_edit(local, edit).added;
      map_patches(local.surface, fresh, local.corners, progress);
      ChartMesh charts(local.surface, local.corners);
      charts.scale = map_.scale();
      double area = 0;
      for (int f = 0; f < charts.mesh.face_count; ++f) area += charts.flat(f).area;
      GlobalMapOptions options = options_.map;
      options.newton_steps = 3;
      options.cone_rounds = 1;
      options.corners_move = false;  // the rim is held
      options.sweeps = 1;
      const GlobalMapReport report = smooth_map(charts, local.surface, options, progress);
      return (report.energy - 1) * area;
    });
    return after ? before - *after : -std::numeric_limits<double>::max();
  }

  const TrialMap& map_;
  const EditSearchOptions& options_;
};

}  // namespace

std::vector<LayoutEdit> find_edits(const TrialMap& map, const EditSearchOptions& options, const Progress& progress) {
  return EditSearch(map, options).run(progress);
}

}  // namespace hybrid_mesh
