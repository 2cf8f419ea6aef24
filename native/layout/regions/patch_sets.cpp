// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/patch_sets.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

namespace hybrid_mesh {
namespace {

// The loops of the surface's boundary: per node the number of its own, or -1.
std::vector<int> loops_of_nodes(const QuadGraph& s) {
  std::vector<std::vector<int>> next(s.node_count);
  for (int q = 0; q < s.patch_count(); ++q)
    for (int i = 0; i < 4; ++i)
      if (s.neighbours[q][i].patch < 0) next[s.nodes[q][i]].push_back(s.nodes[q][(i + 1) % 4]);
  std::vector<int> loop(s.node_count, -1);
  int count = 0;
  for (int first = 0; first < s.node_count; ++first) {
    if (next[first].empty() || loop[first] >= 0) continue;
    for (int n = first; loop[n] < 0; n = next[n].front()) loop[n] = count;
    ++count;
  }
  return loop;
}

}  // namespace

std::vector<std::vector<int>> components(const QuadGraph& s, const PatchSet& in, char value) {
  std::vector<std::vector<int>> parts;
  std::vector<char> seen(s.patch_count(), 0);
  for (int first = 0; first < s.patch_count(); ++first) {
    if (in[first] != value || seen[first]) continue;
    std::vector<int> part{first};
    seen[first] = 1;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (const PatchSide& other : s.neighbours[part[i]])
        if (other.patch >= 0 && in[other.patch] == value && !seen[other.patch]) {
          seen[other.patch] = 1;
          part.push_back(other.patch);
        }
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

PatchSet dilated(const QuadGraph& s, const PatchSet& in) {
  std::vector<char> node(s.node_count, 0), out = in;
  for (int q = 0; q < s.patch_count(); ++q)
    if (in[q])
      for (const int n : s.nodes[q]) node[n] = 1;
  for (int q = 0; q < s.patch_count(); ++q)
    for (const int n : s.nodes[q]) out[q] |= node[n];
  return out;
}

void open_to_loops(const QuadGraph& s, PatchSet& in, const std::vector<double>& energy) {
  const std::vector<int> loop = loops_of_nodes(s);
  const std::vector<std::vector<int>> outside = components(s, in, 0);
  if (outside.empty()) return;
  const auto& largest = *std::max_element(outside.begin(), outside.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::vector<char> reached(s.patch_count(), 0), joined(s.node_count, 0);
  const auto reach = [&](int q) {
    reached[q] = 1;
    in[q] = 0;
    for (const int n : s.nodes[q])
      if (loop[n] >= 0) joined[loop[n]] = 1;
  };
  for (const int q : largest) reach(q);
  const double least = 0.1 * std::accumulate(energy.begin(), energy.end(), 0.0) / s.patch_count();
  for (;;) {
    std::vector<double> cost(s.patch_count(), std::numeric_limits<double>::infinity());
    std::vector<int> from(s.patch_count(), -1);
    std::set<std::pair<double, int>> front;
    for (int q = 0; q < s.patch_count(); ++q)
      if (reached[q]) front.insert({cost[q] = 0, q});
    int found = -1;
    while (!front.empty() && found < 0) {
      const int q = front.begin()->second;
      front.erase(front.begin());
      if (std::any_of(s.nodes[q].begin(), s.nodes[q].end(), [&](int n) { return loop[n] >= 0 && !joined[loop[n]]; })) found = q;
      for (const PatchSide& other : s.neighbours[q]) {
        if (other.patch < 0) continue;
        const double sum = cost[q] + energy[other.patch] + least;
        if (!(sum < cost[other.patch])) continue;
        front.erase({cost[other.patch], other.patch});
        front.insert({cost[other.patch] = sum, other.patch});
        from[other.patch] = q;
      }
    }
    if (found < 0) return;
    for (int q = found; q >= 0 && !reached[q]; q = from[q]) reach(q);
  }
}

void part_at_nodes(const QuadGraph& s, PatchSet& in) {
  std::vector<std::vector<int>> around(s.node_count);
  for (int q = 0; q < s.patch_count(); ++q)
    for (const int n : s.nodes[q]) around[n].push_back(q);
  for (bool any = true; any;) {
    any = false;
    for (int n = 0; n < s.node_count; ++n) {
      std::vector<std::vector<int>> fans;
      for (const int q : around[n]) {
        if (!in[q] || std::any_of(fans.begin(), fans.end(), [&](const auto& fan) { return std::find(fan.begin(), fan.end(), q) != fan.end(); }))
          continue;
        std::vector<int> fan{q};
        for (std::size_t i = 0; i < fan.size(); ++i)
          for (int k = 0; k < 4; ++k) {
            const int other = s.neighbours[fan[i]][k].patch;
            if (other < 0 || !in[other] || (s.nodes[fan[i]][k] != n && s.nodes[fan[i]][(k + 1) % 4] != n)) continue;
            if (std::find(fan.begin(), fan.end(), other) == fan.end()) fan.push_back(other);
          }
        fans.push_back(std::move(fan));
      }
      std::stable_sort(fans.begin(), fans.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
      for (std::size_t k = 1; k < fans.size(); ++k)
        for (const int q : fans[k]) in[q] = 0, any = true;
    }
  }
}

std::vector<PatchRegion> regions_around(const QuadGraph& s, const PatchSet& in) {
  std::vector<PatchRegion> regions;
  std::vector<char> taken(s.patch_count(), 0);
  for (const std::vector<int>& seed : components(s, in, 1)) {
    std::vector<char> region(s.patch_count(), 0);
    for (const int q : seed) region[q] = 1;
    for (int ring = 0; ring < 4; ++ring) {
      // What the region encloses joins it.
      std::vector<std::vector<int>> outside = components(s, region, 0);
      // Another component of the surface is not enclosed.
      std::erase_if(outside, [&](const std::vector<int>& part) {
        return std::none_of(part.begin(), part.end(), [&](int q) {
          return std::any_of(s.neighbours[q].begin(), s.neighbours[q].end(), [&](const PatchSide& n) { return n.patch >= 0 && region[n.patch]; });
        });
      });
      std::size_t largest = 0;
      for (std::size_t i = 0; i < outside.size(); ++i)
        if (outside[i].size() > outside[largest].size()) largest = i;
      for (std::size_t i = 0; i < outside.size(); ++i)
        if (i != largest)
          for (const int q : outside[i]) region[q] = 1;
      std::vector<int> patches;
      bool free = true;
      for (int q = 0; q < s.patch_count(); ++q)
        if (region[q]) {
          patches.push_back(q);
          free &= !taken[q];
        }
      if (!free) break;
      if (std::optional<PatchRegion> found = make_region(s, patches)) {
        for (const int q : patches) taken[q] = 1;
        regions.push_back(std::move(*found));
        break;
      }
      region = dilated(s, region);
    }
  }
  return regions;
}

}  // namespace hybrid_mesh
