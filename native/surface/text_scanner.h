// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <charconv>
#include <cstdint>
#include <limits>
#include <string_view>
#include <system_error>

namespace hybrid_mesh {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }

// What some programs leave behind the end of a file: blanks, line ends, zeros, and the sign for the end of a text.
inline bool is_padding(std::string_view rest) {
  for (const char c : rest)
    if (!is_blank(c) && !is_line_end(c) && c != '\0' && c != '\x1a') return false;
  return true;
}

// A number as text, independent of the locale. Infinite if too large, zero if too small for a double.
inline bool parse_number(std::string_view token, double& value) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error == std::errc::result_out_of_range) {
    const std::size_t exponent = token.find_first_of("eE");
    const std::string_view integer = token.substr(0, token.find_first_of(".eE"));
    const bool tiny = exponent != std::string_view::npos ? token.substr(exponent + 1, 1) == "-" : integer.find_first_not_of("-0") == integer.npos;
    value = tiny ? 0 : std::numeric_limits<double>::infinity();
    return true;
  }
  return error == std::errc() && end == token.data() + token.size();
}

inline bool parse_integer(std::string_view token, std::int64_t& value) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  return error == std::errc() && end == token.data() + token.size();
}

// Goes through text by tokens between blanks and line ends. Never reads past the end; an empty token says that there is none.
class TextScanner {
 public:
  // first_line: the number of the text's first line
  explicit TextScanner(std::string_view text, char comment = '\0', std::uint64_t first_line = 1)
      : text_(text), line_(first_line), comment_(comment) {}

  std::string_view rest() const { return text_.substr(position_); }
  std::size_t position() const { return position_; }
  std::uint64_t line() const { return line_; }

  // The next token of this line.
  std::string_view token_in_line() {
    while (position_ < text_.size() && is_blank(text_[position_])) ++position_;
    if (position_ < text_.size() && comment_ && text_[position_] == comment_)
      while (position_ < text_.size() && !is_line_end(text_[position_])) ++position_;
    const std::size_t begin = position_;
    while (position_ < text_.size() && !is_blank(text_[position_]) && !is_line_end(text_[position_])) ++position_;
    return text_.substr(begin, position_ - begin);
  }
  // The next token of this or a later line.
  std::string_view token() {
    for (;;) {
      const std::string_view found = token_in_line();
      if (!found.empty() || position_ == text_.size()) return found;
      next_line();
    }
  }
  // Skips what is left of the line.
  void next_line() {
    while (position_ < text_.size() && !is_line_end(text_[position_])) ++position_;
    if (position_ == text_.size()) return;
    if (text_[position_] == '\r' && position_ + 1 < text_.size() && text_[position_ + 1] == '\n') ++position_;
    ++position_;
    ++line_;
  }
  bool at_end() const { return position_ == text_.size(); }

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::uint64_t line_;
  char comment_;
};

}  // namespace hybrid_mesh
