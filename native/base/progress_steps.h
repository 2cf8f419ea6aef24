// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "base/context.h"

namespace hybrid_mesh {

// A part of the work in equal steps, which several threads do together.
class ProgressSteps {
 public:
  ProgressSteps(const Progress& progress, std::int64_t count) : progress_(progress), count_(std::max<std::int64_t>(count, 1)) {}

  // So many more are done; throws like Progress::check().
  void operator()(std::int64_t more = 1) {
    const std::int64_t done = done_.fetch_add(more, std::memory_order_relaxed) + more;
    progress_(std::min(1.0, static_cast<double>(done) / static_cast<double>(count_)));
  }
  const Progress& progress() const { return progress_; }

 private:
  Progress progress_;
  std::int64_t count_;
  std::atomic<std::int64_t> done_{0};
};

}  // namespace hybrid_mesh
