// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/inserted_points.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace hybrid_mesh {
namespace {

using Weights = std::array<float, 3>;

class Merging {
 public:
  Merging(ChartMesh& charts, FaceSources& sources) : c_(charts), sources_(sources) {}

  // Into the nearest neighbour that will do. Returns false if there is none.
  bool merge(int v) {
    int best = -1;
    double shortest = std::numeric_limits<double>::infinity();
    int h = c_.mesh.out[v];
    do {
      const double length = (c_.points[c_.mesh.to(h)] - c_.points[v]).squaredNorm();
      if (length < shortest && c_.can_collapse(h) && lies_where_v_does(h) && c_.collapse_keeps_map(h, kLeastDeterminant, kLeastShape) &&
          c_.collapse_keeps_area(h))
        shortest = length, best = h;
      if (c_.mesh.is_boundary(v)) break;  // along the boundary alone
      h = c_.mesh.ccw(h);
    } while (h >= 0 && h != c_.mesh.out[v]);
    if (best < 0) return false;
    const std::vector<std::pair<int, Weights>> target = target_on_faces(best);
    std::vector<int> corners;  // of faces, where v is
    c_.for_star(v, [&](int g, const Complex&, const Complex&) { corners.push_back(g); });
    c_.collapse(best);
    for (const int g : corners) {
      if (!c_.mesh.alive[g / 3]) continue;
      const auto on = std::find_if(target.begin(), target.end(), [&](const auto& t) { return t.first == sources_.face[g / 3]; });
      std::copy(on->second.begin(), on->second.end(), sources_.weights[g / 3].begin() + 3 * (g % 3));
    }
    return true;
  }

 private:
  static constexpr double kLeastDeterminant = 0.01, kLeastShape = 1e-6;  // see ChartMesh::collapse_keeps_map()

  // Where to(h) lies on the faces that those beside h lie on.
  std::vector<std::pair<int, Weights>> target_on_faces(int h) const {
    std::vector<std::pair<int, Weights>> out;
    const auto add = [&](int g) {  // leaves to(h)
      const std::array<float, 9>& w = sources_.weights[g / 3];
      const int i = 3 * (g % 3);
      out.push_back({sources_.face[g / 3], {w[i], w[i + 1], w[i + 2]}});
    };
    add(EditMesh::next(h));
    if (c_.mesh.opposite[h] >= 0) add(c_.mesh.opposite[h]);
    return out;
  }

  // Do all faces at from(h) lie on faces on which to(h) is as well?
  bool lies_where_v_does(int h) const {
    const int one = sources_.face[h / 3], o = c_.mesh.opposite[h], other = o >= 0 ? sources_.face[o / 3] : one;
    bool all = true;
    c_.for_star(c_.mesh.from(h), [&](int g, const Complex&, const Complex&) {
      const int face = sources_.face[g / 3];
      all &= face == one || face == other;
    });
    return all;
  }

  ChartMesh& c_;
  FaceSources& sources_;
};

}  // namespace

void merge_inserted(ChartMesh& charts, const std::vector<char>& inserted, FaceSources& sources) {
  Merging merging(charts, sources);
  std::vector<int> left;
  for (int v = 0; v < static_cast<int>(inserted.size()); ++v)
    if (inserted[v] && charts.mesh.vertex_alive(v)) left.push_back(v);
  // What is in the way of one may have gone after others.
  constexpr int passes = 6;
  for (int pass = 0; pass < passes; ++pass)
    if (std::erase_if(left, [&](int v) { return merging.merge(v); }) == 0) return;
}

}  // namespace hybrid_mesh
