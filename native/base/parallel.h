// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>

namespace hybrid_mesh {

// Calls body(i) for all i of [0, count), in parallel. A body that throws keeps further ones from being begun, and what it has thrown (of several,
// that of the lowest i) is thrown on once those that have begun are done. tbb::parallel_for alone would cancel its whole group of tasks then:
// parallel loops inside the other bodies would return early without a word, and the bodies would go on with what was not computed.
template <class Body>
void parallel_for_each_index(std::int64_t count, const Body& body) {
  std::atomic<bool> thrown{false};
  std::mutex mutex;
  std::exception_ptr error;
  std::int64_t error_at = count;
  tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t i) {
    if (thrown.load(std::memory_order_relaxed)) return;
    try {
      body(i);
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (i < error_at) error = std::current_exception(), error_at = i;
      thrown.store(true, std::memory_order_relaxed);
    }
  });
  if (error) std::rethrow_exception(error);
}

}  // namespace hybrid_mesh
