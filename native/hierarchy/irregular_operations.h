// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Active quads of one level that form a disk whose boundary meets no vertex twice.
struct DiskRegion {
  int level = 0;
  std::vector<int> nodes;              // in the order given
  std::vector<HalfEdge> boundary;      // counter-clockwise
  std::vector<SideLink> sides;         // the same, as sides of the nodes
  std::vector<VertexId> corners;       // where each boundary half-edge starts
  std::vector<VertexId> inner;         // the other vertices
  std::vector<int> outside;            // per corner: quads of the region's level around it that are not of the region
  std::vector<char> on_mesh_boundary;  // per corner
  std::string reason;                  // empty, or in words why the nodes are no such region
};

// The disk made of some nodes, its boundary beginning with the half-edge `start` (-1: the first boundary side of the first node that has one).
DiskRegion find_disk_region(const HybridMesh& mesh, const std::vector<int>& nodes, HalfEdge start = -1);

// Where a new vertex of an operation belongs, whatever the positions of the others: at a weighted mean of vertices, raised along the normal of the
// removed quads.
struct VertexPlace {
  std::vector<std::pair<VertexId, double>> mean;  // weights, 1 together
  double rise = 0;                                // in mean side lengths of the removed quads
};

// What a builder makes: an operation, or in words why there is none. HybridMesh::apply looks at the rest of the mesh, too, and may still refuse it.
struct OperationDraft {
  Repatch repatch;
  std::string reason;
  std::vector<VertexPlace> places{};  // #new vertices; empty: every one belongs at the mean of its neighbours
};

// `count` rings of quads grow on the region's boundary, and a copy of the region closes them: a cube for one quad and one ring, else a tower. A ring
// is as high as the region's sides are long.
OperationDraft add_cubes(const HybridMesh& mesh, const std::vector<int>& nodes, int count);

// Two disks are removed and their boundaries joined by a tube. The first boundary side of `region_a` faces that of `region_b` with the number `turn`
// (any integer; modulo their number). Between boundaries of as many sides the tube is one ring of quads, or two where one would join vertices twice;
// else the rings narrow, with vertices of three to six quads as far as the mesh around has not more.
OperationDraft connect(const HybridMesh& mesh, const std::vector<int>& region_a, const std::vector<int>& region_b, int turn);

// The quads are removed and nothing takes their place.
OperationDraft open_boundary(const HybridMesh& mesh, const std::vector<int>& nodes);

// New quads for a disk. Their corners, counter-clockwise, are 0 .. n - 1 for the region's n corners in the order of find_disk_region(mesh, nodes,
// start), and n .. for new vertices (as fill_disk names them).
OperationDraft free_layout(const HybridMesh& mesh, const std::vector<int>& nodes, const std::vector<std::array<int, 4>>& quads, HalfEdge start = -1);

}  // namespace hybrid_mesh
