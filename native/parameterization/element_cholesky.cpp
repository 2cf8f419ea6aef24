// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Duff, Reid, The multifrontal solution of indefinite sparse symmetric linear equations, 1983; Liu, The role of elimination trees in sparse
// factorization, 1990; Ashcraft, Grimes, The influence of relaxed supernode partitions on the multifrontal method, 1989.
#include "parameterization/element_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace hybrid_mesh {
namespace {

// Supernodes are merged with their parents, at the price of explicit zeros, where that makes fronts large enough for dense arithmetic to pay: up to
// so many nodes always, then as long as less than a share of the merged columns is zero (the numbers are those of CHOLMOD, in nodes of two unknowns).
struct Relaxation {
  int nodes;
  double zeros;
};
constexpr std::array<Relaxation, 3> kRelaxed{{{2, 1.0}, {8, 0.8}, {24, 0.1}}};
constexpr double kMostZeros = 0.05;

constexpr int kSmallFront = 24;   // unknowns; below it the overhead of blocked dense algorithms is larger than their gain
constexpr double kSubtrees = 16;  // subtrees of up to one such part of the work are tasks: enough of them to keep a few threads busy

using Eigen::MatrixXd;
using Panel = Eigen::Map<MatrixXd>;

// Eliminates the first `columns` of a front that is given as those columns and the square of the rest.
bool eliminate_small(Panel& panel, Panel& rest) {
  const Eigen::Index columns = panel.cols(), size = panel.rows(), rows = size - columns;
  for (Eigen::Index j = 0; j < columns; ++j) {
    if (!(panel(j, j) > 0)) return false;
    const double root = std::sqrt(panel(j, j)), scale = 1 / root;
    panel(j, j) = root;
    for (Eigen::Index i = j + 1; i < size; ++i) panel(i, j) *= scale;
    for (Eigen::Index k = j + 1; k < columns; ++k) {
      const double factor = panel(k, j);
      for (Eigen::Index i = k; i < size; ++i) panel(i, k) -= factor * panel(i, j);
    }
    for (Eigen::Index k = 0; k < rows; ++k) {
      const double factor = panel(columns + k, j);
      for (Eigen::Index i = k; i < rows; ++i) rest(i, k) -= factor * panel(columns + i, j);
    }
  }
  return true;
}

bool eliminate_large(Panel& panel, Panel& rest) {
  const Eigen::Index columns = panel.cols(), rows = panel.rows() - columns;
  Eigen::Ref<MatrixXd> diagonal = panel.topRows(columns);
  const Eigen::LLT<Eigen::Ref<MatrixXd>> in_place(diagonal);
  if (in_place.info() != Eigen::Success) return false;
  if (rows == 0) return true;
  auto below = panel.bottomRows(rows);
  diagonal.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
  rest.selfadjointView<Eigen::Lower>().rankUpdate(below, -1.0);
  return true;
}

}  // namespace

// The symbolic factorisation, on nodes.
class ElementCholesky::Analysis {
 public:
  Analysis(ElementCholesky& of, const std::vector<Element>& elements, int unknowns) : of_(of), elements_(elements), node_(unknowns, -1) {
    name_nodes();
    connect();
    order();
    find_rows();
    make_supernodes();
    place_elements();
    plan_tasks();
  }

 private:
  struct Range {
    int begin, end;    // nodes
    double zeros = 0;  // entries, of nodes, that merging has added
  };

  int node_at(const Element& e, int corner) const {
    const int unknown = e[2 * corner] >= 0 ? e[2 * corner] : e[2 * corner + 1];
    return unknown < 0 ? -1 : node_[unknown];
  }

  void name_nodes() {
    for (const Element& e : elements_)
      for (int k = 0; k < 3; ++k) {
        const int a = e[2 * k], b = e[2 * k + 1], first = a >= 0 ? a : b;
        if (first < 0 || node_[first] >= 0) continue;
        for (const int unknown : {a, b})
          if (unknown >= 0) node_[unknown] = static_cast<int>(unknowns_of_.size());
        unknowns_of_.push_back({a, b});
      }
  }

  void connect() {
    std::vector<std::pair<int, int>> edges;
    for (const Element& e : elements_)
      for (int k = 0; k < 3; ++k) {
        const int a = node_at(e, k), b = node_at(e, (k + 1) % 3);
        if (a >= 0 && b >= 0 && a != b) edges.insert(edges.end(), {{a, b}, {b, a}});
      }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    neighbours_.resize(unknowns_of_.size());
    for (const auto& [a, b] : edges) neighbours_[a].push_back(b);
  }

  // Approximate minimum degree, then a postorder of the elimination tree: every subtree is a range.
  void order() {
    const int n = static_cast<int>(unknowns_of_.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (int a = 0; a < n; ++a) {
      entries.push_back({a, a, 1.0});
      for (const int b : neighbours_[a])
        if (b < a) entries.push_back({a, b, 1.0});
    }
    Eigen::SparseMatrix<double> pattern(n, n);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> eliminated;
    Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), eliminated);
    std::vector<int> at(n);  // per node
    for (int k = 0; k < n; ++k) at[eliminated.indices()[k]] = k;
    std::vector<int> parent(n, -1), ancestor(n, -1);
    for (int k = 0; k < n; ++k)
      for (const int b : neighbours_[eliminated.indices()[k]]) {
        for (int i = at[b]; i >= 0 && i < k;) {
          const int up = std::exchange(ancestor[i], k);
          if (up < 0) parent[i] = k;
          i = up;
        }
      }
    // Children before parents, from the last root back.
    std::vector<std::vector<int>> children(n);
    std::vector<int> stack, reversed;
    for (int k = 0; k < n; ++k) (parent[k] < 0 ? stack : children[parent[k]]).push_back(k);
    while (!stack.empty()) {
      const int k = stack.back();
      stack.pop_back();
      reversed.push_back(k);
      stack.insert(stack.end(), children[k].begin(), children[k].end());
    }
    at_.resize(n);
    node_at_.resize(n);
    parent_.assign(n, -1);
    std::vector<int> fresh(n);
    for (int k = 0; k < n; ++k) fresh[reversed[n - 1 - k]] = k;
    for (int k = 0; k < n; ++k) {
      const int node = eliminated.indices()[k];
      at_[node] = fresh[k];
      node_at_[fresh[k]] = node;
      if (parent[k] >= 0) parent_[fresh[k]] = fresh[parent[k]];
    }
    begin_.assign(n + 1, 0);
    for (int k = 0; k < n; ++k) {
      const auto& [a, b] = unknowns_of_[node_at_[k]];
      begin_[k + 1] = begin_[k] + (a >= 0) + (b >= 0);
    }
    of_.order_.resize(node_.size());
    for (int k = 0; k < n; ++k) {
      int next = begin_[k];
      for (const int unknown : unknowns_of_[node_at_[k]])
        if (unknown >= 0) of_.order_[unknown] = next++;
    }
  }

  // Per column the rows below the diagonal.
  void find_rows() {
    const int n = static_cast<int>(at_.size());
    rows_.resize(n);
    std::vector<int> seen(n, -1);
    std::vector<std::vector<int>> children(n);
    for (int k = 0; k < n; ++k) {
      seen[k] = k;
      const auto add = [&](int row) {
        if (row <= k || seen[row] == k) return;
        seen[row] = k;
        rows_[k].push_back(row);
      };
      for (const int b : neighbours_[node_at_[k]]) add(at_[b]);
      for (const int c : children[k])
        for (const int row : rows_[c]) add(row);
      std::sort(rows_[k].begin(), rows_[k].end());
      if (parent_[k] >= 0) children[parent_[k]].push_back(k);
    }
  }

  bool merge(const Range& child, Range& parent) const {
    const double columns = child.end - child.begin, more = parent.end - parent.begin;
    const auto below = static_cast<double>(rows_[parent.end - 1].size());
    const double zeros = child.zeros + parent.zeros + columns * (more + below - static_cast<double>(rows_[child.end - 1].size()));
    const double all = columns + more, entries = 0.5 * all * (all + 1) + all * below;
    double most = kMostZeros;
    for (auto r = kRelaxed.rbegin(); r != kRelaxed.rend(); ++r)
      if (all <= r->nodes) most = r->zeros;
    if (zeros > most * entries) return false;
    parent = {child.begin, parent.end, zeros};
    return true;
  }

  void make_supernodes() {
    const int n = static_cast<int>(at_.size());
    std::vector<Range> ranges;
    for (int k = 0; k < n;) {
      Range range{k, k + 1};
      while (range.end < n && parent_[range.end - 1] == range.end && rows_[range.end - 1].size() == rows_[range.end].size() + 1) ++range.end;
      k = range.end;
      // The last child ends where its parent begins; once it is merged, the one before it may.
      while (!ranges.empty() && parent_[ranges.back().end - 1] >= range.begin && parent_[ranges.back().end - 1] < range.end &&
             merge(ranges.back(), range))
        ranges.pop_back();
      ranges.push_back(range);
    }
    supernode_of_.resize(n);
    std::vector<Supernode>& all = of_.supernodes_;
    all.resize(ranges.size());
    std::size_t factor = 0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const auto [begin, end, zeros] = ranges[i];
      Supernode& s = all[i];
      std::fill(supernode_of_.begin() + begin, supernode_of_.begin() + end, static_cast<int>(i));
      s.first = begin_[begin];
      s.columns = begin_[end] - begin_[begin];
      for (const int row : rows_[end - 1])
        for (int u = begin_[row]; u < begin_[row + 1]; ++u) s.rows.push_back(u);
      s.factor = factor;
      factor += static_cast<std::size_t>(s.front()) * s.columns;
    }
    of_.factor_.resize(factor);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      Supernode& s = all[i];
      s.first_descendant = s.children.empty() ? static_cast<int>(i) : all[s.children.front()].first_descendant;
      const int last = ranges[i].end - 1;
      if (rows_[last].empty()) continue;
      s.parent = supernode_of_[rows_[last].front()];
      all[s.parent].children.push_back(static_cast<int>(i));
      for (const int row : s.rows) s.in_parent.push_back(place_in(all[s.parent], row));
    }
  }

  static int place_in(const Supernode& s, int unknown) {
    if (unknown < s.first + s.columns) return unknown - s.first;
    return s.columns + static_cast<int>(std::lower_bound(s.rows.begin(), s.rows.end(), unknown) - s.rows.begin());
  }

  void place_elements() {
    std::vector<std::pair<int, int>> by_supernode;
    for (int i = 0; i < static_cast<int>(elements_.size()); ++i) {
      int first = static_cast<int>(at_.size());
      for (int k = 0; k < 3; ++k)
        if (const int node = node_at(elements_[i], k); node >= 0) first = std::min(first, at_[node]);
      if (first < static_cast<int>(at_.size())) by_supernode.push_back({supernode_of_[first], i});
    }
    std::sort(by_supernode.begin(), by_supernode.end());
    of_.placed_begin_.assign(of_.supernodes_.size() + 1, 0);
    for (const auto& [supernode, i] : by_supernode) {
      Placed placed{i, {}};
      for (int k = 0; k < 6; ++k) placed.at[k] = elements_[i][k] < 0 ? -1 : place_in(of_.supernodes_[supernode], of_.order_[elements_[i][k]]);
      of_.placed_.push_back(placed);
      ++of_.placed_begin_[supernode + 1];
    }
    for (std::size_t s = 0; s < of_.supernodes_.size(); ++s) of_.placed_begin_[s + 1] += of_.placed_begin_[s];
  }

  void plan_tasks() {
    const std::vector<Supernode>& all = of_.supernodes_;
    std::vector<double> work(all.size());
    double sum = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double front = all[i].front();
      work[i] = front * front * all[i].columns;
      sum += work[i];
      for (const int c : all[i].children) work[i] += work[c];
    }
    for (int i = static_cast<int>(all.size()) - 1; i >= 0;) {
      if (work[i] <= sum / kSubtrees) {
        of_.subtrees_.push_back({all[i].first_descendant, i + 1});
        i = all[i].first_descendant - 1;
      } else {
        of_.top_.push_back(i--);
      }
    }
    std::reverse(of_.top_.begin(), of_.top_.end());
  }

  ElementCholesky& of_;
  const std::vector<Element>& elements_;
  std::vector<int> node_;                        // per unknown
  std::vector<std::array<int, 2>> unknowns_of_;  // per node, -1: held
  std::vector<std::vector<int>> neighbours_;     // per node
  std::vector<int> at_, node_at_;                // per node its place in the order of elimination, and back
  // From here on by place.
  std::vector<int> parent_, begin_;     // in the elimination tree; the first unknown, and the end
  std::vector<std::vector<int>> rows_;  // of the factor
  std::vector<int> supernode_of_;
};

ElementCholesky::ElementCholesky(const std::vector<Element>& elements, int unknowns) { Analysis(*this, elements, unknowns); }

bool ElementCholesky::eliminate(Supernode& s, const Placed* begin, const Placed* end, const std::vector<Matrix>& matrices) {
  const int size = s.front(), columns = s.columns, rows = size - columns;
  Panel panel(factor_.data() + s.factor, size, columns);
  panel.setZero();
  s.update.assign(static_cast<std::size_t>(rows) * rows, 0.0);
  Panel rest(s.update.data(), rows, rows);
  const auto entry = [&](int i, int j) -> double& { return j < columns ? panel(i, j) : rest(i - columns, j - columns); };
  for (const Placed* p = begin; p != end; ++p)
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b <= a; ++b)
        if (p->at[a] >= 0 && p->at[b] >= 0) entry(std::max(p->at[a], p->at[b]), std::min(p->at[a], p->at[b])) += matrices[p->element](a, b);
  for (const int c : s.children) {
    Supernode& child = supernodes_[c];
    const int n = static_cast<int>(child.rows.size());
    for (int j = 0; j < n; ++j) {
      const double* column = child.update.data() + static_cast<std::size_t>(j) * n;
      const int to = child.in_parent[j];
      double* target = to < columns ? &panel(0, to) : s.update.data() + static_cast<std::ptrdiff_t>(to - columns) * rows - columns;
      for (int i = j; i < n; ++i) target[child.in_parent[i]] += column[i];
    }
    std::vector<double>().swap(child.update);
  }
  return size < kSmallFront ? eliminate_small(panel, rest) : eliminate_large(panel, rest);
}

bool ElementCholesky::factorize(const std::vector<Matrix>& matrices) {
  std::atomic<bool> failed{false};
  const auto eliminate_one = [&](int i) {
    if (!eliminate(supernodes_[i], placed_.data() + placed_begin_[i], placed_.data() + placed_begin_[i + 1], matrices))
      failed.store(true, std::memory_order_relaxed);
  };
  parallel_for_each_index(static_cast<std::int64_t>(subtrees_.size()), [&](std::int64_t t) {
    for (int i = subtrees_[t][0]; i < subtrees_[t][1] && !failed.load(std::memory_order_relaxed); ++i) eliminate_one(i);
  });
  for (const int i : top_)
    if (!failed.load(std::memory_order_relaxed)) eliminate_one(i);
  if (failed)
    for (Supernode& s : supernodes_) std::vector<double>().swap(s.update);
  return !failed;
}

Eigen::VectorXd ElementCholesky::solve(const Eigen::VectorXd& right) const {
  Eigen::VectorXd x(right.size()), rows;
  for (std::size_t u = 0; u < order_.size(); ++u) x[order_[u]] = right[u];
  const auto panel_of = [&](const Supernode& s) { return Eigen::Map<const MatrixXd>(factor_.data() + s.factor, s.front(), s.columns); };
  for (const Supernode& s : supernodes_) {
    const auto panel = panel_of(s);
    auto own = x.segment(s.first, s.columns);
    panel.topRows(s.columns).triangularView<Eigen::Lower>().solveInPlace(own);
    rows.noalias() = panel.bottomRows(s.rows.size()) * own;
    for (std::size_t i = 0; i < s.rows.size(); ++i) x[s.rows[i]] -= rows[i];
  }
  for (auto s = supernodes_.rbegin(); s != supernodes_.rend(); ++s) {
    const auto panel = panel_of(*s);
    rows.resize(s->rows.size());
    for (std::size_t i = 0; i < s->rows.size(); ++i) rows[i] = x[s->rows[i]];
    auto own = x.segment(s->first, s->columns);
    own.noalias() -= panel.bottomRows(s->rows.size()).transpose() * rows;
    panel.topRows(s->columns).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  }
  Eigen::VectorXd result(right.size());
  for (std::size_t u = 0; u < order_.size(); ++u) result[u] = x[order_[u]];
  return result;
}

}  // namespace hybrid_mesh
