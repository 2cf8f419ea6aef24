// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Amestoy, Davis, Duff, An approximate minimum degree ordering algorithm, 1996, in the form of Davis, Direct Methods for Sparse Linear
// Systems, 2006, chapter 7.
#include "decoder/transform/minimum_degree.h"

#include <algorithm>
#include <cmath>

namespace hybrid_mesh {

namespace {

// The graph that is left, in the form of a quotient graph: nodes, each with a list of elements and one of nodes, and elements, which are cliques of
// nodes that pivots have left behind. All lists are in one array. A node stands for all that cannot be told from it.
class QuotientGraph {
 public:
  explicit QuotientGraph(const SymmetricPattern& pattern);
  std::vector<int> eliminate();

 private:
  // A number that says: absorbed into that.
  static int absorbed(int into) { return -into - 2; }
  void list_nodes();
  int next_pivot();
  void collect_garbage();
  void make_element();
  void gather(int from, int begin, int count);
  void unlist(int node);
  void find_set_differences();
  void update_degrees();
  void find_twins();
  void finish_element();
  std::vector<int> post_order();
  int fresh_mark(int mark);

  int n_;
  std::vector<int> place_;  // of a live node's or element's list; absorbed(parent) of a dead one, -1 of a root
  std::vector<int> lists_;
  std::vector<int> length_;    // of lists
  std::vector<int> size_;      // how many a node stands for; negative while it is in the new element; 0: dead
  std::vector<int> elements_;  // how many elements begin the list; -2: an element, -1: a dead node
  std::vector<int> degree_;
  std::vector<int> next_, last_, head_;  // lists of nodes by degree; while degrees are updated, by hash
  std::vector<int> hash_head_;
  std::vector<int> mark_of_;  // 0: a dead element
  int mark_ = 0, largest_ = 0, least_degree_ = 0, done_ = 0, used_ = 0;
  // The element that is being made.
  int pivot_ = 0, pivot_size_ = 0, pivot_elements_ = 0, begin_ = 0, end_ = 0, new_degree_ = 0;
};

QuotientGraph::QuotientGraph(const SymmetricPattern& pattern)
    : n_(pattern.size()),
      place_(n_ + 1, -1),
      lists_(pattern.row),
      length_(n_ + 1, 0),
      size_(n_ + 1, 1),
      elements_(n_ + 1, 0),
      degree_(n_ + 1, 0),
      next_(n_ + 1, -1),
      last_(n_ + 1, -1),
      head_(n_ + 1, -1),
      hash_head_(n_ + 1, -1),
      mark_of_(n_ + 1, 1),
      used_(static_cast<int>(pattern.row.size())) {
  lists_.resize(used_ + used_ / 5 + 2 * n_);  // room for elements
  for (int i = 0; i < n_; ++i) {
    place_[i] = pattern.first[i];
    degree_[i] = length_[i] = pattern.first[i + 1] - pattern.first[i];
  }
  mark_ = fresh_mark(0);
  list_nodes();
}

int QuotientGraph::fresh_mark(int mark) {
  if (mark >= 2 && mark + largest_ >= 0) return mark;
  for (int i = 0; i < n_; ++i)
    if (mark_of_[i] != 0) mark_of_[i] = 1;
  return 2;
}

void QuotientGraph::list_nodes() {
  const int dense = std::min(n_ - 2, std::max(16, static_cast<int>(10 * std::sqrt(static_cast<double>(n_)))));
  for (int i = 0; i < n_; ++i) {
    const int d = degree_[i];
    if (d == 1) {  // alone
      elements_[i] = -2;
      ++done_;
      place_[i] = -1;
      mark_of_[i] = 0;
    } else if (d > dense) {
      size_[i] = 0;
      elements_[i] = -1;
      ++done_;
      place_[i] = absorbed(n_);
      ++size_[n_];
    } else {
      if (head_[d] != -1) last_[head_[d]] = i;
      next_[i] = head_[d];
      head_[d] = i;
    }
  }
  elements_[n_] = -2;
  place_[n_] = -1;
  mark_of_[n_] = 0;
}

int QuotientGraph::next_pivot() {
  int k = -1;
  for (; least_degree_ < n_ && (k = head_[least_degree_]) == -1; ++least_degree_) {
  }
  if (next_[k] != -1) last_[next_[k]] = -1;
  head_[least_degree_] = next_[k];
  return k;
}

// Moves all lists together.
void QuotientGraph::collect_garbage() {
  for (int j = 0; j < n_; ++j)
    if (const int p = place_[j]; p >= 0) {
      place_[j] = lists_[p];
      lists_[p] = absorbed(j);
    }
  int q = 0;
  for (int p = 0; p < used_;) {
    const int j = absorbed(lists_[p++]);
    if (j < 0) continue;
    lists_[q] = place_[j];
    place_[j] = q++;
    for (int i = 0; i < length_[j] - 1; ++i) lists_[q++] = lists_[p++];
  }
  used_ = q;
}

void QuotientGraph::unlist(int node) {
  if (next_[node] != -1) last_[next_[node]] = last_[node];
  if (last_[node] != -1)
    next_[last_[node]] = next_[node];
  else
    head_[degree_[node]] = next_[node];
}

// Puts the live nodes of a list into the new element.
void QuotientGraph::gather(int from, int begin, int count) {
  for (int p = begin; p < begin + count; ++p) {
    const int i = lists_[p], size = size_[i];
    if (size <= 0) continue;
    new_degree_ += size;
    size_[i] = -size;
    lists_[end_++] = i;
    unlist(i);
  }
  if (from == pivot_) return;
  place_[from] = absorbed(pivot_);
  mark_of_[from] = 0;
}

void QuotientGraph::make_element() {
  new_degree_ = 0;
  size_[pivot_] = -pivot_size_;
  int p = place_[pivot_];
  begin_ = end_ = pivot_elements_ == 0 ? p : used_;
  for (int k = 0; k < pivot_elements_; ++k) {
    const int e = lists_[p++];
    gather(e, place_[e], length_[e]);
  }
  gather(pivot_, p, length_[pivot_] - pivot_elements_);
  if (pivot_elements_ != 0) used_ = end_;
  degree_[pivot_] = new_degree_;
  place_[pivot_] = begin_;
  length_[pivot_] = end_ - begin_;
  elements_[pivot_] = -2;
}

// Of every element beside the new one: how much of it is not in that.
void QuotientGraph::find_set_differences() {
  mark_ = fresh_mark(mark_);
  for (int pk = begin_; pk < end_; ++pk) {
    const int i = lists_[pk], count = elements_[i];
    if (count <= 0) continue;
    const int size = -size_[i];
    for (int p = place_[i]; p < place_[i] + count; ++p) {
      const int e = lists_[p];
      if (mark_of_[e] >= mark_)
        mark_of_[e] -= size;
      else if (mark_of_[e] != 0)
        mark_of_[e] = degree_[e] + mark_ - size;
    }
  }
}

void QuotientGraph::update_degrees() {
  for (int pk = begin_; pk < end_; ++pk) {
    const int i = lists_[pk], first = place_[i], last_element = first + elements_[i] - 1;
    int to = first, d = 0;
    int hash = 0;
    for (int p = first; p <= last_element; ++p) {
      const int e = lists_[p];
      if (mark_of_[e] == 0) continue;
      const int outside = mark_of_[e] - mark_;
      if (outside > 0) {
        d += outside;
        lists_[to++] = e;
        hash += e;
      } else {  // all of it is in the new element
        place_[e] = absorbed(pivot_);
        mark_of_[e] = 0;
      }
    }
    elements_[i] = to - first + 1;
    const int nodes = to, end = first + length_[i];
    for (int p = last_element + 1; p < end; ++p) {
      const int j = lists_[p], size = size_[j];
      if (size <= 0) continue;
      d += size;
      lists_[to++] = j;
      hash += j;
    }
    if (d == 0) {  // it has no other neighbours than the pivot has: eliminated at once
      place_[i] = absorbed(pivot_);
      const int size = -size_[i];
      new_degree_ -= size;
      pivot_size_ += size;
      done_ += size;
      size_[i] = 0;
      elements_[i] = -1;
    } else {
      degree_[i] = std::min(degree_[i], d);
      lists_[to] = lists_[nodes];
      lists_[nodes] = lists_[first];
      lists_[first] = pivot_;
      length_[i] = to - first + 1;
      hash %= n_;
      next_[i] = hash_head_[hash];
      hash_head_[hash] = i;
      last_[i] = hash;
    }
  }
  degree_[pivot_] = new_degree_;
  largest_ = std::max(largest_, new_degree_);
  mark_ = fresh_mark(mark_ + largest_);
}

// Nodes with the same neighbours become one.
void QuotientGraph::find_twins() {
  for (int pk = begin_; pk < end_; ++pk) {
    if (size_[lists_[pk]] >= 0) continue;
    const int hash = last_[lists_[pk]];
    int i = hash_head_[hash];
    hash_head_[hash] = -1;
    for (; i != -1 && next_[i] != -1; i = next_[i], ++mark_) {
      const int length = length_[i], elements = elements_[i];
      for (int p = place_[i] + 1; p < place_[i] + length; ++p) mark_of_[lists_[p]] = mark_;
      int before = i;
      for (int j = next_[i]; j != -1;) {
        bool same = length_[j] == length && elements_[j] == elements;
        for (int p = place_[j] + 1; same && p < place_[j] + length; ++p) same = mark_of_[lists_[p]] == mark_;
        if (same) {
          place_[j] = absorbed(i);
          size_[i] += size_[j];
          size_[j] = 0;
          elements_[j] = -1;
          j = next_[j];
          next_[before] = j;
        } else {
          before = j;
          j = next_[j];
        }
      }
    }
  }
}

void QuotientGraph::finish_element() {
  int p = begin_;
  for (int pk = begin_; pk < end_; ++pk) {
    const int i = lists_[pk], size = -size_[i];
    if (size <= 0) continue;
    size_[i] = size;
    const int d = std::min(degree_[i] + new_degree_ - size, n_ - done_ - size);
    if (head_[d] != -1) last_[head_[d]] = i;
    next_[i] = head_[d];
    last_[i] = -1;
    head_[d] = i;
    least_degree_ = std::min(least_degree_, d);
    degree_[i] = d;
    lists_[p++] = i;
  }
  size_[pivot_] = pivot_size_;
  length_[pivot_] = p - begin_;
  if (length_[pivot_] == 0) {
    place_[pivot_] = -1;
    mark_of_[pivot_] = 0;
  }
  if (pivot_elements_ != 0) used_ = p;
}

std::vector<int> QuotientGraph::post_order() {
  for (int i = 0; i < n_; ++i) place_[i] = absorbed(place_[i]);  // parents
  std::fill(head_.begin(), head_.end(), -1);
  for (int j = n_; j >= 0; --j) {
    if (size_[j] > 0) continue;
    next_[j] = head_[place_[j]];
    head_[place_[j]] = j;
  }
  for (int e = n_; e >= 0; --e) {
    if (size_[e] <= 0 || place_[e] == -1) continue;
    next_[e] = head_[place_[e]];
    head_[place_[e]] = e;
  }
  std::vector<int> order, stack;
  for (int root = 0; root <= n_; ++root) {
    if (place_[root] != -1) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int p = stack.back(), child = head_[p];
      if (child == -1) {
        stack.pop_back();
        order.push_back(p);
      } else {
        head_[p] = next_[child];
        stack.push_back(child);
      }
    }
  }
  order.resize(n_);  // the last one is what dense nodes were absorbed into
  return order;
}

std::vector<int> QuotientGraph::eliminate() {
  while (done_ < n_) {
    pivot_ = next_pivot();
    pivot_elements_ = elements_[pivot_];
    pivot_size_ = size_[pivot_];
    done_ += pivot_size_;
    if (pivot_elements_ > 0 && used_ + least_degree_ >= static_cast<int>(lists_.size())) collect_garbage();
    make_element();
    find_set_differences();
    update_degrees();
    find_twins();
    finish_element();
  }
  return post_order();
}

}  // namespace

std::vector<int> minimum_degree_order(const SymmetricPattern& pattern) { return QuotientGraph(pattern).eliminate(); }

}  // namespace hybrid_mesh
