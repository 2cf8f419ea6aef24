// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/reader/stream_content.h"

#include <algorithm>
#include <cmath>

#include "decoder/error.h"
#include "decoder/planes/coefficient_scale.h"
#include "decoder/transform/plain_levels.h"
#include "decoder/transform/surface_frames.h"

namespace hybrid_mesh {

double StreamPlacement::unit() const { return std::ldexp(mantissa, exponent); }

Point3 StreamPlacement::inward(const Point3& point) const {
  const auto moved = [&](double x, int i) { return x / unit() - static_cast<double>(origin[i]) / 16; };
  return {moved(point.x, 0), moved(point.y, 1), moved(point.z, 2)};
}

int last_plane(int depth, int level) { return 27 - (depth - level); }

int bits_at(int plane, int depth) { return std::min(plane + depth - 3, base_bits); }

std::shared_ptr<StreamGeometry> stream_geometry(QuadForest forest) {
  auto geometry = std::make_shared<StreamGeometry>();
  geometry->forest = std::move(forest);
  const int depth = geometry->forest.depth();
  geometry->meshes.reserve(depth + 1);
  for (int j = 0; j <= depth; ++j) {
    geometry->meshes.push_back(geometry->forest.connectivity(j, LevelKind::N, geometry->forest.closure()));
    if (j > 0)
      geometry->steps.push_back(
          std::make_unique<LevelStep>(geometry->forest, geometry->meshes[j - 1], geometry->meshes[j], j, BoundaryRule::EdgesOnly));
  }
  return geometry;
}

std::shared_ptr<StreamGeometry> plain_geometry(QuadForest base, int depth) {
  auto geometry = std::make_shared<StreamGeometry>();
  geometry->forest = std::move(base);
  geometry->is_plain = true;
  PlainLevels levels(geometry->forest, geometry->forest.connectivity(0, LevelKind::N, geometry->forest.closure()));
  for (int j = 1; j <= depth; ++j) {
    PlainLevels::Step step = levels.refine(j == depth);
    geometry->meshes.push_back(std::move(step.mesh));
    geometry->steps.push_back(std::make_unique<LevelStep>(std::move(step.quads), std::move(step.rows), j));
  }
  geometry->meshes.push_back(levels.mesh());
  return geometry;
}

QuadForest whole_forest(const StreamGeometry& geometry) {
  QuadForest forest = geometry.forest;
  if (!geometry.is_plain) return forest;
  forest.reserve_levels(geometry.depth());
  forest.refine_uniform(geometry.depth());
  return forest;
}

void add_layouts(StreamGeometry& geometry, const std::vector<char>& remainders) {
  for (std::size_t j = geometry.layouts.size(); j < geometry.steps.size(); ++j)
    geometry.layouts.push_back(
        coefficient_layout(geometry.forest, *geometry.steps[j], geometry.meshes[j], geometry.meshes[j + 1], remainders[j] != 0));
}

std::vector<Point3> base_points(const StreamContent& content) {
  std::vector<Point3> points;
  points.reserve(content.base.steps.size() / 3);
  for (std::size_t i = 0; i < content.base.steps.size(); i += 3)
    points.push_back({content.base.value(i), content.base.value(i + 1), content.base.value(i + 2)});
  return points;
}

std::vector<Point3> next_points(const StreamGeometry& geometry, const StreamContent& content, int j, const std::vector<Point3>& points) {
  const LevelStep& step = *geometry.steps[j];
  const LevelMesh& mesh = geometry.meshes[j + 1];
  const CoefficientLayout& layout = geometry.layouts[j];
  const Coefficients& known = content.levels[j];
  std::vector<Point3> fine(mesh.vertex_count());
  step.subdivided(points.data(), fine.data());
  const std::size_t count = step.details().size();
  std::vector<Point3> details(layout.items.size());
  std::vector<char> wanted(fine.size(), 0);
  for (std::size_t i = 0; i < layout.items.size(); ++i)
    if (!known.is_zero(i)) wanted[layout.items[i].vertex] = 1;
  const SurfaceFrames frames(mesh.offsets, mesh.indices, fine.data(), fine.size(), wanted.data());
  std::array<std::array<double, components>, 3> scale;
  for (int kind = 0; kind < 3; ++kind)
    for (std::size_t c = 0; c < components; ++c) scale[kind][c] = coefficient_scale(kind, c, geometry.depth() - 1 - j);
  for (std::size_t i = 0; i < layout.items.size(); ++i) {
    if (known.is_zero(i)) continue;
    const auto [vertex, kind, unturned] = layout.items[i];
    const Frame frame = unturned ? coordinate_axes : frames(vertex);
    for (std::size_t c = 0; c < components; ++c) details[i] += known.value(components * i + c) / scale[kind][c] * frame[c];
  }
  step.add_details(fine.data(), details.data(), layout.items.size() > count ? details.data() + count : nullptr);
  return fine;
}

void place_points(const StreamPlacement& placement, std::vector<Point3>& points) {
  const double unit = placement.unit();
  const auto moved = [&](double x, int i) { return (x + static_cast<double>(placement.origin[i]) / 16) * unit; };
  bool finite = true;
  for (Point3& point : points) {
    point = {moved(point.x, 0), moved(point.y, 1), moved(point.z, 2)};
    finite &= point.is_finite();
  }
  if (!finite) throw Error(ErrorCode::CorruptStream, "not a valid hierarchy stream: a vertex farther away than numbers go");
}

}  // namespace hybrid_mesh
