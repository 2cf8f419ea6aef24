// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/range_coder.h"

namespace hybrid_mesh {

namespace {

// The last number of the part of [low, high] that stands for a one. It is below `high`.
std::uint32_t last_of_one(std::uint32_t low, std::uint32_t high, std::uint32_t one) {
  return low + static_cast<std::uint32_t>((static_cast<std::uint64_t>(high - low) * one) >> 16);
}

bool same_first_byte(std::uint32_t low, std::uint32_t high) { return ((low ^ high) & 0xff000000u) == 0; }

}  // namespace

bool BitWriter::code(bool bit, std::uint32_t one) {
  const std::uint32_t middle = last_of_one(low_, high_, one);
  if (bit)
    high_ = middle;
  else
    low_ = middle + 1;
  for (; same_first_byte(low_, high_); low_ <<= 8, high_ = (high_ << 8) | 0xffu) bytes_.push_back(static_cast<std::uint8_t>(high_ >> 24));
  return bit;
}

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

BitReader::BitReader(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {
  for (int i = 0; i < 4; ++i) shift();
}

void BitReader::shift() {
  const bool there = at_ != end_;
  with_zeros_ = (with_zeros_ << 8) | (there ? *at_ : 0x00u);
  with_ones_ = (with_ones_ << 8) | (there ? *at_ : 0xffu);
  if (there) ++at_;
}

bool BitReader::code(bool, std::uint32_t one) {
  const std::uint32_t middle = last_of_one(low_, high_, one);
  const bool bit = with_zeros_ <= middle;
  if (bit != (with_ones_ <= middle)) throw StreamEnd();
  if (bit)
    high_ = middle;
  else
    low_ = middle + 1;
  for (; same_first_byte(low_, high_); low_ <<= 8, high_ = (high_ << 8) | 0xffu) shift();
  return bit;
}

}  // namespace hybrid_mesh
