// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings/mesh_dict.h"

namespace hybrid_mesh {

// A level by its name: N0, M1, N1, ...
struct Level {
  LevelKind kind;
  int number;
  std::string name() const { return (kind == LevelKind::M ? "M" : "N") + std::to_string(number); }
};

// M^j is there only where an irregular operation separates it from N^j. Throws Error{InvalidInput} if there is no such level.
Level find_level(const HybridMesh& mesh, const std::string& name);

// What Python holds of a hierarchy. Copies share it.
class PythonHierarchy {
 public:
  PythonHierarchy(std::shared_ptr<const HybridMesh> mesh, std::string metadata, RootNotes notes = {})
      : shared_(std::make_shared<Shared>()), metadata_(std::move(metadata)) {
    shared_->mesh = std::move(mesh);
    shared_->notes = std::move(notes);
  }

  const RootNotes& notes() const { return shared_->notes; }  // to be read inside locked() alone
  const std::string& metadata() const { return metadata_; }  // JSON text kept in the file

  // Calls function(const HybridMesh&), one caller at a time: sampling remembers where it was, and Python's other threads may go on.
  template <typename Function>
  auto locked(Function&& function) const {
    const std::lock_guard lock(shared_->mutex);
    return function(*shared_->mesh);
  }

  // Puts function(const HybridMesh&), which has the same nodes and perhaps more, in the hierarchy's place. If the function throws, nothing has
  // changed.
  template <typename Function>
  void replace(Function&& function) {
    const std::lock_guard lock(shared_->mutex);
    auto mesh = std::make_shared<const HybridMesh>(function(*shared_->mesh));
    std::vector<int> plan_root = shared_->notes.plan_root;
    if (!plan_root.empty()) {
      int next = *std::max_element(plan_root.begin(), plan_root.end()) + 1;
      for (int node = static_cast<int>(plan_root.size()); node < mesh->node_count(); ++node) plan_root.push_back(mesh->is_root(node) ? next++ : -1);
    }
    shared_->mesh = std::move(mesh);
    shared_->notes.plan_root = std::move(plan_root);
    shared_->sources.reset();
  }

  // The same with function(const HybridMesh&) that has positions elsewhere.
  template <typename Function>
  void edit(Function&& function) {
    const std::lock_guard lock(shared_->mutex);
    shared_->mesh = std::make_shared<const HybridMesh>(function(*shared_->mesh));
    shared_->notes.edited = true;
    shared_->sources.reset();
  }

  // The hierarchy as it is now.
  std::pair<std::shared_ptr<const HybridMesh>, RootNotes> snapshot() const {
    const std::lock_guard lock(shared_->mutex);
    return {shared_->mesh, shared_->notes};
  }
  // Puts another hierarchy, which has the same nodes and more, in the place of `before`, a snapshot; returns false, and does nothing, if it has been
  // replaced meanwhile.
  bool replace(const std::shared_ptr<const HybridMesh>& before, std::shared_ptr<const HybridMesh> mesh, std::vector<int> plan_root) {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->mesh != before) return false;
    shared_->mesh = std::move(mesh);
    shared_->notes.plan_root = std::move(plan_root);
    shared_->sources.reset();
    return true;
  }

  // The mesh that make(const HybridMesh&) takes out of the hierarchy, with what Blender shows of it: no other thread changes the hierarchy in
  // between.
  template <typename Make>
  AnnotatedMesh annotated(Make&& make) const {
    const std::lock_guard lock(shared_->mutex);
    if (!shared_->sources) shared_->sources.emplace(*shared_->mesh, shared_->notes.edited ? VertexPlaces::OfMaps : VertexPlaces::Nearest);
    return annotate(*shared_->mesh, *shared_->sources, shared_->notes, make(*shared_->mesh));
  }

 private:
  struct Shared {
    std::mutex mutex;
    std::shared_ptr<const HybridMesh> mesh;
    RootNotes notes;
    std::optional<VertexSources> sources;  // made when first needed
  };
  std::shared_ptr<Shared> shared_;
  std::string metadata_;
};

}  // namespace hybrid_mesh
