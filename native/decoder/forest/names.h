// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hybrid_mesh {

// What becomes of a mesh of leaves that has hanging nodes. A mesh without any is never changed.
enum class FaceClosure {
  Quads,       // every leaf is split once at its centre and at its edges' midpoints: pure quads, no cracks
  Transition,  // leaves stay whole, hanging nodes become corners: n-gons, no cracks
  Triangles    // the n-gons of Transition with more than four corners are triangulated
};

// N^j is level j after its irregular operations, M^j before them.
enum class LevelKind { N, M };

// A vertex is named by what made it, so that every quad that asks for it gets the same name: a corner of the base or an inner vertex of
// an operation (Free), the midpoint of an edge, or the centre of a node.
struct VertexId {
  enum class Kind { Free = 0, Edge = 1, Node = 2 };
  std::int32_t code = -1;
  VertexId() = default;
  VertexId(Kind kind, int index) : code(static_cast<std::int32_t>((static_cast<std::uint32_t>(index) << 2) | static_cast<std::uint32_t>(kind))) {}
  Kind kind() const { return static_cast<Kind>(code & 3); }
  int index() const { return code >> 2; }
  bool valid() const { return code >= 0; }
  friend bool operator==(VertexId a, VertexId b) { return a.code == b.code; }
  friend bool operator!=(VertexId a, VertexId b) { return a.code != b.code; }
  friend bool operator<(VertexId a, VertexId b) { return a.code < b.code; }
};

// A side of a node; side i runs from corner i to corner i + 1, counter-clockwise. node = -1: none (boundary).
struct SideLink {
  int node = -1;
  int side = 0;
  bool valid() const { return node >= 0; }
  friend bool operator==(const SideLink&, const SideLink&) = default;
};

// A directed edge of some level: 2 * edge + (1 if it runs backwards). The node that has it as a side lies to its left; h ^ 1 is its twin.
using HalfEdge = std::int32_t;

// An irregular operation: quads of one level are removed and new root quads put in their place.
struct Repatch {
  // One side of a new quad.
  struct Side {
    enum class Kind {
      Patch,  // glued to side `side` of new quad `quad`
      Outer,  // takes the half-edge `half`, which a removed quad holds or which is free (an open boundary)
      Open    // a boundary edge of the new mesh
    };
    Kind kind = Kind::Open;
    int quad = -1, side = 0;
    HalfEdge half = -1;
  };
  int level = 0;
  std::vector<int> removed;                // active nodes of `level`, not roots; may be empty
  int new_vertices = 0;                    // inner vertices that the operation makes
  std::vector<std::array<int, 4>> quads;   // corners, counter-clockwise: >= 0 entry of `boundary`, < 0 new vertex -1 - c
  std::vector<VertexId> boundary;          // existing vertices that the quads use
  std::vector<std::array<Side, 4>> sides;  // #quads; empty: derived from corner pairs
  std::string kind = "repatch";            // for reports: "add_cubes", "connect", "open_boundary", ...
};

}  // namespace hybrid_mesh
