// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/curve_classes.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "decoder/disjoint_sets.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

// The surface between curves.
struct Rims {
  int inner_vertices = 0, inner_half_edges = 0, faces = 0;
  std::vector<std::vector<int>> loops;  // of half-edges, the piece on their left
};

class ClassSearch {
 public:
  ClassSearch(const EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures& features, const std::vector<double>& fineness)
      : mesh_(mesh), points_(points), features_(features), fineness_(fineness), piece_(mesh.alive.size(), -1), joined_(features.curve_count()) {}

  CurveClasses run() {
    find_pieces();
    for (const Rims& rims : rims_) join_opposite(rims);
    CurveClasses out;
    out.edges.assign(features_.curve_count(), 0);
    out.length.assign(features_.curve_count(), 0);
    std::vector<int> number(features_.curve_count(), -1);
    for (int c = 0; c < features_.curve_count(); ++c)
      if (joined_.is_representative(c)) {
        number[c] = static_cast<int>(out.curves.size());
        out.curves.emplace_back();
      }
    for (int c = 0; c < features_.curve_count(); ++c) out.curves[number[joined_.find(c)]].push_back(c);
    for (const Rims& rims : rims_) {
      std::vector<int>& on_rim = out.rims.emplace_back();
      for (const std::vector<int>& loop : rims.loops) {
        const std::size_t before = on_rim.size();
        for (std::size_t i = 0; i < loop.size(); ++i) {
          const int curve = features_.curves()[mesh_.edge[loop[i]]];
          const int a = mesh_.from(loop[i]), b = mesh_.to(loop[i]);
          const int sides = mesh_.opposite[loop[i]] < 0 ? 2 : 1;  // seen from both, if it has two
          out.edges[curve] += sides;
          out.length[curve] += 0.5 * sides * (points_[b] - points_[a]).norm() * fineness_on_edge(fineness_, a, b);
          const int last = features_.curves()[mesh_.edge[loop[(i + loop.size() - 1) % loop.size()]]];
          if (curve != last || features_.is_corner(a)) on_rim.push_back(curve);
        }
        if (on_rim.size() == before) on_rim.push_back(features_.curves()[mesh_.edge[loop[0]]]);  // closed, without corners
      }
    }
    for (int& n : out.edges) n /= 2;
    return out;
  }

 private:
  void find_pieces() {
    std::vector<char> seen(mesh_.origin.size(), 0), inner(mesh_.out.size(), 0);
    std::vector<int> stack;
    for (int first = 0; first < static_cast<int>(mesh_.alive.size()); ++first) {
      if (!mesh_.alive[first] || piece_[first] >= 0) continue;
      Rims& rims = rims_.emplace_back();
      const int number = static_cast<int>(rims_.size()) - 1;
      std::vector<int> rim;
      piece_[first] = number;
      stack.push_back(first);
      while (!stack.empty()) {
        const int f = stack.back();
        stack.pop_back();
        ++rims.faces;
        for (int h = 3 * f; h < 3 * f + 3; ++h) {
          const int o = mesh_.opposite[h], v = mesh_.from(h);
          if (!features_.is_on_curve(v) && !inner[v]) inner[v] = 1, ++rims.inner_vertices;
          if (features_.on(mesh_, h)) {
            rim.push_back(h);
            continue;
          }
          ++rims.inner_half_edges;
          if (piece_[o / 3] >= 0) continue;
          piece_[o / 3] = number;
          stack.push_back(o / 3);
        }
      }
      for (const int start : rim) {
        if (seen[start]) continue;
        std::vector<int>& loop = rims.loops.emplace_back();
        for (int h = start; !seen[h];) {
          seen[h] = 1;
          loop.push_back(h);
          h = EditMesh::next(h);
          while (!features_.on(mesh_, h)) h = EditMesh::next(mesh_.opposite[h]);
        }
      }
    }
  }

  // 1 at a corner of about a right angle, 2 where the rim goes straight on, more where it turns outwards.
  int quads_at(int h) const { return features_.regular_quads(mesh_, points_, features_.sector(mesh_, h)); }

  void join_opposite(const Rims& rims) {
    const int euler = rims.inner_vertices - rims.inner_half_edges / 2 + rims.faces;
    // The curves between corners, side by side.
    std::vector<std::vector<int>> sides;
    for (const std::vector<int>& loop : rims.loops) {
      std::size_t first = 0;
      int corners = 0;
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const int quads = quads_at(loop[i]);
        if (quads > 2) return;
        if (quads == 1 && corners++ == 0) first = i;
      }
      if (corners == 0) sides.emplace_back();
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const int h = loop[(first + k) % loop.size()], curve = features_.curves()[mesh_.edge[h]];
        if (quads_at(h) == 1) sides.emplace_back();
        if (sides.back().empty() || sides.back().back() != curve) sides.back().push_back(curve);
      }
    }
    if (std::any_of(sides.begin(), sides.end(), [](const std::vector<int>& side) { return side.size() != 1; })) return;
    if (rims.loops.size() == 1 && euler == 1 && sides.size() == 4) {
      joined_.join(sides[0][0], sides[2][0]);
      joined_.join(sides[1][0], sides[3][0]);
    } else if (rims.loops.size() == 2 && euler == 0 && sides.size() == 2) {
      joined_.join(sides[0][0], sides[1][0]);
    }
  }

  const EditMesh& mesh_;
  const std::vector<Vec3>& points_;
  const MeshFeatures& features_;
  const std::vector<double>& fineness_;
  std::vector<int> piece_;  // per face
  std::vector<Rims> rims_;
  DisjointSets joined_;  // curves
};

// Ways between pieces with odd rims over what changes two rims, or one with the boundary behind it.
class Parity {
 public:
  // `rims`: see CurveClasses. Curves of one of `units` change together.
  Parity(const std::vector<std::vector<int>>& rims, const std::vector<std::vector<int>>& units, std::size_t curves)
      : units_(rims.size()), pieces_(units.size()) {
    std::vector<int> unit(curves, -1);
    for (std::size_t k = 0; k < units.size(); ++k)
      for (const int c : units[k]) unit[c] = static_cast<int>(k);
    for (std::size_t p = 0; p < rims.size(); ++p) {
      std::vector<int> all;
      for (const int c : rims[p]) all.push_back(unit[c]);
      std::sort(all.begin(), all.end());
      for (auto first = all.begin(); first != all.end();) {
        const auto last = std::upper_bound(first, all.end(), *first);
        if ((last - first) % 2 == 1) {
          units_[p].push_back(*first);
          pieces_[*first].push_back(static_cast<int>(p));
        }
        first = last;
      }
    }
  }

  const std::vector<int>& pieces(int unit) const { return pieces_[unit]; }

  // The units to change on the way from an odd piece to the nearest other one; none: there is no way.
  std::vector<int> way(const std::vector<char>& odd, const std::vector<char>& usable) const {
    for (int start = 0; start < static_cast<int>(odd.size()); ++start) {
      if (!odd[start]) continue;
      // Breadth first.
      std::vector<int> by(odd.size(), -1), before(odd.size(), -1), queue{start};
      const auto back = [&](int p, std::vector<int> way) {
        for (; p != start; p = before[p]) way.push_back(by[p]);
        return way;
      };
      for (std::size_t i = 0; i < queue.size(); ++i) {
        const int p = queue[i];
        if (i > 0 && odd[p]) return back(p, {});
        for (const int k : units_[p]) {
          if (!usable[k] || pieces_[k].size() > 2) continue;
          if (pieces_[k].size() == 1) return back(p, {k});
          const int other = pieces_[k][0] == p ? pieces_[k][1] : pieces_[k][0];
          if (other == start || by[other] >= 0) continue;
          by[other] = k, before[other] = p;
          queue.push_back(other);
        }
      }
    }
    return {};
  }

 private:
  std::vector<std::vector<int>> units_, pieces_;  // per piece and per unit: what an odd number of curves have in common
};

}  // namespace

void CurveClasses::make_even(std::vector<int>& wanted, const std::vector<int>& least) const {
  std::vector<char> odd;
  for (const std::vector<int>& rim : rims) odd.push_back(std::accumulate(rim.begin(), rim.end(), 0, [&](int n, int c) { return n + wanted[c]; }) & 1);
  std::vector<std::vector<int>> alone;
  for (int c = 0; c < static_cast<int>(edges.size()); ++c) alone.push_back({c});
  for (const auto* units : {&curves, &std::as_const(alone)}) {
    const auto all = [&](std::size_t k, const auto& may) { return std::all_of((*units)[k].begin(), (*units)[k].end(), may); };
    const auto may_grow = [&](int c) { return wanted[c] < edges[c]; };
    const auto may_shrink = [&](int c) { return wanted[c] > least[c]; };
    std::vector<char> usable;
    for (std::size_t k = 0; k < units->size(); ++k) usable.push_back(all(k, may_grow) || all(k, may_shrink));
    std::vector<int> step(units->size(), 0);
    const Parity parity(rims, *units, edges.size());
    for (std::vector<int> way = parity.way(odd, usable); !way.empty(); way = parity.way(odd, usable))
      for (const int k : way) {
        // What an earlier way has changed is taken back: so there is a way as long as two odd rims are connected.
        const int change = step[k] != 0 ? -step[k] : all(k, may_grow) ? 1 : -1;
        step[k] += change;
        for (const int c : (*units)[k]) wanted[c] += change;
        for (const int p : parity.pieces(k)) odd[p] ^= 1;
      }
  }
}

CurveClasses curve_classes(const EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures& features, const std::vector<double>& fineness) {
  return ClassSearch(mesh, points, features, fineness).run();
}

}  // namespace hybrid_mesh
