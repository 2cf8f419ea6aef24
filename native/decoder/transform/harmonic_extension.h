// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "decoder/transform/point.h"

namespace hybrid_mesh {

// What is known of a vertex's value.
enum class Known : char {
  Yes,
  No,
  Absent  // the vertex takes no part
};

// Makes every value that is not known the mean of its neighbours', along the edges between vertices that take part. Values without a path to a known
// one stay as they are. Results are the same bits everywhere.
class HarmonicExtension {
 public:
  HarmonicExtension(const std::vector<std::array<int, 2>>& edges, const std::vector<Known>& known);
  ~HarmonicExtension();
  HarmonicExtension(HarmonicExtension&&) noexcept;
  HarmonicExtension& operator=(HarmonicExtension&&) noexcept;

  // The values that a known one reaches: there is an equation for each.
  const std::vector<int>& reached() const { return reached_; }
  // What is next to an equation's value along edges, once for each, and known.
  const std::vector<int>& known_beside(int equation) const { return known_beside_[equation]; }
  int without_path() const { return unknown_ - static_cast<int>(reached_.size()); }
  // From the sums of known neighbours to the values. #reached
  void solve(std::vector<double>& values) const;
  // `values`: #known
  void extend(Point3* values) const;

 private:
  class Factors;
  std::vector<int> reached_;
  std::vector<std::vector<int>> known_beside_;
  int unknown_ = 0;
  std::unique_ptr<const Factors> factors_;
};

}  // namespace hybrid_mesh
