// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "base/context.h"

namespace hybrid_mesh {

// One piece of work on a thread of its own, started by the constructor. The work must own what it reads. Every member may be called from
// any thread, but not from the work itself.
class Job {
 public:
  using Work = std::function<void(Context&)>;

  explicit Job(Work work);
  ~Job() { stop(); }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  // Asks the work to end; it does so at its next check, with Error{Cancelled}. Work that has ended already is not changed.
  void cancel() noexcept { context_.cancel(); }
  // Cancels the work and waits until its thread has ended.
  void stop() noexcept;
  // In [0, 1], never decreasing; exactly 1 after success, and only then once the work has ended.
  double progress() const;
  const char* stage() const noexcept { return context_.stage(); }
  // The work has ended: with success, an error, or because it was cancelled.
  bool done() const;
  // Waits until the work has ended, or the time is over; returns done().
  bool wait_for(std::chrono::duration<double> timeout) const;
  void wait() const;
  // Waits, then throws what the work threw, every time it is called.
  void rethrow() const;

 private:
  void run(const Work& work) noexcept;

  Context context_;
  mutable std::mutex mutex_;
  mutable std::condition_variable ended_;
  bool done_ = false;         // guarded by mutex_
  std::exception_ptr error_;  // written before done_
  std::mutex join_mutex_;
  std::thread thread_;  // guarded by join_mutex_; last: starts when everything else is there
};

}  // namespace hybrid_mesh
