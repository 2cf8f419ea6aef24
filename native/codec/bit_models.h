// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/. Adaptive probabilities, in integers alone: what a writer and a reader compute is the same everywhere.
// Based on: Mahoney, Adaptive weighing of context models for lossless data compression, 2005.
#pragma once

#include <array>
#include <cstdint>

#include "codec/range_coder.h"

namespace hybrid_mesh {

// How likely a one is, learnt from the bits that came under one context.
class BitModel {
 public:
  // In 1/65536, within [1, 65535].
  std::uint32_t one() const;
  void learn(bool bit);
  bool code(BitCoder& coder, bool bit);

 private:
  std::uint32_t one_ = 1u << 31;  // in 1/2^32
  std::uint32_t seen_ = 0;
};

// Whole numbers: the count of their binary digits in unary, then the digits, the first of them by models, too.
class NumberModel {
 public:
  // value >= 0 and below 2^31. A reader ignores it. Throws Error{CorruptStream} for larger ones.
  std::int64_t code(BitCoder& coder, std::int64_t value);
  std::int64_t code_signed(BitCoder& coder, std::int64_t value);

 private:
  std::array<BitModel, 32> longer_;
  std::array<BitModel, 32> second_;
  BitModel negative_;
};

// The opinions of several models about one bit, each weighed by how right it has been.
class Mixer {
 public:
  static constexpr int most = 5;
  bool code(BitCoder& coder, bool bit, const std::array<BitModel*, most>& models, int count);

 private:
  std::array<std::int32_t, most> weights_{22000, 22000, 22000, 22000, 22000};  // in 1/65536
};

}  // namespace hybrid_mesh
