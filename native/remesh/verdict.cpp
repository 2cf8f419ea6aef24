// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/verdict.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "remesh/figures.h"
#include "remesh/mirror_sides.h"
#include "remesh/protrusion.h"

namespace hybrid_mesh {
namespace {

// Above so many widths of its quads a mesh is farther from the surface than quads of that size explain; above that fraction of the diagonal whoever
// looks at it sees it, whatever the quads.
constexpr double kTooManyWidths = 3, kTooFar = 0.01;
constexpr double kManyWidths = 2;         // is worth knowing
constexpr double kManyInverted = 0.001;   // of the quads
constexpr double kManyPairs = 10;         // of faces that cross: twice as bad as one
constexpr double kEnoughVertices = 0.98;  // of those allowed
constexpr double kExact = 1e-6;           // a distance below which more vertices gain nothing

std::string widths(double distance, const Finished& f) { return formatted("%.1f", distance / f.width) + " widths of its quads"; }

// Above 1 it is.
double too_far(double distance, const Finished& f) { return std::max(distance / (kTooManyWidths * f.width), distance / kTooFar); }

std::string far_off(const Finished& f) {
  const RemeshTask& task = f.task;
  const double far = f.distance.hausdorff;
  std::string cause = "its quads are too large for the shape; more vertices or adaptive refinement follow it";
  if (far > kManyWidths * f.width)
    cause = protrusion(task.source.repaired, task.source.placement, f.candidate.final_mesh) > kManyWidths * f.width
                ? "a part that sticks out is lost; a larger base (base_quads) or adaptive refinement may keep it"
                : "a fold is closed, or a thin part is lost; more vertices or adaptive refinement follow it";
  return "the mesh is up to " + scientific(far) + " of the diagonal away from the surface, " + widths(far, f) + ": " + cause;
}

std::optional<Reason> surface_missed(const Finished& f) {
  const SurfaceDistance& d = f.distance;
  if (!(too_far(d.hausdorff, f) > 1)) return {};
  return Reason{"hausdorff", far_off(f), d.farthest, too_far(d.hausdorff, f)};
}

std::optional<Reason> boundary_missed(const Finished& f) {
  const SurfaceDistance& d = f.distance;
  if (!(too_far(d.boundary_hausdorff, f) > 1)) return {};
  return Reason{"boundary_hausdorff",
                "the mesh's boundary is up to " + scientific(d.boundary_hausdorff) + " of the diagonal away from the surface's, " +
                    widths(d.boundary_hausdorff, f) + ": more vertices or adaptive refinement follow it",
                d.boundary_farthest, too_far(d.boundary_hausdorff, f)};
}

std::optional<Reason> error_missed(const Finished& f) {
  const double bound = f.task.options.error, error = f.candidate.distance.l2;
  if (bound <= 0 || error <= bound) return {};
  return Reason{"error", "the error bound of " + scientific(bound) + " is not met: the L2 distance is " + scientific(error), {}};
}

std::optional<Reason> many_inverted(const Finished& f) {
  const QuadQuality& q = f.quality;
  if (q.inverted <= kManyInverted) return {};
  const QuadMesh& mesh = f.candidate.final_mesh;
  Vec3 middle = Vec3::Zero();
  for (int i = 0; i < 4; ++i) middle += mesh.points[mesh.indices[mesh.offsets[q.worst] + i]] / 4;
  return Reason{"inverted",
                std::to_string(std::lround(q.inverted * static_cast<double>(q.quads))) + " of " + std::to_string(q.quads) +
                    " quads are inverted: the surface is bent or thin there beyond what quads of this size follow; more vertices may help",
                middle, q.inverted / kManyInverted};
}

std::optional<Reason> runs_through_itself(const Finished& f) {
  const MeshIntersections& found = f.intersections;
  if (found.pairs == 0) return {};
  return Reason{"self_intersections",
                std::to_string(found.pairs) + (found.pairs == 1 ? " pair of faces runs" : " pairs of faces run") +
                    " through one another where the input does not: the surface is bent or thin there beyond what quads of this size follow; more "
                    "vertices may help",
                found.where, 1 + static_cast<double>(found.pairs) / kManyPairs};
}

std::optional<Reason> features_lost(const Finished& f) {
  const std::string why = why_features_are_lost(f.task, f.candidate);
  if (why.empty()) return {};
  return Reason{"features", "the sharp edges of the surface are not kept: " + why, {}};
}

std::optional<Reason> few_vertices(const Finished& f) {
  const RemeshOptions& options = f.task.options;
  const bool uniform = options.refinement == Refinement::Uniform;
  const bool other_bound = options.error > 0 || options.levels >= 0;
  const bool base_is_as_told = uniform && (options.base == BaseSize::Given || f.candidate.base_given);
  const std::int64_t used = whole_vertices(f.candidate.final_mesh, f.task.source);
  const auto made = static_cast<double>(used), allowed = static_cast<double>(options.vertices);
  const bool is_exact = f.distance.hausdorff < kExact;
  if (options.vertices == 0 || other_bound || base_is_as_told || is_exact || made >= kEnoughVertices * allowed) return {};
  const std::string left = !uniform                            ? "no more of its quads could be split"
                           : options.base == BaseSize::Minimal ? "the next level would have too many; an automatic base (base_quads) or adaptive "
                                                                 "refinement uses them"
                                                               : "no base was found that uses them; adaptive refinement does";
  return Reason{"vertices",
                "only " + std::to_string(used) + " of the " + std::to_string(options.vertices) + " vertices that are allowed are used, " +
                    formatted("%.1f", 100 * made / allowed) + " %: " + left,
                {}};
}

// In the order in which people want to know.
constexpr std::optional<Reason> (*kReasons[])(const Finished&) = {surface_missed,      boundary_missed, error_missed, many_inverted,
                                                                  runs_through_itself, features_lost,   few_vertices};

}  // namespace

std::string why_features_are_lost(const RemeshTask& task, const Candidate& candidate) {
  if (!task.source.has_features || candidate.keeps_features) return {};
  if (!candidate.lost_features.empty()) return candidate.lost_features;
  if (!task.source.keeps_features) return "they have more corners than the mesh has room for; more vertices have";
  if (task.base.series) return "handles, boundaries or tubes open on finer levels; with topology in the base they are";
  return "the plan's base was laid out without them";
}

Finished measured(const RemeshTask& task, const Candidate& candidate, const Progress& progress) {
  const Source& source = task.source;
  const QuadMesh& mesh = candidate.final_mesh;
  SurfaceDistance distance = candidate.distance;
  if (source.symmetric) {
    distance = source.symmetric->distance(to_soup(mesh), DistanceOptions(), progress.part(0, 0.5));
  } else if (source.repairs.dropped_components > 0 || source.removed_handles > 0) {
    const DistanceReference wanted(to_soup(source.placement.to_unit(source.repaired)));
    distance = wanted.distance(to_soup(mesh), DistanceOptions(), progress.part(0, 0.5));
  }
  return {task, candidate, quad_quality(mesh), mean_width(mesh), distance, mesh_intersections(mesh, source.placed(), progress.part(0.5, 1))};
}

std::vector<Reason> reasons_against(const Finished& finished) {
  std::vector<Reason> reasons;
  for (const auto& against : kReasons)
    if (std::optional<Reason> reason = against(finished)) reasons.push_back(std::move(*reason));
  return reasons;
}

std::vector<std::string> warnings(const Finished& f) {
  std::vector<std::string> list;
  const Candidate& c = f.candidate;
  if (f.distance.hausdorff > kManyWidths * f.width && !too_far(f.distance.hausdorff, f)) list.push_back(far_off(f));
  if (const Density& density = f.task.source.density; density.outside > 0)
    list.push_back(std::to_string(density.outside) + " values of the density '" + density.name +
                   "' are not in 0 to 1, and count as the nearer of the two");
  std::string levels;
  for (std::size_t j = 0; j + 1 < c.level_reports.size(); ++j) {
    const nlohmann::ordered_json &level = c.level_reports[j], &closed = level["closed_surface"];
    const double off = (closed.is_null() ? level : closed)["hausdorff"].get<double>() / mean_width(c.level_meshes[j]);
    if (off > kManyWidths) levels += (levels.empty() ? "N" : ", N") + std::to_string(j);
  }
  if (!levels.empty())
    list.push_back("coarser levels lose parts of the shape: some of the surface is farther from " + levels + " than " +
                   std::to_string(std::lround(kManyWidths)) + " widths of a quad; a larger base (base_quads) goes out into them");
  return list;
}

}  // namespace hybrid_mesh
