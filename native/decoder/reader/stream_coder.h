// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "decoder/reader/stream_content.h"
#include "decoder/structure/structure_coder.h"

namespace hybrid_mesh {

inline constexpr std::array<std::uint8_t, 3> stream_magic = {'H', 'M', 'w'};
inline constexpr std::uint8_t stream_version = 1;
inline constexpr std::size_t stream_preamble = stream_magic.size() + 1;

// Codes everything in the order of the stream (FORMAT.md). `given`: writers' hierarchy; `all`: what they know of it.
class StreamCoder {
 public:
  explicit StreamCoder(BitCoder& coder, const QuadForest* given = nullptr, int most_quads = most_stream_quads)
      : coder_(coder), structure_(coder, given, most_quads) {}
  // In this order.
  QuadForest code_structure() { return structure_.code(); }
  int depth(const QuadForest& structure) const { return structure_.depth(structure); }
  void code_head(int depth, StreamContent& known, const StreamContent* all);
  void code_base(const LevelMesh& base, StreamContent& known, const StreamContent* all);
  bool is_plain() const { return structure_.is_plain(); }
  QuadForest refined_to_depth(QuadForest structure) { return structure_.refined_to_depth(std::move(structure)); }
  void code_planes(const StreamGeometry& geometry, StreamContent& known, const StreamContent* all);

  VertexId given_vertex(VertexId vertex) const { return structure_.given_vertex(vertex); }

 private:
  BitCoder& coder_;
  StructureCoder structure_;
};

struct DecodedStream {
  std::shared_ptr<const StreamGeometry> geometry;
  StreamContent content;
};

// Whether the bytes start as a stream does, of whatever version.
bool is_stream(const std::uint8_t* data, std::size_t size);

// What a prefix says. `geometry`: of the same stream, if another prefix has been decoded already. Throws Error{CorruptStream} for anything that is
// not a stream, has more quads or ends before its base does, Error{Unsupported} for a later version. Memory is what the hierarchy takes that the base
// is refined to, which is not made before the base has been read; the base itself is no larger than so many bytes can tell.
DecodedStream decode_content(const std::uint8_t* data, std::size_t size, std::shared_ptr<const StreamGeometry> geometry = nullptr,
                             int most_quads = most_stream_quads);

}  // namespace hybrid_mesh
