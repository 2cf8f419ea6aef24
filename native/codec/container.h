// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

struct LoadedHierarchy {
  HybridMesh hierarchy;
  std::string metadata_json;
};

// The .hmesh container: magic, version, sections with lengths and checksums, little-endian. Holds base, operations, refinement, positions,
// maps and a JSON text; saving what was loaded gives the same bytes.
std::vector<std::uint8_t> encode_hierarchy(const HybridMesh& hierarchy, const std::string& metadata_json);

// Throws Error{CorruptStream} for anything that is not such a container, Error{Unsupported} for a later version. Memory stays proportional to
// the size given.
LoadedHierarchy decode_hierarchy(const std::uint8_t* data, std::size_t size);

// Of a section's payload.
std::uint64_t container_checksum(const std::uint8_t* data, std::size_t size);

// Written to a temporary file beside `path` that is renamed when complete. Throws Error{Io} and leaves nothing behind on failure.
void save_hierarchy(const HybridMesh& hierarchy, const std::string& metadata_json, const std::string& path);

// A container, or a stream as encode_stream() makes it, which has no metadata. Throws like decode_hierarchy, Error{Io} if the file cannot be read.
// `most_bytes`: of a stream, what is read of it; 0: all. Throws Error{InvalidInput} if a container is not to be read whole.
LoadedHierarchy load_hierarchy(const std::string& path, std::size_t most_bytes = 0);

}  // namespace hybrid_mesh
