// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/.
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
  virtual ~BitCoder() = default;
  virtual bool reads() const = 0;
  // `one`: how likely a one is, in 1/65536, within [1, 65535]. A reader ignores `bit`. Returns the bit.
  virtual bool code(bool bit, std::uint32_t one) = 0;
  bool code_raw(bool bit) { return code(bit, 1u << 15); }
};

class BitWriter final : public BitCoder {
 public:
  bool reads() const override { return false; }
  bool code(bool bit, std::uint32_t one) override;
  std::size_t size() const { return bytes_.size(); }
  // The fewest bytes from which a reader knows every bit.
  std::vector<std::uint8_t> finish();

 private:
  std::uint32_t low_ = 0, high_ = 0xffffffffu;
  std::vector<std::uint8_t> bytes_;
};

// Decodes what a prefix says for certain: with zeros and with ones in the place of the bytes that are missing a bit must come out the same.
class BitReader final : public BitCoder {
 public:
  BitReader(const std::uint8_t* data, std::size_t size);
  bool reads() const override { return true; }
  bool code(bool bit, std::uint32_t one) override;

 private:
  void shift();

  const std::uint8_t *at_, *end_;
  std::uint32_t low_ = 0, high_ = 0xffffffffu;
  std::uint32_t with_zeros_ = 0, with_ones_ = 0;
};

}  // namespace hybrid_mesh
