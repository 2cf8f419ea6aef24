// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/. Adaptive probabilities, in integers alone: what a writer and a reader compute is the same everywhere.
// Based on: Mahoney, Adaptive weighing of context models for lossless data compression, 2005.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "codec/range_coder.h"

namespace hybrid_mesh {

// How likely a one is, learnt from the bits that came under one context.
class BitModel {
 public:
  // In 1/65536, within [1, 65535].
  std::uint32_t one() const { return std::clamp(one_ >> 16, 1u, 65535u); }
  void learn(bool bit) {
    const std::uint64_t share = shares[seen_];
    if (bit)
      one_ += static_cast<std::uint32_t>((static_cast<std::uint64_t>(0xffffffffu - one_) * share) >> 16);
    else
      one_ -= static_cast<std::uint32_t>((static_cast<std::uint64_t>(one_) * share) >> 16);
    if (seen_ < memory) ++seen_;
  }
  bool code(BitCoder& coder, bool bit) {
    bit = coder.code(bit, one());
    learn(bit);
    return bit;
  }

 private:
  // Of the bits that a model has seen, later ones count as much as in a mean over so many.
  static constexpr std::uint32_t memory = 250;
  // 2^17 / (2 n + 3): the share that the n-th bit has, in 1/65536.
  static constexpr std::array<std::uint32_t, memory + 1> shares = [] {
    std::array<std::uint32_t, memory + 1> result{};
    for (std::uint32_t n = 0; n <= memory; ++n) result[n] = (1u << 17) / (2 * n + 3);
    return result;
  }();

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

namespace logistic {

// 65536 / (1 + exp(-x)) for x = -9, -8.5, ..., 9.
inline constexpr std::array<std::int32_t, 37> nodes = {8,     13,    22,    36,    60,    98,    162,   267,   439,   720,   1179,  1921,  3108,
                                                       4971,  7812,  11955, 17625, 24743, 32768, 40793, 47911, 53581, 57724, 60565, 62428, 63615,
                                                       64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514, 65523, 65528};
// x is in 1/256.
inline constexpr int largest = 9 * 256 - 1;

constexpr std::int32_t squash(std::int64_t x) {
  const int at = static_cast<int>(std::clamp<std::int64_t>(x, -largest, largest)) + 9 * 256;
  const int node = at / 128, rest = at % 128;
  return (nodes[node] * (128 - rest) + nodes[node + 1] * rest + 64) / 128;
}

// The inverse of squash(), of probabilities in 1/4096.
inline constexpr std::array<std::int16_t, 4096> stretched = [] {
  std::array<std::int16_t, 4096> result{};
  int filled = 0;
  for (int x = -largest; x <= largest; ++x)
    for (const int p = squash(x) >> 4; filled <= p; ++filled) result[filled] = static_cast<std::int16_t>(x);
  for (; filled < 4096; ++filled) result[filled] = largest;
  return result;
}();

}  // namespace logistic

// The opinions of several models about one bit, each weighed by how right it has been.
class Mixer {
 public:
  static constexpr std::size_t most = 5;
  template <std::size_t count>
  bool code(BitCoder& coder, bool bit, const std::array<BitModel*, count>& models) {
    static_assert(count <= most);
    std::array<std::int32_t, count> opinion;
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      opinion[i] = logistic::stretched[models[i]->one() >> 4];
      sum += static_cast<std::int64_t>(opinion[i]) * weights_[i];
    }
    const std::int32_t one = logistic::squash(sum / 65536);
    bit = coder.code(bit, static_cast<std::uint32_t>(one));
    const std::int64_t error = (bit ? 65536 : 0) - one;
    for (std::size_t i = 0; i < count; ++i) {
      // A rate of 0.02 where opinions and weights are taken as the numbers that they stand for.
      weights_[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(weights_[i] + opinion[i] * error * 5 / 65536, -(1 << 20), 1 << 20));
      models[i]->learn(bit);
    }
    return bit;
  }

 private:
  std::array<std::int32_t, most> weights_{22000, 22000, 22000, 22000, 22000};  // in 1/65536
};

}  // namespace hybrid_mesh
