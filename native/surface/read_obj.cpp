// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_formats.h"
#include "surface/soup_builder.h"
#include "surface/text_encoding.h"
#include "surface/text_scanner.h"

namespace hybrid_mesh {

namespace {

// Tokens of logical lines: a backslash at a line's end joins it to the next. Unlike TextScanner, which knows nothing of backslashes.
// The first token of a line says whether that is meant: a name may end in a backslash, in a path's or in the second byte of a character.
class ObjScanner {
 public:
  explicit ObjScanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  bool at_end() const { return at_ == end_; }
  std::uint64_t line() const { return line_; }

  std::string_view token() {
    for (;;) {
      while (at_ != end_ && is_blank(*at_)) ++at_;
      if (at_ == end_ || *at_ == '#') return {};
      if (!skip_continuation()) break;
    }
    const char* begin = at_;
    while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_) && !continues()) ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }

  // Skips what is left of a line of numbers. A comment is not continued.
  void next_line() {
    bool comment = false;
    while (at_ != end_ && !is_line_end(*at_)) {
      comment = comment || *at_ == '#';
      if (comment || !skip_continuation()) ++at_;
    }
    skip_line_end();
  }

  // Skips what is left of a line of which nothing is known.
  void next_physical_line() {
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
    skip_line_end();
  }

 private:
  bool continues() const { return *at_ == '\\' && (at_ + 1 == end_ || is_line_end(at_[1])); }
  bool skip_continuation() {
    if (!continues()) return false;
    ++at_;
    skip_line_end();
    return true;
  }
  void skip_line_end() {
    if (at_ == end_) return;
    if (*at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n') ++at_;
    ++at_;
    ++line_;
  }

  const char* at_;
  const char* end_;
  std::uint64_t line_ = 1;
};

}  // namespace

PolygonSoup read_obj(std::string_view bytes, const std::string& name) {
  const DecodedText text(bytes);
  ObjScanner scanner(text.view());
  SoupBuilder soup(name, [&] { return FilePlace{"line", scanner.line()}; });
  while (!scanner.at_end()) {
    const std::string_view keyword = scanner.token();
    if (keyword == "v") {
      Vec3 point;
      for (int i = 0; i < 3; ++i) {
        const std::string_view token = scanner.token();
        if (token.empty()) soup.refuse("a vertex needs three coordinates");
        if (!parse_number(token, point[i])) soup.refuse(quoted(token) + " is not a number");
      }
      soup.add_point(point);
      scanner.next_line();  // a weight or colours
    } else if (keyword == "f" || keyword == "fo") {
      for (std::string_view token = scanner.token(); !token.empty(); token = scanner.token()) {
        std::int64_t index = 0;
        if (!parse_integer(token.substr(0, token.find('/')), index)) soup.refuse(quoted(token) + " is not a face corner");
        // 1 is the first point, -1 the latest.
        soup.add_corner(index > 0 ? index - 1 : index < 0 ? static_cast<std::int64_t>(soup.point_count()) + index : -1);
      }
      soup.end_polygon();
      scanner.next_line();
    } else {
      scanner.next_physical_line();
    }
  }
  return soup.finish();
}

}  // namespace hybrid_mesh
