// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace hybrid_mesh {
namespace {

TEST(ParallelForEachIndex, CallsTheBodyOnceForEachIndex) {
  std::vector<std::atomic<int>> calls(1000);
  parallel_for_each_index(1000, [&](std::int64_t i) { ++calls[i]; });
  for (const auto& c : calls) EXPECT_EQ(c, 1);
  parallel_for_each_index(0, [&](std::int64_t) { FAIL(); });
}

TEST(ParallelForEachIndex, ABodyThatThrowsLeavesTheLoopsInsideOthersWhole) {
  // The first body throws while the second is about to run a loop of its own.
  for (int turn = 0; turn < 20; ++turn) {
    std::atomic<bool> begun{false}, thrown{false};
    std::atomic<int> inner{-1};
    const auto run = [&] {
      parallel_for_each_index(2, [&](std::int64_t i) {
        const auto wait_for = [](const std::atomic<bool>& flag) {
          for (int k = 0; k < 100 && !flag; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        };
        if (i == 0) {
          wait_for(begun);
          thrown = true;
          throw std::runtime_error("the first");
        }
        begun = true;
        wait_for(thrown);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));  // until the loop around has seen it
        std::atomic<int> sum{0};
        parallel_for_each_index(500, [&](std::int64_t) { ++sum; });
        inner = sum.load();
      });
    };
    EXPECT_THROW(run(), std::runtime_error);
    if (begun) EXPECT_EQ(inner, 500);
  }
}

TEST(ParallelForEachIndex, ThrowsWhatTheBodyThrew) {
  try {
    parallel_for_each_index(1, [](std::int64_t) { throw std::invalid_argument("why"); });
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_EQ(std::string(e.what()), "why");
  }
}

}  // namespace
}  // namespace hybrid_mesh
