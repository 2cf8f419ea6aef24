// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace hybrid_mesh {

// What went wrong; reaches Python as an exception class of the same name.
enum class ErrorCode {
  InvalidInput,   // the caller's data or settings cannot be used
  Unsupported,    // a correct request that this build or version cannot serve
  Cancelled,      // the Context was cancelled
  CorruptStream,  // bytes that are no valid file of the format they claim to be
  Io,             // the operating system refused to read or write
  Internal        // an invariant of ours does not hold
};

class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace hybrid_mesh
