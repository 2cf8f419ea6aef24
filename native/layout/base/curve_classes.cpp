// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/curve_classes.h"

#include <algorithm>

#include "base/disjoint_sets.h"
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
    for (std::size_t p = 0; p < rims_.size(); ++p) {
      CurveClasses::Piece& piece = out.pieces.emplace_back();
      piece.odd = rims_[p].faces % 2 == 1;
      std::vector<int> on_rim;
      for (const std::vector<int>& loop : rims_[p].loops) {
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
      std::vector<int> times(out.curves.size(), 0);
      for (const int curve : on_rim) ++times[number[joined_.find(curve)]];
      for (std::size_t k = 0; k < times.size(); ++k)
        if (times[k] % 2 == 1) piece.classes.push_back(static_cast<int>(k));
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

}  // namespace

void CurveClasses::make_even(std::vector<int>& wanted) const {
  std::vector<char> odd, usable;
  for (const Piece& piece : pieces) {
    odd.push_back(piece.odd);
    for (const int k : piece.classes) odd.back() ^= (edges[curves[k][0]] - wanted[k]) & 1;
  }
  const auto most = [&](int k) { return edges[curves[k][0]]; };
  for (std::size_t k = 0; k < curves.size(); ++k) usable.push_back(wanted[k] > 1 || wanted[k] < most(static_cast<int>(k)));
  for (std::vector<int> way = way_to_even(odd, usable); !way.empty(); way = way_to_even(odd, usable))
    for (const int k : way) {
      wanted[k] += wanted[k] < most(k) ? 1 : -1;
      usable[k] = 0;
      for (std::size_t p = 0; p < pieces.size(); ++p) odd[p] ^= std::count(pieces[p].classes.begin(), pieces[p].classes.end(), k) > 0;
    }
}

// The classes on the way from an odd piece to the nearest other one.
std::vector<int> CurveClasses::way_to_even(const std::vector<char>& odd, const std::vector<char>& usable) const {
  std::vector<std::vector<int>> pieces_of(curves.size());
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (const int k : pieces[p].classes)
      if (usable[k]) pieces_of[k].push_back(static_cast<int>(p));
  for (std::size_t start = 0; start < pieces.size(); ++start) {
    if (!odd[start]) continue;
    // Breadth first.
    std::vector<int> by(pieces.size(), -1), before(pieces.size(), -1), queue{static_cast<int>(start)};
    for (std::size_t i = 0; i < queue.size(); ++i) {
      int p = queue[i];
      if (i > 0 && odd[p]) {
        std::vector<int> way;
        for (; p != static_cast<int>(start); p = before[p]) way.push_back(by[p]);
        return way;
      }
      for (const int k : pieces[p].classes) {
        if (!usable[k] || pieces_of[k].size() > 2) continue;
        if (pieces_of[k].size() == 1) {  // the boundary has nothing on its other side
          std::vector<int> way{k};
          for (; p != static_cast<int>(start); p = before[p]) way.push_back(by[p]);
          return way;
        }
        const int other = pieces_of[k][0] == p ? pieces_of[k][1] : pieces_of[k][0];
        if (other == static_cast<int>(start) || by[other] >= 0) continue;
        by[other] = k, before[other] = p;
        queue.push_back(other);
      }
    }
  }
  return {};
}

CurveClasses curve_classes(const EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures& features, const std::vector<double>& fineness) {
  return ClassSearch(mesh, points, features, fineness).run();
}

}  // namespace hybrid_mesh
