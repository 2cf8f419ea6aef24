// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/source.h"

#include <algorithm>
#include <limits>

#include "surface/fingerprint.h"
#include "topology/topological_noise.h"

namespace hybrid_mesh {
namespace {

std::string describe(const RepairReport& r) {
  std::string text;
  const auto add = [&](std::int64_t n, const char* what) {
    if (n > 0) text += (text.empty() ? "" : ", ") + std::to_string(n) + " " + what;
  };
  add(r.merged_points, "points to merge");
  add(r.isolated_points, "isolated points");
  add(r.duplicate_faces, "duplicate faces");
  add(r.degenerate_faces, "degenerate faces");
  add(r.reoriented_faces, "misoriented faces");
  add(r.nonmanifold_edges, "non-manifold edges");
  add(r.nonmanifold_vertices, "non-manifold vertices");
  add(r.one_sided_cuts, "one-sided edges");
  add(r.dropped_components, "components to drop");
  return text;
}

// For good: the surface that is remeshed does not have them.
void close_small_handles(Source& source, double length, const Progress& progress) {
  ClosedNoise closed = close_noise(source.repaired, length * source.placement.diagonal, progress);
  source.removed_handles = closed.handles;
  source.repaired = std::move(closed.surface);
  // Caps show what is beside them.
  TriangleSurface& surface = source.repaired;
  for (bool any = true; any;) {
    any = false;
    for (std::size_t h = 0; h < surface.opposite.size(); ++h) {
      const int across = surface.opposite[h];
      if (surface.source_face[h / 3] >= 0 || across < 0 || surface.source_face[across / 3] < 0) continue;
      surface.source_face[h / 3] = surface.source_face[across / 3];
      any = true;
    }
  }
}

// Fewer vertices a corner of features have no room for the quads around it: a cube of 24 quads has 3.25. Below the second number there often is none.
constexpr double kLeastVerticesACorner = 3, kVerticesACorner = 10;

}  // namespace

void look_for_features(Source& source, const RemeshOptions& options) {
  std::optional<FeatureOptions> wanted = feature_options(source, options.features, options.feature_angle);
  if (!wanted) return;
  wanted->least_length *= source.placement.diagonal;
  const FeatureGraph graph = find_features(source.repaired, *wanted);
  source.has_features = !graph.empty();
  for (std::size_t h = 0; h < graph.edges.size(); ++h) source.has_inner_features |= graph.edges[h] && source.repaired.opposite[h] >= 0;
  source.feature_corners = static_cast<int>(std::count(graph.corners.begin(), graph.corners.end(), 1));
  const double corners = source.copies() * source.feature_corners;
  const auto has = [&](double vertices_a_corner) {
    return options.vertices == 0 || vertices_a_corner * corners <= static_cast<double>(options.vertices);
  };
  source.keeps_features = source.has_features && has(kLeastVerticesACorner);
  source.features_are_crowded = !has(kVerticesACorner);
}

std::optional<FeatureOptions> feature_options(const Source& source, Features features, double angle) {
  FeatureOptions options;
  if (features == Features::None) return {};
  options.polygons = !source.mirror;  // a half's cut is a boundary of its own
  if (features == Features::Given) {
    options.angle = options.weak_angle = angle;
    options.crispness = options.least_total = 0;
    options.most_left = std::numeric_limits<double>::infinity();
  }
  return options;
}

Source read_source(PolygonSoup input, const RemeshOptions& options, const Progress& progress, Stopwatch& watch) {
  progress.stage("repair");
  watch.start("repair");
  Source source;
  source.read_points = input.points.size();
  source.read_polygons = input.polygon_count();
  RepairOptions repair_options;
  repair_options.drop_components = options.drop_components;
  source.repaired = repair(input, repair_options, source.repairs, progress);
  if (options.strict && source.repairs.changed())
    throw Error(ErrorCode::InvalidInput, "the input needs repair, which strict mode refuses: " + describe(source.repairs));
  source.placement = placement_of(source.repaired.points);
  if (options.remove_noise > 0) close_small_handles(source, options.remove_noise, progress);
  source.topology = source.made = summarize_topology(to_soup(source.repaired));
  source.points = static_cast<std::int64_t>(source.repaired.points.size());
  source.area = surface_area(source.repaired) / (source.placement.diagonal * source.placement.diagonal);
  look_for_features(source, options);
  source.density = read_density(input, options.density, source.repaired, source.placement);
  source.fingerprint = fingerprint(source.repaired, source.density.sizes ? source.density.values : std::vector<double>());
  for (Vec3& p : input.points) p = source.placement.to_unit(p);
  source.reference = std::make_unique<const DistanceReference>(input);
  watch.stop();
  return source;
}

}  // namespace hybrid_mesh
