// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <type_traits>
#include <vector>

#include "surface/mesh_formats.h"
#include "surface/text_scanner.h"

namespace hybrid_mesh {

namespace {

enum class Scalar { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };
enum class Encoding { Ascii, LittleEndian, BigEndian };

constexpr std::size_t size_of(Scalar type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

std::optional<Scalar> scalar_named(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Scalar>, 16> names{{{"char", Scalar::Int8},
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
                                                                       {"float", Scalar::Float32},
                                                                       {"float32", Scalar::Float32},
                                                                       {"double", Scalar::Float64},
                                                                       {"float64", Scalar::Float64}}};
  for (const auto& [known, type] : names)
    if (known == name) return type;
  return std::nullopt;
}

enum class Role { Skipped, X, Y, Z, Corners };

struct Property {
  Scalar type = Scalar::Int32;
  std::optional<Scalar> count_type;  // of a list
  Role role = Role::Skipped;
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
};

// Lines end in LF, CR LF, or CR alone if the first line does; bytes follow the header, so that its end must be found exactly.
class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Header read() {
    const std::size_t first_end = bytes_.find_first_of("\r\n");
    if (bytes_.substr(0, first_end) != "ply") refuse_file(name_, "not a PLY file");
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
        if (!parse_integer(words.token(), count) || count < 0) refuse_file(name_, "bad header line " + quoted(line));
        element.count = static_cast<std::uint64_t>(count);
        header.elements.push_back(element);
      } else if (keyword == "property") {
        if (header.elements.empty()) refuse_file(name_, "bad header: a property before any element");
        header.elements.back().properties.push_back(read_property(words, line, header.elements.back().name));
      } else {
        refuse_file(name_, "bad header line " + quoted(line));
      }
    }
    if (!has_format) refuse_file(name_, "bad header: no format line");
    return header;
  }
  std::size_t position() const { return position_; }

 private:
  std::string_view next_line() {
    const std::size_t end = bytes_.find(line_end_, position_);
    if (end == bytes_.npos) {
      // An ASCII file without a body may lack the last line end.
      if (bytes_.substr(position_) != "end_header") refuse_file(name_, "truncated: the header does not end");
      const std::string_view line = bytes_.substr(position_);
      position_ = bytes_.size();
      return line;
    }
    std::string_view line = bytes_.substr(position_, end - position_);
    position_ = end + 1;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  Encoding encoding_named(std::string_view word) const {
    if (word == "ascii") return Encoding::Ascii;
    if (word == "binary_little_endian") return Encoding::LittleEndian;
    if (word == "binary_big_endian") return Encoding::BigEndian;
    refuse_file(name_, "unknown format " + quoted(word));
  }

  Property read_property(TextScanner& words, std::string_view line, std::string_view element) const {
    Property property;
    std::string_view type_name = words.token();
    if (type_name == "list") {
      property.count_type = scalar_named(words.token());
      if (!property.count_type || *property.count_type == Scalar::Float32 || *property.count_type == Scalar::Float64)
        refuse_file(name_, "bad header line " + quoted(line));
      type_name = words.token();
    }
    const std::optional<Scalar> type = scalar_named(type_name);
    const std::string_view name = words.token();
    if (!type || name.empty()) refuse_file(name_, "bad header line " + quoted(line));
    property.type = *type;
    if (element == "vertex" && !property.count_type)
      property.role = name == "x" ? Role::X : name == "y" ? Role::Y : name == "z" ? Role::Z : Role::Skipped;
    if ((element == "face" || element == "tristrips") && property.count_type && (name == "vertex_indices" || name == "vertex_index"))
      property.role = Role::Corners;
    return property;
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t position_ = 0;
  char line_end_ = '\n';
};

// The two kinds of body give values one by one and know how few bytes a value can take.
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, bool swap) : at_(bytes.data()), end_(bytes.data() + bytes.size()), swap_(swap) {}

  std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - at_); }
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
  // An index given as a floating-point number is odd, but exact if it is a whole number.
  template <class T>
  static T from_floating(double value) {
    if constexpr (std::is_integral_v<T>)
      return value >= 0 && value < 4294967296.0 && value == static_cast<double>(static_cast<std::int64_t>(value)) ? static_cast<T>(value) : T(-1);
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

  const char* at_;
  const char* end_;
  bool swap_;
};

class TextBody {
 public:
  explicit TextBody(std::string_view bytes) : scanner_(bytes) {}

  std::uint64_t left() const { return scanner_.rest().size() + 1; }
  static std::uint64_t least_size(Scalar) { return 2; }  // a digit and a blank or the end of the file
  bool holds(std::uint64_t count, Scalar) const { return left() / 2 >= count; }
  bool skip(std::uint64_t count, Scalar) {
    for (; count > 0; --count)
      if (scanner_.token().empty()) return false;
    return true;
  }
  bool read(Scalar, double& value) { return parse_number(scanner_.token(), value); }
  bool read(Scalar, std::int64_t& value) {
    const std::string_view token = scanner_.token();
    return parse_integer(token, value);
  }

 private:
  TextScanner scanner_;
};

template <class Body>
class BodyReader {
 public:
  BodyReader(Body body, const std::string& name) : body_(body), polygons_(soup_), name_(name) {}

  PolygonSoup read(const std::vector<Element>& elements) {
    for (const Element& element : elements) {
      check_count(element);
      if (element.properties.empty()) continue;
      if (element.name == "vertex") {
        require(element, {Role::X, Role::Y, Role::Z}, "x, y and z");
        soup_.points.reserve(soup_.points.size() + element.count);
      }
      if (element.name == "face") {
        require(element, {Role::Corners}, "vertex_indices");
        soup_.offsets.reserve(soup_.offsets.size() + std::min(element.count, body_.left() / 4));
      }
      for (std::uint64_t i = 0; i < element.count; ++i) read_one(element, i);
    }
    return std::move(soup_);
  }

 private:
  void check_count(const Element& element) {
    std::uint64_t least = 0;
    for (const Property& property : element.properties) least += Body::least_size(property.count_type.value_or(property.type));
    if (least > 0 && body_.left() / least < element.count)
      refuse_file(
          name_, "truncated: its header promises " + std::to_string(element.count) + " of " + quoted(element.name) + ", more than the file can hold");
  }
  void require(const Element& element, std::initializer_list<Role> roles, const char* names) {
    for (const Role role : roles) {
      bool found = false;
      for (const Property& property : element.properties) found = found || property.role == role;
      if (!found && element.count > 0) refuse_file(name_, "the element " + quoted(element.name) + " lacks the properties " + names);
    }
  }

  [[noreturn]] void fail(const Element& element, std::uint64_t i) {
    refuse_file(name_, "truncated or damaged at " + quoted(element.name) + " " + std::to_string(i + 1) + " of " + std::to_string(element.count));
  }

  void read_one(const Element& element, std::uint64_t i) {
    Vec3 point;
    for (const Property& property : element.properties) {
      if (property.count_type) {
        std::int64_t count = 0;
        if (!body_.read(*property.count_type, count) || count < 0 || !body_.holds(static_cast<std::uint64_t>(count), property.type)) fail(element, i);
        if (property.role == Role::Corners) {
          if (!(element.name == "face" ? read_polygon(property.type, count) : read_strips(property.type, count))) fail(element, i);
        } else if (!body_.skip(static_cast<std::uint64_t>(count), property.type)) {
          fail(element, i);
        }
      } else if (property.role == Role::Skipped) {
        if (!body_.skip(1, property.type)) fail(element, i);
      } else if (!body_.read(property.type, point[static_cast<int>(property.role) - static_cast<int>(Role::X)])) {
        fail(element, i);
      }
    }
    if (element.name == "vertex") soup_.points.push_back(point);
  }

  bool read_polygon(Scalar type, std::int64_t count) {
    for (; count > 0; --count) {
      std::int64_t index = 0;
      if (!body_.read(type, index)) return false;
      polygons_.add_corner(to_index(index));
    }
    polygons_.end_polygon();
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
      if (index < 0) return false;
      if (last[0] >= 0) {
        for (const std::int64_t corner : {last[turned ? 1 : 0], last[turned ? 0 : 1], index}) polygons_.add_corner(to_index(corner));
        polygons_.end_polygon();
        turned = !turned;
      }
      last = {last[1], index};
    }
    return true;
  }

  Body body_;
  PolygonSoup soup_;
  PolygonCollector polygons_;
  const std::string& name_;
};

}  // namespace

PolygonSoup read_ply(std::string_view bytes, const std::string& name) {
  HeaderReader reader(bytes, name);
  const Header header = reader.read();
  const std::string_view body = bytes.substr(reader.position());
  if (header.encoding == Encoding::Ascii) return BodyReader<TextBody>(TextBody(body), name).read(header.elements);
  const bool swap = (header.encoding == Encoding::BigEndian) != (std::endian::native == std::endian::big);
  return BodyReader<BinaryBody>(BinaryBody(body, swap), name).read(header.elements);
}

}  // namespace hybrid_mesh
