// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/polygon_soup.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>

#include "base/error.h"
#include "surface/mesh_formats.h"

namespace hybrid_mesh {

namespace {

namespace fs = std::filesystem;

std::optional<MeshFormat> format_of(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (extension == ".ply") return MeshFormat::Ply;
  if (extension == ".obj") return MeshFormat::Obj;
  if (extension == ".off") return MeshFormat::Off;
  if (extension == ".stl") return MeshFormat::Stl;
  return std::nullopt;
}

std::string reason() { return errno ? std::strerror(errno) : "unknown error"; }

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

std::string read_bytes(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw Error(ErrorCode::Io, path + ": no such file");
  if (!fs::exists(status)) throw Error(ErrorCode::Io, path + ": " + error.message());
  if (!fs::is_regular_file(status)) throw Error(ErrorCode::Io, path + ": not a regular file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw Error(ErrorCode::Io, path + ": " + error.message());
  errno = 0;
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) throw Error(ErrorCode::Io, path + ": " + reason());
  std::string bytes;
  try {
    bytes.resize(size);
  } catch (const std::exception&) {
    throw Error(ErrorCode::Io, path + ": too large to be read");
  }
  if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) throw Error(ErrorCode::Io, path + ": " + reason());
  return bytes;
}

template <class T>
void append_raw(std::string& out, const T& value) {
  static_assert(std::endian::native == std::endian::little, "the writer stores the machine's own byte order");
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  out.append(raw, sizeof(T));
}

std::string encode_ply(const PolygonSoup& soup) {
  bool single = true;  // every coordinate is a float32
  for (const Vec3& p : soup.points)
    for (int i = 0; i < 3; ++i)
      single = single && std::abs(p[i]) <= std::numeric_limits<float>::max() && static_cast<double>(static_cast<float>(p[i])) == p[i];
  std::int64_t largest = 0;
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) largest = std::max(largest, soup.offsets[p + 1] - soup.offsets[p]);
  const bool short_count = largest <= 255;
  const std::string type = single ? "float" : "double";
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(soup.points.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) out += "property " + type + " " + axis + "\n";
  out += "element face " + std::to_string(soup.polygon_count()) + "\nproperty list " + (short_count ? "uchar" : "int") +
         " int vertex_indices\nend_header\n";
  out.reserve(out.size() + soup.points.size() * (single ? 12 : 24) + soup.polygon_count() * 4 + soup.indices.size() * 4);
  for (const Vec3& p : soup.points)
    for (int i = 0; i < 3; ++i) single ? append_raw(out, static_cast<float>(p[i])) : append_raw(out, p[i]);
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    const std::int64_t corners = soup.offsets[p + 1] - soup.offsets[p];
    short_count ? append_raw(out, static_cast<std::uint8_t>(corners)) : append_raw(out, static_cast<std::int32_t>(corners));
    for (std::int64_t c = soup.offsets[p]; c < soup.offsets[p + 1]; ++c) append_raw(out, soup.indices[c]);
  }
  return out;
}

template <class T>
void append_number(std::string& out, T value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
  out.append(text, end);
}

std::string encode_obj(const PolygonSoup& soup) {
  std::string out;
  for (const Vec3& p : soup.points) {
    out += 'v';
    for (int i = 0; i < 3; ++i) {
      out += ' ';
      append_number(out, p[i]);
    }
    out += '\n';
  }
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    out += 'f';
    for (std::int64_t c = soup.offsets[p]; c < soup.offsets[p + 1]; ++c) {
      out += ' ';
      append_number(out, static_cast<std::int64_t>(soup.indices[c]) + 1);
    }
    out += '\n';
  }
  return out;
}

void write_atomically(const std::string& path, const std::string& bytes) {
  const std::string temporary = path + ".part";
  const auto fail = [&](const std::string& cause) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw Error(ErrorCode::Io, path + ": cannot be written: " + cause);
  };
  errno = 0;
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (!file) throw Error(ErrorCode::Io, path + ": cannot be written: " + reason());
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() && std::fflush(file) == 0;
  const std::string cause = reason();
  if (std::fclose(file) != 0 && written) fail(reason());
  if (!written) fail(cause);
  std::error_code error;
  fs::rename(temporary, path, error);
  if (error) fail(error.message());
}

}  // namespace

PolygonSoup read_polygon_soup(std::string_view bytes, MeshFormat format, const std::string& name, const std::string& density) {
  if (bytes.empty()) throw Error(ErrorCode::InvalidInput, name + ": the file is empty");
  if (!density.empty() && format != MeshFormat::Ply)
    throw Error(ErrorCode::Unsupported,
                name + ": has no property " + hybrid_mesh::quoted(density) + " for the density: of mesh files only .ply has properties of points");
  try {
    switch (format) {
      case MeshFormat::Ply:
        return read_ply(bytes, name, density);
      case MeshFormat::Obj:
        return read_obj(bytes, name);
      case MeshFormat::Off:
        return read_off(bytes, name);
      case MeshFormat::Stl:
        return read_stl(bytes, name);
    }
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::Io, name + ": too large for the memory there is");
  }
  throw Error(ErrorCode::Internal, "a format without a reader");
}

PolygonSoup read_polygon_soup(const std::string& path, const std::string& density) {
  const auto format = format_of(path);
  if (!format) throw Error(ErrorCode::Unsupported, path + ": not a .ply, .obj, .off or .stl file");
  return read_polygon_soup(read_bytes(path), *format, path, density);
}

void write_polygon_soup(const PolygonSoup& soup, const std::string& path) {
  const auto format = format_of(path);
  if (format == MeshFormat::Ply) return write_atomically(path, encode_ply(soup));
  if (format == MeshFormat::Obj) return write_atomically(path, encode_obj(soup));
  throw Error(ErrorCode::Unsupported, path + ": only .ply and .obj files can be written");
}

}  // namespace hybrid_mesh
