// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/edit_candidates.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

namespace hybrid_mesh {
namespace {

constexpr int kMostRings = 8;         // of a tower
constexpr double kLeastWorth = 0.05;  // gain less price, in quads, of an edit that is worth doing

double worth(const EditCandidate& c, const EditCandidateOptions& options) {
  return c.gain - options.price * c.edit.growth() - options.irregular_price * c.irregular;
}

}  // namespace

std::vector<EditCandidate> find_edit_candidates(const QuadGraph& s, const std::vector<double>& energy, const EditCandidateOptions& options,
                                                const std::function<int(const PatchRegion&)>& tower_height) {
  const std::vector<int> valence = node_valences(s);
  const std::vector<char> on_boundary = boundary_nodes(s);
  std::vector<std::vector<int>> around(s.node_count);
  for (int q = 0; q < s.patch_count(); ++q)
    for (const int n : s.nodes[q]) around[n].push_back(q);
  // Two nodes are joined by one side at most, or the base's quads would be no manifold mesh.
  std::set<std::pair<int, int>> joined;
  for (const auto& nodes : s.nodes)
    for (int i = 0; i < 4; ++i) joined.insert(std::minmax(nodes[i], nodes[(i + 1) % 4]));
  std::vector<EditCandidate> found;
  const auto add = [&](const PatchRegion& region, const LayoutEdit& edit) {
    const std::optional<int> irregular = irregular_growth(s, region, edit, valence, on_boundary);
    if (!irregular) return;
    EditCandidate c{region, edit};
    c.irregular = *irregular;
    for (const int q : region.patches) c.excess += energy[q];
    if (c.excess < options.threshold * static_cast<double>(region.patches.size())) return;
    found.push_back(std::move(c));
  };
  const bool room = s.patch_count() < options.most;
  const auto add_ring = [&](const std::vector<int>& patches) {
    if (!room) return;
    if (const auto region = make_disk(s, patches))
      if (const LayoutEdit edit = tower_edit(s, *region, 1); s.patch_count() + edit.growth() <= options.most) add(*region, edit);
  };
  for (int q = 0; q < s.patch_count(); ++q) {
    add_ring({q});
    for (int i = 0; i < 4; ++i) {
      const PatchSide other = s.neighbours[q][i];
      if (other.patch <= q) continue;
      add_ring({q, other.patch});
      if (const auto region = make_disk(s, {q, other.patch}); region && region->corners.size() == 6) {
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
    if (const auto region = make_disk(s, patches); region && region->inner_nodes.size() == 1) {
      // The corner that the node is joined to now has an even or odd place; the other parity turns the star.
      int parity = 0;
      for (std::size_t k = 0; k < region->corners.size(); ++k) {
        const PatchSide& side = region->boundary[k];
        if (s.nodes[side.patch][(side.side + 3) % 4] == n) parity = static_cast<int>(k % 2);
      }
      add(*region, star_edit(*region, 1 - parity));
    }
  }
  std::sort(found.begin(), found.end(), [](const EditCandidate& a, const EditCandidate& b) {
    const double x = a.excess / (a.region.patches.size() + a.edit.growth()), y = b.excess / (b.region.patches.size() + b.edit.growth());
    return x != y ? x > y : a.region.patches < b.region.patches;
  });
  if (static_cast<int>(found.size()) > options.trials) found.resize(options.trials);
  for (std::size_t i = 0, n = found.size(); i < n; ++i) {
    if (found[i].edit.rings == 0) continue;
    const int height = std::min(kMostRings, tower_height(found[i].region));
    if (height < 2) continue;
    EditCandidate tall = found[i];
    tall.edit = tower_edit(s, tall.region, height);
    if (s.patch_count() + tall.edit.growth() > options.most) continue;
    found.push_back(std::move(tall));
  }
  return found;
}

std::vector<EditCandidate> choose_edits(const QuadGraph& s, std::vector<EditCandidate> candidates, const EditCandidateOptions& options) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](const EditCandidate& a, const EditCandidate& b) { return worth(a, options) > worth(b, options); });
  std::vector<char> touched(s.patch_count(), 0);
  std::vector<EditCandidate> chosen;
  int size = s.patch_count();
  for (EditCandidate& c : candidates) {
    if (worth(c, options) <= kLeastWorth) break;
    if (size + c.edit.growth() > options.most) continue;
    const std::vector<int> patches = with_surroundings(s, c.region);
    if (std::any_of(patches.begin(), patches.end(), [&](int q) { return touched[q]; })) continue;
    for (const int q : patches) touched[q] = 1;
    size += c.edit.growth();
    chosen.push_back(std::move(c));
  }
  return chosen;
}

std::vector<int> with_surroundings(const QuadGraph& s, const PatchRegion& region) {
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

}  // namespace hybrid_mesh
