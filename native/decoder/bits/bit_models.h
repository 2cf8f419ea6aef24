// SPDX-License-Identifier: GPL-3.0-or-later
// Private to decoder/ and codec/. Adaptive probabilities, in integers alone: what a writer and a reader compute is the same everywhere.
// Based on: Mahoney, Adaptive weighing of context models for lossless data compression, 2005.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "decoder/bits/range_coder.h"

namespace hybrid_mesh {

// How likely a one is, learnt from the bits that came under one context.
class BitModel {
 public:
  // In 1/65536, within [1, 65535].
  std::uint32_t one() const { return std::clamp(one_ >> 16, 1u, 65535u); }
  // In 1/4096.
  std::uint32_t one_in_4096() const { return one_ >> 20; }
  void learn(bool bit) {
    // Downwards, after a zero, is upwards in the complement.
    const std::uint32_t turn = bit ? 0xffffffffu : 0;
    const std::uint32_t rest = one_ ^ turn;
    one_ = (rest - static_cast<std::uint32_t>((static_cast<std::uint64_t>(rest) * shares[seen_]) >> 16)) ^ turn;
    seen_ += seen_ < memory;
  }
  bool code(BitCoder& coder, bool bit) {
    bit = coder.code(bit, one());
    learn(bit);
    return bit;
  }
  template <bool reading>
  bool code_as(BitCoder& coder, bool bit) {
    bit = coder.code_as<reading>(bit, one());
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
  const auto at = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::clamp<std::int64_t>(x, -largest, largest)) + 9 * 256);
  const std::uint32_t node = at / 128;
  const auto rest = static_cast<std::int32_t>(at % 128);
  return (nodes[node] * (128 - rest) + nodes[node + 1] * rest + 64) / 128;
}

// squash(x - largest) for all x that it tells apart.
inline constexpr std::array<std::uint16_t, 2 * largest + 1> squashed = [] {
  std::array<std::uint16_t, 2 * largest + 1> result{};
  for (int x = -largest; x <= largest; ++x) result[x + largest] = static_cast<std::uint16_t>(squash(x));
  return result;
}();

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
    return coder.reads() ? code_as<true>(coder, bit, models) : code_as<false>(coder, bit, models);
  }
  template <bool reading, std::size_t count>
  bool code_as(BitCoder& coder, bool bit, const std::array<BitModel*, count>& models) {
    static_assert(count <= most);
    // Everything is read before anything is written: so the compiler need not think of models and weights that are the same.
    std::array<BitModel, count> model;
    std::array<std::int32_t, count> opinion, weight;
    for (std::size_t i = 0; i < count; ++i) {
      model[i] = *models[i];
      weight[i] = weights_[i];
      opinion[i] = logistic::stretched[model[i].one_in_4096()];
    }
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += static_cast<std::int64_t>(opinion[i]) * weight[i];
    const std::int64_t at = std::clamp<std::int64_t>(sum / 65536, -logistic::largest, logistic::largest);
    const std::int32_t one = logistic::squashed[static_cast<std::size_t>(at + logistic::largest)];
    bit = coder.code_as<reading>(bit, static_cast<std::uint32_t>(one));
    // A rate of 0.02 where opinions and weights are taken as the numbers that they stand for. An opinion is at most 2303: this stays below 2^31.
    const std::int32_t error = 5 * ((bit ? 65536 : 0) - one);
    std::uint32_t beyond = 0;
    for (std::size_t i = 0; i < count; ++i) {
      weight[i] += opinion[i] * error / 65536;
      beyond |= static_cast<std::uint32_t>(weight[i] + largest_weight);
      model[i].learn(bit);
    }
    if (beyond >= 2 * largest_weight)
      for (std::int32_t& w : weight) w = std::clamp(w, -largest_weight, largest_weight);
    for (std::size_t i = 0; i < count; ++i) {
      weights_[i] = weight[i];
      *models[i] = model[i];
    }
    return bit;
  }

 private:
  static constexpr std::int32_t largest_weight = 1 << 20;
  std::array<std::int32_t, most> weights_{22000, 22000, 22000, 22000, 22000};  // in 1/65536
};

}  // namespace hybrid_mesh
