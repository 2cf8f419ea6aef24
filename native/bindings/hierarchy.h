// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// What Python holds of a hierarchy. The mutex is there because sampling remembers where it was, and the interpreter's lock is released.
struct PythonHierarchy {
  std::shared_ptr<const HybridMesh> mesh;
  std::string metadata;  // JSON text kept in the file
  std::shared_ptr<std::mutex> mutex = std::make_shared<std::mutex>();
};

}  // namespace hybrid_mesh
