// SPDX-License-Identifier: GPL-3.0-or-later
// The faces of levels, and what is counted and checked on them.
#include "decoder/forest/leaf_polygons.h"

#include <algorithm>

namespace hybrid_mesh {

std::vector<int> QuadForest::level_faces(int cap, LevelKind kind) const {
  std::vector<int> result, stack;
  const int last_operation_level = kind == LevelKind::N ? cap : cap - 1;
  for (int o = operation_count() - 1; o >= 0; --o) {
    const Operation& op = operations_[o];
    if (!op.enabled || op.repatch.level > last_operation_level) continue;
    stack.insert(stack.end(), op.roots.rbegin(), op.roots.rend());
  }
  for (int q = base_count_; q-- > 0;) stack.push_back(q);
  while (!stack.empty()) {
    const int n = stack.back();
    stack.pop_back();
    const Node& node = nodes_[n];
    if (node.operation >= 0 && node.level <= last_operation_level && node.parent >= 0 && operations_[node.operation].enabled) continue;
    if (node.child < 0 || node.level >= cap)
      result.push_back(n);
    else
      for (int k = 3; k >= 0; --k) stack.push_back(node.child + k);
  }
  return result;
}

QuadForest::Polygons QuadForest::polygons(int cap, LevelKind kind) const { return polygons(level_faces(cap, kind)); }

QuadForest::Polygons QuadForest::polygons(std::vector<int> faces) const {
  Polygons result;
  result.faces = std::move(faces);
  int highest = 0;
  std::vector<char> used(vertex_slots(), 0);
  for (const int n : result.faces) {
    highest = std::max(highest, static_cast<int>(nodes_[n].level));
    for (const HalfEdge h : nodes_[n].half) used[vertex_slot(from(h))] = 1;
  }
  result.corners.reserve(4 * result.faces.size() + 16);
  result.offsets.reserve(result.faces.size() + 1);
  // Whether a face has a corner inside an edge: then it is cut in its middle. Where leaves are balanced, the middle itself is that corner.
  const auto used_inside = [&](const auto& self, int e) -> bool {
    if (edges_[e].child < 0 || edges_[e].level >= highest) return false;
    return used[vertex_slot(VertexId(VertexId::Kind::Edge, e))] || self(self, edges_[e].child) || self(self, edges_[e].child + 1);
  };
  struct Part {
    HalfEdge half;
    double begin, end;
  };
  std::vector<Part> parts;
  for (const int n : result.faces) {
    for (int s = 0; s < 4; ++s) {
      parts.assign(1, {nodes_[n].half[s], 0.0, 1.0});
      while (!parts.empty()) {
        const Part part = parts.back();
        parts.pop_back();
        if (used_inside(used_inside, part.half >> 1)) {
          const double t = 0.5 * (part.begin + part.end);
          parts.push_back({half_child(part.half, 1), t, part.end});
          parts.push_back({half_child(part.half, 0), part.begin, t});
        } else {
          result.corners.push_back({from(part.half), part.half, s, part.begin, part.end});
        }
      }
    }
    result.offsets.push_back(static_cast<int>(result.corners.size()));
  }
  return result;
}

void QuadForest::count_leaves() {
  const Polygons leaves = polygons(max_level + 1, LevelKind::N);
  std::vector<char> vertex(vertex_slots(), 0), edge(edges_.size(), 0);
  counts_ = {};
  counts_.faces = static_cast<std::int64_t>(leaves.faces.size());
  std::int64_t edges = 0;
  for (const auto& corner : leaves.corners) {
    char& v = vertex[vertex_slot(corner.vertex)];
    counts_.vertices += !v;
    v = 1;
    char& e = edge[corner.half >> 1];
    edges += !e;
    e = 1;
  }
  counts_.hanging = static_cast<std::int64_t>(leaves.corners.size()) - 4 * counts_.faces;
  counts_.euler = counts_.vertices - edges + counts_.faces;
}

std::string QuadForest::find_fan_defect(int cap) const {
  const Polygons level = polygons(cap, LevelKind::N);
  std::vector<char> seen(2 * edges_.size(), 0), vertex(vertex_slots(), 0);
  for (std::size_t f = 0; f < level.faces.size(); ++f)
    for (int c = level.offsets[f]; c < level.offsets[f + 1]; ++c) {
      const HalfEdge start = descend(level.corners[c].half, cap);
      if (seen[start]) continue;
      char& fan = vertex[vertex_slot(level.corners[c].vertex)];
      if (fan) return "a vertex has more than one fan of quads on level " + std::to_string(std::min(cap, depth()));
      fan = 1;
      HalfEdge h = start;
      bool closed = false;
      while (true) {
        const Sector sector = sector_left(h, cap);
        if (sector.node < 0) break;
        if (seen[h]) return "a fan of quads that does not close on level " + std::to_string(std::min(cap, depth()));
        seen[h] = 1;
        h = sector.next;
        if (h == start) {
          closed = true;
          break;
        }
      }
      for (h = start; !closed;) {
        const Sector sector = sector_right(h, cap);
        if (sector.node < 0) break;
        h = sector.next;
        if (seen[h]) return "a fan of quads that does not close on level " + std::to_string(std::min(cap, depth()));
        seen[h] = 1;
      }
    }
  return "";
}

}  // namespace hybrid_mesh
