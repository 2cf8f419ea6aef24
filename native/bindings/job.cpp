// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/job.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <vector>

#include "bindings/bindings.h"
#include "bindings/remesh.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

// Every job that Python has started and not yet let go.
class LiveJobs {
 public:
  void add(const std::shared_ptr<PythonJob>& job) {
    const std::lock_guard lock(mutex_);
    jobs_.erase(std::remove_if(jobs_.begin(), jobs_.end(), [](const auto& weak) { return weak.expired(); }), jobs_.end());
    jobs_.push_back(job);
  }

  void stop_all() {
    std::vector<std::shared_ptr<PythonJob>> live;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& weak : jobs_) {
        if (auto job = weak.lock()) live.push_back(std::move(job));
      }
    }
    for (const auto& job : live) job->job().cancel();
    const py::gil_scoped_release release;
    for (const auto& job : live) job->job().stop();
  }

 private:
  std::mutex mutex_;
  std::vector<std::weak_ptr<PythonJob>> jobs_;
};

LiveJobs& live_jobs() {
  static LiveJobs jobs;
  return jobs;
}

std::shared_ptr<PythonJob> start_remesh(const py::object& points, const py::object& offsets, const py::object& indices, const py::dict& settings,
                                        const py::object& density) {
  auto result = std::make_shared<RemeshResult>();  // written by the job's thread until it is done
  return start_job([input = soup_from_arrays(points, offsets, indices, density), options = remesh_options_from_dict(settings),
                    result](Context& context) mutable { *result = remesh(std::move(input), options, context); },
                   [result, made = std::optional<PythonResult>()]() mutable {
                     if (!made) made.emplace(result);
                     return py::cast(*made);
                   });
}

bool wait(PythonJob& job, std::optional<double> timeout_s) {
  if (timeout_s && !(*timeout_s >= 0)) throw Error(ErrorCode::InvalidInput, "the timeout must not be negative");
  return wait_interruptibly(job.job(), timeout_s);
}

}  // namespace

PythonJob::~PythonJob() {
  if (!PyGILState_Check()) return;
  const py::gil_scoped_release release;
  job_.stop();
}

py::object PythonJob::result() {
  wait_interruptibly(job_);
  without_gil([&] { job_.rethrow(); });
  return make_();
}

std::shared_ptr<PythonJob> start_job(Job::Work work, std::function<py::object()> make) {
  auto job = std::make_shared<PythonJob>(std::move(work), std::move(make));
  live_jobs().add(job);
  return job;
}

bool wait_interruptibly(const Job& job, std::optional<double> timeout_s) {
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  const Seconds slice(0.1);  // how long a signal may have to wait
  const auto start = Clock::now();
  while (true) {
    Seconds next = slice;
    if (timeout_s) next = std::clamp(Seconds(Seconds(*timeout_s) - (Clock::now() - start)), Seconds(0), slice);
    {
      const py::gil_scoped_release release;
      if (job.wait_for(next)) return true;
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (timeout_s && Clock::now() - start >= Seconds(*timeout_s)) return job.done();
  }
}

void bind_job(py::module_& module) {
  using py::arg;
  py::class_<PythonJob, std::shared_ptr<PythonJob>>(module, "Job", "Work that runs on a thread of its own.")
      .def_property_readonly(
          "progress", [](PythonJob& job) { return job.job().progress(); }, "In [0, 1], never decreasing.")
      .def_property_readonly(
          "stage", [](PythonJob& job) { return job.job().stage(); }, "What is being done.")
      .def_property_readonly(
          "done", [](PythonJob& job) { return job.job().done(); }, "It has ended, in whatever way.")
      .def(
          "cancel", [](PythonJob& job) { job.job().cancel(); }, "Asks it to end; result() then raises Cancelled.")
      .def("wait", &wait, arg("timeout_s") = py::none(), "Waits until it has ended or the time is over; returns `done`.")
      .def("result", &PythonJob::result, "Waits, then returns what start_... says, or raises what went wrong.");
  module.def("start_remesh", &start_remesh, arg("points"), arg("face_offsets"), arg("face_indices"), arg("settings") = py::dict(),
             arg("density") = py::none(), "Starts a remesh and returns its Job at once; the job's result is a Result.");
  module.def(
      "shutdown_jobs", [] { live_jobs().stop_all(); }, "Cancels every job that is still running and waits for its thread.");
  py::module_::import("atexit").attr("register")(module.attr("shutdown_jobs"));
}

}  // namespace hybrid_mesh
