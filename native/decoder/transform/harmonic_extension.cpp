// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Davis, Algorithm 849: a concise sparse Cholesky factorization package, 2005. Operations are those of Eigen 3.4's SimplicialLDLT, one by
// one: what was written with that is read with the same bits.
#include "decoder/transform/harmonic_extension.h"

#include <algorithm>
#include <cstddef>

#include "decoder/error.h"
#include "decoder/transform/minimum_degree.h"

namespace hybrid_mesh {

// L D L' of a symmetric matrix, in an order of its own.
class HarmonicExtension::Factors {
 public:
  // The lower half of the matrix, column by column, rows ascending.
  struct Matrix {
    std::vector<int> first{0}, row;
    std::vector<double> value;
    int size() const { return static_cast<int>(first.size()) - 1; }
  };
  explicit Factors(const Matrix& matrix);
  void solve(std::vector<double>& values) const;

 private:
  static SymmetricPattern whole_pattern(const Matrix& lower);
  void permute(const Matrix& matrix);
  void find_columns();
  void factorise();

  int n_;
  std::vector<int> place_;  // of a row in the order
  // The upper half of the permuted matrix, column by column, as entries came.
  std::vector<int> upper_first_, upper_row_;
  std::vector<double> upper_value_;
  std::vector<int> parent_, first_, count_, row_;
  std::vector<double> value_, diagonal_;
};

SymmetricPattern HarmonicExtension::Factors::whole_pattern(const Matrix& lower) {
  const int n = lower.size();
  std::vector<int> count(n + 1, 0);
  const auto for_entries = [&](const auto& body) {
    for (int j = 0; j < n; ++j)
      for (int p = lower.first[j]; p < lower.first[j + 1]; ++p) {
        body(j, lower.row[p]);
        if (lower.row[p] != j) body(lower.row[p], j);
      }
  };
  for_entries([&](int column, int) { ++count[column]; });
  SymmetricPattern pattern;
  for (int j = 0; j < n; ++j) pattern.first.push_back(pattern.first[j] + count[j]);
  pattern.row.resize(pattern.first.back());
  std::vector<int> at(pattern.first.begin(), pattern.first.end() - 1);
  for_entries([&](int column, int row) { pattern.row[at[column]++] = row; });
  return pattern;
}

HarmonicExtension::Factors::Factors(const Matrix& matrix) : n_(matrix.size()), place_(n_) {
  const std::vector<int> order = minimum_degree_order(whole_pattern(matrix));
  for (int k = 0; k < n_; ++k) place_[order[k]] = k;
  permute(matrix);
  find_columns();
  factorise();
}

void HarmonicExtension::Factors::permute(const Matrix& matrix) {
  upper_first_.assign(n_ + 1, 0);
  const auto for_entries = [&](const auto& body) {
    for (int j = 0; j < n_; ++j)
      for (int p = matrix.first[j]; p < matrix.first[j + 1]; ++p) {
        const int a = place_[j], b = place_[matrix.row[p]];
        body(std::max(a, b), std::min(a, b), matrix.value[p]);
      }
  };
  for_entries([&](int column, int, double) { ++upper_first_[column + 1]; });
  for (int k = 0; k < n_; ++k) upper_first_[k + 1] += upper_first_[k];
  upper_row_.resize(upper_first_[n_]);
  upper_value_.resize(upper_first_[n_]);
  std::vector<int> at(upper_first_.begin(), upper_first_.end() - 1);
  for_entries([&](int column, int row, double value) {
    upper_row_[at[column]] = row;
    upper_value_[at[column]++] = value;
  });
}

// The elimination tree, and how many entries the columns of L have.
void HarmonicExtension::Factors::find_columns() {
  std::vector<int> tag(n_);
  parent_.assign(n_, -1);
  count_.assign(n_, 0);
  for (int k = 0; k < n_; ++k) {
    tag[k] = k;
    for (int p = upper_first_[k]; p < upper_first_[k + 1]; ++p)
      for (int i = upper_row_[p]; i < k && tag[i] != k; i = parent_[i]) {
        if (parent_[i] == -1) parent_[i] = k;
        ++count_[i];
        tag[i] = k;
      }
  }
  first_.assign(n_ + 1, 0);
  for (int k = 0; k < n_; ++k) first_[k + 1] = first_[k] + count_[k];
  row_.resize(first_[n_]);
  value_.resize(first_[n_]);
  diagonal_.resize(n_);
}

// Row by row: each a triangular system with the columns so far.
void HarmonicExtension::Factors::factorise() {
  std::vector<double> y(n_, 0);
  std::vector<int> pattern(n_), tag(n_);
  std::fill(count_.begin(), count_.end(), 0);
  for (int k = 0; k < n_; ++k) {
    int top = n_;
    tag[k] = k;
    y[k] = 0;
    for (int p = upper_first_[k]; p < upper_first_[k + 1]; ++p) {
      int i = upper_row_[p], length = 0;
      y[i] += upper_value_[p];
      for (; tag[i] != k; i = parent_[i]) {
        pattern[length++] = i;
        tag[i] = k;
      }
      while (length > 0) pattern[--top] = pattern[--length];
    }
    double d = y[k];
    y[k] = 0;
    for (; top < n_; ++top) {
      const int i = pattern[top];
      const double yi = y[i], entry = yi / diagonal_[i];
      y[i] = 0;
      const int end = first_[i] + count_[i];
      for (int p = first_[i]; p < end; ++p) y[row_[p]] -= value_[p] * yi;
      d -= entry * yi;
      row_[end] = k;
      value_[end] = entry;
      ++count_[i];
    }
    diagonal_[k] = d;
    if (d == 0) throw Error(ErrorCode::Internal, "the harmonic extension has no solution");
  }
}

void HarmonicExtension::Factors::solve(std::vector<double>& values) const {
  std::vector<double> x(n_);
  for (int i = 0; i < n_; ++i) x[place_[i]] = values[i];
  for (int i = 0; i < n_; ++i)
    if (x[i] != 0)
      for (int p = first_[i]; p < first_[i + 1]; ++p) x[row_[p]] -= x[i] * value_[p];
  for (int i = 0; i < n_; ++i) x[i] = 1 / diagonal_[i] * x[i];
  for (int i = n_ - 1; i >= 0; --i) {
    double sum = x[i];
    for (int p = first_[i]; p < first_[i + 1]; ++p) sum -= value_[p] * x[row_[p]];
    x[i] = sum;
  }
  for (int i = 0; i < n_; ++i) values[i] = x[place_[i]];
}

HarmonicExtension::HarmonicExtension(const std::vector<std::array<int, 2>>& edges, const std::vector<Known>& known) {
  // Lists of unknown values alone: most are known.
  std::vector<int> number(known.size(), -1);
  std::vector<int> unknown;
  for (int v = 0; v < static_cast<int>(known.size()); ++v)
    if (known[v] == Known::No) {
      number[v] = static_cast<int>(unknown.size());
      unknown.push_back(v);
    }
  unknown_ = static_cast<int>(unknown.size());
  std::vector<std::vector<int>> neighbours(unknown.size());
  for (const auto& [a, b] : edges) {
    if (a == b || known[a] == Known::Absent || known[b] == Known::Absent) continue;
    if (known[a] == Known::No) neighbours[number[a]].push_back(b);
    if (known[b] == Known::No) neighbours[number[b]].push_back(a);
  }
  std::vector<int> equation(unknown.size(), -1);
  const auto reach = [&](int u) {
    if (equation[u] >= 0) return;
    equation[u] = static_cast<int>(reached_.size());
    reached_.push_back(unknown[u]);
  };
  for (std::size_t u = 0; u < unknown.size(); ++u)
    for (const int w : neighbours[u])
      if (known[w] == Known::Yes) reach(static_cast<int>(u));
  for (std::size_t i = 0; i < reached_.size(); ++i)
    for (const int w : neighbours[number[reached_[i]]])
      if (known[w] == Known::No) reach(number[w]);
  if (reached_.empty()) return;

  Factors::Matrix laplacian;
  std::vector<int> below;
  for (int i = 0; i < static_cast<int>(reached_.size()); ++i) {
    const std::vector<int>& around = neighbours[number[reached_[i]]];
    laplacian.row.push_back(i);
    laplacian.value.push_back(static_cast<double>(around.size()));
    below.clear();
    std::vector<int>& beside = known_beside_.emplace_back();
    for (const int w : around)
      if (known[w] == Known::Yes)
        beside.push_back(w);
      else if (equation[number[w]] > i)
        below.push_back(equation[number[w]]);
    std::sort(below.begin(), below.end());
    for (const int b : below) {
      if (laplacian.row.back() != b) {
        laplacian.row.push_back(b);
        laplacian.value.push_back(0);
      }
      laplacian.value.back() -= 1;
    }
    laplacian.first.push_back(static_cast<int>(laplacian.row.size()));
  }
  factors_ = std::make_unique<const Factors>(laplacian);
}

HarmonicExtension::~HarmonicExtension() = default;
HarmonicExtension::HarmonicExtension(HarmonicExtension&&) noexcept = default;
HarmonicExtension& HarmonicExtension::operator=(HarmonicExtension&&) noexcept = default;

void HarmonicExtension::solve(std::vector<double>& values) const {
  if (factors_) factors_->solve(values);
}

void HarmonicExtension::extend(Point3* values) const {
  std::vector<Point3> right(reached_.size());
  for (std::size_t i = 0; i < right.size(); ++i)
    for (const int w : known_beside_[i]) right[i] += values[w];
  std::vector<double> column(right.size());
  for (const auto coordinate : {&Point3::x, &Point3::y, &Point3::z}) {
    for (std::size_t i = 0; i < right.size(); ++i) column[i] = right[i].*coordinate;
    solve(column);
    for (std::size_t i = 0; i < right.size(); ++i) values[reached_[i]].*coordinate = column[i];
  }
}

}  // namespace hybrid_mesh
