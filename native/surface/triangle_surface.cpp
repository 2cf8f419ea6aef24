// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangle_surface.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

struct EdgeEnd {
  int other;      // the edge's end of larger index
  int half_edge;  // in input order within one value of `other`
};

[[noreturn]] void refuse(const char* what, int a, int b) {
  throw Error(ErrorCode::InvalidInput, "the edge " + std::to_string(a) + "-" + std::to_string(b) + " " + what);
}

}  // namespace

void connect_half_edges(TriangleSurface& surface) {
  const int point_count = static_cast<int>(surface.points.size());
  if (surface.faces.size() > static_cast<std::size_t>(std::numeric_limits<int>::max() / 3))
    throw Error(ErrorCode::Unsupported, "too many faces: " + std::to_string(surface.faces.size()));
  const int half_edges = 3 * static_cast<int>(surface.faces.size());
  // Half-edges are gathered by the smaller end of their edge (a counting sort), then matched within that end's few edges.
  std::vector<int> first(static_cast<std::size_t>(point_count) + 1, 0);
  for (const auto& face : surface.faces)
    for (int i = 0; i < 3; ++i) {
      const int a = face[i], b = face[(i + 1) % 3];
      if (a < 0 || a >= point_count) throw Error(ErrorCode::InvalidInput, "a face has the point " + std::to_string(a) + ", which does not exist");
      if (a == b) refuse("has equal ends", a, b);
      if (b >= 0 && b < point_count) ++first[std::min(a, b) + 1];
    }
  for (int v = 0; v < point_count; ++v) first[v + 1] += first[v];
  std::vector<EdgeEnd> ends(half_edges);
  std::vector<int> fill(first.begin(), first.end() - 1);
  for (int h = 0; h < half_edges; ++h) {
    const int a = surface.from(h), b = surface.to(h);
    ends[fill[std::min(a, b)]++] = {std::max(a, b), h};
  }
  surface.opposite.assign(half_edges, -1);
  for (int v = 0; v < point_count; ++v) {
    const auto begin = ends.begin() + first[v], end = ends.begin() + first[v + 1];
    std::sort(begin, end, [](const EdgeEnd& a, const EdgeEnd& b) { return a.other != b.other ? a.other < b.other : a.half_edge < b.half_edge; });
    for (auto e = begin; e != end;) {
      auto last = e + 1;
      while (last != end && last->other == e->other) ++last;
      if (last - e > 2) refuse("has more than two faces", v, e->other);
      if (last - e == 2) {
        const int h = e->half_edge, g = e[1].half_edge;
        if (surface.from(h) == surface.from(g)) refuse("has two faces that run along it in the same direction", v, e->other);
        surface.opposite[h] = g;
        surface.opposite[g] = h;
      }
      e = last;
    }
  }
}

}  // namespace hybrid_mesh
