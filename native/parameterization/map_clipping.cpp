// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/map_clipping.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

constexpr double kTie = 1e-9;  // of an area: what rounding must not decide
constexpr std::array<float, 9> kCorners{1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr double kSnap = 1e-13;  // of the map's unit square: what rounding moves a crossing by, and some

// A map's triangles while they are cut along lines u = c and v = c. Which side of a line a vertex is on is exact, since c is a number that a double
// holds; what is cut gets a vertex exactly on the line, the same for both triangles of an edge.
class MapCutting {
 public:
  // `by_triangles`: sources are triangles of the map, and not those of them.
  MapCutting(const PatchMap& map, bool by_triangles) : map_(map), by_triangles_(by_triangles) {}

  // Only triangles that overlap one of the squares are kept.
  void take(const std::vector<DyadicSquare>& squares) {
    DyadicSquare all = squares.front();
    double high_u = all.u + all.width, high_v = all.v + all.width;
    for (const DyadicSquare& s : squares) {
      all.u = std::min(all.u, s.u);
      all.v = std::min(all.v, s.v);
      high_u = std::max(high_u, s.u + s.width);
      high_v = std::max(high_v, s.v + s.width);
    }
    for (std::size_t t = 0; t < map_.triangles.size(); ++t) {
      const std::array<int, 3>& c = map_.triangles[t];
      const Vec2 &a = map_.uv[c[0]], &b = map_.uv[c[1]], &d = map_.uv[c[2]];
      const Vec2 low = a.cwiseMin(b).cwiseMin(d), high = a.cwiseMax(b).cwiseMax(d);
      if (high.x() <= all.u || low.x() >= high_u || high.y() <= all.v || low.y() >= high_v) continue;
      Triangle triangle{c, static_cast<int>(t), {}};
      for (int i = 0; i < 3; ++i) triangle.weights[i][i] = 1;
      triangles_.push_back(triangle);
    }
    uv_ = map_.uv;
    positions_ = map_.positions;
  }

  // `across`: the lines of the other axis, along which the pieces are cut as well. Where an edge runs through a crossing of lines, but for rounding,
  // its point is the crossing.
  void cut(int axis, double c, const std::set<double>& across) {
    across_ = &across;
    std::unordered_map<std::uint64_t, int> crossing;  // by the ends of an edge
    const auto side = [&](int v) { return uv_[v][axis] < c ? -1 : uv_[v][axis] > c ? 1 : 0; };
    std::vector<Triangle> out;
    out.reserve(triangles_.size());
    for (const Triangle& t : triangles_) {
      const std::array<int, 3> s{side(t.corners[0]), side(t.corners[1]), side(t.corners[2])};
      if (*std::min_element(s.begin(), s.end()) >= 0 || *std::max_element(s.begin(), s.end()) <= 0) {
        out.push_back(t);
        continue;
      }
      // The corner that is alone on its side, or, with one on the line, the one on the line.
      int alone = 0;
      for (int i = 0; i < 3; ++i)
        if (s[i] == 0 || (s[(i + 1) % 3] == s[(i + 2) % 3] && s[i] != s[(i + 1) % 3])) {
          alone = i;
          if (s[i] == 0) break;
        }
      const int next = (alone + 1) % 3, last = (alone + 2) % 3;
      if (s[alone] == 0) {
        const Corner x = cross(t, next, last, axis, c, crossing);
        out.push_back(made_of(t, corner(t, alone), corner(t, next), x));
        out.push_back(made_of(t, corner(t, alone), x, corner(t, last)));
        continue;
      }
      const Corner x = cross(t, alone, next, axis, c, crossing), y = cross(t, alone, last, axis, c, crossing);
      out.push_back(made_of(t, corner(t, alone), x, y));
      // The quadrilateral x, next, last, y along the diagonal that leaves the better triangles.
      const Corner n = corner(t, next), l = corner(t, last);
      if (std::min(area(x, n, l), area(x, l, y)) >= (1 - kTie) * std::min(area(x, n, y), area(n, l, y))) {
        out.push_back(made_of(t, x, n, l));
        out.push_back(made_of(t, x, l, y));
      } else {
        out.push_back(made_of(t, x, n, y));
        out.push_back(made_of(t, n, l, y));
      }
    }
    triangles_ = std::move(out);
  }

  PatchMap part(const DyadicSquare& square) const {
    PatchMap out;
    std::unordered_map<int, int> index;
    for (const Triangle& t : triangles_) {
      // Nothing crosses the square's sides any more: a triangle lies in it if all its corners do.
      bool inside = true;
      for (const int v : t.corners)
        inside &= uv_[v].x() >= square.u && uv_[v].x() <= square.u + square.width && uv_[v].y() >= square.v && uv_[v].y() <= square.v + square.width;
      if (!inside) continue;
      std::array<int, 3> corners;
      std::array<float, 9> source;
      const std::array<float, 9>& whole = by_triangles_ ? kCorners : map_.source[t.source];
      for (int i = 0; i < 3; ++i) {
        const auto [at, fresh] = index.insert({t.corners[i], static_cast<int>(out.uv.size())});
        corners[i] = at->second;
        if (fresh) {
          // Exact: the square's numbers are dyadic, and no digits are lost towards 0.
          out.uv.push_back((uv_[t.corners[i]] - Vec2(square.u, square.v)) / square.width);
          out.positions.push_back(positions_[t.corners[i]]);
          const auto v = static_cast<std::size_t>(t.corners[i]);
          out.inserted.push_back(v >= map_.uv.size() || map_.is_inserted(v));
        }
        for (int k = 0; k < 3; ++k)
          source[3 * i + k] = static_cast<float>(t.weights[i][0] * whole[k] + t.weights[i][1] * whole[3 + k] + t.weights[i][2] * whole[6 + k]);
      }
      out.triangles.push_back(corners);
      out.source_face.push_back(by_triangles_ ? t.source : map_.source_face[t.source]);
      out.source.push_back(source);
    }
    if (const char* defect = find_map_defect(out); *defect) throw NoMap(std::string("a part of a map: ") + defect);
    return out;
  }

 private:
  struct Triangle {
    std::array<int, 3> corners;
    int source;                                      // triangle of the map
    std::array<std::array<double, 3>, 3> weights{};  // of the corners, in that triangle
  };
  struct Corner {
    int vertex;
    std::array<double, 3> weights;
  };

  static Corner corner(const Triangle& t, int i) { return {t.corners[i], t.weights[i]}; }
  static Triangle made_of(const Triangle& t, const Corner& a, const Corner& b, const Corner& c) {
    return {{a.vertex, b.vertex, c.vertex}, t.source, {a.weights, b.weights, c.weights}};
  }
  double area(const Corner& a, const Corner& b, const Corner& c) const {
    const Vec2 x = uv_[b.vertex] - uv_[a.vertex], y = uv_[c.vertex] - uv_[a.vertex];
    return x.x() * y.y() - x.y() * y.x();
  }

  Corner cross(const Triangle& t, int i, int k, int axis, double c, std::unordered_map<std::uint64_t, int>& crossing) {
    // From the end of the lower number, whichever triangle asks.
    if (t.corners[i] > t.corners[k]) std::swap(i, k);
    const int a = t.corners[i], b = t.corners[k];
    const double along = (c - uv_[a][axis]) / (uv_[b][axis] - uv_[a][axis]);
    const std::uint64_t key = (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint64_t>(b);
    const auto [at, fresh] = crossing.insert({key, static_cast<int>(uv_.size())});
    if (fresh) {
      Vec2 uv = (1 - along) * uv_[a] + along * uv_[b];
      uv[axis] = c;
      const auto line = across_->lower_bound(uv[1 - axis] - kSnap);
      if (line != across_->end() && *line <= uv[1 - axis] + kSnap) uv[1 - axis] = *line;
      // On a side of the map it stays there.
      if (uv_[a][1 - axis] == uv_[b][1 - axis]) uv[1 - axis] = uv_[a][1 - axis];
      uv_.push_back(uv);
      positions_.push_back((1 - along) * positions_[a] + along * positions_[b]);
    }
    Corner out{at->second, {}};
    for (int w = 0; w < 3; ++w) out.weights[w] = (1 - along) * t.weights[i][w] + along * t.weights[k][w];
    return out;
  }

  const PatchMap& map_;
  bool by_triangles_;
  const std::set<double>* across_ = nullptr;
  std::vector<Triangle> triangles_;
  std::vector<Vec2> uv_;
  std::vector<Vec3> positions_;
};

// The width of the largest dyadic squares that end at c.
double coarsest_width(double c) {
  double width = 0.5;
  while (std::floor(c / width) * width != c) width /= 2;
  return width;
}

std::vector<PatchMap> clip(const PatchMap& map, const std::vector<DyadicSquare>& squares, bool by_triangles) {
  if (squares.empty()) return {};
  MapCutting cutting(map, by_triangles);
  cutting.take(squares);
  // Coarse lines first, those of the squares' ancestors too: then the points along a line are the same whichever finer squares are asked for, and
  // maps that were clipped at different times still share them. A line that was cut before leaves diagonals, which later ones cross.
  std::map<double, std::array<std::set<double>, 2>, std::greater<>> by_width;
  std::array<std::set<double>, 2> all;
  for (const DyadicSquare& s : squares)
    for (double width = s.width; width < 1; width *= 2) {
      const std::array<double, 2> low{std::floor(s.u / width) * width, std::floor(s.v / width) * width};
      for (int axis = 0; axis < 2; ++axis)
        for (const double c : {low[axis], low[axis] + width})
          if (c > 0 && c < 1 && all[axis].insert(c).second) by_width[coarsest_width(c)][axis].insert(c);
    }
  for (int axis = 0; axis < 2; ++axis) all[axis].insert({0.0, 1.0});
  for (const auto& [width, lines] : by_width)
    for (int axis = 0; axis < 2; ++axis)
      for (const double c : lines[axis]) cutting.cut(axis, c, all[1 - axis]);
  std::vector<PatchMap> parts;
  for (const DyadicSquare& s : squares) parts.push_back(cutting.part(s));
  return parts;
}

}  // namespace

std::vector<PatchMap> clip_map(const PatchMap& map, const std::vector<DyadicSquare>& squares) {
  if (squares.size() == 1 && squares[0].is_whole()) return {map};
  return clip(map, squares, false);
}

std::vector<PatchMap> clip_by_triangles(const PatchMap& map, const std::vector<DyadicSquare>& squares) {
  if (squares.size() != 1 || !squares[0].is_whole()) return clip(map, squares, true);
  PatchMap whole = map;
  whole.source.assign(whole.triangles.size(), kCorners);
  whole.source_face.resize(whole.triangles.size());
  std::iota(whole.source_face.begin(), whole.source_face.end(), 0);
  return {std::move(whole)};
}

}  // namespace hybrid_mesh
