// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/patched_surface.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"

namespace hybrid_mesh {

PointSource combine(const std::array<const PointSource*, 3>& points, const std::array<double, 3>& weights) {
  PointSource sum;
  int n = 0;
  for (int p = 0; p < 3; ++p) {
    if (!points[p] || weights[p] == 0) continue;
    for (int i = 0; i < 3; ++i) {
      if (points[p]->vertices[i] < 0) continue;
      int k = 0;
      while (k < n && sum.vertices[k] != points[p]->vertices[i]) ++k;
      if (k == 3) throw Error(ErrorCode::Internal, "a surface point with more than three corners");
      sum.vertices[k] = points[p]->vertices[i];
      sum.weights[k] += weights[p] * points[p]->weights[i];
      n = std::max(n, k + 1);
    }
  }
  return sum;
}

PointSource middle_of(const PointSource& a, const PointSource& b) { return combine({&a, &b, nullptr}, {0.5, 0.5, 0}); }

void split_inner_edge(TriangleSurface& mesh, std::vector<PointSource>& source, int h) {
  const int a = mesh.from(h), b = mesh.to(h), m = static_cast<int>(mesh.points.size());
  mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
  source.push_back(middle_of(source[a], source[b]));
  for (const int g : {h, mesh.opposite[h]}) {
    const int f = g / 3, i = g % 3;
    std::array<int, 3> second = mesh.faces[f];
    mesh.faces[f][(i + 1) % 3] = m;
    second[i] = m;
    mesh.faces.push_back(second);
    mesh.source_face.push_back(mesh.source_face[f]);
  }
}

PatchedPart part_of(const PatchedSurface& surface, const std::vector<int>& patches) {
  PatchedPart part;
  std::vector<int> local_patch(surface.patch_count(), -1);
  for (std::size_t i = 0; i < patches.size(); ++i) local_patch[patches[i]] = static_cast<int>(i);
  const TriangleSurface& whole = surface.mesh;
  std::vector<int> local_face(whole.faces.size(), -1);
  for (int f = 0; f < static_cast<int>(whole.faces.size()); ++f)
    if (local_patch[surface.patch[f]] >= 0) {
      local_face[f] = static_cast<int>(part.face.size());
      part.face.push_back(f);
    }
  const int faces = static_cast<int>(part.face.size());
  TriangleSurface& mesh = part.surface.mesh;
  mesh.sizes = whole.sizes;
  mesh.opposite.resize(3 * faces);
  for (int f = 0; f < faces; ++f)
    for (int i = 0; i < 3; ++i) {
      const int o = whole.opposite[3 * part.face[f] + i];
      mesh.opposite[3 * f + i] = o >= 0 && local_face[o / 3] >= 0 ? 3 * local_face[o / 3] + o % 3 : -1;
    }
  // A point a fan of faces: corners are walked around, clockwise first to where the fan begins.
  std::vector<int> point_of_corner(3 * faces, -1);
  for (int h = 0; h < 3 * faces; ++h) {
    if (point_of_corner[h] >= 0) continue;
    int first = h;
    for (int o = mesh.opposite[first]; o >= 0; o = mesh.opposite[first]) {
      first = TriangleSurface::next(o);
      if (first == h) break;
    }
    const int point = static_cast<int>(part.point.size());
    part.point.push_back(whole.from(3 * part.face[h / 3] + h % 3));
    int g = first;
    do {
      point_of_corner[g] = point;
      g = mesh.opposite[TriangleSurface::previous(g)];
    } while (g >= 0 && g != first);
  }
  mesh.faces.resize(faces);
  for (int f = 0; f < faces; ++f) {
    mesh.faces[f] = {point_of_corner[3 * f], point_of_corner[3 * f + 1], point_of_corner[3 * f + 2]};
    mesh.source_face.push_back(whole.source_face[part.face[f]]);
    part.surface.patch.push_back(local_patch[surface.patch[part.face[f]]]);
  }
  for (const int v : part.point) {
    mesh.points.push_back(whole.points[v]);
    part.surface.source.push_back(surface.source[v]);
  }

  // Sides: the half-edges along them are found by the whole's points, within the patch.
  std::vector<std::vector<int>> faces_of(patches.size());
  for (int f = 0; f < faces; ++f) faces_of[part.surface.patch[f]].push_back(f);
  std::vector<int> node_at(part.point.size(), -1);
  part.surface.nodes.resize(patches.size());
  part.surface.neighbours.resize(patches.size());
  part.surface.sides.resize(patches.size());
  for (std::size_t q = 0; q < patches.size(); ++q) {
    std::vector<std::pair<std::pair<int, int>, int>> rim;  // the whole's points, half-edge
    for (const int f : faces_of[q])
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int o = mesh.opposite[h];
        if (o < 0 || part.surface.patch[o / 3] != static_cast<int>(q)) rim.push_back({{part.point[mesh.from(h)], part.point[mesh.to(h)]}, h});
      }
    std::sort(rim.begin(), rim.end());
    for (int i = 0; i < 4; ++i) {
      const std::vector<int>& side = surface.sides[patches[q]][i];
      std::vector<int>& local = part.surface.sides[q][i];
      for (std::size_t k = 1; k < side.size(); ++k) {
        const auto at = std::lower_bound(rim.begin(), rim.end(), std::pair(std::pair(side[k - 1], side[k]), -1));
        if (at == rim.end() || at->first != std::pair(side[k - 1], side[k]))
          throw Error(ErrorCode::Internal, "a patch's side is not made of the mesh's edges");
        if (k == 1) local.push_back(mesh.from(at->second));
        local.push_back(mesh.to(at->second));
      }
      int& node = node_at[local.front()];
      if (node < 0) {
        node = static_cast<int>(part.node.size());
        part.node.push_back(surface.nodes[patches[q]][i]);
      }
      part.surface.nodes[q][i] = node;
      const PatchSide other = surface.neighbours[patches[q]][i];
      if (other.patch >= 0 && local_patch[other.patch] >= 0) part.surface.neighbours[q][i] = {local_patch[other.patch], other.side};
    }
  }
  part.surface.node_count = static_cast<int>(part.node.size());
  return part;
}

}  // namespace hybrid_mesh
