// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes are refused in words or give meshes, of which a shorter prefix has the same connectivity, by way of the header for C. The first four are
// those of a stream, so that the fuzzer gets past them.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "decoder/reader/hybrid_mesh_decoder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes = {'H', 'M', 'w', 1};
  bytes.insert(bytes.end(), data, data + size);
  hybrid_mesh_decoder* decoder = hybrid_mesh_decoder_open(bytes.data(), bytes.size());
  if (!decoder) std::abort();
  hybrid_mesh_decoder_limit(decoder, 20000);
  const hybrid_mesh_status status = hybrid_mesh_decoder_decode(decoder, 0, -1);
  if (status == HYBRID_MESH_OK) {
    const std::size_t vertices = hybrid_mesh_decoder_vertex_count(decoder), faces = hybrid_mesh_decoder_face_count(decoder);
    for (std::size_t i = 0; i < 3 * vertices; ++i)
      if (!std::isfinite(hybrid_mesh_decoder_points(decoder)[i])) std::abort();
    for (std::int64_t c = 0; c < hybrid_mesh_decoder_offsets(decoder)[faces]; ++c)
      if (static_cast<std::size_t>(hybrid_mesh_decoder_indices(decoder)[c]) >= vertices) std::abort();
    if (hybrid_mesh_decoder_decode(decoder, bytes.size() - 1, -1) == HYBRID_MESH_OK && hybrid_mesh_decoder_face_count(decoder) != faces) std::abort();
  } else if (status != HYBRID_MESH_CORRUPT) {
    std::abort();
  }
  hybrid_mesh_decoder_close(decoder);
  return 0;
}
