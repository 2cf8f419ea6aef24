// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/patched_surface.h"

#include <algorithm>

#include "base/error.h"

namespace hybrid_mesh {

PointSource middle_of(const PointSource& a, const PointSource& b) {
  PointSource m;
  int n = 0;
  for (const PointSource* p : {&a, &b})
    for (int i = 0; i < 3; ++i) {
      if (p->vertices[i] < 0) continue;
      int k = 0;
      while (k < n && m.vertices[k] != p->vertices[i]) ++k;
      if (k == 3) throw Error(ErrorCode::Internal, "a surface point with more than three corners");
      m.vertices[k] = p->vertices[i];
      m.weights[k] += 0.5 * p->weights[i];
      n = std::max(n, k + 1);
    }
  return m;
}

}  // namespace hybrid_mesh
