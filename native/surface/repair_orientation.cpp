// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "surface/edge_groups.h"
#include "surface/repair_stages.h"

namespace hybrid_mesh {

namespace {

class Orientation {
 public:
  Orientation(RepairMesh& mesh, RepairReport& report) : mesh_(mesh), report_(report), turned_(mesh.faces.size(), -1) {}

  void run() {
    const int face_count = static_cast<int>(mesh_.faces.size());
    for (int f = 0; f < face_count; ++f) {
      if (turned_[f] >= 0) continue;
      spread(f);
      if (conflicts() > 0) cut_open();
      turn_majority();
    }
    apply();
  }

 private:
  bool conflict(int h) const {
    const int g = mesh_.mate[h];
    return g >= 0 && ((turned_[h / 3] ^ turned_[g / 3]) != 0) != mesh_.same_direction(h, g);
  }

  // Orients the component of a face, which is left in `component_`, breadth first.
  void spread(int seed) {
    component_.assign(1, seed);
    turned_[seed] = 0;
    for (std::size_t i = 0; i < component_.size(); ++i)
      for (int h = 3 * component_[i]; h < 3 * component_[i] + 3; ++h) {
        const int g = mesh_.mate[h];
        if (g < 0 || turned_[g / 3] >= 0) continue;
        turned_[g / 3] = turned_[h / 3] ^ static_cast<signed char>(mesh_.same_direction(h, g));
        component_.push_back(g / 3);
      }
  }

  void spread_anew(int seed) {
    for (const int f : component_) turned_[f] = -1;
    spread(seed);
    straighten();
  }

  std::int64_t conflicts() const {
    std::int64_t count = 0;
    for (const int f : component_)
      for (int h = 3 * f; h < 3 * f + 3; ++h) count += conflict(h) && h < mesh_.mate[h];
    return count;
  }

  // Turns single faces while that leaves fewer conflicts: it straightens the cut.
  void straighten() {
    std::vector<int> pending = component_;
    while (!pending.empty()) {
      const int f = pending.back();
      pending.pop_back();
      int glued = 0, in_conflict = 0;
      for (int h = 3 * f; h < 3 * f + 3; ++h) glued += mesh_.mate[h] >= 0, in_conflict += conflict(h);
      if (2 * in_conflict <= glued) continue;
      turned_[f] ^= 1;
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (mesh_.mate[h] >= 0) pending.push_back(mesh_.mate[h] / 3);
    }
  }

  // A one-sided component: the edges at which the orientations that meet differ are cut. Around an interior vertex their number is even, so
  // that the cut has no loose ends. Where they lie depends on where the orientation starts; a few starts are tried.
  void cut_open() {
    std::vector<int> faces = component_;
    std::sort(faces.begin(), faces.end());
    constexpr std::size_t tries = 8;
    std::int64_t fewest = -1;
    int best = faces[0];
    for (std::size_t i = 0; i < tries; ++i) {
      const int seed = faces[faces.size() * i / tries];
      spread_anew(seed);
      const std::int64_t count = conflicts();
      if (fewest < 0 || count < fewest) fewest = count, best = seed;
    }
    spread_anew(best);
    std::vector<int> edges;
    for (const int f : component_)
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (conflict(h) && h < mesh_.mate[h]) edges.push_back(h);
    for (const int h : edges) mesh_.cut(h);
    report_.one_sided_cuts += static_cast<std::int64_t>(edges.size());
  }

  void turn_majority() {
    std::size_t turned = 0;
    for (const int f : component_) turned += turned_[f];
    const int first = *std::min_element(component_.begin(), component_.end());
    const std::size_t size = component_.size();
    if (2 * turned > size || (2 * turned == size && turned_[first]))
      for (const int f : component_) turned_[f] ^= 1;
  }

  void apply() {
    const auto renamed = [&](int h) { return h >= 0 && turned_[h / 3] ? 3 * (h / 3) + 2 - h % 3 : h; };
    std::vector<int> mate(mesh_.mate.size());
    for (int h = 0; h < mesh_.half_edge_count(); ++h) mate[renamed(h)] = renamed(mesh_.mate[h]);
    mesh_.mate = std::move(mate);
    for (std::size_t f = 0; f < mesh_.faces.size(); ++f)
      if (turned_[f]) std::swap(mesh_.faces[f][1], mesh_.faces[f][2]), ++report_.reoriented_faces;
  }

  RepairMesh& mesh_;
  RepairReport& report_;
  std::vector<signed char> turned_;  // -1: not yet known
  std::vector<int> component_;
};

// One vertex a fan; the first fan of a point keeps the first vertex of that point.
void name_fans(RepairMesh& mesh) {
  const int half_edges = mesh.half_edge_count();
  const int point_count = static_cast<int>(mesh.points.size());
  std::vector<int> vertex(half_edges, -1);  // at the corner that a half-edge leaves
  std::vector<int> origin(point_count);
  for (int p = 0; p < point_count; ++p) origin[p] = p;
  std::vector<char> named(point_count, 0);
  for (int h = 0; h < half_edges; ++h) {
    if (vertex[h] >= 0) continue;
    const int point = mesh.origin[mesh.from(h)];
    int name = point;
    if (named[point]) {
      name = static_cast<int>(origin.size());
      origin.push_back(point);
    }
    named[point] = 1;
    int c = h;
    while (c >= 0 && vertex[c] < 0) vertex[c] = name, c = mesh.mate[TriangleSurface::previous(c)];
    for (c = mesh.mate[h]; c >= 0 && vertex[TriangleSurface::next(c)] < 0; c = mesh.mate[TriangleSurface::next(c)])
      vertex[TriangleSurface::next(c)] = name;
  }
  for (int h = 0; h < half_edges; ++h) mesh.faces[h / 3][h % 3] = vertex[h];
  mesh.origin = std::move(origin);
}

EdgeGroups edges_of(const RepairMesh& mesh) {
  return group_edges(
      static_cast<int>(mesh.origin.size()), mesh.half_edge_count(), [&](int h) { return mesh.from(h); }, [&](int h) { return mesh.to(h); });
}

}  // namespace

void orient(RepairMesh& mesh, RepairReport& report) { Orientation(mesh, report).run(); }

void separate_fans(RepairMesh& mesh) {
  name_fans(mesh);
  // Pairs made at a crowded edge can leave several edges with the same two vertices.
  const EdgeGroups edges = edges_of(mesh);
  bool shared = false;
  for (int e = 0; e < edges.count(); ++e) {
    const int* h = edges.of(e);
    if (edges.size(e) == 1 || (edges.size(e) == 2 && mesh.mate[h[0]] == h[1])) continue;
    shared = true;
    for (int i = 0; i < edges.size(e); ++i) mesh.cut(h[i]);
  }
  if (!shared) return;
  // Cut, each fan has at most two of these half-edges, its two ends, and they run in opposite directions: they are one edge.
  name_fans(mesh);
  const EdgeGroups separated = edges_of(mesh);
  for (int e = 0; e < separated.count(); ++e)
    if (separated.size(e) == 2 && !mesh.same_direction(separated.of(e)[0], separated.of(e)[1])) mesh.glue(separated.of(e)[0], separated.of(e)[1]);
}

}  // namespace hybrid_mesh
