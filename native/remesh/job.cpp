// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/job.h"

#include <algorithm>
#include <utility>

namespace hybrid_mesh {
namespace {

// The work may report all of its parts done before it returns; whoever sees 1 may count on the result.
constexpr double kLargestUnfinished = 0.999;

}  // namespace

Job::Job(Work work) : thread_([this, work = std::move(work)] { run(work); }) {}

void Job::stop() noexcept {
  cancel();
  const std::lock_guard lock(join_mutex_);
  if (thread_.joinable()) thread_.join();
}

void Job::run(const Work& work) noexcept {
  std::exception_ptr error;
  try {
    work(context_);
  } catch (...) {
    error = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  error_ = std::move(error);
  done_ = true;
  ended_.notify_all();
}

double Job::progress() const {
  const std::lock_guard lock(mutex_);
  return done_ && !error_ ? 1.0 : std::min(context_.progress(), kLargestUnfinished);
}

bool Job::done() const {
  const std::lock_guard lock(mutex_);
  return done_;
}

bool Job::wait_for(std::chrono::duration<double> timeout) const {
  // A longer wait would overflow the clock.
  const auto bounded = std::chrono::duration<double>(std::clamp(timeout.count(), 0.0, 1e6));
  std::unique_lock lock(mutex_);
  return ended_.wait_for(lock, bounded, [this] { return done_; });
}

void Job::wait() const {
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [this] { return done_; });
}

void Job::rethrow() const {
  wait();
  if (error_) std::rethrow_exception(error_);
}

}  // namespace hybrid_mesh
