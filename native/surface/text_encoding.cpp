// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/text_encoding.h"

#include <cstdint>

namespace hybrid_mesh {

namespace {

enum class Utf16 { None, LittleEndian, BigEndian };

Utf16 utf16_of(std::string_view bytes) {
  if (bytes.size() < 4) return Utf16::None;
  if (bytes.substr(0, 2) == "\xff\xfe") return Utf16::LittleEndian;
  if (bytes.substr(0, 2) == "\xfe\xff") return Utf16::BigEndian;
  if (bytes[0] && !bytes[1] && bytes[2] && !bytes[3]) return Utf16::LittleEndian;
  if (!bytes[0] && bytes[1] && !bytes[2] && bytes[3]) return Utf16::BigEndian;
  return Utf16::None;
}

void append_utf8(std::string& out, std::uint32_t code) {
  const auto add = [&](std::uint32_t byte) { out += static_cast<char>(static_cast<unsigned char>(byte)); };
  if (code < 0x80) return add(code);
  if (code < 0x800) {
    add(0xc0 | code >> 6);
  } else {
    if (code < 0x10000) {
      add(0xe0 | code >> 12);
    } else {
      add(0xf0 | code >> 18);
      add(0x80 | (code >> 12 & 0x3f));
    }
    add(0x80 | (code >> 6 & 0x3f));
  }
  add(0x80 | (code & 0x3f));
}

std::string from_utf16(std::string_view bytes, Utf16 encoding) {
  const std::size_t count = bytes.size() / 2, low = encoding == Utf16::LittleEndian ? 0 : 1;
  const auto unit = [&](std::size_t i) -> std::uint32_t {
    return static_cast<unsigned char>(bytes[2 * i + low]) | static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[2 * i + 1 - low])) << 8;
  };
  const auto half = [](std::uint32_t code, std::uint32_t first) { return code >= first && code < first + 0x400; };
  std::string out;
  out.reserve(count + count / 8);
  for (std::size_t i = unit(0) == 0xfeff ? 1 : 0; i < count; ++i) {
    std::uint32_t code = unit(i);
    if (half(code, 0xd800) && i + 1 < count && half(unit(i + 1), 0xdc00))
      code = 0x10000 + ((code - 0xd800) << 10) + (unit(++i) - 0xdc00);
    else if (half(code, 0xd800) || half(code, 0xdc00))
      code = 0xfffd;
    append_utf8(out, code);
  }
  return out;
}

}  // namespace

DecodedText::DecodedText(std::string_view bytes) : view_(bytes) {
  if (view_.substr(0, 3) == "\xef\xbb\xbf") {
    view_.remove_prefix(3);
  } else if (const Utf16 encoding = utf16_of(bytes); encoding != Utf16::None) {
    decoded_ = from_utf16(bytes, encoding);
    view_ = decoded_;
  }
}

}  // namespace hybrid_mesh
