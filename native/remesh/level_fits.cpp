// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/level_fits.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "remesh/adaptive_refinement.h"
#include "remesh/report.h"
#include "remesh/surface_fit.h"

namespace hybrid_mesh {
namespace {

// The vertices of a fitted mesh by their names.
class FittedVertices {
 public:
  explicit FittedVertices(const QuadMesh& mesh) : mesh_(mesh) {
    for (std::size_t v = 0; v < mesh.vertex.size(); ++v) at_.push_back({mesh.vertex[v], v});
    std::sort(at_.begin(), at_.end());
  }
  // Puts the vertices of a level where they are in the fitted mesh, if it has most of that mesh's.
  bool place(QuadMesh& level) const {
    std::vector<std::pair<std::size_t, std::size_t>> shared;
    for (std::size_t v = 0; v < level.vertex.size(); ++v) {
      const auto at = std::lower_bound(at_.begin(), at_.end(), std::pair(level.vertex[v], std::size_t{0}));
      if (at != at_.end() && at->first == level.vertex[v]) shared.push_back({v, at->second});
    }
    if (2 * shared.size() < at_.size()) return false;
    for (const auto& [v, w] : shared) level.points[v] = mesh_.points[w];
    return true;
  }

 private:
  const QuadMesh& mesh_;
  std::vector<std::pair<VertexId, std::size_t>> at_;
};

// The surfaces that the levels are fitted to where not all of the topology is open, K^j, for distances to them.
class ClosedSurfaces {
 public:
  ClosedSurfaces(const BaseSurface& base, const std::vector<int>& opened_on, int depth) {
    for (int j = 0; j <= depth; ++j) {
      std::vector<bool> open;
      for (const int on : opened_on) open.push_back(on <= j);
      std::shared_ptr<const DistanceReference>& reference = of_[open];
      if (!reference && std::find(open.begin(), open.end(), false) != open.end())
        reference = std::make_shared<const DistanceReference>(to_soup(open_topology(*base.series, open).surface));
      at_level_.push_back(reference);
    }
  }
  // Null where all is open.
  const DistanceReference* at(int level) const { return at_level_[level].get(); }

 private:
  std::map<std::vector<bool>, std::shared_ptr<const DistanceReference>> of_;
  std::vector<std::shared_ptr<const DistanceReference>> at_level_;
};

SurfaceFitOptions for_task(SurfaceFitOptions options, const RemeshTask& task) {
  options.sizes = task.sizes().get();
  options.surface = task.source.placed();
  return options;
}

}  // namespace

SurfaceFitOptions level_fit(bool finest, int level) {
  SurfaceFitOptions options;
  options.finest = level;
  FitOptions& fit = options.first;
  if (finest) {
    options.turns = 2;
    options.apart = true;
    fit.rounds = 2;
    // Only where quads are as good as square: elsewhere the shape would suffer more than the distance gains.
    fit.square_smoothness = 0.012;
    fit.poor = 0.96;
    fit.square = 0.985;
  } else {
    options.turns = 1;
    fit.rounds = 1;
    // Held closer to where the map puts them, or corners overshoot tips.
    fit.tangential = 0.1;
  }
  return options;
}

void fit_uniform(const RemeshTask& task, Candidate& c, int level) {
  task.progress.stage("fit");
  task.watch.start("fit");
  c.hierarchy.refine_uniform(std::max(level, c.finest));
  c.final_mesh = c.hierarchy.level_mesh(level);
  fit_to_surface(c.final_mesh, c.hierarchy, for_task(level_fit(true, level), task), task.progress.part(0.6, 0.8));
}

void fit_adaptive(const RemeshTask& task, Candidate& c, std::int64_t vertices) {
  task.progress.stage("adaptive refinement");
  task.watch.start("adaptive");
  AdaptiveOptions adaptive;
  // An error bound alone asks for as few vertices as meet it, however many that are.
  adaptive.vertices = task.options.error > 0 && task.options.vertices == 0 ? 0 : vertices;
  adaptive.error = task.options.error;
  adaptive.sizes = task.sizes().get();
  adaptive.surface = task.source.placed();
  if (task.source.half) adaptive.cut_euler = task.source.half->cut_euler;
  if (task.options.levels >= 0) adaptive.deepest = task.options.levels;
  c.final_mesh = refine_adaptively(c.hierarchy, *task.source.reference, adaptive, task.progress.part(0.55, 0.8));
}

void measure_level(const RemeshTask& task, Candidate& c, int level, const DistanceReference* closed, const Progress& progress) {
  const QuadMesh& mesh = c.level_meshes[level];
  const bool last = level + 1 == static_cast<int>(c.level_meshes.size());
  DistanceOptions samples;
  if (!last) samples.samples = 30000;
  const SurfaceDistance distance = task.source.reference->distance(to_soup(mesh), samples, progress);
  if (last) c.distance = distance;
  std::optional<SurfaceDistance> to_closed;
  if (closed) to_closed = closed->distance(to_soup(mesh), samples, progress);
  c.level_reports[level] = describe_level(c.hierarchy, level, mesh, distance, to_closed);
}

void finish_levels(const RemeshTask& task, Candidate& c) {
  task.progress.stage("levels");
  task.watch.start("levels");
  const int depth = c.hierarchy.depth();
  const FittedVertices fitted(c.final_mesh);
  const ClosedSurfaces closed(task.base, c.opened_on, depth);
  c.level_meshes.assign(depth + 1, {});
  c.level_reports.assign(depth + 1, {});
  // The finest, which take the longest, first.
  parallel_for_each_index(depth + 1, [&](std::int64_t k) {
    const int j = depth - static_cast<int>(k);
    const bool last = j == depth;
    const Progress part = task.progress.part(0.8, last ? 0.95 : 0.8);
    QuadMesh& mesh = c.level_meshes[j];
    mesh = last ? c.final_mesh : c.hierarchy.level_mesh(j);
    if (!last) {
      SurfaceFitOptions options = for_task(level_fit(false, j), task);
      // A level that is nearly the final mesh begins with that and has little left to do.
      if (fitted.place(mesh)) options.turns = 0;
      fit_to_surface(mesh, c.hierarchy, options, part);
    }
    measure_level(task, c, j, closed.at(j), part);
  });
  task.watch.stop();
}

}  // namespace hybrid_mesh
