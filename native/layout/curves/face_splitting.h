// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle split into smaller ones along the chords in which curves cross it.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "base/error.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A corner of the triangle, or a point where a curve crosses one of its sides.
struct PieceCorner {
  int point;  // index of the point
  int mark;   // the curve along the polygon's edge to the next corner, -1: none
  Vec2 at;    // in a reference triangle
  int sides;  // bit set of the triangle's sides that hold it
};

// A curve's way across the triangle, between two corners of the polygon.
struct FaceChord {
  int low, high;  // indices in the polygon, low < high
  int curve;
};

// Splits a convex polygon with corners on the sides of one triangle into triangles none of which lies along one side. `emit` gets three corners and
// the marks of the edges that follow them.
template <class Emit>
void split_piece(std::vector<PieceCorner> polygon, const Emit& emit) {
  while (polygon.size() > 3) {
    const int n = static_cast<int>(polygon.size());
    int best = -1;
    double best_quality = -1;
    for (int i = 0; i < n; ++i) {
      const PieceCorner &a = polygon[(i + n - 1) % n], &b = polygon[i], &c = polygon[(i + 1) % n];
      if (a.sides & b.sides & c.sides) continue;
      int rest = ~0;
      for (int j = 0; j < n; ++j)
        if (j != i) rest &= polygon[j].sides;
      if (rest) continue;
      const Vec2 ab = b.at - a.at, bc = c.at - b.at, ca = a.at - c.at;
      const double area = ab.x() * bc.y() - ab.y() * bc.x();
      const double quality = area / (ab.squaredNorm() + bc.squaredNorm() + ca.squaredNorm());
      if (quality > best_quality) best_quality = quality, best = i;
    }
    if (best < 0) throw NoMap("a piece of a triangle lies along one of its sides");
    const int p = (best + n - 1) % n, q = (best + 1) % n;
    emit(polygon[p], polygon[best], polygon[q], polygon[p].mark, polygon[best].mark, -1);
    polygon[p].mark = -1;
    polygon.erase(polygon.begin() + best);
  }
  if (polygon[0].sides & polygon[1].sides & polygon[2].sides) throw NoMap("a piece of a triangle lies along one of its sides");
  emit(polygon[0], polygon[1], polygon[2], polygon[0].mark, polygon[1].mark, polygon[2].mark);
}

// The same for a whole triangle with the points on its sides, along chords. Throws NoMap if they cross each other.
template <class Emit>
void split_along_chords(std::vector<PieceCorner> polygon, const std::vector<FaceChord>& chords, const Emit& emit) {
  // Cut off the shortest arc first: what lies below it holds no other chord.
  std::vector<int> order(chords.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::pair(chords[a].high - chords[a].low, a) < std::pair(chords[b].high - chords[b].low, b); });
  std::vector<int> left(polygon.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  for (const int i : order) {
    const auto low = std::find(left.begin(), left.end(), chords[i].low), high = std::find(left.begin(), left.end(), chords[i].high);
    if (low == left.end() || high == left.end()) throw NoMap("two curves cross in a triangle");
    std::vector<PieceCorner> piece;
    for (auto it = low; it != high + 1; ++it) piece.push_back(polygon[*it]);
    if (piece.size() < 3) throw NoMap("a curve runs along a side of a triangle");
    piece.back().mark = chords[i].curve;
    polygon[*low].mark = chords[i].curve;
    split_piece(piece, emit);
    left.erase(low + 1, high);
  }
  std::vector<PieceCorner> rest;
  for (const int i : left) rest.push_back(polygon[i]);
  split_piece(rest, emit);
}

}  // namespace hybrid_mesh
