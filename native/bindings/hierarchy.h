// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings/mesh_dict.h"

namespace hybrid_mesh {

// What Python holds of a hierarchy. Copies share it.
class PythonHierarchy {
 public:
  // `plan_root`: see RemeshResult; empty where there is no plan.
  PythonHierarchy(std::shared_ptr<const HybridMesh> mesh, std::string metadata, std::vector<int> plan_root = {})
      : shared_(std::make_shared<Shared>()), metadata_(std::move(metadata)) {
    shared_->mesh = std::move(mesh);
    shared_->plan_root = std::move(plan_root);
  }

  const std::vector<int>& plan_root() const { return shared_->plan_root; }
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
    return annotate(*shared_->mesh, *shared_->sources, shared_->plan_root, std::move(mesh));
  }

 private:
  struct Shared {
    std::mutex mutex;
    std::shared_ptr<const HybridMesh> mesh;
    std::vector<int> plan_root;
    std::optional<VertexSources> sources;  // made when first needed
  };
  std::shared_ptr<Shared> shared_;
  std::string metadata_;
};

}  // namespace hybrid_mesh
