// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

#include "bindings/hierarchy.h"
#include "remesh/remesh.h"

namespace hybrid_mesh {

// What Python holds of a remesh.
struct PythonResult {
  std::shared_ptr<const RemeshResult> result;
  PythonHierarchy hierarchy;  // that of the result

  explicit PythonResult(std::shared_ptr<const RemeshResult> from)
      : result(std::move(from)), hierarchy(std::shared_ptr<const HybridMesh>(result, &result->hierarchy), "", {result->plan_root, result->opened}) {}
};

// Throws Error{InvalidInput} that names the key that is unknown, of the wrong type or out of range.
RemeshOptions remesh_options_from_dict(const pybind11::dict& settings);

}  // namespace hybrid_mesh
