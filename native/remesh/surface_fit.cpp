// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/surface_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "remesh/angle_relaxation.h"
#include "remesh/crossing_faces.h"
#include "remesh/face_separation.h"
#include "remesh/mesh_intersections.h"
#include "remesh/quality.h"
#include "remesh/surface_samples.h"

namespace hybrid_mesh {

std::int64_t fit_sample_count(std::size_t vertices) { return std::clamp<std::int64_t>(12 * static_cast<std::int64_t>(vertices), 30000, 4000000); }

std::vector<double> parameter_shares(const HybridMesh& hierarchy, const QuadMesh& mesh, const SizeField* sizes) {
  std::vector<double> share(mesh.points.size(), 0);
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i)
      share[mesh.indices[i]] += std::ldexp(1.0, -2 * hierarchy.level(mesh.node[f]));
  std::vector<int> count(mesh.points.size(), 0);
  for (const std::int32_t v : mesh.indices) ++count[v];
  for (std::size_t v = 0; v < share.size(); ++v) share[v] /= std::max(1, count[v]);
  if (!sizes) return share;
  const std::vector<double> fineness = sizes->fineness(mesh.points);
  for (std::size_t v = 0; v < share.size(); ++v) share[v] /= fineness[v] * fineness[v];
  return share;
}

void fit_to_surface(QuadMesh& mesh, const HybridMesh& hierarchy, const SurfaceFitOptions& options, const Progress& progress) {
  const SurfaceSamples samples(hierarchy, fit_sample_count(mesh.points.size()), options.finest, options.sizes);
  fit_to_samples(mesh, samples.on(hierarchy, mesh), parameter_shares(hierarchy, mesh, options.sizes), options, progress);
}

namespace {

// A mesh and the samples that it is fitted to.
class SampleFit {
 public:
  SampleFit(QuadMesh& mesh, std::vector<FitSample> samples, const std::vector<double>& share, const SurfaceFitOptions& options,
            const Progress& progress)
      : mesh_(mesh), samples_(std::move(samples)), share_(share), options_(options), held_(held_vertices(mesh)), progress_(progress) {}

  void run() {
    const std::vector<Vec3> on_surface = mesh_.points;
    for (const FitSample& s : samples_) first_face_.push_back(s.face);
    const Badness start = badness();
    samples_to_first_faces();
    move(on_surface);
    // Walls far thinner than a quad is wide are no ground for least squares: samples walk to the other side.
    if (badness().is_worse_than(start)) mesh_.points = on_surface;
  }

 private:
  struct Badness {
    double distance = 0;  // root of the mean square
    std::size_t inverted = 0;
    bool is_worse_than(const Badness& o) const { return distance > o.distance + kUnseen && inverted >= o.inverted; }
  };
  static constexpr double kUnseen = 1e-6;  // of the surface's size

  Badness badness() {
    double weight = 0;
    for (const FitSample& s : samples_) weight += s.weight;
    return {weight > 0 ? std::sqrt(squared_distance(mesh_) / weight) : 0, inverted_quads(mesh_).size()};
  }

  void samples_to_first_faces() {
    for (std::size_t i = 0; i < samples_.size(); ++i) samples_[i].face = first_face_[i];
  }

  void move(const std::vector<Vec3>& on_surface) {
    fit(mesh_, options_.first.rounds);
    // The least squares decide where the mesh lies, the angles where its vertices lie on it; in turns, since each disturbs the other a little.
    for (int turn = 0; turn < options_.turns; ++turn) {
      relax_angles(mesh_, held_, AngleRelaxationOptions(), progress_);
      fit(mesh_, turn + 1);
    }
    unfold(mesh_);
    if (options_.apart) take_apart(on_surface);
  }

  void fit(QuadMesh& mesh, int rounds) {
    FitOptions options = options_.first;
    options.rounds = rounds;
    fit_mesh(mesh, held_, share_, samples_, options, progress_);
  }

  // What is still folded is unfolded even where the surface bends: a few quads, at the cost of a little distance.
  void unfold(QuadMesh& mesh, CrossingGuard* guard = nullptr) const {
    AngleRelaxationOptions unfold;
    unfold.enough = 0.05;
    unfold.flatness = -1;
    unfold.reach = options_.unfold;
    relax_angles(mesh, held_, unfold, progress_, guard);
  }

  // A fit may push one sheet of a thin part, or one side of a fold, through the other; with its vertices on the surface the mesh seldom does that.
  void take_apart(const std::vector<Vec3>& on_surface) {
    const CrossingFilter wrong = [&](const QuadMesh& mesh, CrossingFaces& pairs) { leave_out_those_of_surface(mesh, pairs); };
    const TakenBack first = take_back_crossings(mesh_, on_surface, wrong, progress_);
    if (!first.any) return;
    const double before = squared_distance(mesh_);
    QuadMesh again = mesh_;
    samples_to_first_faces();  // they may have walked to the other sheet
    fit(again, 1);
    unfold(again);
    const TakenBack second = take_back_crossings(again, mesh_.points, wrong, progress_);
    const double after = squared_distance(again);
    if (second.left <= first.left && after <= before) mesh_ = std::move(again);
    // What is left, and what going back has folded, vertex by vertex.
    CrossingGuard guard(mesh_);
    unfold(mesh_, &guard);
    separate_faces(mesh_, held_, on_surface, wrong, guard, progress_);
    unfold(mesh_, &guard);
  }

  // Takes out pairs that run through one another as the surface does: there the mesh is right.
  void leave_out_those_of_surface(const QuadMesh& mesh, CrossingFaces& pairs) {
    if (pairs.empty() || !options_.surface.surface) return;
    if (!surface_crossings_) surface_crossings_.emplace(options_.surface, progress_);
    const std::vector<char> in_surface = surface_crossings_->at(mesh, pairs, progress_);
    std::size_t at = 0;
    std::erase_if(pairs, [&](const auto&) { return in_surface[at++] != 0; });
  }

  // The sum over the samples, with their weights.
  double squared_distance(const QuadMesh& mesh) {
    const std::vector<double> squared = squared_distances(mesh, samples_);
    double sum = 0;
    for (std::size_t i = 0; i < squared.size(); ++i) sum += samples_[i].weight * squared[i];
    return sum;
  }

  QuadMesh& mesh_;
  std::vector<FitSample> samples_;
  const std::vector<double>& share_;
  const SurfaceFitOptions& options_;
  const std::vector<char> held_;
  const Progress& progress_;
  std::vector<int> first_face_;  // of every sample
  std::optional<SurfaceCrossings> surface_crossings_;
};

}  // namespace

void fit_to_samples(QuadMesh& mesh, std::vector<FitSample> samples, const std::vector<double>& share, const SurfaceFitOptions& options,
                    const Progress& progress) {
  SampleFit(mesh, std::move(samples), share, options, progress).run();
}

}  // namespace hybrid_mesh
