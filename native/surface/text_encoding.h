// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace hybrid_mesh {

// The bytes of a text file as UTF-8 without a byte-order mark, which must outlive it. UTF-16 is decoded (where it has no mark the zeros of its first
// two characters tell it); any other bytes stay as they are, for names may be in any encoding. Halves of characters become U+FFFD.
class DecodedText {
 public:
  explicit DecodedText(std::string_view bytes);
  DecodedText(const DecodedText&) = delete;
  DecodedText& operator=(const DecodedText&) = delete;

  std::string_view view() const { return view_; }

 private:
  std::string decoded_;
  std::string_view view_;
};

}  // namespace hybrid_mesh
