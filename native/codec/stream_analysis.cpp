// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/stream_analysis.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "decoder/planes/coefficient_scale.h"
#include "decoder/transform/surface_frames.h"
#include "hierarchy/flat_points.h"
#include "wavelets/wavelet_step.h"

namespace hybrid_mesh {

namespace {

constexpr int least_rough_bits = 5, most_rough_bits = 12;

Coefficients quantised(const CoefficientLayout& layout, const LevelAnalysis& analysis, const SurfaceFrames& frames, int levels, int plane) {
  Coefficients result;
  result.plane = result.last_plane = plane;
  std::uint32_t largest = 0;
  for (std::size_t i = 0; i < layout.items.size(); ++i) {
    const auto [vertex, kind, unturned] = layout.items[i];
    const Frame frame = unturned ? coordinate_axes : frames(vertex);
    const Vec3& vector = i < analysis.details.size() ? analysis.details[i] : analysis.remainder[i - analysis.details.size()];
    const Point3 detail{vector.x(), vector.y(), vector.z()};
    for (std::size_t c = 0; c < components; ++c) {
      const double steps = std::ldexp(dot(detail, frame[c]) * coefficient_scale(kind, c, levels), plane);
      if (!(std::abs(steps) < 1u << 30)) throw Error(ErrorCode::Unsupported, "a stream cannot hold details this large");
      result.size.push_back(static_cast<std::uint32_t>(std::abs(steps)));
      result.negative.push_back(steps < 0);
      largest = std::max(largest, result.size.back());
    }
  }
  result.coded = result.size.size();
  result.first_plane = plane + 1;
  for (; largest > 0; largest /= 2) --result.first_plane;
  return result;
}

StreamPlacement placement_of(const std::vector<Vec3>& points) {
  Vec3 low = points[0], high = points[0];
  for (const Vec3& point : points) low = low.cwiseMin(point), high = high.cwiseMax(point);
  StreamPlacement placement;
  const double diagonal = (high - low).norm();
  if (diagonal > 0 && std::isfinite(diagonal)) {
    placement.mantissa = static_cast<int>(std::ceil(std::ldexp(std::frexp(diagonal, &placement.exponent), 8)));
    placement.exponent -= 8;
    if (placement.mantissa == 256) placement.mantissa = 128, ++placement.exponent;
  }
  for (int i = 0; i < 3; ++i) {
    const double steps = std::nearbyint(16 * (0.5 * low[i] + 0.5 * high[i]) / placement.unit());
    if (!(std::abs(steps) < 1u << 30)) throw Error(ErrorCode::Unsupported, "a stream cannot hold a surface this far from the origin");
    placement.origin[i] = static_cast<std::int64_t>(steps);
  }
  return placement;
}

}  // namespace

StreamContent analyse(StreamGeometry& geometry, const std::vector<Vec3>& points) {
  StreamContent content;
  content.placement = placement_of(points);
  std::vector<Vec3> at;
  for (const Point3& point : flat_points(points)) {
    const Point3 moved = content.placement.inward(point);
    at.emplace_back(moved.x, moved.y, moved.z);
  }
  const int depth = geometry.depth();
  const std::vector<WaveletStep> steps = wavelet_steps(HybridMesh(geometry.forest));
  std::vector<LevelAnalysis> analyses(depth);
  content.remainders.assign(depth, 0);
  for (int j = depth - 1; j >= 0; --j) {
    analyses[j] = steps[j].analyse(at);
    content.remainders[j] = !analyses[j].remainder.empty();
    at = analyses[j].coarse;
  }
  content.base.bits = base_bits;
  for (const Vec3& point : at)
    for (int i = 0; i < 3; ++i) {
      const double steps = std::floor(std::ldexp(point[i] + base_shift, base_bits));
      if (!(std::abs(steps) < 1u << 30)) throw Error(ErrorCode::Unsupported, "a stream cannot hold a base this far from the surface");
      content.base.steps.push_back(static_cast<std::int32_t>(steps));
    }
  content.base.coded = content.base.steps.size();
  add_layouts(geometry, content.remainders);
  // Frames are those of what a reader has, so that to the last plane it has the same.
  int first = base_bits;
  std::vector<Point3> known = base_points(content);
  for (int j = 0; j < depth; ++j) {
    const LevelMesh& mesh = geometry.meshes[j + 1];
    std::vector<Point3> subdivided(mesh.vertex_count());
    geometry.steps[j]->subdivided(known.data(), subdivided.data());
    const SurfaceFrames frames(mesh.offsets, mesh.indices, subdivided.data(), subdivided.size());
    content.levels.push_back(quantised(geometry.layouts[j], analyses[j], frames, depth - 1 - j, last_plane(depth, j + 1)));
    known = next_points(geometry, content, j, known);
    first = std::min(first, content.levels[j].first_plane);
  }
  content.rough_bits = std::clamp(bits_at(first, depth), least_rough_bits, most_rough_bits);
  return content;
}

}  // namespace hybrid_mesh
