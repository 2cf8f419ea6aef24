// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/file_bytes.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#if defined(__unix__) || defined(__APPLE__)
#include <unistd.h>
#endif

#include "base/error.h"

namespace hybrid_mesh {

void write_bytes(const std::vector<std::uint8_t>& bytes, const std::string& path) {
  namespace fs = std::filesystem;
#if defined(__unix__) || defined(__APPLE__)
  const std::string part = path + "." + std::to_string(::getpid()) + ".part";
#else
  const std::string part = path + ".part";
#endif
  const auto fail = [&](const std::string& what) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw Error(ErrorCode::Io, "cannot write " + path + ": " + what);
  };
  {
    std::ofstream file(part, std::ios::binary | std::ios::trunc);
    if (!file) fail(std::strerror(errno));
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) fail(errno ? std::strerror(errno) : "the disk may be full");
  }
  std::error_code error;
  fs::rename(part, path, error);
  if (error) fail(error.message());
}

std::vector<std::uint8_t> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::Io, "cannot read " + path + ": " + std::strerror(errno));
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw Error(ErrorCode::Io, "cannot read " + path + ": it is a folder");
  std::vector<std::uint8_t> bytes;
  std::vector<char> block(1 << 20);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    bytes.insert(bytes.end(), block.begin(), block.begin() + file.gcount());
  }
  return bytes;
}

}  // namespace hybrid_mesh
