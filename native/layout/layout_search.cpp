// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/layout_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "parameterization/global_map.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_extraction.h"

namespace hybrid_mesh {
namespace {

struct Candidate {
  PatchRegion region;
  LayoutEdit edit;
  int irregular = 0;  // further irregular nodes
  double excess = 0;  // energy of the region's patches beyond an isometry's
  double gain = 0;    // energy that the edit saves
};

class LayoutSearch {
 public:
  LayoutSearch(PatchedSurface& surface, const std::vector<std::array<int, 3>>& faces, const LayoutSearchOptions& options)
      : faces_(faces), options_(options), mapped_{std::move(surface), {}} {}

  LayoutSearchResult run(PatchedSurface& surface, const Progress& progress) {
    mapped_.corners = map_patches(mapped_.surface, progress.part(0, 0.05));
    std::optional<ChartMesh> best;
    std::vector<LayoutEdit> best_edits;
    double least = 0;
    for (int round = 0;; ++round) {
      const Progress part = progress.part(0.05 + 0.95 * round / (options_.rounds + 1), 0.05 + 0.95 * (round + 1) / (options_.rounds + 1));
      try {
        GlobalMapOptions map = options_.map;
        // Most of the map is as it was the round before.
        if (round > 0) map.newton_steps /= 2, map.cone_rounds /= 2;
        ChartMesh charts(mapped_.surface, mapped_.corners);
        const GlobalMapReport report = smooth_map(charts, mapped_.surface, map, part.part(0, 0.4));
        const double excess = (report.energy - 1) * mapped_.surface.patch_count();
        if (best && !(excess < least)) break;
        least = excess;
        surface = mapped_.surface;
        best_edits = edits_;
        best = charts;
        if (round == options_.rounds) break;
        glue(charts, part.part(0.4, 0.5));
        std::vector<Candidate> candidates = find_candidates();
        tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
          part.check();
          candidates[i].gain = measure_gain(candidates[i], part.part(0.5, 0.5));
        });
        if (!apply_best(candidates, part)) break;
      } catch (const Error& e) {
        // What was found before stays.
        if (e.code() != ErrorCode::Internal || !best) throw;
        break;
      }
      part(1);
    }
    return {std::move(*best), std::move(best_edits)};
  }

 private:
  void glue(ChartMesh& charts, const Progress& progress) {
    scale_ = charts.scale;
    mapped_ = glue_patch_maps(extract_patch_maps(charts, mapped_.surface, faces_, progress), mapped_.surface, faces_);
    energy_.assign(mapped_.surface.patch_count(), 0);
    const Distortion density{options_.map.theta};
    for (int f = 0; f < static_cast<int>(mapped_.surface.patch.size()); ++f) energy_[mapped_.surface.patch[f]] += face_excess(f, density);
  }

  // Of one face: its energy less its area. A face is a piece of one on which the map is linear, and slivers count for as little as they cover.
  double face_excess(int f, const Distortion& density) const {
    const std::array<int, 3>& c = mapped_.surface.mesh.faces[f];
    const std::vector<Vec3>& p = mapped_.surface.mesh.points;
    const Vec3 e1 = scale_ * (p[c[1]] - p[c[0]]), e2 = scale_ * (p[c[2]] - p[c[0]]);
    const double l = e1.norm(), twice_area = e1.cross(e2).norm();
    if (!(l > 0 && twice_area > 1e-12)) return 0;
    const double x = e1.dot(e2) / l, y = twice_area / l;
    const std::array<Vec2, 3>& uv = mapped_.corners[f];
    const Vec2 du = (uv[1] - uv[0]) / l, dv = (uv[2] - uv[0] - x * du) / y;
    const Complex a = 0.5 * Complex(du.x() + dv.y(), du.y() - dv.x()), b = 0.5 * Complex(du.x() - dv.y(), du.y() + dv.x());
    const double s = std::norm(a), t = std::norm(b);
    return 0.5 * twice_area * ((s > t ? std::min(density.value(s, t), 100.0) : 100.0) - 1);
  }

  std::vector<Candidate> find_candidates() const {
    const PatchedSurface& s = mapped_.surface;
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
      for (const int q : region.patches) c.excess += energy_[q];
      found.push_back(std::move(c));
    };
    const bool room = s.patch_count() < options_.quads;
    const auto add_ring = [&](const std::vector<int>& patches) {
      if (!room) return;
      if (const auto region = make_region(s, patches))
        if (const auto edit = ring_edit(s, *region))
          if (s.patch_count() + edit->growth() <= options_.quads) add(*region, *edit);
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
    return found;
  }

  // The region's patches, then those that share a node with it.
  std::vector<int> with_surroundings(const PatchRegion& region) const {
    const PatchedSurface& s = mapped_.surface;
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
    for (const int q : patches) before += energy_[q];
    MappedSurface local;
    PatchedPart part = part_of(mapped_.surface, patches);
    local.surface = std::move(part.surface);
    for (const int f : part.face) local.corners.push_back(mapped_.corners[f]);
    // The region's patches come first in the part.
    LayoutEdit edit = candidate.edit;
    for (std::size_t k = 0; k < edit.patches.size(); ++k) edit.patches[k] = static_cast<int>(k);
    for (std::size_t k = 0; k < candidate.edit.patches.size(); ++k)
      if (candidate.edit.patches[k] == candidate.edit.start.patch) edit.start.patch = static_cast<int>(k);
    try {
      const std::vector<int> fresh = apply_edit(local, edit);
      map_patches(local.surface, fresh, local.corners, progress);
      ChartMesh charts(local.surface, local.corners);
      charts.scale = scale_;
      double area = 0;
      for (int f = 0; f < charts.mesh.face_count; ++f) area += charts.flat(f).area;
      GlobalMapOptions options = options_.map;
      options.newton_steps = 3;
      options.cone_rounds = 1;
      options.sweeps = 1;
      const GlobalMapReport report = smooth_map(charts, local.surface, options, progress);
      return before - (report.energy - 1) * area;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal) throw;
      return -1e300;
    }
  }

  bool apply_best(std::vector<Candidate>& candidates, const Progress& progress) {
    std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) { return worth(a) > worth(b); });
    const PatchedSurface& s = mapped_.surface;
    std::vector<char> touched(s.patch_count(), 0);
    std::vector<LayoutEdit> chosen;
    int size = s.patch_count();
    for (const Candidate& c : candidates) {
      if (worth(c) <= 0.05) break;
      if (size + c.edit.growth() > options_.quads) continue;
      const std::vector<int> patches = with_surroundings(c.region);
      if (std::any_of(patches.begin(), patches.end(), [&](int q) { return touched[q]; })) continue;
      for (const int q : patches) touched[q] = 1;
      size += c.edit.growth();
      chosen.push_back(c.edit);
    }
    // Edits that do not shrink leave other patches' numbers alone.
    for (const LayoutEdit& edit : chosen) {
      const std::vector<int> fresh = apply_edit(mapped_, edit);
      map_patches(mapped_.surface, fresh, mapped_.corners, progress.part(1, 1));
      edits_.push_back(edit);
    }
    return !chosen.empty();
  }

  double worth(const Candidate& c) const { return c.gain - options_.price * c.edit.growth() - options_.irregular_price * c.irregular; }

  const std::vector<std::array<int, 3>>& faces_;
  const LayoutSearchOptions& options_;
  MappedSurface mapped_;
  double scale_ = 1;
  std::vector<double> energy_;    // per patch, beyond an isometry's
  std::vector<LayoutEdit> edits_;
};

}  // namespace

LayoutSearchResult search_layout(PatchedSurface& surface, const std::vector<std::array<int, 3>>& faces, const LayoutSearchOptions& options, const Progress& progress) {
  return LayoutSearch(surface, faces, options).run(surface, progress);
}

}  // namespace hybrid_mesh
