// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <vector>

#include "surface/edge_groups.h"
#include "surface/repair_stages.h"

namespace hybrid_mesh {

namespace {

// +1 or -1: whether a face runs through its corners in ascending order.
int sign(const std::array<int, 3>& face) {
  const int smallest = static_cast<int>(std::min_element(face.begin(), face.end()) - face.begin());
  return face[(smallest + 1) % 3] < face[(smallest + 2) % 3] ? 1 : -1;
}

class DuplicateFaces {
 public:
  explicit DuplicateFaces(const RepairMesh& mesh) : mesh_(mesh), keep_(mesh.faces.size(), 1), balanced_(mesh.faces.size(), 0) {}

  const std::vector<char>& find() {
    if (thin_out()) cancel_balanced();
    return keep_;
  }

 private:
  // Leaves one face of each group; whether some group is balanced.
  bool thin_out() {
    const int vertex_count = static_cast<int>(mesh_.origin.size());
    struct Key {
      int middle, largest, face;
    };
    // A counting sort by the smallest corner, then a sort of its few faces.
    std::vector<int> first(static_cast<std::size_t>(vertex_count) + 1, 0);
    for (const auto& face : mesh_.faces) ++first[*std::min_element(face.begin(), face.end()) + 1];
    for (int v = 0; v < vertex_count; ++v) first[v + 1] += first[v];
    std::vector<int> fill(first.begin(), first.end() - 1);
    std::vector<Key> keys(mesh_.faces.size());
    for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
      std::array<int, 3> sorted = mesh_.faces[f];
      std::sort(sorted.begin(), sorted.end());
      keys[fill[sorted[0]]++] = {sorted[1], sorted[2], static_cast<int>(f)};
    }
    bool any_balanced = false;
    for (int v = 0; v < vertex_count; ++v) {
      std::sort(keys.begin() + first[v], keys.begin() + first[v + 1], [](const Key& a, const Key& b) {
        return a.middle != b.middle ? a.middle < b.middle : a.largest != b.largest ? a.largest < b.largest : a.face < b.face;
      });
      for (int begin = first[v]; begin < first[v + 1];) {
        int end = begin + 1;
        while (end < first[v + 1] && keys[end].middle == keys[begin].middle && keys[end].largest == keys[begin].largest) ++end;
        if (end - begin > 1) {
          int balance = 0;
          for (int i = begin; i < end; ++i) balance += sign(mesh_.faces[keys[i].face]), keep_[keys[i].face] = 0;
          int kept = begin;
          while (balance * sign(mesh_.faces[keys[kept].face]) < 0) ++kept;
          keep_[keys[kept].face] = 1;
          balanced_[keys[kept].face] = balance == 0;
          any_balanced = any_balanced || balance == 0;
        }
        begin = end;
      }
    }
    return any_balanced;
  }

  void cancel_balanced() {
    std::vector<int> half_edges;  // of the faces that are left
    for (int h = 0; h < 3 * static_cast<int>(keep_.size()); ++h)
      if (keep_[h / 3]) half_edges.push_back(h);
    const EdgeGroups edges = group_edges(
        static_cast<int>(mesh_.origin.size()), static_cast<int>(half_edges.size()), [&](int i) { return mesh_.from(half_edges[i]); },
        [&](int i) { return mesh_.to(half_edges[i]); });
    std::vector<int> edge_of(3 * keep_.size(), -1), others(edges.count(), 0);  // `others`: faces at an edge that are not balanced
    for (int e = 0; e < edges.count(); ++e)
      for (int i = 0; i < edges.size(e); ++i) {
        const int h = half_edges[edges.of(e)[i]];
        edge_of[h] = e;
        others[e] += !balanced_[h / 3];
      }
    std::vector<char> seen(keep_.size(), 0);
    for (std::size_t seed = 0; seed < keep_.size(); ++seed) {
      if (!balanced_[seed] || seen[seed]) continue;
      std::vector<int> patch{static_cast<int>(seed)};
      seen[seed] = 1;
      bool attached = false, free = false, tangled = false;
      for (std::size_t i = 0; i < patch.size(); ++i)
        for (int h = 3 * patch[i]; h < 3 * patch[i] + 3; ++h) {
          const int e = edge_of[h], size = edges.size(e);
          if (others[e] >= 2) {
            attached = true;
          } else if (size == 1) {
            free = true;
          } else if (size == 2 && others[e] == 0) {
            for (int k = 0; k < 2; ++k)
              if (const int f = half_edges[edges.of(e)[k]] / 3; !seen[f]) seen[f] = 1, patch.push_back(f);
          } else {
            tangled = true;
          }
        }
      if (attached && !tangled && (!free || patch.size() == 1))
        for (const int f : patch) keep_[f] = 0;
    }
  }

  const RepairMesh& mesh_;
  std::vector<char> keep_, balanced_;
};

}  // namespace

void remove_duplicate_faces(RepairMesh& mesh, RepairReport& report) {
  const std::vector<char> keep = DuplicateFaces(mesh).find();
  report.duplicate_faces = std::count(keep.begin(), keep.end(), 0);
  if (report.duplicate_faces > 0) mesh.keep_faces(keep);
}

}  // namespace hybrid_mesh
