// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/range_coder.h"

#include <utility>

namespace hybrid_mesh {

void BitCoder::shift() {
  if (reads_)
    read_byte();
  else
    written_.push_back(static_cast<std::uint8_t>(high_ >> 24));
  low_ <<= 8;
  high_ = (high_ << 8) | 0xffu;
}

void BitCoder::read_byte() {
  const bool there = at_ != end_;
  with_zeros_ = (with_zeros_ << 8) | (there ? *at_ : 0x00u);
  with_ones_ = (with_ones_ << 8) | (there ? *at_ : 0xffu);
  if (there) ++at_;
}

std::vector<std::uint8_t> BitWriter::finish() {
  if (low_ == 0 && high_ == 0xffffffffu) return std::move(written_);
  for (int bytes = 1; bytes <= 4; ++bytes) {
    const std::uint64_t width = std::uint64_t{1} << (32 - 8 * bytes);
    const std::uint64_t first = (low_ + width - 1) / width * width;
    if (first + width - 1 > high_) continue;
    for (int i = 0; i < bytes; ++i) written_.push_back(static_cast<std::uint8_t>(first >> (24 - 8 * i)));
    break;
  }
  return std::move(written_);
}

BitReader::BitReader(const std::uint8_t* data, std::size_t size) : BitCoder(true) {
  at_ = data;
  end_ = data + size;
  for (int i = 0; i < 4; ++i) read_byte();
}

}  // namespace hybrid_mesh
