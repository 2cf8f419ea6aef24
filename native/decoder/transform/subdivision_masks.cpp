// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Catmull, Clark, Recursively generated B-spline surfaces on arbitrary topological meshes, 1978; creases as OpenSubdiv has them, and
// weights to the last bit: each is summed up in the order in which that library comes to it.
#include "decoder/transform/subdivision_masks.h"

#include <algorithm>
#include <array>

namespace hybrid_mesh {

namespace {

// Sorts numbers side by side by exchanges that a fixed network makes: no branch depends on them.
template <int count>
void sort_numbers(std::array<std::uint32_t, count>& n) {
  const auto exchange = [&n](int a, int b) {
    const std::uint32_t low = std::min(n[a], n[b]), high = std::max(n[a], n[b]);
    n[a] = low;
    n[b] = high;
  };
  if constexpr (count == 4) {
    exchange(0, 1), exchange(2, 3), exchange(0, 2), exchange(1, 3), exchange(1, 2);
  } else if constexpr (count == 6) {
    exchange(1, 2), exchange(4, 5), exchange(0, 2), exchange(3, 5), exchange(0, 1), exchange(3, 4);
    exchange(2, 5), exchange(0, 3), exchange(1, 4), exchange(2, 4), exchange(1, 3), exchange(2, 3);
  } else {
    static_assert(count == 9);
    exchange(0, 1), exchange(3, 4), exchange(6, 7), exchange(1, 2), exchange(4, 5), exchange(7, 8), exchange(0, 1), exchange(3, 4), exchange(6, 7);
    exchange(0, 3), exchange(3, 6), exchange(0, 3), exchange(1, 4), exchange(4, 7), exchange(1, 4), exchange(2, 5), exchange(5, 8), exchange(2, 5);
    exchange(1, 3), exchange(5, 7), exchange(2, 6), exchange(4, 6), exchange(2, 4), exchange(2, 3), exchange(5, 6);
  }
}

// Vertices, each with the kind of its weight in the last two bits, and the sum; false if a vertex is there twice.
template <int count>
bool sum_sorted(std::array<std::uint32_t, count>& tagged, const std::array<double, 3>& weights, const Point3* points, Point3& sum) {
  sort_numbers<count>(tagged);
  bool twice = false;
  for (int i = 1; i < count; ++i) twice |= (tagged[i] >> 2) == (tagged[i - 1] >> 2);
  if (twice) return false;
  sum = {};
  for (int i = 0; i < count; ++i) sum += weights[tagged[i] & 3] * points[tagged[i] >> 2];
  return true;
}

std::uint32_t tagged(int vertex, std::uint32_t kind) { return (static_cast<std::uint32_t>(vertex) << 2) | kind; }

}  // namespace

void SubdivisionMasks::add(int v, double weight) {
  const int vertex = quads_->in_mesh[v];
  int& place = place_[vertex];
  if (place < 0) {
    place = static_cast<int>(mask_.size());
    mask_.emplace_back(vertex, weight);
  } else {
    mask_[place].second += weight;
  }
}

// The centre of a quad, which is the mean of its corners.
void SubdivisionMasks::add_quad(int q, double weight) {
  for (int i = 0; i < 4; ++i) add(quads_->vertex[4 * q + i], weight * 0.25);
}

const SubdivisionMasks::Mask& SubdivisionMasks::finished() {
  for (const auto& [vertex, weight] : mask_) place_[vertex] = -1;
  std::sort(mask_.begin(), mask_.end());
  return mask_;
}

const SubdivisionMasks::Mask& SubdivisionMasks::quad_mask(int q) {
  mask_.clear();
  add_quad(q, 1);
  return finished();
}

const SubdivisionMasks::Mask& SubdivisionMasks::edge_mask(int e) {
  mask_.clear();
  if (quads_->sharp[e] || quads_->is_boundary(e)) {
    for (int i = 0; i < 2; ++i) add(quads_->end(e, i), 0.5);
  } else {
    for (int i = 0; i < 2; ++i) add(quads_->end(e, i), 0.25);
    for (int i = 0; i < 2; ++i) add_quad(quads_->side[e][i] / 4, 0.25);
  }
  return finished();
}

const SubdivisionMasks::Mask& SubdivisionMasks::vertex_mask(int v) {
  mask_.clear();
  const int creases = quads_->creases[v], start = quads_->start[v];
  const bool corner = creases > 2 || (boundary_ == BoundaryRule::EdgesAndCorners && quads_->valence[v] == 1 && quads_->across[start] < 0);
  // Calls body(side, whether it leaves the vertex) for the edges around.
  const auto for_spokes = [&](const auto& body) {
    for (int c = start;;) {
      body(c, true);
      const int last = LevelQuads::previous(c);
      c = quads_->across[last];
      if (c < 0) body(last, false);
      if (c < 0 || c == start) return;
    }
  };
  if (corner) {
    add(v, 1);
  } else if (creases == 2) {
    for_spokes([&](int side, bool leaves) {
      const int e = quads_->edge_at(side);
      if (quads_->sharp[e] || quads_->is_boundary(e)) add(quads_->vertex[leaves ? LevelQuads::next(side) : side], 0.125);
    });
    add(v, 0.75);
  } else {
    const double valence = quads_->valence[v], weight = 1 / (valence * valence);
    for_spokes([&](int side, bool leaves) {
      if (leaves) add_quad(side / 4, weight);
    });
    for_spokes([&](int side, bool leaves) { add(quads_->vertex[leaves ? LevelQuads::next(side) : side], weight); });
    add(v, (valence - 2) / valence);
  }
  return finished();
}

Point3 SubdivisionMasks::summed(const Mask& mask, const Point3* points) const {
  Point3 sum;
  for (const auto& [vertex, weight] : mask) sum += weight * points[vertex];
  return sum;
}

// Where nothing is out of the ordinary weights are whole numbers of 64ths, and there is nothing to be summed up but the points.

Point3 SubdivisionMasks::quad_point(int q, const Point3* points) {
  std::array<std::uint32_t, 4> corners;
  for (int i = 0; i < 4; ++i) corners[i] = tagged(quads_->in_mesh[quads_->vertex[4 * q + i]], 0);
  Point3 sum;
  return sum_sorted<4>(corners, {0.25, 0, 0}, points, sum) ? sum : summed(quad_mask(q), points);
}

Point3 SubdivisionMasks::edge_point(int e, const Point3* points) {
  const auto& [left, right] = quads_->side[e];
  if (left < 0 || right < 0 || quads_->sharp[e]) return summed(edge_mask(e), points);
  std::array<std::uint32_t, 6> around;
  const auto vertex = [&](int corner) { return quads_->in_mesh[quads_->vertex[corner]]; };
  const int l = LevelQuads::next(left), r = LevelQuads::next(right);
  around = {tagged(vertex(left), 0),
            tagged(vertex(l), 0),
            tagged(vertex(LevelQuads::next(l)), 1),
            tagged(vertex(LevelQuads::previous(left)), 1),
            tagged(vertex(LevelQuads::next(r)), 1),
            tagged(vertex(LevelQuads::previous(right)), 1)};
  Point3 sum;
  return sum_sorted<6>(around, {0.375, 0.0625, 0}, points, sum) ? sum : summed(edge_mask(e), points);
}

Point3 SubdivisionMasks::vertex_point(int v, const Point3* points) {
  if (quads_->valence[v] != 4 || quads_->creases[v] > 1) return summed(vertex_mask(v), points);
  std::array<std::uint32_t, 9> around;
  int c = quads_->start[v];
  for (int i = 0; i < 4; ++i) {
    const int next = LevelQuads::next(c);
    around[2 * i] = tagged(quads_->in_mesh[quads_->vertex[next]], 1);
    around[2 * i + 1] = tagged(quads_->in_mesh[quads_->vertex[LevelQuads::next(next)]], 2);
    c = quads_->turned(c);
  }
  around[8] = tagged(quads_->in_mesh[v], 0);
  Point3 sum;
  return sum_sorted<9>(around, {0.5625, 0.09375, 0.015625}, points, sum) ? sum : summed(vertex_mask(v), points);
}

}  // namespace hybrid_mesh
