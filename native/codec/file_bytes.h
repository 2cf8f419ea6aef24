// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/, but for the bindings.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hybrid_mesh {

// Throws Error{Io} if the file cannot be read.
std::vector<std::uint8_t> read_bytes(const std::string& path);

// Written to a temporary file beside `path` that is renamed when complete. Throws Error{Io} and leaves nothing behind on failure.
void write_bytes(const std::vector<std::uint8_t>& bytes, const std::string& path);

}  // namespace hybrid_mesh
