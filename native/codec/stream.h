// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/context.h"
#include "decoder/reader/stream_coder.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// A hierarchy as one embedded stream (decoder/FORMAT.md): connectivity and a rough base, then details from coarse to fine. Every prefix that has the
// base whole is a stream; the more there is of it, the nearer positions come. It carries the final mesh; levels have what analysis of it leaves of
// them (see wavelet_step.h). Maps, metadata and names of vertices are not in it.

enum class StreamFit {
  Auto,  // the final mesh is fitted for the rate (rate_fit.h) to the surface that is given, else to that under the hierarchy's maps if it lies on it
         // (or the final mesh that is given where that makes the better stream: the fitted one is farther from the surface, beyond 5 %)
  None   // the final mesh that is given is what the whole of the stream has
};

struct StreamOptions {
  std::size_t most_bytes = 0;  // 0: no bound
  // The shortest prefix with an L2 distance, between the surface that is given, else the final mesh that is given, and the final mesh that is
  // decoded, of no more than this fraction of the first one's bounding-box diagonal (see distance.h). 0: no bound
  double error = 0;
  StreamFit fit = StreamFit::Auto;
  std::shared_ptr<const PolygonSoup> surface = nullptr;  // that the final mesh was made of; none: it is not at hand
};

// Throws Error{Unsupported} if an operation is switched off, Error{InvalidInput} if the hierarchy is empty, positions are not finite, or the bound on
// bytes is too small for the base.
std::vector<std::uint8_t> encode_stream(const HybridMesh& hierarchy, const StreamOptions& options, const Progress& progress);

// With positions of all levels and of the final mesh. Throws Error{CorruptStream} for anything that is not a stream or ends before its base does,
// Error{Unsupported} for a later version.
HybridMesh decode_stream(const std::uint8_t* data, std::size_t size);

}  // namespace hybrid_mesh
