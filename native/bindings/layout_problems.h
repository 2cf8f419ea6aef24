// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <vector>

#include "layout/drawn/drawn_layout.h"

namespace hybrid_mesh {

// Problems as Python has them: dicts of kind, message, points (n, 3), stroke and face.
pybind11::list to_list(const std::vector<LayoutProblem>& problems);

}  // namespace hybrid_mesh
