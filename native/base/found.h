// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"

namespace hybrid_mesh {

// What was sought, or why there is none.
template <class T>
struct Found {
  std::optional<T> value;
  std::string reason;  // without a value

  explicit operator bool() const { return value.has_value(); }
  T& operator*() { return *value; }
  T* operator->() { return &*value; }
};

// What `seek` returns, or why it found no map. The only place where NoMap is caught.
template <class Seek>
auto found(const Seek& seek) -> Found<std::invoke_result_t<Seek>> {
  try {
    return {seek(), {}};
  } catch (const NoMap& none) {
    return {std::nullopt, none.what()};
  }
}

}  // namespace hybrid_mesh
