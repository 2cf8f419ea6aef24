// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Guskov, Khodakovsky, Schroeder, Sweldens, Hybrid meshes: multiresolution using regular and irregular refinement, 2002 (four points on a
// boundary and a chain of cubes).
#include "layout/drawn/boundary_tower.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "layout/drawn/layout_transfer.h"
#include "layout/drawn/quad_complex.h"
#include "layout/regions/region_layout.h"
#include "surface/boundary_loop.h"

namespace hybrid_mesh {
namespace {

constexpr double kCornerWindow = 0.05;  // of the loop's length: over which its turns are measured
constexpr double kLeastGap = 1e-3;      // of the loop's length: between two nodes

// What a surface is instead of a disk; empty if it is one.
std::string find_disk_defect(const TriangleSurface& surface) {
  const std::vector<std::array<int, 2>> components = components_of(surface).topology;
  if (components.size() != 1) return "has " + std::to_string(components.size()) + " components";
  const auto [euler, loops] = components.front();
  if (loops == 0) return "is closed: it has no boundary loop";
  if (loops > 1) return "has " + std::to_string(loops) + " boundary loops";
  const int genus = (1 - euler) / 2;
  return genus > 0 ? "has " + std::to_string(genus) + (genus == 1 ? " handle" : " handles") : "";
}

// Where the nodes lie along the loop, in its order.
std::vector<double> arcs_of(const BoundaryLoop& loop, const std::vector<Vec3>& nodes) {
  std::vector<double> arcs;
  if (nodes.empty()) {
    int sharpest = 0;
    double most = -1;
    for (int i = 0; i < loop.size(); ++i)
      if (const double turn = loop.turn(i, kCornerWindow * loop.length()); turn > most) most = turn, sharpest = i;
    for (int k = 0; k < 4; ++k) arcs.push_back(loop.arc(sharpest) + 0.25 * k * loop.length());
    return arcs;
  }
  for (const Vec3& p : nodes) arcs.push_back(loop.nearest(p));
  for (std::size_t i = 0; i < arcs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double gap = std::abs(arcs[i] - arcs[j]);
      if (std::min(gap, loop.length() - gap) < kLeastGap * loop.length())
        throw Error(ErrorCode::InvalidInput,
                    "boundary nodes " + std::to_string(j) + " and " + std::to_string(i) + " lie at one place of the boundary");
    }
  std::sort(arcs.begin(), arcs.end());
  return arcs;
}

}  // namespace

PatchedSurface grow_boundary_tower(const TriangleSurface& surface, const BoundaryTower& tower, const Progress& progress) {
  if (const std::string defect = find_disk_defect(surface); !defect.empty())
    throw Error(ErrorCode::InvalidInput, "a base on four nodes of a boundary takes a surface that is a disk, and this one " + defect);
  if (!tower.nodes.empty() && tower.nodes.size() != 4)
    throw Error(ErrorCode::InvalidInput, "a base has four nodes on a boundary, not " + std::to_string(tower.nodes.size()));
  const BoundaryLoop loop = boundary_loops(surface).front();
  LayoutOutline outline;
  outline.quads = {{0, 1, 2, 3}};
  for (const double arc : arcs_of(loop, tower.nodes)) outline.nodes.push_back(loop.at(arc));
  const TransferredLayout quad = transfer_layout(surface, outline, progress);
  if (!quad.failure.empty()) throw Error(ErrorCode::InvalidInput, "no quad has its corners at the boundary nodes: " + quad.failure);
  MappedSurface mapped{to_patched_surface(quad.layout), {}};
  mapped.corners.resize(mapped.surface.mesh.faces.size());
  const std::optional<PatchRegion> region = make_disk(mapped.surface, {0});
  if (!region) throw Error(ErrorCode::Internal, "the quad on the boundary nodes is no disk");
  const int cubes = tower.cubes > 0 ? tower.cubes : std::max(1, tower_height(surface_of(mapped.surface, *region)));
  apply_edit(mapped, tower_edit(mapped.surface, *region, cubes));
  return std::move(mapped.surface);
}

}  // namespace hybrid_mesh
