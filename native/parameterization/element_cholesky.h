// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace hybrid_mesh {

// Solves symmetric positive definite systems that are sums of small matrices over the triangles of a mesh with two unknowns a node: a multifrontal
// Cholesky factorisation. What depends on the pattern alone is done once, by the constructor. Works on TBB's threads; the numbers do not depend on
// how many there are.
class ElementCholesky {
 public:
  // The unknowns of a triangle's nodes, two a node; -1: held. An unknown stands beside the same other one in all elements.
  using Element = std::array<int, 6>;
  using Matrix = Eigen::Matrix<double, 6, 6>;

  // Every one of the unknowns 0 .. unknowns - 1 occurs in some element.
  ElementCholesky(const std::vector<Element>& elements, int unknowns);

  // One matrix an element, of which the lower triangle is read; rows and columns of held unknowns count for nothing. False if the sum is not positive
  // definite in double precision.
  bool factorize(const std::vector<Matrix>& matrices);
  // After a factorisation that succeeded.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  // Columns with (nearly) the same rows, eliminated together in one dense front: the supernode's own columns first, then its rows.
  struct Supernode {
    int first = 0, columns = 0;  // unknowns in the order of elimination
    std::vector<int> rows;       // the other unknowns of the front, in that order
    int parent = -1;             // the supernode that holds the first of the rows
    std::vector<int> in_parent;  // per row: where it is in the parent's front
    std::vector<int> children;
    int first_descendant = 0;    // with all between it and this one: supernodes are in postorder
    std::size_t factor = 0;      // where its columns begin, each as long as the front
    std::vector<double> update;  // between its elimination and its parent's: what the rows lose, the lower triangle of a square
    int front() const { return columns + static_cast<int>(rows.size()); }
  };
  struct Placed {
    int element;
    std::array<int, 6> at;  // in the front of its supernode, -1: held
  };
  class Analysis;

  bool eliminate(Supernode& s, const Placed* begin, const Placed* end, const std::vector<Matrix>& matrices);

  std::vector<int> order_;  // per unknown: its place in the order of elimination
  std::vector<Supernode> supernodes_;
  std::vector<Placed> placed_;                // elements, by the supernode that eliminates the first of their unknowns
  std::vector<std::size_t> placed_begin_;     // per supernode, and the end
  std::vector<std::array<int, 2>> subtrees_;  // disjoint ranges of supernodes that can be eliminated side by side
  std::vector<int> top_;                      // those above them
  std::vector<double> factor_;
};

}  // namespace hybrid_mesh
