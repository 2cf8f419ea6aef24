// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/layout_levels.h"

#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <utility>

namespace hybrid_mesh {
namespace {

// Maps on their way to the surface itself, each beside what is done meanwhile.
class Carriers {
 public:
  ~Carriers() {
    try {
      tasks_.cancel();
      tasks_.wait();
    } catch (...) {
      // Another exception is on its way already.
    }
  }
  void carry(CarriedMap& map, const GlobalMapOptions& options, const Progress& progress) {
    tasks_.run([this, &map, &options, progress] {
      try {
        map.carry(std::numeric_limits<double>::infinity(), options, progress);
      } catch (...) {
        failed_.store(true, std::memory_order_relaxed);
        throw;
      }
    });
  }
  // Throws what a carrier has thrown: where one map cannot be carried, further search is in vain.
  void check() {
    if (failed_.load(std::memory_order_relaxed)) tasks_.wait();
  }
  void wait() { tasks_.wait(); }

 private:
  tbb::task_group tasks_;
  std::atomic<bool> failed_{false};
};

// Of the quads of a level so many above the present one: how many times the mean area the largest covers, by the faces whose middles lie in it.
double largest_stretch(const CarriedMap& map, int levels) {
  const ChartMesh& c = map.charts;
  const int cells = 1 << levels;
  std::vector<double> on_surface(static_cast<std::size_t>(map.layout.patch_count()) * cells * cells, 0), in_chart = on_surface;
  for (int f = 0; f < c.mesh.face_count; ++f) {
    if (!c.mesh.alive[f]) continue;
    const Complex p = c.at(3 * f), q = c.at(3 * f + 1), r = c.at(3 * f + 2), middle = (p + q + r) / 3.0;
    const auto cell = [&](double x) { return std::clamp(static_cast<int>(x * cells), 0, cells - 1); };
    const std::size_t at = (static_cast<std::size_t>(c.chart[f]) * cells + cell(middle.real())) * cells + cell(middle.imag());
    on_surface[at] += c.flat(f).area;
    in_chart[at] += 0.5 * (std::conj(q - p) * (r - p)).imag();
  }
  double largest = 0;
  for (std::size_t i = 0; i < in_chart.size(); ++i)
    if (in_chart[i] > 0) largest = std::max(largest, on_surface[i] / in_chart[i]);
  return largest;
}

class LevelMapper {
 public:
  LevelMapper(CarriedMap base, const std::vector<LevelVersion>& versions, const LevelWork& work)
      : map_(std::move(base)), versions_(versions), work_(work) {}

  MappedLayouts run(double stretch, const Progress& progress) {
    const double parts = 1 + static_cast<double>(versions_.size());
    map_.map_patches_and_keep(versions_[0].map, progress.part(0, 1 / parts));
    work(0, progress.part(1 / parts, 2 / parts));
    const int finer = static_cast<int>(versions_.size()) - 1;
    const bool optional = stretch > 0;
    if (optional && !(largest_stretch(map_.best(), finer) > stretch)) {
      result_.stages.push_back({0, map_.best()});
      return std::move(result_);
    }
    try {
      map_finer(progress.part(2 / parts, 1));
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal || !optional) throw;
      // The base alone does, too. If it is that which cannot be carried, the caller tries a finer surface.
      while (result_.stages.size() > 1) result_.stages.pop_back();
      if (result_.stages.empty()) result_.stages.push_back({0, map_.best()});
      result_.script.levels.resize(1);
    }
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
      result_.stages.push_back({static_cast<int>(result_.script.levels.size()) - 1, map_.best()});
      if (last > 0) carriers.carry(result_.stages.back().map, versions_[0].map, progress.part(0, 0));
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

MappedLayouts map_levels(CarriedMap base, const std::vector<LevelVersion>& versions, double stretch, const LevelWork& work,
                         const Progress& progress) {
  return LevelMapper(std::move(base), versions, work).run(stretch, progress);
}

}  // namespace hybrid_mesh
