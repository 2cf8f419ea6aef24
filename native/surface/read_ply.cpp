// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "surface/mesh_formats.h"
#include "surface/soup_builder.h"
#include "surface/text_encoding.h"
#include "surface/text_scanner.h"

namespace hybrid_mesh {

namespace {

enum class Scalar { Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float32, Float64 };
enum class Encoding { Ascii, LittleEndian, BigEndian };

constexpr std::size_t size_of(Scalar type) {
  constexpr std::array<std::size_t, 10> sizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

constexpr bool is_whole(Scalar type) { return type != Scalar::Float32 && type != Scalar::Float64; }

std::optional<Scalar> scalar_named(std::string_view name) {
  // Those of 64 bits are in no specification, but some programs write them.
  constexpr std::array<std::pair<std::string_view, Scalar>, 18> names{{{"char", Scalar::Int8},
                                                                       {"int8", Scalar::Int8},
                                                                       {"uchar", Scalar::UInt8},
                                                                       {"uint8", Scalar::UInt8},
                                                                       {"short", Scalar::Int16},
                                                                       {"int16", Scalar::Int16},
                                                                       {"ushort", Scalar::UInt16},
                                                                       {"uint16", Scalar::UInt16},
                                                                       {"int", Scalar::Int32},
                                                                       {"int32", Scalar::Int32},
                                                                       {"uint", Scalar::UInt32},
                                                                       {"uint32", Scalar::UInt32},
                                                                       {"int64", Scalar::Int64},
                                                                       {"uint64", Scalar::UInt64},
                                                                       {"float", Scalar::Float32},
                                                                       {"float32", Scalar::Float32},
                                                                       {"double", Scalar::Float64},
                                                                       {"float64", Scalar::Float64}}};
  for (const auto& [known, type] : names)
    if (known == name) return type;
  return std::nullopt;
}

enum class Role { Skipped, X, Y, Z, Corners, Density };

struct Property {
  std::string_view name;
  Scalar type = Scalar::Int32;
  std::optional<Scalar> count_type;  // of a list
  Role role = Role::Skipped;
  double weight = 1;  // with Role::Density, of which a point's values are summed up
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  bool has_corners() const { return name == "face" || name == "tristrips"; }
};

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
  std::string_view stray;  // a line that was skipped although it is no comment
};

// A colour's brightness, as Rec. 709 weighs its parts.
constexpr std::array<std::pair<std::string_view, double>, 3> kColor{{{"red", 0.2126}, {"green", 0.7152}, {"blue", 0.0722}}};

// Bytes and shorts are fractions of the largest, as colours are stored.
double fraction_of(Scalar type) { return type == Scalar::UInt8 ? 1.0 / 255 : type == Scalar::UInt16 ? 1.0 / 65535 : 1.0; }

Property* scalar_of(Element& element, std::string_view name) {
  for (Property& property : element.properties)
    if (!property.count_type && property.role == Role::Skipped && property.name == name) return &property;
  return nullptr;
}

// The property of points that has the name; for "color", where there is none, all of red, green and blue.
bool find_density(Element& element, std::string_view name) {
  if (Property* one = scalar_of(element, name)) {
    one->role = Role::Density;
    one->weight = fraction_of(one->type);
    return true;
  }
  if (name != "color") return false;
  for (const auto& [part, weight] : kColor)
    if (!scalar_of(element, part)) return false;
  for (const auto& [part, weight] : kColor) {
    Property* of = scalar_of(element, part);
    of->role = Role::Density;
    of->weight = weight * fraction_of(of->type);
  }
  return true;
}

void set_density(Header& header, std::string_view attribute, const std::string& name) {
  if (attribute.empty()) return;
  std::string known;
  for (Element& element : header.elements) {
    if (element.name != "vertex") continue;
    if (find_density(element, attribute)) return;
    for (const Property& property : element.properties)
      if (!property.count_type && property.role == Role::Skipped) known += (known.empty() ? "" : ", ") + std::string(property.name);
  }
  throw Error(ErrorCode::InvalidInput, name + ": its vertices have no property " + quoted(attribute) + " for the density; " +
                                           (known.empty() ? "they have none but their places" : "they have " + known));
}

bool speaks_of_vertices(std::string_view name) { return name.find("vert") != name.npos || name.find("Vert") != name.npos; }

// The list of a face's corners: of one of the two usual names, else the only list of whole numbers that speaks of vertices, else the only one there
// is.
Property* corners_of(Element& element) {
  for (Property& property : element.properties)
    if (property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index")) return &property;
  const auto only = [&](const auto& fits) -> Property* {
    Property* found = nullptr;
    for (Property& property : element.properties)
      if (property.count_type && is_whole(property.type) && fits(property.name)) {
        if (found) return nullptr;
        found = &property;
      }
    return found;
  };
  Property* named = only(speaks_of_vertices);
  return named ? named : only([](std::string_view) { return true; });
}

// Lines end in LF, CR LF, or CR alone if the first line does; bytes follow the header, so that its end must be found exactly.
class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Header read() {
    const std::size_t first_end = bytes_.find_first_of("\r\n");
    if (keyword_of(bytes_.substr(0, first_end)) != "ply") refuse_file(name_, "not a PLY file");
    if (first_end != bytes_.npos && bytes_[first_end] == '\r' && bytes_.substr(first_end + 1, 1) != "\n") line_end_ = '\r';
    next_line();
    Header header;
    bool has_format = false;
    for (;;) {
      const std::string_view line = next_line();
      TextScanner words(line);
      const std::string_view keyword = words.token();
      if (keyword == "end_header") break;
      if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) continue;
      if (keyword == "format") {
        header.encoding = encoding_named(words.token());
        has_format = true;
      } else if (keyword == "element") {
        Element element;
        element.name = words.token();
        std::int64_t count = -1;
        if (!parse_integer(words.token(), count) || count < 0) refuse_line(line);
        element.count = static_cast<std::uint64_t>(count);
        header.elements.push_back(element);
      } else if (keyword == "property") {
        if (header.elements.empty()) refuse("bad header: a property before any element");
        header.elements.back().properties.push_back(read_property(words, line));
      } else {
        header.stray = line;  // a comment may go on in lines that do not say so
      }
    }
    if (!has_format) refuse_file(name_, "bad header: no format line");
    for (Element& element : header.elements) set_roles(element);
    return header;
  }
  std::size_t position() const { return position_; }
  std::uint64_t lines() const { return lines_; }

 private:
  std::string_view next_line() {
    const std::size_t end = bytes_.find(line_end_, position_);
    std::string_view line = bytes_.substr(position_, end == bytes_.npos ? end : end - position_);
    // An ASCII file without a body may lack the last line end.
    if (end == bytes_.npos && keyword_of(line) != "end_header") refuse_file(name_, "truncated: the header does not end");
    position_ = end == bytes_.npos ? bytes_.size() : end + 1;
    ++lines_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  static std::string_view keyword_of(std::string_view line) { return TextScanner(line).token_in_line(); }

  [[noreturn]] void refuse(const std::string& cause) const { refuse_file(name_, "line " + std::to_string(lines_) + ": " + cause); }
  [[noreturn]] void refuse_line(std::string_view line) const { refuse("bad header line " + quoted(line)); }

  Encoding encoding_named(std::string_view word) const {
    if (word == "ascii") return Encoding::Ascii;
    if (word == "binary_little_endian") return Encoding::LittleEndian;
    if (word == "binary_big_endian") return Encoding::BigEndian;
    refuse("unknown format " + quoted(word));
  }

  Property read_property(TextScanner& words, std::string_view line) const {
    Property property;
    std::string_view type_name = words.token();
    if (type_name == "list") {
      property.count_type = scalar_named(words.token());
      if (!property.count_type || !is_whole(*property.count_type)) refuse_line(line);
      type_name = words.token();
    }
    const std::optional<Scalar> type = scalar_named(type_name);
    property.name = words.token();
    if (!type || property.name.empty()) refuse_line(line);
    property.type = *type;
    return property;
  }

  void set_roles(Element& element) const {
    if (element.name == "vertex") {
      for (Property& property : element.properties)
        if (!property.count_type)
          property.role = property.name == "x" ? Role::X : property.name == "y" ? Role::Y : property.name == "z" ? Role::Z : Role::Skipped;
      for (const Role role : {Role::X, Role::Y, Role::Z})
        if (element.count > 0 &&
            std::none_of(element.properties.begin(), element.properties.end(), [&](const Property& p) { return p.role == role; }))
          refuse_file(name_, "the element 'vertex' lacks the properties x, y and z");
    } else if (element.has_corners()) {
      if (Property* corners = corners_of(element))
        corners->role = Role::Corners;
      else if (element.count > 0)
        refuse_file(name_, "the element " + quoted(element.name) + " lacks the property vertex_indices, and no other list is its corners for sure");
    }
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t position_ = 0;
  std::uint64_t lines_ = 0;
  char line_end_ = '\n';
};

// An index given as a floating-point number is odd, but exact if it is a whole number.
std::int64_t index_from(double value) {
  return value >= 0 && value < 4294967296.0 && value == static_cast<double>(static_cast<std::int64_t>(value)) ? static_cast<std::int64_t>(value) : -1;
}

// The two kinds of body give values one by one, and know how few bytes a value can take and where they are. Where there is no value complaint() says
// what stands there instead; it is empty where the file ends.
class BinaryBody {
 public:
  // header: how many bytes come before
  BinaryBody(std::string_view bytes, std::size_t header, bool swap)
      : begin_(bytes.data()), at_(begin_ + header), end_(begin_ + bytes.size()), swap_(swap) {}

  FilePlace place() const { return {"byte", static_cast<std::uint64_t>(at_ - begin_)}; }
  std::string complaint() const { return {}; }
  std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - at_); }
  bool only_padding_left() { return is_padding({at_, left()}); }
  static std::uint64_t least_size(Scalar type) { return size_of(type); }
  // Whether `count` values fit in what is left.
  bool holds(std::uint64_t count, Scalar type) const { return left() / size_of(type) >= count; }
  bool skip(std::uint64_t count, Scalar type) {
    if (!holds(count, type)) return false;
    at_ += count * size_of(type);
    return true;
  }
  template <class T>
  bool read(Scalar type, T& value) {
    if (left() < size_of(type)) return false;
    switch (type) {
      case Scalar::Int8:
        value = static_cast<T>(take<std::int8_t>());
        break;
      case Scalar::UInt8:
        value = static_cast<T>(take<std::uint8_t>());
        break;
      case Scalar::Int16:
        value = static_cast<T>(take<std::int16_t>());
        break;
      case Scalar::UInt16:
        value = static_cast<T>(take<std::uint16_t>());
        break;
      case Scalar::Int32:
        value = static_cast<T>(take<std::int32_t>());
        break;
      case Scalar::UInt32:
        value = static_cast<T>(take<std::uint32_t>());
        break;
      case Scalar::Int64:
        value = static_cast<T>(take<std::int64_t>());
        break;
      case Scalar::UInt64:
        value = static_cast<T>(take<std::uint64_t>());
        break;
      case Scalar::Float32:
        value = from_floating<T>(take<float>());
        break;
      case Scalar::Float64:
        value = from_floating<T>(take<double>());
        break;
    }
    return true;
  }

 private:
  template <class T>
  static T from_floating(double value) {
    if constexpr (std::is_integral_v<T>)
      return index_from(value);
    else
      return value;
  }
  template <class T>
  T take() {
    char raw[sizeof(T)];
    if (swap_)
      for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = at_[sizeof(T) - 1 - i];
    else
      std::memcpy(raw, at_, sizeof(T));
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }

  const char* begin_;
  const char* at_;
  const char* end_;
  bool swap_;
};

class TextBody {
 public:
  // header_lines: how many come before
  TextBody(std::string_view bytes, std::uint64_t header_lines) : scanner_(bytes, '\0', header_lines + 1) {}

  FilePlace place() const { return {"line", scanner_.line()}; }
  std::string complaint() const { return last_.empty() ? "" : quoted(last_) + " is not a number that can be here"; }
  std::uint64_t left() const { return scanner_.rest().size() + 1; }
  bool only_padding_left() { return is_padding(next()); }
  static std::uint64_t least_size(Scalar) { return 2; }  // a digit and a blank or the end of the file
  bool holds(std::uint64_t count, Scalar) const { return left() / 2 >= count; }
  bool skip(std::uint64_t count, Scalar) {
    for (; count > 0; --count)
      if (next().empty()) return false;
    return true;
  }
  bool read(Scalar, double& value) { return parse_number(next(), value); }
  bool read(Scalar type, std::int64_t& value) {
    if (is_whole(type)) return parse_integer(next(), value);
    double number = 0;
    if (!parse_number(next(), number)) return false;
    value = index_from(number);
    return true;
  }

 private:
  std::string_view next() { return last_ = scanner_.token(); }

  TextScanner scanner_;
  std::string_view last_;
};

template <class Body>
class BodyReader {
 public:
  BodyReader(Body body, const Header& header, const std::string& name)
      : body_(body), header_(header), soup_(name, [this] { return body_.place(); }), name_(name) {}

  PolygonSoup read() {
    for (const Element& element : header_.elements) {
      check_count(element);
      if (element.properties.empty()) continue;
      if (element.name == "vertex") soup_.reserve_points(element.count);
      if (element.name == "face") soup_.reserve_polygons(std::min(element.count, body_.left() / 4));
      for (std::uint64_t i = 0; i < element.count; ++i) read_one(element, i);
    }
    // With a count that is too small, or a line of the header that was none, surface would be lost or garbage.
    if (!body_.only_padding_left()) refuse("the file goes on after all that its header promises");
    PolygonSoup soup = soup_.finish();
    soup.density = std::move(density_);
    return soup;
  }

 private:
  void check_count(const Element& element) {
    std::uint64_t least = 0;
    for (const Property& property : element.properties) least += Body::least_size(property.count_type.value_or(property.type));
    if (least > 0 && body_.left() / least < element.count)
      refuse_file(
          name_, "truncated: its header promises " + std::to_string(element.count) + " of " + quoted(element.name) + ", more than the file can hold");
  }

  [[noreturn]] void refuse(const std::string& cause) const {
    soup_.refuse(cause + (header_.stray.empty() ? "" : "; the line " + quoted(header_.stray) + " of the header was skipped"));
  }
  // cause: empty where the file ends
  [[noreturn]] void fail(const Element& element, std::uint64_t i, const std::string& cause) const {
    const std::string which = quoted(element.name) + " " + std::to_string(i + 1) + " of " + std::to_string(element.count);
    refuse(cause.empty() ? "truncated: the file ends at " + which : "damaged at " + which + ": " + cause);
  }

  void read_one(const Element& element, std::uint64_t i) {
    Vec3 point;
    double density = 0;
    for (const Property& property : element.properties) {
      if (property.count_type) {
        std::int64_t count = 0;
        if (!body_.read(*property.count_type, count)) fail(element, i, body_.complaint());
        if (count < 0) fail(element, i, "a list of " + std::to_string(count));
        if (!body_.holds(static_cast<std::uint64_t>(count), property.type))
          fail(element, i, "a list of " + std::to_string(count) + ", more than the rest of the file can hold");
        const bool read = property.role != Role::Corners ? body_.skip(static_cast<std::uint64_t>(count), property.type)
                          : element.name == "face"       ? read_polygon(property.type, count)
                                                         : read_strips(property.type, count);
        if (!read) fail(element, i, body_.complaint());
      } else if (property.role == Role::Density) {
        double value = 0;
        if (!body_.read(property.type, value)) fail(element, i, body_.complaint());
        density += property.weight * value;
        has_density_ = true;
      } else if (!(property.role == Role::Skipped ? body_.skip(1, property.type) : body_.read(property.type, point[axis_of(property.role)]))) {
        fail(element, i, body_.complaint());
      }
    }
    if (element.name != "vertex") return;
    soup_.add_point(point);
    if (has_density_) density_.push_back(density);
  }

  static int axis_of(Role role) { return static_cast<int>(role) - static_cast<int>(Role::X); }

  bool read_polygon(Scalar type, std::int64_t count) {
    for (; count > 0; --count) {
      std::int64_t index = 0;
      if (!body_.read(type, index)) return false;
      soup_.add_corner(index);
    }
    soup_.end_polygon();
    return true;
  }

  // Triangle strips, one after another, each ended by -1; every second triangle is turned.
  bool read_strips(Scalar type, std::int64_t count) {
    std::array<std::int64_t, 2> last{-1, -1};
    bool turned = false;
    for (; count > 0; --count) {
      std::int64_t index = 0;
      if (!body_.read(type, index)) return false;
      if (index == -1) {
        last = {-1, -1};
        turned = false;
        continue;
      }
      if (index < 0) soup_.add_corner(index);  // which refuses it, be it in a triangle or not
      if (last[0] >= 0) {
        for (const std::int64_t corner : {last[turned ? 1 : 0], last[turned ? 0 : 1], index}) soup_.add_corner(corner);
        soup_.end_polygon();
        turned = !turned;
      }
      last = {last[1], index};
    }
    return true;
  }

  Body body_;
  const Header& header_;
  SoupBuilder soup_;
  std::vector<double> density_;
  bool has_density_ = false;
  const std::string& name_;
};

}  // namespace

PolygonSoup read_ply(std::string_view bytes, const std::string& name, std::string_view density) {
  const DecodedText text(bytes);
  HeaderReader reader(text.view(), name);
  Header header = reader.read();
  set_density(header, density, name);
  if (header.encoding == Encoding::Ascii)
    return BodyReader<TextBody>(TextBody(text.view().substr(reader.position()), reader.lines()), header, name).read();
  const bool swap = (header.encoding == Encoding::BigEndian) != (std::endian::native == std::endian::big);
  return BodyReader<BinaryBody>(BinaryBody(text.view(), reader.position(), swap), header, name).read();
}

}  // namespace hybrid_mesh
