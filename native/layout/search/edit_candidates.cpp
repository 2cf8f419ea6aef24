// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/edit_candidates.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "parameterization/initial_map.h"

namespace hybrid_mesh {
namespace {

struct Candidate {
  PatchRegion region;
  LayoutEdit edit;
  int irregular = 0;  // further irregular nodes
  double excess = 0;  // energy of the region's patches beyond an isometry's
  double gain = 0;    // energy that the edit saves
};

class EditSearch {
 public:
  EditSearch(const TrialMap& map, const EditSearchOptions& options) : map_(map), options_(options) {}

  std::vector<LayoutEdit> run(const Progress& progress) const {
    std::vector<Candidate> candidates = find_candidates();
    tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
      progress.check();
      candidates[i].gain = measure_gain(candidates[i], progress.part(0, 0));
    });
    return choose_best(candidates);
  }

 private:
  std::vector<Candidate> find_candidates() const {
    const PatchedSurface& s = map_.mapped().surface;
    const std::vector<int> valence = node_valences(s);
    const std::vector<char> on_boundary = boundary_nodes(s);
    std::vector<std::vector<int>> around(s.node_count);
    for (int q = 0; q < s.patch_count(); ++q)
      for (const int n : s.nodes[q]) around[n].push_back(q);
    // Two nodes are joined by one side at most, or the base's quads would be no manifold mesh.
    std::set<std::pair<int, int>> joined;
    for (const auto& nodes : s.nodes)
      for (int i = 0; i < 4; ++i) joined.insert(std::minmax(nodes[i], nodes[(i + 1) % 4]));
    std::vector<Candidate> found;
    const auto add = [&](const PatchRegion& region, const LayoutEdit& edit) {
      const std::optional<int> irregular = irregular_growth(s, region, edit, valence, on_boundary);
      if (!irregular) return;
      Candidate c{region, edit};
      c.irregular = *irregular;
      for (const int q : region.patches) c.excess += map_.energy()[q];
      if (c.excess < options_.threshold * static_cast<double>(region.patches.size())) return;
      found.push_back(std::move(c));
    };
    const bool room = s.patch_count() < options_.most;
    const auto add_ring = [&](const std::vector<int>& patches) {
      if (!room) return;
      if (const auto region = make_region(s, patches))
        if (const LayoutEdit edit = tower_edit(s, *region, 1); s.patch_count() + edit.growth() <= options_.most) add(*region, edit);
    };
    for (int q = 0; q < s.patch_count(); ++q) {
      add_ring({q});
      for (int i = 0; i < 4; ++i) {
        const PatchSide other = s.neighbours[q][i];
        if (other.patch <= q) continue;
        add_ring({q, other.patch});
        if (const auto region = make_region(s, {q, other.patch}); region && region->corners.size() == 6) {
          // Corner `now` is where the side between them starts today.
          const int now = static_cast<int>(std::find(region->corners.begin(), region->corners.end(), s.nodes[q][i]) - region->corners.begin());
          for (const int from : {(now + 1) % 3, (now + 2) % 3})
            if (!joined.count(std::minmax(region->corners[from], region->corners[from + 3]))) add(*region, chord_edit(*region, from));
        }
      }
    }
    for (int n = 0; n < s.node_count; ++n) {
      if (on_boundary[n]) continue;
      std::vector<int> patches = around[n];
      std::sort(patches.begin(), patches.end());
      if (std::unique(patches.begin(), patches.end()) != patches.end()) continue;
      add_ring(patches);
      if (const auto region = make_region(s, patches); region && region->inner_nodes.size() == 1) {
        // The corner that the node is joined to now has an even or odd place; the other parity turns the star.
        int parity = 0;
        for (std::size_t k = 0; k < region->corners.size(); ++k) {
          const PatchSide& side = region->boundary[k];
          if (s.nodes[side.patch][(side.side + 3) % 4] == n) parity = static_cast<int>(k % 2);
        }
        add(*region, star_edit(*region, 1 - parity));
      }
    }
    std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
      const double x = a.excess / (a.region.patches.size() + a.edit.growth()), y = b.excess / (b.region.patches.size() + b.edit.growth());
      return x != y ? x > y : a.region.patches < b.region.patches;
    });
    if (static_cast<int>(found.size()) > options_.trials) found.resize(options_.trials);
    for (std::size_t i = 0, n = found.size(); i < n; ++i) {
      if (found[i].edit.rings == 0) continue;
      const int height = std::min(8, tower_height(s, found[i].region));
      if (height < 2) continue;
      Candidate tall = found[i];
      tall.edit = tower_edit(s, tall.region, height);
      if (s.patch_count() + tall.edit.growth() > options_.most) continue;
      found.push_back(std::move(tall));
    }
    return found;
  }

  // The region's patches, then those that share a node with it.
  std::vector<int> with_surroundings(const PatchRegion& region) const {
    const PatchedSurface& s = map_.mapped().surface;
    std::vector<char> in_region(s.patch_count(), 0), node(s.node_count, 0);
    for (const int q : region.patches) {
      in_region[q] = 1;
      for (const int n : s.nodes[q]) node[n] = 1;
    }
    std::vector<int> patches = region.patches;
    for (int q = 0; q < s.patch_count(); ++q)
      if (!in_region[q] && std::any_of(s.nodes[q].begin(), s.nodes[q].end(), [&](int n) { return node[n]; })) patches.push_back(q);
    return patches;
  }

  // How much energy the edit saves in the region and its surroundings, once they have relaxed within their rim.
  double measure_gain(const Candidate& candidate, const Progress& progress) const {
    const std::vector<int> patches = with_surroundings(candidate.region);
    double before = 0;
    for (const int q : patches) before += map_.energy()[q];
    MappedSurface local;
    PatchedPart part = part_of(map_.mapped().surface, patches);
    local.surface = std::move(part.surface);
    for (const int f : part.face) local.corners.push_back(map_.mapped().corners[f]);
    // The region's patches come first in the part.
    LayoutEdit edit = candidate.edit;
    for (std::size_t k = 0; k < edit.patches.size(); ++k) edit.patches[k] = static_cast<int>(k);
    for (std::size_t k = 0; k < candidate.edit.patches.size(); ++k)
      if (candidate.edit.patches[k] == candidate.edit.start.patch) edit.start.patch = static_cast<int>(k);
    try {
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
      return before - (report.energy - 1) * area;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal) throw;
      return -1e300;
    }
  }

  std::vector<LayoutEdit> choose_best(std::vector<Candidate>& candidates) const {
    std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) { return worth(a) > worth(b); });
    const PatchedSurface& s = map_.mapped().surface;
    std::vector<char> touched(s.patch_count(), 0);
    std::vector<LayoutEdit> chosen;
    int size = s.patch_count();
    for (const Candidate& c : candidates) {
      if (worth(c) <= 0.05) break;
      if (size + c.edit.growth() > options_.most) continue;
      const std::vector<int> patches = with_surroundings(c.region);
      if (std::any_of(patches.begin(), patches.end(), [&](int q) { return touched[q]; })) continue;
      for (const int q : patches) touched[q] = 1;
      size += c.edit.growth();
      chosen.push_back(c.edit);
    }
    return chosen;
  }

  double worth(const Candidate& c) const { return c.gain - options_.price * c.edit.growth() - options_.irregular_price * c.irregular; }

  const TrialMap& map_;
  const EditSearchOptions& options_;
};

}  // namespace

std::vector<LayoutEdit> find_edits(const TrialMap& map, const EditSearchOptions& options, const Progress& progress) {
  return EditSearch(map, options).run(progress);
}

}  // namespace hybrid_mesh
