// SPDX-License-Identifier: GPL-3.0-or-later
#include "read_and_repair.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hybrid_mesh::read_and_repair(data, size, hybrid_mesh::MeshFormat::Stl);
  return 0;
}
