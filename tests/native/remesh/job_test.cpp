// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/job.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/error.h"
#include "remesh/remesh.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

using std::chrono::milliseconds;

// Works until it is cancelled, in steps of a millisecond.
void work_forever(Context& context) {
  const Progress progress(context);
  progress.stage("forever");
  for (int i = 0;; ++i) {
    progress(1.0 - 1.0 / (1 + i));
    std::this_thread::sleep_for(milliseconds(1));
  }
}

TEST(Job, SucceedsWithProgressOne) {
  int result = 0;
  Job job([&result](Context& context) {
    const Progress progress(context);
    progress(0.5);
    result = 42;
  });
  job.wait();
  EXPECT_TRUE(job.done());
  EXPECT_EQ(job.progress(), 1.0);
  EXPECT_EQ(result, 42);
  EXPECT_NO_THROW(job.rethrow());
}

TEST(Job, CancelEndsItWithinHalfASecond) {
  Job job(work_forever);
  EXPECT_FALSE(job.wait_for(milliseconds(20)));
  EXPECT_FALSE(job.done());
  const auto start = std::chrono::steady_clock::now();
  job.cancel();
  EXPECT_TRUE(job.wait_for(std::chrono::seconds(60)));
  EXPECT_LT(std::chrono::steady_clock::now() - start, milliseconds(500));
  EXPECT_LT(job.progress(), 1.0);
  try {
    job.rethrow();
    FAIL() << "a cancelled job has no result";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Cancelled);
  }
}

TEST(Job, CancelAfterSuccessKeepsTheResult) {
  Job job([](Context&) {});
  job.wait();
  job.cancel();
  EXPECT_NO_THROW(job.rethrow());
  EXPECT_EQ(job.progress(), 1.0);
}

TEST(Job, ProgressNeverDecreasesAndIsOneOnlyAtTheEnd) {
  Job job([](Context& context) {
    const Progress progress(context);
    for (int part = 0; part < 4; ++part) {
      const Progress inner = progress.part(part / 4.0, (part + 1) / 4.0);
      inner.stage(part % 2 == 0 ? "even" : "odd");
      for (int i = 0; i <= 200; ++i) inner(i / 200.0);
      inner(0);  // a late report of an earlier fraction
      std::this_thread::sleep_for(milliseconds(2));
    }
  });
  double previous = 0;
  while (true) {
    const bool done = job.done();
    const double progress = job.progress();
    ASSERT_GE(progress, previous);
    ASSERT_LE(progress, 1.0);
    ASSERT_NE(job.stage(), nullptr);
    if (progress == 1.0) {
      ASSERT_TRUE(job.done());
    }
    previous = progress;
    if (done) break;
  }
  EXPECT_EQ(previous, 1.0);
}

TEST(Job, ErrorsAreKeptAndThrownEveryTime) {
  Job job([](Context&) { throw Error(ErrorCode::InvalidInput, "no faces"); });
  for (int i = 0; i < 2; ++i) {
    try {
      job.rethrow();
      FAIL() << "the error was lost";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
      EXPECT_STREQ(error.what(), "no faces");
    }
  }
  EXPECT_TRUE(job.done());
  EXPECT_LT(job.progress(), 1.0);
}

TEST(Job, DestructorCancelsAndJoins) {
  std::atomic<bool> running{false}, ended{false};
  {
    Job job([&](Context& context) {
      struct AtExit {
        std::atomic<bool>& flag;
        ~AtExit() { flag = true; }
      } at_exit{ended};
      running = true;
      work_forever(context);
    });
    while (!running) std::this_thread::yield();
  }
  EXPECT_TRUE(ended);
}

TEST(Job, ManyWatchersOfManyJobs) {
  std::vector<std::unique_ptr<Job>> jobs;
  for (int i = 0; i < 8; ++i) jobs.push_back(std::make_unique<Job>(work_forever));
  std::vector<std::thread> watchers;
  for (int i = 0; i < 4; ++i) {
    watchers.emplace_back([&jobs, i] {
      for (int round = 0; round < 50; ++round) {
        for (const auto& job : jobs) {
          EXPECT_LE(job->progress(), 1.0);
          EXPECT_NE(job->stage(), nullptr);
        }
        if (round == 25) jobs[i]->cancel();
      }
    });
  }
  for (std::thread& watcher : watchers) watcher.join();
  for (int i = 0; i < 4; ++i) jobs[i]->wait();
  for (int i = 4; i < 8; ++i) EXPECT_FALSE(jobs[i]->done());
}

// A flat sheet of squares, bent.
PolygonSoup bent_sheet(int n) {
  PolygonSoup soup = grid(n, n);
  for (Vec3& p : soup.points) p.z() = 0.1 * n * std::sin(3 * p.x() / n) * std::cos(4 * p.y() / n);
  return soup;
}

// One thread: the thread sanitizer does not see how an uninstrumented TBB hands work from one to another.
RemeshOptions single_threaded(std::int64_t vertices) {
  RemeshOptions options;
  options.vertices = vertices;
  options.threads = 1;
  return options;
}

TEST(JobRemesh, IsWatchedUntilItIsDone) {
  std::int64_t vertices = 0;
  Job job([&vertices, input = bent_sheet(16)](Context& context) {
    vertices = static_cast<std::int64_t>(remesh(input, single_threaded(600), context).final_mesh.points.size());
  });
  double previous = 0;
  while (!job.wait_for(milliseconds(1))) {
    const double progress = job.progress();
    ASSERT_GE(progress, previous);
    ASSERT_LT(progress, 1.0);
    previous = progress;
  }
  ASSERT_NO_THROW(job.rethrow());
  EXPECT_EQ(job.progress(), 1.0);
  EXPECT_GT(previous, 0.0);
  EXPECT_GT(vertices, 0);
  EXPECT_LE(vertices, 600);
}

TEST(JobRemesh, CanBeCancelledAtAnyTime) {
  const PolygonSoup input = bent_sheet(24);
  int cancelled = 0;
  for (const double at : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9}) {
    Job job([&input](Context& context) { remesh(input, single_threaded(1500), context); });
    while (job.progress() < at && !job.wait_for(milliseconds(0))) {
    }
    job.cancel();
    try {
      job.rethrow();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Cancelled);
      ++cancelled;
    }
  }
  EXPECT_GT(cancelled, 0);
}

TEST(JobRemesh, JobsDoNotDisturbEachOther) {
  const auto points_of = [](int n) {
    auto points = std::make_shared<std::vector<Vec3>>();
    return std::pair(points,
                     [points, input = bent_sheet(n)](Context& context) { *points = remesh(input, single_threaded(600), context).final_mesh.points; });
  };
  std::vector<std::vector<Vec3>> alone;
  for (const int n : {12, 16}) {
    const auto [points, work] = points_of(n);
    Job(work).rethrow();
    alone.push_back(*points);
  }
  const auto [first, first_work] = points_of(12);
  const auto [second, second_work] = points_of(16);
  Job a(first_work), b(second_work);
  a.rethrow();
  b.rethrow();
  EXPECT_EQ(*first, alone[0]);
  EXPECT_EQ(*second, alone[1]);
}

}  // namespace
}  // namespace hybrid_mesh
