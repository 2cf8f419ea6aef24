// SPDX-License-Identifier: GPL-3.0-or-later
// Private to decoder/ and codec/.
// Based on: Rossignac, Edgebreaker: connectivity compression for triangle meshes, 1999; for quads, which are glued one side at a time.
#pragma once

#include <array>
#include <vector>

#include "decoder/bits/bit_models.h"
#include "decoder/forest/quad_forest.h"

namespace hybrid_mesh {

using QuadSides = std::vector<std::array<Repatch::Side, 4>>;

// A half-edge that new quads may take, and its ends.
struct OuterHalf {
  HalfEdge half = -1;
  VertexId from, to;
};

struct GluedQuads {
  QuadSides sides;          // in the order of the stream
  std::vector<int> quad;    // writers: number of each in what was given
  std::vector<int> turn;    // writers: side s of it is side (s + turn) % 4 there
  std::vector<int> vertex;  // 4 a quad: of its corners, numbered as they first appear
  int vertices = 0;
};

// How quads are glued to each other and to what is around them, coded as they are met on a way over them. Order and first sides of quads are not
// kept. What it has learnt it keeps from one call to the next.
class GluingCoder {
 public:
  explicit GluingCoder(BitCoder& coder) : coder_(&coder) {}
  // `given` is null for readers. `outer`: of which outer sides are coded by the corners they are at; others by their number, which is below `halves`.
  GluedQuads code(const QuadSides* given, const std::vector<OuterHalf>& outer, int halves, int most_quads);

 private:
  friend class GluingWay;
  static constexpr int degrees = 8;
  struct Decision {
    Mixer mixer;
    std::array<BitModel, degrees> end;
    std::array<BitModel, degrees * degrees> both, ahead;
  };
  BitCoder* coder_;
  NumberModel count_, far_, escaped_;
  std::array<Decision, 6> decisions_;
  BitModel listed_, expected_;
};

}  // namespace hybrid_mesh
