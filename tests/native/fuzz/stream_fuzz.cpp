// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes are refused with an error or give a hierarchy that can be used. The first four are those of a stream, so that the fuzzer gets past them.
#include <cstdlib>
#include <vector>

#include "base/error.h"
#include "codec/stream.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hybrid_mesh;
  std::vector<std::uint8_t> bytes = {'H', 'M', 'w', 1};
  bytes.insert(bytes.end(), data, data + size);
  try {
    const HybridMesh mesh = decode_stream(bytes.data(), bytes.size());
    if (mesh.node_count() > 20000) return 0;
    if (!find_defects(mesh).empty()) std::abort();
    for (const Vec3& point : mesh.final_mesh().points)
      if (!point.allFinite()) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::CorruptStream && error.code() != ErrorCode::Unsupported) std::abort();
  }
  return 0;
}
