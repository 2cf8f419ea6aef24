// SPDX-License-Identifier: GPL-3.0-or-later
// Layout, all little-endian: 8 bytes of magic, u32 version, u32 number of sections; a section is a tag of 4 bytes, u32 zero, u64 length,
// u64 checksum of the payload, payload. Lists are a u64 count and that many entries. Every count is compared with the bytes that remain
// before anything is allocated for it.
#include "codec/container.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/error.h"
#include "codec/file_bytes.h"
#include "codec/stream.h"
#include "hierarchy/archive.h"

namespace hybrid_mesh {

namespace {

constexpr char magic[8] = {'H', 'M', 'E', 'S', 'H', '\r', '\n', '\x1a'};
constexpr std::uint32_t version = 1;
constexpr const char* tags[] = {"META", "BASE", "TREE", "OPER", "POSN", "MAPS"};
constexpr std::size_t section_count = sizeof(tags) / sizeof(tags[0]);

[[noreturn]] void corrupt(const std::string& what) { throw Error(ErrorCode::CorruptStream, "not a valid hierarchy file: " + what); }

class Writer {
 public:
  std::vector<std::uint8_t> bytes;

  void u8(std::uint8_t x) { bytes.push_back(x); }
  void u32(std::uint32_t x) {
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(x >> (8 * i)));
  }
  void u64(std::uint64_t x) {
    for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<std::uint8_t>(x >> (8 * i)));
  }
  void i32(std::int32_t x) { u32(static_cast<std::uint32_t>(x)); }
  void f32(float x) { u32(std::bit_cast<std::uint32_t>(x)); }
  void f64(double x) { u64(std::bit_cast<std::uint64_t>(x)); }
  void text(const std::string& s) {
    u64(s.size());
    bytes.insert(bytes.end(), s.begin(), s.end());
  }
};

class Reader {
 public:
  Reader(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}

  std::size_t left() const { return left_; }
  const std::uint8_t* take(std::size_t n) {
    if (n > left_) corrupt("it ends too early");
    const std::uint8_t* p = at_;
    at_ += n;
    left_ -= n;
    return p;
  }
  std::uint8_t u8() { return *take(1); }
  std::uint32_t u32() {
    const std::uint8_t* p = take(4);
    std::uint32_t x = 0;
    for (int i = 0; i < 4; ++i) x |= static_cast<std::uint32_t>(p[i]) << (8 * i);
    return x;
  }
  std::uint64_t u64() {
    const std::uint8_t* p = take(8);
    std::uint64_t x = 0;
    for (int i = 0; i < 8; ++i) x |= static_cast<std::uint64_t>(p[i]) << (8 * i);
    return x;
  }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }
  // A count of entries of at least `entry` bytes each.
  std::size_t count(std::size_t entry) {
    const std::uint64_t n = u64();
    if (n > left_ / entry) corrupt("a list is longer than the file");
    return static_cast<std::size_t>(n);
  }
  std::string text() {
    const std::size_t n = count(1);
    const std::uint8_t* p = take(n);
    return std::string(reinterpret_cast<const char*>(p), n);
  }
  void end() const {
    if (left_ != 0) corrupt("a section is longer than what it holds");
  }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

void write_point(Writer& out, const Vec3& p) {
  for (int i = 0; i < 3; ++i) out.f64(p[i]);
}

Vec3 read_point(Reader& in) {
  Vec3 p;
  for (int i = 0; i < 3; ++i) p[i] = in.f64();
  return p;
}

// Beside the closure: a byte for each base quad follows the quads, see HierarchyParts::sharp.
constexpr std::uint32_t kHasSharpSides = 1u << 8;

void write_base(Writer& out, const HierarchyParts& parts) {
  out.i32(parts.base_vertices);
  out.u32(static_cast<std::uint32_t>(parts.closure) | (parts.sharp.empty() ? 0 : kHasSharpSides));
  out.u64(parts.base_quads.size());
  for (std::size_t q = 0; q < parts.base_quads.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      out.i32(parts.base_quads[q][s]);
      out.i32(parts.base_links[q][s].valid() ? 4 * parts.base_links[q][s].node + parts.base_links[q][s].side : -1);
    }
  for (const std::uint8_t sides : parts.sharp) out.u8(sides);
}

void read_base(Reader& in, HierarchyParts& parts) {
  parts.base_vertices = in.i32();
  const std::uint32_t flags = in.u32(), closure = flags & ~kHasSharpSides;
  if (closure > static_cast<std::uint32_t>(FaceClosure::Triangles)) corrupt("a closure of no known kind");
  parts.closure = static_cast<FaceClosure>(closure);
  const std::size_t n = in.count(32);
  parts.base_quads.resize(n);
  parts.base_links.resize(n);
  for (std::size_t q = 0; q < n; ++q)
    for (int s = 0; s < 4; ++s) {
      parts.base_quads[q][s] = in.i32();
      const std::int32_t link = in.i32();
      if (link < -1) corrupt("a neighbour out of range");
      if (link >= 0) parts.base_links[q][s] = {link / 4, link % 4};
    }
  for (std::size_t q = 0; q < n && (flags & kHasSharpSides); ++q) {
    parts.sharp.push_back(in.u8());
    if (parts.sharp.back() > 15) corrupt("a sharp side that no quad has");
  }
}

void write_tree(Writer& out, const HierarchyParts& parts) {
  out.u64(parts.refined.size());
  std::uint8_t byte = 0;
  for (std::size_t i = 0; i < parts.refined.size(); ++i) {
    byte |= static_cast<std::uint8_t>(parts.refined[i] << (i % 8));
    if (i % 8 == 7 || i + 1 == parts.refined.size()) {
      out.u8(byte);
      byte = 0;
    }
  }
}

void read_tree(Reader& in, HierarchyParts& parts) {
  const std::uint64_t n = in.u64();
  if (n > 8 * static_cast<std::uint64_t>(in.left()) || n / 8 + (n % 8 != 0) != in.left()) corrupt("the tree's length");
  parts.refined.resize(static_cast<std::size_t>(n));
  std::uint8_t byte = 0;
  for (std::size_t i = 0; i < parts.refined.size(); ++i) {
    if (i % 8 == 0) byte = in.u8();
    parts.refined[i] = (byte >> (i % 8)) & 1;
  }
  if (n % 8 != 0 && byte >> (n % 8)) corrupt("the tree's last bits");
}

void write_operations(Writer& out, const HierarchyParts& parts) {
  out.u64(parts.operations.size());
  for (std::size_t o = 0; o < parts.operations.size(); ++o) {
    const Repatch& op = parts.operations[o];
    out.u8(parts.enabled[o]);
    out.i32(op.level);
    out.text(op.kind);
    out.u64(op.removed.size());
    for (int n : op.removed) out.i32(n);
    out.i32(op.new_vertices);
    out.u64(op.boundary.size());
    for (VertexId v : op.boundary) out.i32(v.code);
    out.u64(op.quads.size());
    for (std::size_t q = 0; q < op.quads.size(); ++q)
      for (int s = 0; s < 4; ++s) {
        const Repatch::Side& side = op.sides[q][s];
        out.i32(op.quads[q][s]);
        out.u8(static_cast<std::uint8_t>(side.kind));
        out.i32(side.kind == Repatch::Side::Kind::Patch ? 4 * side.quad + side.side : side.kind == Repatch::Side::Kind::Outer ? side.half : -1);
      }
  }
}

void read_operations(Reader& in, HierarchyParts& parts) {
  const std::size_t operations = in.count(41);
  parts.operations.reserve(operations);
  for (std::size_t o = 0; o < operations; ++o) {
    Repatch op;
    const std::uint8_t enabled = in.u8();
    if (enabled > 1) corrupt("an operation neither enabled nor disabled");
    parts.enabled.push_back(enabled);
    op.level = in.i32();
    op.kind = in.text();
    op.removed.resize(in.count(4));
    for (int& n : op.removed) n = in.i32();
    op.new_vertices = in.i32();
    op.boundary.resize(in.count(4));
    for (VertexId& v : op.boundary) v.code = in.i32();
    const std::size_t quads = in.count(36);
    op.quads.resize(quads);
    op.sides.resize(quads);
    for (std::size_t q = 0; q < quads; ++q)
      for (int s = 0; s < 4; ++s) {
        op.quads[q][s] = in.i32();
        const std::uint8_t kind = in.u8();
        const std::int32_t value = in.i32();
        Repatch::Side& side = op.sides[q][s];
        if (kind > static_cast<std::uint8_t>(Repatch::Side::Kind::Open)) corrupt("a side of no known kind");
        side.kind = static_cast<Repatch::Side::Kind>(kind);
        if (side.kind == Repatch::Side::Kind::Open ? value != -1 : value < 0) corrupt("a side with a value out of range");
        if (side.kind == Repatch::Side::Kind::Patch) side.quad = value / 4, side.side = value % 4;
        if (side.kind == Repatch::Side::Kind::Outer) side.half = value;
      }
    parts.operations.push_back(std::move(op));
  }
}

void write_positions(Writer& out, const std::vector<std::pair<VertexId, Vec3>>& positions) {
  out.u64(positions.size());
  for (const auto& [v, p] : positions) {
    out.i32(v.code);
    write_point(out, p);
  }
}

std::vector<std::pair<VertexId, Vec3>> read_positions(Reader& in) {
  std::vector<std::pair<VertexId, Vec3>> positions(in.count(28));
  for (auto& [v, p] : positions) {
    v.code = in.i32();
    p = read_point(in);
  }
  return positions;
}

void write_maps(Writer& out, const HierarchyParts& parts) {
  out.u64(parts.maps.size());
  for (const auto& [node, map] : parts.maps) {
    out.i32(node);
    out.u64(map.uv.size());
    for (std::size_t v = 0; v < map.uv.size(); ++v) {
      out.f64(map.uv[v].x());
      out.f64(map.uv[v].y());
      write_point(out, map.positions[v]);
    }
    out.u64(map.triangles.size());
    for (const auto& t : map.triangles)
      for (int c : t) out.i32(c);
    out.u64(map.source_face.size());
    for (std::size_t t = 0; t < map.source_face.size(); ++t) {
      out.i32(map.source_face[t]);
      for (float w : map.source[t]) out.f32(w);
    }
  }
}

void read_maps(Reader& in, HierarchyParts& parts) {
  const std::size_t maps = in.count(28);
  parts.maps.reserve(maps);
  for (std::size_t m = 0; m < maps; ++m) {
    PatchMap map;
    const int node = in.i32();
    const std::size_t vertices = in.count(40);
    map.uv.resize(vertices);
    map.positions.resize(vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
      map.uv[v].x() = in.f64();
      map.uv[v].y() = in.f64();
      map.positions[v] = read_point(in);
    }
    map.triangles.resize(in.count(12));
    for (auto& t : map.triangles)
      for (int& c : t) c = in.i32();
    const std::size_t sources = in.count(40);
    map.source_face.resize(sources);
    map.source.resize(sources);
    for (std::size_t t = 0; t < sources; ++t) {
      map.source_face[t] = in.i32();
      for (float& w : map.source[t]) w = in.f32();
    }
    parts.maps.emplace_back(node, std::move(map));
  }
}

}  // namespace

std::uint64_t container_checksum(const std::uint8_t* data, std::size_t size) {
  // FNV-1a over words of 8 bytes, the last one filled with zeros and followed by the length.
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto mix = [&](std::uint64_t word) {
    hash ^= word;
    hash *= 0x100000001b3u;
    hash ^= hash >> 32;
  };
  for (std::size_t i = 0; i < size; i += 8) {
    std::uint64_t word = 0;
    for (std::size_t k = 0; k < 8 && i + k < size; ++k) word |= static_cast<std::uint64_t>(data[i + k]) << (8 * k);
    mix(word);
  }
  mix(size);
  return hash;
}

std::vector<std::uint8_t> encode_hierarchy(const HybridMesh& hierarchy, const std::string& metadata_json) {
  const HierarchyParts parts = take_apart(hierarchy);
  Writer out;
  out.bytes.insert(out.bytes.end(), magic, magic + sizeof(magic));
  out.u32(version);
  out.u32(section_count);
  for (std::size_t s = 0; s < section_count; ++s) {
    Writer section;
    switch (s) {
      case 0:
        section.text(metadata_json);
        break;
      case 1:
        write_base(section, parts);
        break;
      case 2:
        write_tree(section, parts);
        break;
      case 3:
        write_operations(section, parts);
        break;
      case 4:
        section.u64(parts.level_positions.size());
        for (const auto& positions : parts.level_positions) write_positions(section, positions);
        write_positions(section, parts.final_positions);
        break;
      default:
        write_maps(section, parts);
    }
    out.bytes.insert(out.bytes.end(), tags[s], tags[s] + 4);
    out.u32(0);
    out.u64(section.bytes.size());
    out.u64(container_checksum(section.bytes.data(), section.bytes.size()));
    out.bytes.insert(out.bytes.end(), section.bytes.begin(), section.bytes.end());
  }
  return std::move(out.bytes);
}

LoadedHierarchy decode_hierarchy(const std::uint8_t* data, std::size_t size) {
  Reader file(data, size);
  if (std::memcmp(file.take(sizeof(magic)), magic, sizeof(magic)) != 0) corrupt("it starts with other bytes");
  const std::uint32_t found = file.u32();
  if (found == 0) corrupt("a version that never was");
  if (found > version) throw Error(ErrorCode::Unsupported, "a hierarchy file of version " + std::to_string(found) + ", newer than this program");
  if (file.u32() != section_count) corrupt("a number of sections that is not its version's");
  LoadedHierarchy result;
  HierarchyParts parts;
  for (std::size_t s = 0; s < section_count; ++s) {
    if (std::memcmp(file.take(4), tags[s], 4) != 0) corrupt(std::string("no section ") + tags[s]);
    if (file.u32() != 0) corrupt("reserved bytes in use");
    const std::uint64_t length = file.u64(), checksum = file.u64();
    if (length > file.left()) corrupt("it ends too early");
    const std::uint8_t* payload = file.take(static_cast<std::size_t>(length));
    if (container_checksum(payload, static_cast<std::size_t>(length)) != checksum)
      corrupt(std::string("section ") + tags[s] + " has a wrong checksum");
    Reader in(payload, static_cast<std::size_t>(length));
    switch (s) {
      case 0:
        result.metadata_json = in.text();
        break;
      case 1:
        read_base(in, parts);
        break;
      case 2:
        read_tree(in, parts);
        break;
      case 3:
        read_operations(in, parts);
        break;
      case 4:
        parts.level_positions.resize(in.count(8));
        for (auto& positions : parts.level_positions) positions = read_positions(in);
        parts.final_positions = read_positions(in);
        break;
      default:
        read_maps(in, parts);
    }
    in.end();
  }
  file.end();
  try {
    result.hierarchy = put_together(std::move(parts));
  } catch (const Error& error) {
    corrupt(error.what());
  }
  return result;
}

void save_hierarchy(const HybridMesh& hierarchy, const std::string& metadata_json, const std::string& path) {
  write_bytes(encode_hierarchy(hierarchy, metadata_json), path);
}

LoadedHierarchy load_hierarchy(const std::string& path, std::size_t most_bytes) {
  const std::vector<std::uint8_t> bytes = read_bytes(path);
  try {
    if (is_stream(bytes.data(), bytes.size()))
      return {decode_stream(bytes.data(), most_bytes ? std::min(most_bytes, bytes.size()) : bytes.size()), ""};
    if (most_bytes > 0) throw Error(ErrorCode::InvalidInput, "a hierarchy that is no stream is read whole or not at all");
    return decode_hierarchy(bytes.data(), bytes.size());
  } catch (const Error& e) {
    throw Error(e.code(), path + ": " + e.what());
  }
}

}  // namespace hybrid_mesh
