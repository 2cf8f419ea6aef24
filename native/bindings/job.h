// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "bindings/conversions.h"
#include "remesh/job.h"

namespace hybrid_mesh {

// Waits until the job has ended or the time is over, and returns done(). The interpreter's lock is released meanwhile, but Python's signal
// handlers get their turn: what they raise (KeyboardInterrupt) ends the waiting, not the job. Without a timeout: as long as it takes.
bool wait_interruptibly(const Job& job, std::optional<double> timeout_s = {});

// Work on a thread of its own, which must own what it reads and never touches Python, and what Python gets of it.
class PythonJob {
 public:
  // `make`: called with the interpreter's lock once the work has succeeded, every time that the result is asked for.
  PythonJob(Job::Work work, std::function<pybind11::object()> make) : make_(std::move(make)), job_(std::move(work)) {}
  ~PythonJob();

  Job& job() { return job_; }
  pybind11::object result();  // waits; throws what the work threw

 private:
  std::function<pybind11::object()> make_;
  Job job_;
};

// Starts work that shutdown_jobs() stops: a thread that outlives the interpreter's exit would crash it.
std::shared_ptr<PythonJob> start_job(Job::Work work, std::function<pybind11::object()> make);

// Does native work on another thread while this one lets Python's signals through, and returns its result or throws what it throws.
// A signal handler that raises cancels the work.
template <typename Work>
auto run_interruptibly(Work&& work) {
  using Result = std::invoke_result_t<Work, Context&>;
  std::optional<Result> result;
  std::optional<Job> job;
  // The job's destructor waits for its thread, which may itself wait for the lock that this thread holds.
  struct DestroyWithoutGil {
    std::optional<Job>& job;
    ~DestroyWithoutGil() {
      const pybind11::gil_scoped_release release;
      job.reset();
    }
  } destroy{job};
  job.emplace([&](Context& context) { result.emplace(work(context)); });
  wait_interruptibly(*job);
  without_gil([&] { job->rethrow(); });
  return std::move(*result);
}

}  // namespace hybrid_mesh
