// SPDX-License-Identifier: GPL-3.0-or-later
// Private to decoder/ and codec/.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "decoder/bits/bit_models.h"
#include "decoder/planes/coefficient_layout.h"

namespace hybrid_mesh {

// Of a coefficient: a detail's component across the surface (0) or along it (1, 2).
inline constexpr int components = 3;

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
  // Throws StreamEnd for readers; `known` has what was read, then, and there is nothing more to read.
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
  using Pair = std::array<std::uint32_t, 2>;
  struct Context {
    std::uint32_t near = 0, above = 0, mean = 0;  // bins
  };
  static Context context(std::uint32_t around, std::uint32_t weight, std::uint32_t along, std::uint32_t above);
  void find_above(const CoefficientLayout& layout, const std::vector<Pair>& at_vertices);
  template <bool reading>
  BitCoder code_items(BitCoder coder, const CoefficientLayout& layout, Coefficients& known, int level, const Coefficients* all);
  template <bool reading>
  bool code_significance(BitCoder& coder, Significance& models, const Context& context, std::uint32_t own, int level, bool bit);

  BitCoder& coder_;
  // By level, of each item: the neighbours' sizes so far, each as often as it counts. Few change in a plane, and these are added where they are
  // known.
  std::array<std::vector<Pair>, levels> around_;
  // Of each item of the level that is being coded: the sizes above it.
  std::vector<std::array<std::uint16_t, 2>> above_;
  std::array<Significance, components * kinds> significance_;
  std::array<BitModel, components * 4> refinement_;
};

}  // namespace hybrid_mesh
