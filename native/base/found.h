// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "base/error.h"

namespace hybrid_mesh {

// What was sought, or why there is none. Without a type: that it was done.
template <class T = std::monostate>
struct Found {
  std::optional<T> value;
  std::string reason;  // without a value

  explicit operator bool() const { return value.has_value(); }
  T& operator*() { return *value; }
  const T& operator*() const { return *value; }
  T* operator->() { return &*value; }
  const T* operator->() const { return &*value; }
};

// What `seek` returns, or why it found no map. But for the border to Python, the only place where NoMap is caught.
template <class Seek>
auto found(const Seek& seek) {
  using Result = std::invoke_result_t<Seek>;
  using Value = std::conditional_t<std::is_void_v<Result>, std::monostate, Result>;
  try {
    if constexpr (std::is_void_v<Result>) {
      seek();
      return Found<Value>{std::monostate(), {}};
    } else {
      return Found<Value>{seek(), {}};
    }
  } catch (const NoMap& none) {
    return Found<Value>{std::nullopt, none.what()};
  }
}

}  // namespace hybrid_mesh
