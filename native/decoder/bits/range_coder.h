// SPDX-License-Identifier: GPL-3.0-or-later
// Private to decoder/ and codec/.
// Based on: Martin, Range encoding, 1979, in the carry-less binary form of Mahoney's lpaq, 2007.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hybrid_mesh {

// Thrown by a decoder where the bytes that it has do not decide the next bit: they are a prefix of a longer stream.
struct StreamEnd {};

// Bits in the order that both sides go through them by the same code: a writer is told each bit, a reader tells it.
class BitCoder {
 public:
  bool reads() const { return reads_; }
  // Of readers: no more than so much information is left.
  std::uint64_t bits_left() const { return 32 + 8 * static_cast<std::uint64_t>(end_ - at_); }
  // `one`: how likely a one is, in 1/65536, within [1, 65535]. A reader ignores `bit`. Returns the bit.
  bool code(bool bit, std::uint32_t one) { return reads_ ? code_as<true>(bit, one) : code_as<false>(bit, one); }
  // The same where it is known which of the two this is.
  template <bool reading>
  bool code_as(bool bit, std::uint32_t one) {
    // The last number of the part of [low, high] that stands for a one. It is below `high`.
    const std::uint32_t middle = low_ + static_cast<std::uint32_t>((static_cast<std::uint64_t>(high_ - low_) * one) >> 16);
    if constexpr (reading) {
      bit = with_zeros_ <= middle;
      if (at_ == end_ && bit != (with_ones_ <= middle)) [[unlikely]]
        throw StreamEnd();
    }
    high_ = bit ? middle : high_;
    low_ = bit ? low_ : middle + 1;
    while (((low_ ^ high_) & 0xff000000u) == 0) [[unlikely]] shift<reading>();
    return bit;
  }
  bool code_raw(bool bit) { return code(bit, 1u << 15); }

 protected:
  explicit BitCoder(bool reads) : reads_(reads) {}
  void read_byte() {
    const bool there = at_ != end_;
    with_zeros_ = (with_zeros_ << 8) | (there ? *at_ : 0x00u);
    with_ones_ = (with_ones_ << 8) | (there ? *at_ : 0xffu);
    if (there) ++at_;
  }

  std::uint32_t low_ = 0, high_ = 0xffffffffu;
  std::vector<std::uint8_t>* written_ = nullptr;
  const std::uint8_t *at_ = nullptr, *end_ = nullptr;  // what is not read yet
  // Four bytes that are read: with zeros and with ones in the place of those beyond the end.
  std::uint32_t with_zeros_ = 0, with_ones_ = 0;

 private:
  // Past the first byte, which `low` and `high` agree in.
  template <bool reading>
  void shift() {
    if constexpr (reading)
      read_byte();
    else
      written_->push_back(static_cast<std::uint8_t>(high_ >> 24));
    low_ <<= 8;
    high_ = (high_ << 8) | 0xffu;
  }

  bool reads_;
};

class BitWriter final : public BitCoder {
 public:
  BitWriter() : BitCoder(false) { written_ = &bytes_; }
  BitWriter(const BitWriter&) = delete;
  BitWriter& operator=(const BitWriter&) = delete;
  std::size_t size() const { return bytes_.size(); }
  // The fewest bytes from which a reader knows every bit.
  std::vector<std::uint8_t> finish();

 private:
  std::vector<std::uint8_t> bytes_;
};

// Decodes what a prefix says for certain: with zeros and with ones in the place of the bytes that are missing a bit must come out the same.
class BitReader final : public BitCoder {
 public:
  BitReader(const std::uint8_t* data, std::size_t size);
};

}  // namespace hybrid_mesh
