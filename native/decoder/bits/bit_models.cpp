// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/bits/bit_models.h"

#include "decoder/error.h"

namespace hybrid_mesh {

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

}  // namespace hybrid_mesh
