// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

#include "base/error.h"

namespace hybrid_mesh {

// Shared by the thread that works and the threads that watch it. Every member may be called from any thread.
class Context {
 public:
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }
  // In [0, 1], never decreasing; exactly 1 when the work is done.
  double progress() const noexcept { return progress_.load(std::memory_order_relaxed); }
  // A string literal that names what is being done.
  const char* stage() const noexcept { return stage_.load(std::memory_order_relaxed); }

 private:
  friend class Progress;
  std::atomic<bool> cancelled_{false};
  std::atomic<double> progress_{0};
  std::atomic<const char*> stage_{""};
};

// A part [begin, end] of a context's progress, handed down by value to the function that does that part.
class Progress {
 public:
  explicit Progress(Context& context) : context_(&context) {}
  // The part of this part between two fractions in [0, 1].
  Progress part(double from, double to) const {
    Progress p = *this;
    p.begin_ = begin_ + (end_ - begin_) * from;
    p.end_ = begin_ + (end_ - begin_) * to;
    return p;
  }
  // Names the stage; a string literal.
  void stage(const char* name) const noexcept { context_->stage_.store(name, std::memory_order_relaxed); }
  // Throws Error{Cancelled} if the work is to end.
  void check() const {
    if (context_->cancelled()) throw Error(ErrorCode::Cancelled, "cancelled");
  }
  // Reports that a fraction in [0, 1] of this part is done; throws like check().
  void operator()(double fraction) const {
    check();
    const double value = begin_ + (end_ - begin_) * fraction;
    double seen = context_->progress_.load(std::memory_order_relaxed);
    while (seen < value && !context_->progress_.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
    }
  }

 private:
  Context* context_;
  double begin_ = 0, end_ = 1;
};

}  // namespace hybrid_mesh
