// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/surface_fit.h"

#include <algorithm>
#include <cmath>

#include "remesh/angle_relaxation.h"
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

void fit_to_samples(QuadMesh& mesh, std::vector<FitSample> on, const std::vector<double>& share, const SurfaceFitOptions& options,
                    const Progress& progress) {
  const std::vector<char> held = held_vertices(mesh);
  FitOptions fit = options.first;
  fit_mesh(mesh, held, share, on, fit, progress);
  // The least squares decide where the mesh lies, the angles where its vertices lie on it; in turns, since each disturbs the other a little.
  for (int turn = 0; turn < options.turns; ++turn) {
    relax_angles(mesh, held, AngleRelaxationOptions(), progress);
    fit.rounds = turn + 1;
    fit_mesh(mesh, held, share, on, fit, progress);
  }
  // What is still folded is unfolded even where the surface bends: a few quads, at the cost of a little distance.
  AngleRelaxationOptions unfold;
  unfold.enough = 0.05;
  unfold.flatness = -1;
  unfold.reach = options.unfold;
  relax_angles(mesh, held, unfold, progress);
}

}  // namespace hybrid_mesh
