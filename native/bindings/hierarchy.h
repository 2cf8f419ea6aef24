// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "bindings/mesh_dict.h"

namespace hybrid_mesh {

// What Python holds of a hierarchy. Copies share it.
class PythonHierarchy {
 public:
  PythonHierarchy(std::shared_ptr<const HybridMesh> mesh, std::string metadata)
      : shared_(std::make_shared<Shared>()), metadata_(std::move(metadata)) {
    shared_->mesh = std::move(mesh);
  }

  const std::string& metadata() const { return metadata_; }  // JSON text kept in the file

  // Calls function(const HybridMesh&), one caller at a time: sampling remembers where it was, and Python's other threads may go on.
  template <typename Function>
  auto locked(Function&& function) const {
    const std::lock_guard lock(shared_->mutex);
    return function(*shared_->mesh);
  }

  AnnotatedMesh annotated(QuadMesh mesh) const {
    const std::lock_guard lock(shared_->mutex);
    if (!shared_->sources) shared_->sources.emplace(*shared_->mesh);
    return annotate(*shared_->mesh, *shared_->sources, std::move(mesh));
  }

 private:
  struct Shared {
    std::mutex mutex;
    std::shared_ptr<const HybridMesh> mesh;
    std::optional<VertexSources> sources;  // made when first needed
  };
  std::shared_ptr<Shared> shared_;
  std::string metadata_;
};

}  // namespace hybrid_mesh
