// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/context.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A vector over the field of two elements.
using BitVector = std::vector<std::uint64_t>;

// A subspace of such vectors, given by its basis.
class BitSpace {
 public:
  explicit BitSpace(int dimension) : row_of_(dimension, -1) {}
  // Takes out of `vector` what lies in the space: zero if it lies in it, and linear in `vector`.
  void reduce(BitVector& vector) const;
  // Enlarges the space; false if it holds the vector already.
  bool add(BitVector vector);
  int dimension() const { return static_cast<int>(rows_.size()); }

 private:
  std::vector<BitVector> rows_;
  std::vector<int> row_of_;  // per bit: the row whose first bit it is, or -1
};

// Which loops of a closed surface separate nothing: the first cohomology over the field of two elements, as a number a cycle of edges.
//
// A spanning forest of the points and one of the faces that crosses none of its edges leave 2 g edges of a component of genus g. Each closes a
// cycle of faces; bit i of a cycle of edges is the parity of its crossings with cycle i of faces. A simple cycle separates its component if and only
// if all its bits are zero, and disjoint simple cycles separate nothing together if and only if their bits are linearly independent.
// Most edges are crossed by no such cycle; the others lie in few chains, whose edges have the same bits.
class Cohomology {
 public:
  // `closed` has no boundary.
  Cohomology(const TriangleSurface& closed, const Progress& progress);

  int dimension() const { return dimension_; }
  // The chain that crosses the edge of a half-edge, or -1.
  int chain(int half_edge) const { return chain_[half_edge]; }
  const std::vector<BitVector>& chains() const { return bits_; }

 private:
  void trace_chains(const TriangleSurface& closed, const std::vector<char>& crossed, const std::vector<int>& degree);
  void number_cycles(std::vector<std::array<int, 2>>& ends, int nodes);

  int dimension_ = 0;
  std::vector<int> chain_;                 // per half-edge
  std::vector<std::array<int, 2>> nodes_;  // per chain: the faces of three crossed edges at its ends
  std::vector<BitVector> bits_;            // per chain
};

}  // namespace hybrid_mesh
