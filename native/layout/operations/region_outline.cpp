// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/region_outline.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "layout/regions/disk_drawing.h"
#include "surface/boundary_loop.h"

namespace hybrid_mesh {
namespace {

std::vector<int> corners_of(const RegionSurface& surface) {
  std::vector<int> corners;
  for (const std::vector<int>& side : surface.sides) corners.push_back(side.front());
  return corners;
}

std::vector<Vec3> points_at(const TriangleSurface& mesh, const std::vector<int>& corners) {
  std::vector<Vec3> points;
  for (const int v : corners) points.push_back(mesh.points[v]);
  return points;
}

// The boundary loop without corners, if there is one.
const BoundaryLoop* open_loop(const std::vector<BoundaryLoop>& loops, const std::vector<int>& corners) {
  for (const BoundaryLoop& loop : loops) {
    bool any = false;
    for (int i = 0; i < loop.size(); ++i) any |= std::find(corners.begin(), corners.end(), loop.vertex(i)) != corners.end();
    if (!any) return &loop;
  }
  return nullptr;
}

// Springs along the quads' sides pull the nodes that have no place yet.
void spread(const std::vector<std::array<int, 4>>& quads, std::vector<Vec3>& nodes, const std::vector<char>& placed) {
  std::vector<int> number(nodes.size(), -1);
  int free = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (!placed[n]) number[n] = free++;
  if (free == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(free, 3);
  for (const auto& quad : quads)
    for (int i = 0; i < 4; ++i)
      for (const int other : {quad[(i + 1) % 4], quad[(i + 3) % 4]}) {
        const int k = number[quad[i]];
        if (k < 0) continue;
        entries.emplace_back(k, k, 1.0);
        if (number[other] >= 0)
          entries.emplace_back(k, number[other], -1.0);
        else
          right.row(k) += nodes[other].transpose();
      }
  Eigen::SparseMatrix<double> matrix(free, free);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::MatrixXd at = solver.solve(right);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (number[n] >= 0) nodes[n] = at.row(number[n]).transpose();
}

}  // namespace

LayoutOutline outline_of(const DrawnEdit& drawn, const PatchRegion& region) {
  constexpr std::size_t parts = 4;
  LayoutOutline outline;
  outline.quads = drawn.edit.quads;
  outline.nodes.resize(region.corners.size() + drawn.edit.inner_nodes);
  outline.sides.resize(outline.quads.size());
  for (std::size_t q = 0; q < outline.quads.size(); ++q)
    for (int i = 0; i < 4; ++i) {
      const std::vector<int>& side = drawn.piece.sides[q][i];
      const auto at = [&](std::size_t k) { return drawn.piece.mesh.points[side[k]]; };
      outline.nodes[outline.quads[q][i]] = at(0);
      const std::size_t last = side.size() - 1, count = std::min(parts, last);
      // Each line once; the boundary's is known.
      if (outline.quads[q][i] > outline.quads[q][(i + 1) % 4]) continue;
      for (std::size_t k = 0; k <= count; ++k) outline.sides[q][i].push_back(at(k * last / count));
    }
  return outline;
}

LayoutOutline spread_outline(const RegionSurface& surface, const LayoutEdit& edit) {
  LayoutOutline outline;
  outline.quads = edit.quads;
  outline.nodes = points_at(surface.mesh, corners_of(surface));
  std::vector<char> placed(outline.nodes.size(), 1);
  outline.nodes.resize(outline.nodes.size() + edit.inner_nodes, Vec3::Zero());
  placed.resize(outline.nodes.size(), 0);
  spread(edit.quads, outline.nodes, placed);
  return outline;
}

PatchedSurface lay_out_region(const RegionSurface& surface, LayoutOutline outline, const Progress& progress) {
  const std::vector<Vec3> corners = points_at(surface.mesh, corners_of(surface));
  std::copy(corners.begin(), corners.end(), outline.nodes.begin());
  const TransferredLayout laid = transfer_layout(surface.mesh, outline, progress);
  return laid.failure.empty() ? to_patched_surface(laid.layout) : PatchedSurface();
}

RowsPlace place_rows(const RegionSurface& surface, const PatchRegion& region) {
  const TriangleSurface& mesh = surface.mesh;
  const std::vector<int> corner = corners_of(surface);
  const std::vector<Vec3> points = points_at(mesh, corner);
  const int n = region.rims[1], m = static_cast<int>(points.size()) - n;
  double side = 0;
  for (int k = 0; k < n; ++k) side += (points[region.next(k)] - points[k]).norm() / n;
  RowsPlace out;
  // Corners of the first rim beside those of the second that are joined to them.
  double least = std::numeric_limits<double>::infinity();
  for (int shift = 0; shift < m; ++shift) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const int j = shift - static_cast<int>(std::lround(static_cast<double>(i) * m / n));
      sum += (points[n + (j % m + m) % m] - points[i]).squaredNorm();
    }
    if (sum < least) least = sum, out.shift = shift;
  }
  // How far the boundaries are apart, on average over the first one's corners.
  std::vector<int> second(corner.begin() + n, corner.end());
  if (m == 0) {
    const std::vector<BoundaryLoop> loops = boundary_loops(mesh);
    const BoundaryLoop* loop = open_loop(loops, corner);
    for (int i = 0; loop && i < loop->size(); ++i) second.push_back(loop->vertex(i));
  }
  const std::vector<double> distance = edge_distances(mesh, second);
  double mean = 0;
  for (int k = 0; k < n; ++k) mean += distance[corner[k]] / n;
  out.rows = std::max(1, static_cast<int>(std::lround(mean / std::max(side, 1e-300))));
  return out;
}

}  // namespace hybrid_mesh
