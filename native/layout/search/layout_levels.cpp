// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/layout_levels.h"

#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <utility>

#include "base/found.h"

namespace hybrid_mesh {
namespace {

// Maps on their way to the surface itself, each beside what is done meanwhile. No exception leaves a task, and the group is never cancelled: TBB
// would make every parallel loop inside the other tasks return early, and these would go on with what it had not computed.
class Carriers {
 public:
  ~Carriers() {
    stopped_.store(true, std::memory_order_relaxed);
    tasks_.wait();
  }
  void carry(MappedLayouts::Stage& stage, const GlobalMapOptions& options, const Progress& progress) {
    tasks_.run([this, &stage, &options, progress] {
      if (stopped_.load(std::memory_order_relaxed)) return;
      try {
        const auto carried = found([&] { stage.map.carry(std::numeric_limits<double>::infinity(), options, progress); });
        stage.failure = carried.reason;
        // Without a map of a finer level, further search is in vain; that of the base can be made in another way.
        if (!carried && stage.level > 0) failed_.store(true, std::memory_order_relaxed);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!error_) error_ = std::current_exception();
        failed_.store(true, std::memory_order_relaxed);
      }
    });
  }
  void check() {
    if (failed_.load(std::memory_order_relaxed)) wait();
  }
  // Throws what a carrier has thrown, and NoMap where the map of a finer level cannot be carried.
  void wait() {
    tasks_.wait();
    if (error_) std::rethrow_exception(error_);
    if (failed_.load(std::memory_order_relaxed)) throw NoMap("the map of a level with operations could not be carried to the surface");
  }

 private:
  tbb::task_group tasks_;
  std::atomic<bool> failed_{false}, stopped_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
};

class LevelMapper {
 public:
  LevelMapper(CarriedMap base, const std::vector<LevelVersion>& versions, const LevelWork& work)
      : map_(std::move(base)), versions_(versions), work_(work) {}

  MappedLayouts run(const Progress& progress) {
    const double parts = 1 + static_cast<double>(versions_.size());
    map_.map_patches_and_keep(versions_[0].map, progress.part(0, 1 / parts));
    work(0, progress.part(1 / parts, 2 / parts));
    map_finer(progress.part(2 / parts, 1));
    return std::move(result_);
  }

 private:
  void work(std::size_t level, const Progress& progress) {
    const LevelVersion& version = versions_[level];
    result_.script.levels.push_back({version.vertices, version.map.vertices_a_quad, {}});
    result_.script.levels.back().edits = work_(map_, level, progress);
  }

  void map_finer(const Progress& progress) {
    const std::size_t last = versions_.size() - 1;
    result_.stages.reserve(versions_.size());  // carriers hold on to them
    Carriers carriers;
    const auto keep = [&] {
      const int level = static_cast<int>(result_.script.levels.size()) - 1;
      Found<> free;
      if (last > 0) free = found([&] { map_.uncut(versions_[0].map, progress.part(0, 0)); });
      if (!free && level > 0 && last > 0) throw NoMap(free.reason);
      result_.stages.push_back({level, map_.best(), free.reason});
      if (free) carriers.carry(result_.stages.back(), versions_[0].map, progress.part(0, 0));
    };
    const auto is_new = [&] { return result_.stages.empty() || !result_.script.levels.back().edits.empty(); };
    for (std::size_t level = 1; level <= last; ++level) {
      const Progress part =
          progress.part(static_cast<double>(level - 1) / static_cast<double>(last), static_cast<double>(level) / static_cast<double>(last));
      if (is_new()) keep();
      map_.refine(versions_[level].vertices, versions_[level].map, part.part(0.1, 0.2));
      carriers.check();
      work(level, part.part(0.2, 1));
      carriers.check();
    }
    if (is_new()) keep();
    carriers.wait();
  }

  TrialMap map_;
  const std::vector<LevelVersion>& versions_;
  const LevelWork& work_;
  MappedLayouts result_;
};

}  // namespace

MappedLayouts map_levels(CarriedMap base, const std::vector<LevelVersion>& versions, const LevelWork& work, const Progress& progress) {
  return LevelMapper(std::move(base), versions, work).run(progress);
}

}  // namespace hybrid_mesh
