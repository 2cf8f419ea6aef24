// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/bits/range_coder.h"

#include <utility>

namespace hybrid_mesh {

std::vector<std::uint8_t> BitWriter::finish() {
  if (low_ == 0 && high_ == 0xffffffffu) return std::move(bytes_);
  for (int bytes = 1; bytes <= 4; ++bytes) {
    const std::uint64_t width = std::uint64_t{1} << (32 - 8 * bytes);
    const std::uint64_t first = (low_ + width - 1) / width * width;
    if (first + width - 1 > high_) continue;
    for (int i = 0; i < bytes; ++i) bytes_.push_back(static_cast<std::uint8_t>(first >> (24 - 8 * i)));
    break;
  }
  return std::move(bytes_);
}

BitReader::BitReader(const std::uint8_t* data, std::size_t size) : BitCoder(true) {
  at_ = data;
  end_ = data + size;
  for (int i = 0; i < 4; ++i) read_byte();
}

}  // namespace hybrid_mesh
