// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Khodakovsky, Schroeder, Sweldens, Progressive geometry compression, 2000; the order of bits is that of bit-planes of coefficients that
// are weighed by what they do to the finest level's mean square.
#include "codec/stream_body.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "codec/coefficient_scale.h"
#include "codec/surface_frames.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void corrupt(const std::string& what) { throw Error(ErrorCode::CorruptStream, std::string("not a valid hierarchy stream: ") + what); }

// Of the bits of the base's coordinates, as many as the details' steps make worth while.
int bits_at(int plane, int depth) { return std::min(plane + depth - 3, base_bits); }

constexpr int least_rough_bits = 5, most_rough_bits = 12;

double dot(const Vec3& a, const Vec3& b) { return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z(); }

// The details and remainder that coefficients stand for, added to where subdivision alone puts a level.
std::vector<Vec3> detailed_points(const WaveletStep& step, const CoefficientLayout& layout, const Coefficients& known, const SurfaceFrames& frames,
                                  int levels, std::vector<Vec3> subdivided) {
  const std::size_t count = step.details().size();
  std::vector<Vec3> details(count, Vec3::Zero()), remainder(layout.items.size() - count, Vec3::Zero());
  for (std::size_t i = 0; i < layout.items.size(); ++i) {
    if (known.is_zero(i)) continue;
    const auto [vertex, kind, unturned] = layout.items[i];
    const Frame frame = unturned ? coordinate_axes : frames(vertex);
    Vec3& detail = i < count ? details[i] : remainder[i - count];
    for (std::size_t c = 0; c < components; ++c) {
      const double value = known.value(components * i + c) / coefficient_scale(kind, c, levels);
      const Vec3& axis = frame[c];
      detail = {detail.x() + value * axis.x(), detail.y() + value * axis.y(), detail.z() + value * axis.z()};
    }
  }
  return step.detailed(std::move(subdivided), details, remainder);
}

Coefficients quantised(const CoefficientLayout& layout, const LevelAnalysis& analysis, const SurfaceFrames& frames, int levels, int plane) {
  Coefficients result;
  result.plane = result.last_plane = plane;
  std::uint32_t largest = 0;
  for (std::size_t i = 0; i < layout.items.size(); ++i) {
    const auto [vertex, kind, unturned] = layout.items[i];
    const Frame frame = unturned ? coordinate_axes : frames(vertex);
    const Vec3& detail = i < analysis.details.size() ? analysis.details[i] : analysis.remainder[i - analysis.details.size()];
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

double StreamPlacement::unit() const { return std::ldexp(mantissa, exponent); }

Vec3 StreamPlacement::inward(const Vec3& point) const {
  Vec3 result;
  for (int i = 0; i < 3; ++i) result[i] = point[i] / unit() - static_cast<double>(origin[i]) / 16;
  return result;
}

Vec3 StreamPlacement::outward(const Vec3& point) const {
  Vec3 result;
  for (int i = 0; i < 3; ++i) result[i] = (point[i] + static_cast<double>(origin[i]) / 16) * unit();
  return result;
}

int last_plane(int depth, int level) { return 27 - (depth - level); }

std::shared_ptr<StreamGeometry> stream_geometry(HybridMesh mesh) {
  auto geometry = std::make_shared<StreamGeometry>();
  geometry->mesh = std::move(mesh);
  geometry->steps = wavelet_steps(geometry->mesh);
  return geometry;
}

void add_layouts(StreamGeometry& geometry, const std::vector<char>& remainders) {
  for (std::size_t j = geometry.layouts.size(); j < geometry.steps.size(); ++j)
    geometry.layouts.push_back(coefficient_layout(geometry.mesh, geometry.steps[j], remainders[j]));
}

StreamContent analyse(StreamGeometry& geometry, const std::vector<Vec3>& points) {
  StreamContent content;
  content.placement = placement_of(points);
  std::vector<Vec3> at;
  for (const Vec3& point : points) at.push_back(content.placement.inward(point));
  const auto depth = static_cast<int>(geometry.steps.size());
  std::vector<LevelAnalysis> analyses(depth);
  content.remainders.assign(depth, 0);
  for (int j = depth - 1; j >= 0; --j) {
    analyses[j] = geometry.steps[j].analyse(at);
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
  for (std::size_t v = 0; v < at.size(); ++v)
    for (std::size_t i = 0; i < 3; ++i) at[v][static_cast<int>(i)] = content.base.value(3 * v + i);
  for (int j = 0; j < depth; ++j) {
    at = geometry.steps[j].subdivided(at);
    const SurfaceFrames frames(geometry.steps[j].fine(), at);
    content.levels.push_back(quantised(geometry.layouts[j], analyses[j], frames, depth - 1 - j, last_plane(depth, j + 1)));
    at = detailed_points(geometry.steps[j], geometry.layouts[j], content.levels[j], frames, depth - 1 - j, std::move(at));
    first = std::min(first, content.levels[j].first_plane);
  }
  content.rough_bits = std::clamp(bits_at(first, depth), least_rough_bits, most_rough_bits);
  return content;
}

std::vector<std::vector<Vec3>> synthesise(const StreamGeometry& geometry, const StreamContent& content) {
  std::vector<std::vector<Vec3>> levels(1);
  for (std::size_t i = 0; i < content.base.steps.size(); i += 3)
    levels[0].emplace_back(content.base.value(i), content.base.value(i + 1), content.base.value(i + 2));
  const auto depth = static_cast<int>(geometry.steps.size());
  for (int j = 0; j < depth; ++j) {
    std::vector<Vec3> subdivided = geometry.steps[j].subdivided(levels[j]);
    const SurfaceFrames frames(geometry.steps[j].fine(), subdivided);
    levels.push_back(detailed_points(geometry.steps[j], geometry.layouts[j], content.levels[j], frames, depth - 1 - j, std::move(subdivided)));
  }
  return levels;
}

void StreamCoder::code_head(int depth, StreamContent& known, const StreamContent* all) {
  NumberModel number;
  std::array<NumberModel, 2> plane;
  StreamPlacement& placement = known.placement;
  if (all) placement = all->placement;
  placement.exponent = static_cast<int>(number.code_signed(coder_, placement.exponent));
  if (std::abs(placement.exponent) > 1000) corrupt("a unit out of range");
  int mantissa = 1;
  for (int i = 6; i >= 0; --i) mantissa = 2 * mantissa + coder_.code_raw((placement.mantissa >> i) & 1);
  placement.mantissa = mantissa;
  for (std::int64_t& origin : placement.origin) origin = number.code_signed(coder_, origin);
  known.remainders.assign(depth, 0);
  known.levels.resize(depth);
  int before = 0;
  for (int j = 0; j < depth; ++j) {
    known.remainders[j] = coder_.code_raw(all && all->remainders[j]);
    known.levels[j].last_plane = last_plane(depth, j + 1);
    before += static_cast<int>(plane[j > 0].code_signed(coder_, all ? all->levels[j].first_plane - before : 0));
    // So that no coefficient leads out of 32 bits.
    if (before < known.levels[j].last_plane - 30 || before > known.levels[j].last_plane + 1) corrupt("a bit-plane out of range");
    known.levels[j].first_plane = before;
    known.levels[j].plane = before - 1;
  }
  known.rough_bits = static_cast<int>(number.code(coder_, all ? all->rough_bits : 0));
  if (known.rough_bits > base_bits) corrupt("too many bits of the base");
}

void StreamCoder::code_base(const StreamGeometry& geometry, StreamContent& known, const StreamContent* all) {
  const QuadMesh base = geometry.mesh.level_mesh(0);
  code_base_points(coder_, base, known.base, known.rough_bits, all ? &all->base : nullptr);
  for (std::size_t j = 0; j < geometry.layouts.size(); ++j) {
    known.levels[j].size.assign(components * geometry.layouts[j].items.size(), 0);
    known.levels[j].negative.assign(known.levels[j].size.size(), 0);
    known.levels[j].coded = known.levels[j].size.size();
  }
}

void StreamCoder::code_planes(const StreamGeometry& geometry, StreamContent& known, const StreamContent* all) {
  PlaneCoder planes(coder_);
  const auto depth = static_cast<int>(known.levels.size());
  const BasePoints* base = all ? &all->base : nullptr;
  int first = 0, last = -1;
  for (int j = 0; j < depth; ++j) {
    first = std::min(first, known.levels[j].first_plane);
    last = std::max(last, known.levels[j].last_plane);
  }
  for (int plane = first; plane <= last; ++plane) {
    while (known.base.bits < bits_at(plane, depth)) refine_base_points(coder_, known.base, base);
    for (int j = 0; j < depth; ++j) {
      Coefficients& level = known.levels[j];
      if (plane < level.first_plane || plane > level.last_plane) continue;
      planes.code(geometry.layouts[j], level, j > 0 ? &geometry.layouts[j - 1] : nullptr, j > 0 ? &known.levels[j - 1] : nullptr,
                  geometry.steps[j].coarse().vertex_count(), j + 1, plane, all ? &all->levels[j] : nullptr);
    }
  }
  while (known.base.bits < base_bits) refine_base_points(coder_, known.base, base);
}

}  // namespace hybrid_mesh
