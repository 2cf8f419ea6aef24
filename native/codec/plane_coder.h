// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/bit_models.h"
#include "wavelets/wavelet_step.h"

namespace hybrid_mesh {

// Of a coefficient: a detail's component across the surface (0) or along it (1, 2).
inline constexpr int components = 3;

// Which coefficients there are on a level and what is around each: the same for writers and readers.
struct CoefficientLayout {
  struct Item {
    int vertex = -1;  // of the level's mesh
    int kind = 0;     // 0: side, 1: centre, 2: other
    // Components are those of the coordinates, not of a frame: an operation's vertices are far from what they are predicted by, which may be a point.
    bool unturned = false;
  };
  struct Neighbour {
    std::uint32_t item : 31;
    std::uint32_t twice : 1;  // whether it counts twice
  };
  std::vector<Item> items;
  // Of each item: others whose size tells about its own, as its own does about theirs.
  std::vector<std::size_t> first_neighbour{0};
  std::vector<Neighbour> neighbours;
  std::vector<std::uint32_t> weight;  // #items: what the neighbours count together
  // Vertices of the level's mesh without an item, and the items one edge away.
  std::vector<int> bare;
  std::vector<std::size_t> first_beside{0};
  std::vector<int> beside;
  // Vertices of the coarser mesh between which it is; -1: fewer than four.
  std::vector<std::array<int, 4>> parents;
};

// With `remainder`, every vertex has an item more, after the details.
CoefficientLayout coefficient_layout(const HybridMesh& hierarchy, const WaveletStep& step, bool remainder);

// Coefficients of one level as far as they are known, in units of the steps of a bit-plane. Planes are numbered from coarse to fine; the steps of
// plane p are 2^-p.
struct Coefficients {
  int first_plane = 0, last_plane = -1;  // outside of which all bits are zero, or not coded
  int plane = -1;                        // the last one that was begun
  std::vector<std::uint32_t> size;       // components an item; in steps of `plane`
  std::vector<char> negative;
  std::size_t coded = 0;  // of the coefficients, in order: how many have their bit of `plane`

  // Within its interval, where the mean of what is likely there is.
  double value(std::size_t i) const;
  bool is_zero(std::size_t item) const { return (size[components * item] | size[components * item + 1] | size[components * item + 2]) == 0; }
};

// Goes through the bit-planes of one stream.
class PlaneCoder {
 public:
  explicit PlaneCoder(BitCoder& coder) : coder_(coder) {}
  // One bit of each coefficient of a level. `coarser`: those of the level before, null for the first. `all`: writers' coefficients, with all planes.
  void code(const CoefficientLayout& layout, Coefficients& known, const CoefficientLayout* coarser_layout, const Coefficients* coarser,
            std::size_t coarser_vertices, int level, int plane, const Coefficients* all);

 private:
  static constexpr int bins = 12, kinds = 3, levels = 25;
  struct Significance {
    Mixer mixer;
    std::array<BitModel, bins> near, above;
    std::array<BitModel, bins * 3> joint;
    std::array<BitModel, bins * bins> both;
    std::array<BitModel, levels> level;
  };
  // Of an item's component across the surface, and of those along it.
  using Pair = std::array<std::uint64_t, 2>;
  struct Context {
    int near = 0, above = 0, mean = 0;  // bins
  };
  static Context context(const CoefficientLayout& layout, std::size_t item, std::size_t along, const Pair& around, const std::vector<Pair>& above);
  bool code_significance(Significance& models, const Context& context, int own, int level, bool bit);
  void code_item(const CoefficientLayout& layout, Coefficients& known, std::size_t item, int level, const Pair& around,
                 const std::vector<Pair>& above, const Coefficients* all);

  BitCoder& coder_;
  // By level, of each item: the neighbours' sizes so far, each as often as it counts. Few change in a plane, and these are added where they are
  // known.
  std::array<std::vector<Pair>, levels> around_;
  std::array<Significance, components * kinds> significance_;
  std::array<BitModel, components * 4> refinement_;
};

}  // namespace hybrid_mesh
