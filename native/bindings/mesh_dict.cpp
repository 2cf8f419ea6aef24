// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/mesh_dict.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bindings/conversions.h"
#include "hierarchy/stretch.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

constexpr double kIslandMargin = 0.02;  // of an island's cell, on every side

// Where the vertices of the faces under one node lie in the square of the node's root.
class NodeSquare {
 public:
  NodeSquare(const HybridMesh& hierarchy, int node) : hierarchy_(hierarchy), node_(node), square_(hierarchy.square_in(node, hierarchy.root(node))) {
    for (int side = 0; side < 4; ++side) add_side(side);
    places_.emplace_back(VertexId(VertexId::Kind::Node, node), Vec2(0.5, 0.5));
  }

  // A root quad may have the same vertex at several corners: then their order tells.
  bool is_whole(const VertexId* face, int count, int& rotation) const {
    if (count != 4) return false;
    for (rotation = 0; rotation < 4; ++rotation) {
      bool same = true;
      for (int i = 0; i < 4; ++i) same = same && face[i] == hierarchy_.corner(node_, (i + rotation) % 4);
      if (same) return true;
    }
    return false;
  }

  Vec2 corner(int i) const { return in_root(kCorners[i % 4]); }

  Vec2 place(VertexId vertex) const {
    for (const auto& [id, uv] : places_) {
      if (id == vertex) return in_root(uv);
    }
    return in_root(Vec2(0.5, 0.5));
  }

 private:
  static inline const std::array<Vec2, 4> kCorners{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};

  // Corner, midpoint, and the ends and midpoints of the sides of finer leaves across.
  void add_side(int side) {
    const Vec2& begin = kCorners[side];
    const Vec2 step = kCorners[(side + 1) % 4] - begin;
    places_.emplace_back(hierarchy_.corner(node_, side), begin);
    places_.emplace_back(VertexId(VertexId::Kind::Edge, hierarchy_.half_edge(node_, side) >> 1), begin + 0.5 * step);
    double t = 0;
    for (const SideLink& link : hierarchy_.leaf_neighbours(node_, side)) {
      const double width = std::ldexp(1.0, hierarchy_.level(node_) - hierarchy_.level(link.node));
      if (width >= 1) break;
      // Their sides run the other way: the corner after side s is where this one begins.
      places_.emplace_back(hierarchy_.corner(link.node, (link.side + 1) % 4), begin + t * step);
      places_.emplace_back(VertexId(VertexId::Kind::Edge, hierarchy_.half_edge(link.node, link.side) >> 1), begin + (t + width / 2) * step);
      t += width;
    }
  }

  Vec2 in_root(const Vec2& uv) const { return Vec2(square_.u, square_.v) + square_.width * uv; }

  const HybridMesh& hierarchy_;
  int node_;
  HybridMesh::Square square_;
  std::vector<std::pair<VertexId, Vec2>> places_;
};

// The patches' islands lie row by row in the order of the hierarchy's roots, so that a patch has the same island on every level.
class IslandGrid {
 public:
  explicit IslandGrid(const HybridMesh& hierarchy) : rank_(hierarchy.node_count(), 0) {
    const std::vector<int> roots = hierarchy.roots();
    for (std::size_t i = 0; i < roots.size(); ++i) rank_[roots[i]] = static_cast<int>(i);
    side_ = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(roots.size())))));
  }

  std::array<float, 2> operator()(int root, const Vec2& uv) const {
    const Vec2 cell(rank_[root] % side_, rank_[root] / side_);
    const Vec2 place = (cell + Vec2::Constant(kIslandMargin) + (1 - 2 * kIslandMargin) * uv) / side_;
    return {static_cast<float>(place.x()), static_cast<float>(place.y())};
  }

 private:
  std::vector<int> rank_;
  int side_ = 1;
};

void add_uv(const HybridMesh& hierarchy, AnnotatedMesh& annotated) {
  const QuadMesh& mesh = annotated.mesh;
  const IslandGrid grid(hierarchy);
  annotated.uv.reserve(mesh.indices.size());
  std::vector<VertexId> face;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const NodeSquare square(hierarchy, mesh.node[f]);
    face.clear();
    for (std::int64_t k = mesh.offsets[f]; k < mesh.offsets[f + 1]; ++k) face.push_back(mesh.vertex[mesh.indices[k]]);
    int rotation = 0;
    const bool whole = square.is_whole(face.data(), static_cast<int>(face.size()), rotation);
    for (std::size_t i = 0; i < face.size(); ++i) {
      annotated.uv.push_back(grid(mesh.root[f], whole ? square.corner(static_cast<int>(i) + rotation) : square.place(face[i])));
    }
  }
}

void add_sources(const HybridMesh& hierarchy, const VertexSources& vertex_sources, AnnotatedMesh& annotated) {
  for (const SurfacePoint& source : vertex_sources(hierarchy, annotated.mesh)) {
    annotated.source_face.push_back(source.face);
    annotated.source_weights.push_back(
        {static_cast<float>(source.weights[0]), static_cast<float>(source.weights[1]), static_cast<float>(source.weights[2])});
  }
}

void add_addresses(const HybridMesh& hierarchy, const std::vector<int>& plan_root, AnnotatedMesh& annotated) {
  const std::vector<int> number = root_numbers(hierarchy, plan_root);
  for (std::size_t f = 0; f < annotated.mesh.face_count(); ++f) {
    std::int32_t path = 0, digit = 1;
    int node = annotated.mesh.node[f];
    for (; !hierarchy.is_root(node); node = hierarchy.parent(node), digit *= 4)
      path += digit * (node - hierarchy.first_child(hierarchy.parent(node)));
    annotated.root.push_back(number[node]);
    annotated.path.push_back(path + digit);
  }
}

}  // namespace

std::vector<int> root_numbers(const HybridMesh& hierarchy, const std::vector<int>& plan_root) {
  if (!plan_root.empty()) return plan_root;
  std::vector<int> number(hierarchy.node_count(), -1);
  int roots = 0;
  for (const int root : hierarchy.roots()) number[root] = roots++;
  return number;
}

AnnotatedMesh annotate(const HybridMesh& hierarchy, const VertexSources& vertex_sources, const RootNotes& notes, QuadMesh mesh) {
  AnnotatedMesh annotated;
  annotated.mesh = std::move(mesh);
  const LevelStretch stretch = level_stretch(hierarchy, annotated.mesh);
  annotated.stretch.assign(stretch.stretch.begin(), stretch.stretch.end());
  annotated.anisotropy.assign(stretch.anisotropy.begin(), stretch.anisotropy.end());
  for (const std::int32_t root : annotated.mesh.root) {
    annotated.irregular.push_back(hierarchy.inserted_by(root) >= 0);
    if (notes.opened.empty()) continue;
    const int event = notes.opened_at(root);
    annotated.opened.push_back(event + 1);
    annotated.opened_level.push_back(event < 0 ? 0 : hierarchy.level(root));
  }
  add_addresses(hierarchy, notes.plan_root, annotated);
  add_uv(hierarchy, annotated);
  add_sources(hierarchy, vertex_sources, annotated);
  return annotated;
}

py::dict to_dict(const AnnotatedMesh& annotated) {
  py::array_t<bool> irregular(static_cast<py::ssize_t>(annotated.irregular.size()));
  std::copy(annotated.irregular.begin(), annotated.irregular.end(), irregular.mutable_data());
  py::dict result;
  result["points"] = rows_to_array<double>(annotated.mesh.points);
  result["offsets"] = to_array(annotated.mesh.offsets);
  result["indices"] = to_array(annotated.mesh.indices);
  result["stretch"] = to_array(annotated.stretch);
  result["anisotropy"] = to_array(annotated.anisotropy);
  result["quad"] = to_array(annotated.mesh.node);
  result["patch"] = to_array(annotated.mesh.root);
  result["root"] = to_array(annotated.root);
  result["path"] = to_array(annotated.path);
  result["irregular"] = irregular;
  if (!annotated.mesh.sharp.empty()) {
    py::array_t<bool> sharp(static_cast<py::ssize_t>(annotated.mesh.sharp.size()));
    std::copy(annotated.mesh.sharp.begin(), annotated.mesh.sharp.end(), sharp.mutable_data());
    result["sharp"] = sharp;
  }
  if (!annotated.opened.empty()) {
    result["opened"] = to_array(annotated.opened);
    result["opened_level"] = to_array(annotated.opened_level);
  }
  result["uv"] = rows_to_array<float>(annotated.uv);
  result["source_face"] = to_array(annotated.source_face);
  result["source_weights"] = rows_to_array<float>(annotated.source_weights);
  return result;
}

}  // namespace hybrid_mesh
