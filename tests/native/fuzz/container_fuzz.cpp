// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes are refused with an error or give a hierarchy that can be used. Checksums are put right first, so that the fuzzer gets past them.
#include <cstdlib>
#include <cstring>
#include <vector>

#include "base/error.h"
#include "codec/container.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hybrid_mesh;
  std::vector<std::uint8_t> bytes(data, data + size);
  for (std::size_t at = 16; at + 24 <= bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[at + 8], 8);
    if (length > bytes.size() - at - 24) break;
    const std::uint64_t checksum = container_checksum(bytes.data() + at + 24, length);
    std::memcpy(&bytes[at + 16], &checksum, 8);
    at += 24 + length;
  }
  try {
    const LoadedHierarchy loaded = decode_hierarchy(bytes.data(), bytes.size());
    const std::vector<std::uint8_t> again = encode_hierarchy(loaded.hierarchy, loaded.metadata_json);
    const LoadedHierarchy twice = decode_hierarchy(again.data(), again.size());
    if (encode_hierarchy(twice.hierarchy, twice.metadata_json) != again) std::abort();
    if (loaded.hierarchy.node_count() < 20000) {
      loaded.hierarchy.final_mesh();
      for (int j = 0; j < 4; ++j) loaded.hierarchy.level_mesh(j, LevelKind::M);
      find_defects(loaded.hierarchy);
    }
  } catch (const Error&) {
  }
  return 0;
}
