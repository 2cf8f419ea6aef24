// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/planes/coefficient_scale.h"

#include <algorithm>
#include <cmath>

namespace hybrid_mesh {

namespace {

constexpr double tangential = 0.25;

}  // namespace

double coefficient_weight(int kind, int levels) {
  constexpr double weights[3][5] = {
      {1.0938, 0.9369, 1.5176, 2.8878, 5.7053}, {1.0938, 0.4443, 0.5962, 1.0853, 2.1210}, {1, 1.0938, 1.9756, 3.8630, 7.6837}};
  return std::ldexp(weights[kind][std::min(levels, 4)], std::max(levels - 4, 0));
}

double coefficient_scale(int kind, std::size_t component, int levels) { return coefficient_weight(kind, levels) * (component > 0 ? tangential : 1); }

int coefficient_kind(DetailKind kind) { return kind == DetailKind::Edge ? 0 : kind == DetailKind::Face ? 1 : 2; }

}  // namespace hybrid_mesh
