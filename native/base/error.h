// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

#include "decoder/error.h"

namespace hybrid_mesh {

// There is no layout, or no bijective map that holds in double precision, for what was tried: an outcome and no defect. Other quads, near-ties
// decided in another way, or a finer surface may have one. Who decides what to try next asks with found(), and what it gets is a value.
class NoMap : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace hybrid_mesh
