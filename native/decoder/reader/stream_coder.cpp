// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Khodakovsky, Schroeder, Sweldens, Progressive geometry compression, 2000; the order of bits is that of bit-planes of coefficients that
// are weighed by what they do to the finest level's mean square.
#include "decoder/reader/stream_coder.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "decoder/error.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void corrupt(const std::string& what) { throw Error(ErrorCode::CorruptStream, "not a valid hierarchy stream: " + what); }

}  // namespace

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

void StreamCoder::code_base(const LevelMesh& base, StreamContent& known, const StreamContent* all) {
  code_base_points(coder_, base, known.base, known.rough_bits, all ? &all->base : nullptr);
}

void StreamCoder::code_planes(const StreamGeometry& geometry, StreamContent& known, const StreamContent* all) {
  for (std::size_t j = 0; j < geometry.layouts.size(); ++j) {
    known.levels[j].size.assign(components * geometry.layouts[j].items.size(), 0);
    known.levels[j].negative.assign(known.levels[j].size.size(), 0);
    known.levels[j].coded = known.levels[j].size.size();
  }
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
                  geometry.meshes[j].vertex_count(), j + 1, plane, all ? &all->levels[j] : nullptr);
    }
  }
  while (known.base.bits < base_bits) refine_base_points(coder_, known.base, base);
}

bool is_stream(const std::uint8_t* data, std::size_t size) {
  return size >= stream_magic.size() && std::equal(stream_magic.begin(), stream_magic.end(), data);
}

DecodedStream decode_content(const std::uint8_t* data, std::size_t size, std::shared_ptr<const StreamGeometry> geometry, int most_quads) {
  if (size < stream_preamble || !is_stream(data, size)) corrupt("it starts with other bytes");
  const std::uint8_t version = data[stream_magic.size()];
  if (version == 0) corrupt("a version that never was");
  if (version > stream_version)
    throw Error(ErrorCode::Unsupported, "a hierarchy stream of version " + std::to_string(version) + ", newer than this program");
  BitReader reader(data + stream_preamble, size - stream_preamble);
  StreamCoder coder(reader, nullptr, most_quads);
  StreamContent content;
  try {
    QuadForest forest = coder.code_structure();
    const int depth = coder.depth(forest);
    coder.code_head(depth, content, nullptr);
    coder.code_base(forest.connectivity(0, LevelKind::N, forest.closure()), content, nullptr);
    if (!geometry) {
      const std::shared_ptr<StreamGeometry> made = coder.is_plain() ? plain_geometry(std::move(forest), depth) : stream_geometry(std::move(forest));
      add_layouts(*made, content.remainders);
      geometry = made;
    }
  } catch (const StreamEnd&) {
    corrupt("it ends before its base does");
  }
  try {
    coder.code_planes(*geometry, content, nullptr);
  } catch (const StreamEnd&) {
  }
  return {std::move(geometry), std::move(content)};
}

}  // namespace hybrid_mesh
