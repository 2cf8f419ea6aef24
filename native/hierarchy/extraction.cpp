// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes taken out of the hierarchy.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/error.h"
#include "hierarchy/hybrid_mesh.h"
#include "hierarchy/leaf_polygons.h"

namespace hybrid_mesh {

namespace {

constexpr double side_u[4] = {0, 1, 1, 0}, side_v[4] = {0, 0, 1, 1};

}  // namespace

HybridMesh::Polygons HybridMesh::polygons(int cap, LevelKind kind) const {
  Polygons result;
  // Faces in the order of the trees; operations of the level itself are left out for M.
  const int last_operation_level = kind == LevelKind::N ? cap : cap - 1;
  struct Item {
    int node, owner;
    Square square;
  };
  std::vector<Item> stack;
  for (int o = operation_count() - 1; o >= 0; --o) {
    const Operation& op = operations_[o];
    if (!op.enabled || op.repatch.level > last_operation_level) continue;
    for (std::size_t i = op.roots.size(); i-- > 0;) stack.push_back({op.roots[i], op.roots[i], {}});
  }
  for (int q = base_count_; q-- > 0;) stack.push_back({q, q, {}});
  while (!stack.empty()) {
    Item item = stack.back();
    stack.pop_back();
    const Node& node = nodes_[item.node];
    const int removed = removed_by(item.node);
    if (removed >= 0 && operations_[removed].enabled && node.level <= last_operation_level) continue;
    if (node.map >= 0) item.owner = item.node, item.square = {};
    if (node.child < 0 || node.level >= cap) {
      result.faces.push_back({item.node, item.owner, item.square});
      result.highest = std::max(result.highest, static_cast<int>(node.level));
      continue;
    }
    const double w = 0.5 * item.square.width;
    for (int k = 3; k >= 0; --k)
      stack.push_back({node.child + k, item.owner, {item.square.u + w * (k == 1 || k == 2), item.square.v + w * (k >= 2), w}});
  }
  std::vector<char> used(vertex_slots(), 0);
  for (const auto& face : result.faces)
    for (HalfEdge h : nodes_[face.node].half) used[vertex_slot(from(h))] = 1;
  result.corners.reserve(4 * result.faces.size() + 16);
  result.offsets.reserve(result.faces.size() + 1);
  // Whether a face has a corner inside an edge: then it is cut in its middle. Where leaves are balanced, the middle itself is that corner.
  const auto used_inside = [&](const auto& self, int e) -> bool {
    if (edges_[e].child < 0 || edges_[e].level >= result.highest) return false;
    return used[vertex_slot(VertexId(VertexId::Kind::Edge, e))] || self(self, edges_[e].child) || self(self, edges_[e].child + 1);
  };
  struct Part {
    HalfEdge half;
    double begin, end;
  };
  std::vector<Part> parts;
  for (const auto& face : result.faces) {
    for (int s = 0; s < 4; ++s) {
      const double u0 = face.square.u + face.square.width * side_u[s], v0 = face.square.v + face.square.width * side_v[s];
      const double du = face.square.width * (side_u[(s + 1) % 4] - side_u[s]), dv = face.square.width * (side_v[(s + 1) % 4] - side_v[s]);
      parts.assign(1, {nodes_[face.node].half[s], 0.0, 1.0});
      while (!parts.empty()) {
        const Part part = parts.back();
        parts.pop_back();
        const int e = part.half >> 1;
        if (used_inside(used_inside, e)) {
          const double t = 0.5 * (part.begin + part.end);
          parts.push_back({half_child(part.half, 1), t, part.end});
          parts.push_back({half_child(part.half, 0), part.begin, t});
        } else {
          result.corners.push_back({from(part.half), part.half, u0 + du * part.begin, v0 + dv * part.begin});
        }
      }
    }
    result.offsets.push_back(static_cast<int>(result.corners.size()));
  }
  return result;
}

void HybridMesh::count_leaves() {
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

std::string HybridMesh::find_fan_defect(int cap) const {
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

QuadMesh HybridMesh::close(const Polygons& polygons, FaceClosure closure, const Positions* positions) const {
  QuadMesh mesh;
  std::vector<int> index(vertex_slots(), -1);
  const bool split = closure == FaceClosure::Quads && !polygons.conforming();
  const std::size_t expected_faces = split ? polygons.corners.size() : polygons.faces.size();
  mesh.indices.reserve((split ? 4 : 1) * polygons.corners.size());
  mesh.offsets.reserve(expected_faces + 1);
  mesh.node.reserve(expected_faces);
  mesh.root.reserve(expected_faces);
  mesh.vertex.reserve(polygons.faces.size() + 64);
  mesh.location.reserve(polygons.faces.size() + 64);
  const auto vertex = [&](VertexId id, int owner, double u, double v) {
    int& i = index[vertex_slot(id)];
    if (i < 0) {
      i = static_cast<int>(mesh.vertex.size());
      mesh.vertex.push_back(id);
      mesh.location.push_back({owner, u, v});
    }
    return i;
  };
  const auto end_face = [&](int node) {
    mesh.offsets.push_back(static_cast<std::int64_t>(mesh.indices.size()));
    mesh.node.push_back(node);
    mesh.root.push_back(nodes_[node].root);
  };
  const bool sharp = has_sharp_sides();
  std::vector<int> loop, middles;
  std::vector<char> sharp_side;
  for (std::size_t f = 0; f < polygons.faces.size(); ++f) {
    const auto& face = polygons.faces[f];
    const int begin = polygons.offsets[f], count = polygons.offsets[f + 1] - begin;
    loop.clear();
    for (int i = 0; i < count; ++i) {
      const auto& corner = polygons.corners[begin + i];
      loop.push_back(vertex(corner.vertex, face.owner, corner.u, corner.v));
    }
    sharp_side.clear();
    for (int i = 0; i < count && sharp; ++i) sharp_side.push_back(edges_[polygons.corners[begin + i].half >> 1].sharp);
    if (split) {
      middles.clear();
      for (int i = 0; i < count; ++i) {
        const auto &a = polygons.corners[begin + i], &b = polygons.corners[begin + (i + 1) % count];
        middles.push_back(vertex(VertexId(VertexId::Kind::Edge, a.half >> 1), face.owner, 0.5 * (a.u + b.u), 0.5 * (a.v + b.v)));
      }
      const double w = 0.5 * face.square.width;
      const int centre = vertex(VertexId(VertexId::Kind::Node, face.node), face.owner, face.square.u + w, face.square.v + w);
      for (int i = 0; i < count; ++i) {
        mesh.indices.insert(mesh.indices.end(), {loop[i], middles[i], centre, middles[(i + count - 1) % count]});
        if (sharp) mesh.sharp.insert(mesh.sharp.end(), {sharp_side[i], 0, 0, sharp_side[(i + count - 1) % count]});
        end_face(face.node);
      }
      continue;
    }
    // A fan from a hanging node has no triangle without area, unless a side has several. The n-gon starts there too: a fan from its first corner is
    // how many a program triangulates it.
    int apex = 0;
    for (int i = 0; i < count && count > 4 && apex == 0; ++i) {
      bool hanging = true;
      for (HalfEdge h : nodes_[face.node].half) hanging &= from(h) != polygons.corners[begin + i].vertex;
      if (hanging) apex = i;
    }
    std::rotate(loop.begin(), loop.begin() + apex, loop.end());
    if (sharp) std::rotate(sharp_side.begin(), sharp_side.begin() + apex, sharp_side.end());
    if (closure == FaceClosure::Triangles && count > 4) {
      for (int i = 1; i + 1 < count; ++i) {
        mesh.indices.insert(mesh.indices.end(), {loop[0], loop[i], loop[i + 1]});
        if (sharp) {
          const char first = i == 1 ? sharp_side[0] : 0, last = i + 2 == count ? sharp_side[i + 1] : 0;
          mesh.sharp.insert(mesh.sharp.end(), {first, sharp_side[i], last});
        }
        end_face(face.node);
      }
    } else {
      mesh.indices.insert(mesh.indices.end(), loop.begin(), loop.end());
      if (sharp) mesh.sharp.insert(mesh.sharp.end(), sharp_side.begin(), sharp_side.end());
      end_face(face.node);
    }
  }
  mesh.points.assign(mesh.vertex.size(), Vec3::Zero());
  std::vector<char> known(mesh.vertex.size(), 0);
  if (positions)
    for (const auto& [id, point] : *positions) {
      const int i = index[vertex_slot(id)];
      if (i < 0) continue;
      mesh.points[i] = point;
      known[i] = 1;
    }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.vertex.size(), 1024), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (known[i]) continue;
      const MapLocation& location = mesh.location[i];
      if (const PatchSampler* sampler = this->sampler(location.node)) mesh.points[i] = (*sampler)(location.u, location.v).position;
    }
  });
  return mesh;
}

QuadMesh HybridMesh::level_mesh(int j, LevelKind kind, FaceClosure closure) const {
  if (j < 0) throw Error(ErrorCode::InvalidInput, "a level below zero");
  return close(polygons(j, kind), closure, has_level_positions(j) ? &level_positions_[j] : nullptr);
}

QuadMesh HybridMesh::final_mesh(FaceClosure closure) const {
  return close(polygons(max_level + 1, LevelKind::N), closure, has_final_positions() ? &final_positions_ : nullptr);
}

// Joins two sorted lists; the later one wins.
static void merge_positions(std::vector<std::pair<VertexId, Vec3>>& kept, const QuadMesh& mesh) {
  if (mesh.points.size() != mesh.vertex.size()) throw Error(ErrorCode::InvalidInput, "positions and vertices differ in number");
  // Sorted in linear time: names are whole numbers.
  const auto last = std::max_element(mesh.vertex.begin(), mesh.vertex.end());
  std::vector<int> place(last == mesh.vertex.end() ? 0 : last->code + 1, -1);
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v) place[mesh.vertex[v].code] = static_cast<int>(v);
  std::vector<std::pair<VertexId, Vec3>> joined;
  joined.reserve(kept.size() + mesh.points.size());
  std::size_t i = 0;
  for (const int v : place) {
    if (v < 0) continue;
    while (i < kept.size() && kept[i].first < mesh.vertex[v]) joined.push_back(kept[i++]);
    if (i < kept.size() && kept[i].first == mesh.vertex[v]) ++i;
    joined.emplace_back(mesh.vertex[v], mesh.points[v]);
  }
  joined.insert(joined.end(), kept.begin() + static_cast<std::ptrdiff_t>(i), kept.end());
  kept = std::move(joined);
}

void HybridMesh::set_level_positions(int j, const QuadMesh& mesh) {
  if (j < 0 || j > max_level) throw Error(ErrorCode::InvalidInput, "a level out of range");
  if (static_cast<int>(level_positions_.size()) <= j) level_positions_.resize(j + 1);
  merge_positions(level_positions_[j], mesh);
}

void HybridMesh::set_final_positions(const QuadMesh& mesh) { merge_positions(final_positions_, mesh); }

void HybridMesh::clear_positions() {
  level_positions_.clear();
  final_positions_.clear();
}

bool HybridMesh::has_level_positions(int j) const { return j >= 0 && j < static_cast<int>(level_positions_.size()) && !level_positions_[j].empty(); }

}  // namespace hybrid_mesh
