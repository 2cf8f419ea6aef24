// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/bit_models.h"

#include <algorithm>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

// Of the bits that a model has seen, later ones count as much as in a mean over so many.
constexpr std::uint32_t memory = 250;

// 2^17 / (2 n + 3): the share that the n-th bit has, in 1/65536.
std::uint32_t share(std::uint32_t seen) { return (1u << 17) / (2 * seen + 3); }

// 65536 / (1 + exp(-x)) for x = -9, -8.5, ..., 9.
constexpr std::array<std::int32_t, 37> logistic = {8,     13,    22,    36,    60,    98,    162,   267,   439,   720,   1179,  1921,  3108,
                                                   4971,  7812,  11955, 17625, 24743, 32768, 40793, 47911, 53581, 57724, 60565, 62428, 63615,
                                                   64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514, 65523, 65528};
// x is in 1/256.
constexpr int largest = 9 * 256 - 1;

std::int32_t squash(std::int64_t x) {
  const int at = static_cast<int>(std::clamp<std::int64_t>(x, -largest, largest)) + 9 * 256;
  const int node = at / 128, rest = at % 128;
  return (logistic[node] * (128 - rest) + logistic[node + 1] * rest + 64) / 128;
}

// The inverse of squash(), of probabilities in 1/4096.
std::array<std::int16_t, 4096> inverse() {
  std::array<std::int16_t, 4096> result{};
  int filled = 0;
  for (int x = -largest; x <= largest; ++x)
    for (const int p = squash(x) >> 4; filled <= p; ++filled) result[filled] = static_cast<std::int16_t>(x);
  for (; filled < 4096; ++filled) result[filled] = largest;
  return result;
}

std::int32_t stretch(std::uint32_t one) {
  static const std::array<std::int16_t, 4096> table = inverse();
  return table[one >> 4];
}

}  // namespace

std::uint32_t BitModel::one() const { return std::clamp(one_ >> 16, 1u, 65535u); }

void BitModel::learn(bool bit) {
  const std::uint64_t step = share(seen_);
  if (bit)
    one_ += static_cast<std::uint32_t>((static_cast<std::uint64_t>(0xffffffffu - one_) * step) >> 16);
  else
    one_ -= static_cast<std::uint32_t>((static_cast<std::uint64_t>(one_) * step) >> 16);
  if (seen_ < memory) ++seen_;
}

bool BitModel::code(BitCoder& coder, bool bit) {
  bit = coder.code(bit, one());
  learn(bit);
  return bit;
}

std::int64_t NumberModel::code(BitCoder& coder, std::int64_t value) {
  // value + 1 has `digits` binary digits after its first.
  int digits = 0;
  while (longer_[digits].code(coder, ((value + 1) >> digits) > 1))
    if (++digits == 32) throw Error(ErrorCode::CorruptStream, "not a valid hierarchy stream: a number out of range");
  std::int64_t result = 1;
  for (int i = digits - 1; i >= 0; --i) {
    const bool digit = ((value + 1) >> i) & 1;
    result = 2 * result + (i == digits - 1 ? second_[digits].code(coder, digit) : coder.code_raw(digit));
  }
  return result - 1;
}

std::int64_t NumberModel::code_signed(BitCoder& coder, std::int64_t value) {
  const std::int64_t size = code(coder, value < 0 ? -value : value);
  if (size == 0) return 0;
  return negative_.code(coder, value < 0) ? -size : size;
}

bool Mixer::code(BitCoder& coder, bool bit, const std::array<BitModel*, most>& models, int count) {
  std::array<std::int32_t, most> opinion{};
  std::int64_t sum = 0;
  for (int i = 0; i < count; ++i) {
    opinion[i] = stretch(models[i]->one());
    sum += static_cast<std::int64_t>(opinion[i]) * weights_[i];
  }
  const std::int32_t one = squash(sum / 65536);
  bit = coder.code(bit, static_cast<std::uint32_t>(one));
  const std::int64_t error = (bit ? 65536 : 0) - one;
  for (int i = 0; i < count; ++i) {
    // A rate of 0.02 where opinions and weights are taken as the numbers that they stand for.
    weights_[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(weights_[i] + opinion[i] * error * 5 / 65536, -(1 << 20), 1 << 20));
    models[i]->learn(bit);
  }
  return bit;
}

}  // namespace hybrid_mesh
