// SPDX-License-Identifier: GPL-3.0-or-later
// Private to decoder/ and codec/.
#pragma once

#include <array>
#include <vector>

#include "decoder/forest/growth.h"
#include "decoder/structure/gluing_coder.h"

namespace hybrid_mesh {

// Of any hierarchy in a stream: what a reader makes memory for.
inline constexpr int most_stream_quads = 1 << 23;

// A hierarchy's connectivity: base, refinement and operations, grown on both sides by the same code. Base quads and those of operations are numbered
// anew, as the stream meets them.
class StructureCoder final : private Growth {
 public:
  // `given` is null for readers. Throws Error{Unsupported} for what a stream cannot hold.
  // `most_quads`: of which a reader makes the hierarchy, at most most_stream_quads; one of more is no stream to it.
  StructureCoder(BitCoder& coder, const QuadForest* given, int most_quads = most_stream_quads);
  // All that there are bits of: the base and, unless all quads are refined down to the depth and there are no operations, what it has become. Throws
  // Error{CorruptStream} for readers, and StreamEnd.
  QuadForest code();
  // Whether that is the base alone, although there are more levels: all quads are refined down to the depth, and no more is done.
  bool is_plain() const { return uniform_ && !changed_; }
  // Of the hierarchy, of which code() has returned what it has returned.
  int depth(const QuadForest& forest) const { return is_plain() ? depth_ : forest.depth(); }
  // Writers: refines what code() has returned to the depth, where it is plain, so that given_vertex() knows all names.
  QuadForest refined_to_depth(QuadForest forest);
  // Writers: what a vertex of the hierarchy that code() has returned is called in the given one.
  VertexId given_vertex(VertexId vertex) const;

 private:
  template <class Body>
  QuadForest checked(const Body& body);
  QuadForest grown(QuadForest base);
  void check_balance(QuadForest& mesh) const;
  QuadForest code_base();
  void code_sharp_sides(QuadForest& mesh);
  void code_shape();
  void code_turns(GluedQuads& glued);
  bool refined(const QuadForest& mesh, int node) override;
  bool operation(const QuadForest& mesh, int level, Repatch& repatch) override;
  void code_removed(const QuadForest& mesh, Repatch& repatch, std::int64_t first);
  QuadSides given_sides(const Repatch& repatch) const;
  void note_root(int given, int turn);
  void match(const QuadForest& mesh);
  BitModel& refined_model(const QuadForest& mesh, int node);

  BitCoder& coder_;
  const QuadForest* given_;
  int most_quads_;
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
