// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/face_sources.h"

#include <algorithm>

namespace hybrid_mesh {
namespace {

void trace_on(const FaceSources& on, std::vector<int>& face, std::vector<std::array<float, 9>>& weights) {
  for (std::size_t t = 0; t < face.size(); ++t) {
    std::array<double, 9> part;
    std::copy(weights[t].begin(), weights[t].end(), part.begin());
    weights[t] = on.traced(face[t], part);
    face[t] = on.face[face[t]];
  }
}

}  // namespace

std::array<float, 9> FaceSources::traced(int triangle, const std::array<double, 9>& part) const {
  const std::array<float, 9>& whole = weights[triangle];
  std::array<float, 9> out{};
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) {
      double w = 0;
      for (int k = 0; k < 3; ++k) w += part[3 * c + k] * whole[3 * k + i];
      out[3 * c + i] = static_cast<float>(w);
    }
  return out;
}

void FaceSources::trace(FaceSources& named) const { trace_on(*this, named.face, named.weights); }
void FaceSources::trace(PatchMap& map) const { trace_on(*this, map.source_face, map.source); }

}  // namespace hybrid_mesh
