// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/operation_template.h"

#include <map>

#include "layout/regions/region_pattern.h"

namespace hybrid_mesh {
namespace {

// The removed quads' sides that are not between two of them, by half-edge.
std::map<HalfEdge, SideLink> rim_of(const HybridMesh& mesh, const std::vector<int>& removed) {
  std::map<HalfEdge, SideLink> sides;
  for (const int node : removed)
    for (int i = 0; i < 4; ++i) sides[mesh.half_edge(node, i)] = {node, i};
  std::map<HalfEdge, SideLink> rim;
  for (const auto& [half, side] : sides)
    if (!sides.count(half ^ 1)) rim[half] = side;
  return rim;
}

}  // namespace

std::optional<OperationTemplate> template_of(const HybridMesh& mesh, int operation) {
  const Repatch& repatch = mesh.operation(operation).repatch;
  const std::map<HalfEdge, SideLink> rim = rim_of(mesh, repatch.removed);
  // From each corner to the next along the new quads' boundary.
  std::map<int, std::pair<int, HalfEdge>> next;
  int first = -1;
  for (std::size_t q = 0; q < repatch.quads.size(); ++q)
    for (int i = 0; i < 4; ++i) {
      const Repatch::Side& side = repatch.sides[q][i];
      if (side.kind == Repatch::Side::Kind::Patch) continue;
      const int a = repatch.quads[q][i], b = repatch.quads[q][(i + 1) % 4];
      if (side.kind != Repatch::Side::Kind::Outer || a < 0 || b < 0 || !rim.count(side.half) || !next.insert({a, {b, side.half}}).second)
        return std::nullopt;
      if (first < 0) first = a;
    }
  if (first < 0 || next.size() != rim.size()) return std::nullopt;
  OperationTemplate out;
  out.start = rim.at(next.at(first).second);
  std::map<int, int> number;  // of a corner, by its entry of the boundary
  for (int c = first; number.insert({c, out.corners}).second; ++out.corners) {
    const auto at = next.find(c);
    if (at == next.end()) return std::nullopt;
    c = at->second.first;
  }
  if (number.size() != next.size()) return std::nullopt;
  for (const auto& quad : repatch.quads) {
    std::array<int, 4> named;
    for (int i = 0; i < 4; ++i) {
      if (quad[i] >= 0 && !number.count(quad[i])) return std::nullopt;
      named[i] = quad[i] >= 0 ? number.at(quad[i]) : out.corners - 1 - quad[i];
    }
    out.quads.push_back(named);
  }
  if (!find_filling_defect(out.quads, out.corners).empty()) return std::nullopt;
  return out;
}

}  // namespace hybrid_mesh
