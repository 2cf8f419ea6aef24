// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/.
#pragma once

#include <array>
#include <vector>

#include "codec/gluing_coder.h"
#include "hierarchy/archive.h"

namespace hybrid_mesh {

// Of any hierarchy in a stream: what a reader makes memory for.
inline constexpr int most_stream_quads = 1 << 23;

// A hierarchy's connectivity: base, refinement and operations, grown on both sides by the same code. Base quads and those of operations are numbered
// anew, as the stream meets them.
class StructureCoder final : private Growth {
 public:
  // `given` is null for readers. Throws Error{Unsupported} for what a stream cannot hold.
  StructureCoder(BitCoder& coder, const HybridMesh* given);
  // Throws Error{CorruptStream} for readers, and StreamEnd.
  HybridMesh code();
  // Writers: what a vertex of the hierarchy that code() has returned is called in the given one.
  VertexId given_vertex(VertexId vertex) const;

 private:
  void check_balance(HybridMesh& mesh) const;
  HybridMesh code_base();
  void code_sharp_sides(HybridMesh& mesh);
  void code_shape();
  void code_turns(GluedQuads& glued);
  bool refined(const HybridMesh& mesh, int node) override;
  bool operation(const HybridMesh& mesh, int level, Repatch& repatch) override;
  void code_removed(const HybridMesh& mesh, Repatch& repatch, std::int64_t first);
  QuadSides given_sides(const Repatch& repatch) const;
  void note_root(int given, int turn);
  void match(const HybridMesh& mesh);
  BitModel& refined_model(const HybridMesh& mesh, int node);

  BitCoder& coder_;
  const HybridMesh* given_;
  GluingCoder base_, inserted_;
  NumberModel number_, kind_, removed_;
  BitModel sharp_, more_, inactive_;
  std::array<BitModel, 50> refined_;
  int depth_ = 0;
  bool uniform_ = true, changed_ = false;
  FaceClosure closure_ = FaceClosure::Quads;
  std::size_t next_operation_ = 0;
  std::vector<int> operations_;  // writers: of the given hierarchy, by level
  // Writers: names in the given hierarchy by those in the new one, and back.
  std::vector<int> given_node_, turn_, new_node_;
  std::vector<HalfEdge> given_half_, new_half_;
  std::vector<int> given_free_;
  int matched_ = 0;
  HalfEdge halves_ = 0;
};

}  // namespace hybrid_mesh
