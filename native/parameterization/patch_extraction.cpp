// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/patch_extraction.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/parallel.h"

namespace hybrid_mesh {
namespace {

using Wide = __int128;
constexpr std::int64_t kOne = std::int64_t{1} << 40;

struct GridPoint {
  std::int64_t x = 0, y = 0;
};

GridPoint apply(const Transition& t, const GridPoint& p) {
  GridPoint r = p;
  switch (t.turns) {
    case 1:
      r = {-p.y, p.x};
      break;
    case 2:
      r = {-p.x, -p.y};
      break;
    case 3:
      r = {p.y, -p.x};
      break;
    default:
      break;
  }
  return {r.x + t.x * kOne, r.y + t.y * kOne};
}

Wide orientation(const GridPoint& a, const GridPoint& b, const GridPoint& c) { return Wide(b.x - a.x) * (c.y - a.y) - Wide(b.y - a.y) * (c.x - a.x); }

// A corner of a clipped triangle. Crossings lie on one of the square's sides: their place along it is `along` / `parts` of the grid's unit, exactly.
struct Piece {
  enum class Kind { Vertex, Crossing, Corner } kind;
  int index;               // Vertex: corner of the face; Crossing: edge of the face (from corner index to index + 1); Corner: of the square
  int side = -1;           // Crossing: the square's side
  GridPoint at;            // Vertex and Corner
  Wide along = 0;          // Crossing: numerator ...
  std::int64_t parts = 1;  // ... and positive denominator of the coordinate that runs along the side (x for sides 0 and 2, y for 1 and 3)
  int line = -1;           // what the polygon's edge to the next corner lies on: 0..2 an edge of the face, 3 + i side i
};

// Signed distance to the inside of a side's line (positive inside), only its sign and zero being exact for crossings.
int side_of(const Piece& p, int side) {
  const auto sign = [](Wide w) { return (w > 0) - (w < 0); };
  if (p.kind != Piece::Kind::Crossing) {
    switch (side) {
      case 0:
        return sign(p.at.y);
      case 1:
        return sign(Wide(kOne) - p.at.x);
      case 2:
        return sign(Wide(kOne) - p.at.y);
      default:
        return sign(p.at.x);
    }
  }
  const bool along_x = p.side % 2 == 0;
  if ((side % 2 == 0) == along_x) return p.side == side ? 0 : 1;  // on that line itself, or on the parallel one, inside
  const Wide low = p.along, high = Wide(kOne) * p.parts - p.along;
  return sign(side == 3 || side == 0 ? low : high);
}

class Extraction {
 public:
  Extraction(const ChartMesh& charts, const PatchedSurface& surface, const std::vector<std::array<int, 3>>& repaired_faces)
      : c_(charts), surface_(surface), repaired_faces_(repaired_faces) {}

  std::vector<PatchMap> run(const Progress& progress) {
    round();
    parts_.resize(surface_.patch_count());
    flood(progress.part(0, 0.5));
    std::vector<PatchMap> maps(surface_.patch_count());
    parallel_for_each_index(surface_.patch_count(), [&](std::int64_t q) {
      progress.check();
      maps[q] = extract(static_cast<int>(q));
    });
    progress(1);
    return maps;
  }

 private:
  using Corners = std::array<GridPoint, 3>;

  GridPoint grid_at(int h) const { return apply(c_.corner[h], grid_[c_.mesh.origin[h]]); }

  // Free points keep off the integer lines by a little: nothing but pinned and boundary points lies on them exactly.
  void round() {
    grid_.resize(c_.uv.size());
    const std::int64_t margin = kOne >> 24;
    const auto off_lines = [&](std::int64_t x) {
      const std::int64_t r = ((x % kOne) + kOne) % kOne;
      if (r < margin) return x + (margin - r);
      if (kOne - r < margin) return x - (margin - (kOne - r));
      return x;
    };
    for (int v = 0; v < static_cast<int>(c_.uv.size()); ++v) {
      if (!c_.mesh.vertex_alive(v)) continue;
      const Complex z = c_.uv[v];
      GridPoint p{std::llround(z.real() * static_cast<double>(kOne)), std::llround(z.imag() * static_cast<double>(kOne))};
      grid_[v] = p;
    }
    // One after the other: a point is moved off a line only if its star stays unfolded; else by the least amount.
    for (int v = 0; v < static_cast<int>(c_.uv.size()); ++v) {
      if (!c_.mesh.vertex_alive(v) || !c_.movable(v)) continue;
      const GridPoint p = grid_[v];
      const bool free_x = c_.kind[v] != ChartMesh::Kind::SlideV, free_y = c_.kind[v] != ChartMesh::Kind::SlideU;
      for (const std::int64_t step : {std::int64_t{0}, std::int64_t{1}}) {
        GridPoint moved = p;
        const auto nudge = [&](std::int64_t x) { return step == 0 ? off_lines(x) : (x % kOne == 0 ? x + 1 : x); };
        if (free_x) moved.x = nudge(p.x);
        if (free_y) moved.y = nudge(p.y);
        grid_[v] = moved;
        if (star_unfolded(v)) break;
      }
    }
    for (int f = 0; f < static_cast<int>(c_.mesh.alive.size()); ++f)
      if (c_.mesh.alive[f] && orientation(grid_at(3 * f), grid_at(3 * f + 1), grid_at(3 * f + 2)) <= 0)
        throw NoMap("a triangle of the map vanishes when rounded");
  }
  bool star_unfolded(int v) const {
    int h = c_.mesh.out[v];
    do {
      const int f = h / 3;
      if (orientation(grid_at(3 * f), grid_at(3 * f + 1), grid_at(3 * f + 2)) <= 0) return false;
      h = c_.mesh.ccw(h);
    } while (h >= 0 && h != c_.mesh.out[v]);
    return true;
  }

  // The part of a triangle inside the unit square.
  static std::vector<Piece> clip(const Corners& p) {
    std::vector<Piece> polygon, out;
    for (int i = 0; i < 3; ++i) polygon.push_back({Piece::Kind::Vertex, i, -1, p[i], 0, 1, i});
    if (is_inside(p)) return polygon;
    for (int side = 0; side < 4; ++side) {
      out.clear();
      const std::size_t n = polygon.size();
      for (std::size_t i = 0; i < n; ++i) {
        const Piece &a = polygon[i], &b = polygon[(i + 1) % n];
        const int sa = side_of(a, side), sb = side_of(b, side);
        if (sa >= 0) {
          out.push_back(a);
          // Where the polygon leaves through a corner that lies on the line, it goes on along the line.
          if (sa == 0 && sb < 0) out.back().line = 3 + side;
        }
        if ((sa > 0 && sb < 0) || (sa < 0 && sb > 0)) {
          Piece x{};
          if (a.line >= 3) {
            // A side meets a side: their common corner.
            const int other = a.line - 3;
            x.kind = Piece::Kind::Corner;
            x.index = ((other + 1) % 4 == side) ? side : other;
            x.at = {(x.index == 1 || x.index == 2) ? kOne : 0, x.index >= 2 ? kOne : 0};
          } else {
            x.kind = Piece::Kind::Crossing;
            x.index = a.line;
            x.side = side;
            const GridPoint &s = p[a.line], &e = p[(a.line + 1) % 3];
            // On the line y = level (sides 0, 2) or x = level (1, 3).
            const std::int64_t level = side == 1 || side == 2 ? kOne : 0;
            const bool along_x = side % 2 == 0;
            const std::int64_t s0 = (along_x ? s.y : s.x) - level, e0 = (along_x ? e.y : e.x) - level;
            const std::int64_t s1 = along_x ? s.x : s.y, e1 = along_x ? e.x : e.y;
            x.parts = s0 - e0;
            x.along = Wide(e1) * s0 - Wide(s1) * e0;
            if (x.parts < 0) x.parts = -x.parts, x.along = -x.along;
          }
          x.line = sa > 0 ? 3 + side : a.line;
          out.push_back(x);
        }
      }
      polygon.swap(out);
      if (polygon.size() < 3) return {};
    }
    // What is left may be a mere segment or point of the square's rim.
    for (int side = 0; side < 4; ++side) {
      bool all = true;
      for (const Piece& x : polygon) all &= side_of(x, side) == 0;
      if (all) return {};
    }
    return polygon;
  }

  struct Visit {
    int patch;
    Transition to_patch;  // from the face's chart
  };
  // What a face has in a patch.
  struct Part {
    int face;
    Transition to_patch;
  };
  struct Border {
    int side, from, to;
  };
  // A patch's map while it grows.
  struct Growing {
    PatchMap map;
    std::unordered_map<std::uint64_t, int> index;
    std::vector<Border> borders;
  };

  Corners corners_in(int f, const Transition& to_patch) const {
    return {apply(to_patch, grid_at(3 * f)), apply(to_patch, grid_at(3 * f + 1)), apply(to_patch, grid_at(3 * f + 2))};
  }
  static bool is_inside(const Corners& p) {
    return std::all_of(p.begin(), p.end(), [](const GridPoint& x) { return x.x > 0 && x.x < kOne && x.y > 0 && x.y < kOne; });
  }

  PatchMap extract(int q) {
    Growing growing;
    const std::vector<Part> parts = std::exchange(parts_[q], {});
    growing.index.reserve(parts.size());
    for (const Part& part : parts) {
      const Corners p = corners_in(part.face, part.to_patch);
      add_piece(part.face, p, clip(p), growing);
    }
    finish_sides(q, growing);
    double area = 0;
    const PatchMap& m = growing.map;
    for (const auto& t : m.triangles) {
      const Vec2 a = m.uv[t[1]] - m.uv[t[0]], b = m.uv[t[2]] - m.uv[t[0]];
      area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
    if (!(std::abs(area - 1) < 1e-6)) throw NoMap("the map covers base quad " + std::to_string(q) + " " + std::to_string(area) + " times");
    growing.map.compact();
    return std::move(growing.map);
  }

  // Finds the parts of all patches: from face to face, and from patch to patch where a face reaches over a side.
  void flood(const Progress& progress) {
    const int faces = static_cast<int>(c_.mesh.alive.size());
    std::vector<Visit> seed(faces, Visit{-1, {}});
    std::vector<char> queued(faces, 0);
    std::vector<int> queue;
    // A component starts at the face whose own square holds it best.
    std::vector<std::pair<double, int>> starts;
    for (int f = 0; f < faces; ++f) {
      if (!c_.mesh.alive[f]) continue;
      const Complex z = (c_.at(3 * f) + c_.at(3 * f + 1) + c_.at(3 * f + 2)) / 3.0;
      const double off = std::max(std::abs(z.real() - 0.5), std::abs(z.imag() - 0.5));
      if (off < 0.5) starts.push_back({off, f});
    }
    std::sort(starts.begin(), starts.end());
    int done = 0;
    for (const auto& [off, start] : starts) {
      if (queued[start]) continue;
      seed[start] = {c_.chart[start], {}};
      queued[start] = 1;
      queue.push_back(start);
      while (!queue.empty()) {
        const int f = queue.back();
        queue.pop_back();
        if (++done % 4096 == 0) progress(static_cast<double>(done) / c_.mesh.face_count);
        cut(f, seed[f], [&](int edge, const Visit& at) {
          const int h = 3 * f + edge, o = c_.mesh.opposite[h];
          if (o < 0 || queued[o / 3]) return;
          queued[o / 3] = 1;
          seed[o / 3] = {at.patch, at.to_patch * c_.gluing[o]};
          queue.push_back(o / 3);
        });
      }
    }
    if (done != c_.mesh.face_count) throw NoMap("the map leaves faces uncovered");
  }

  // Notes all parts of a face, from a patch that it overlaps on; calls `reach` for each of its edges with a patch that holds a part of it.
  template <class Reach>
  void cut(int f, const Visit& first, const Reach& reach) {
    if (is_inside(corners_in(f, first.to_patch))) {
      parts_[first.patch].push_back({f, first.to_patch});
      for (int edge = 0; edge < 3; ++edge) reach(edge, first);
      return;
    }
    std::vector<Visit> visits{first};
    for (std::size_t i = 0; i < visits.size(); ++i) {
      const Visit visit = visits[i];
      const std::vector<Piece> polygon = clip(corners_in(f, visit.to_patch));
      if (polygon.empty()) {
        if (i == 0) throw NoMap("the map's faces do not follow its patches");
        continue;
      }
      parts_[visit.patch].push_back({f, visit.to_patch});
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Piece &x = polygon[k], &y = polygon[(k + 1) % polygon.size()];
        // The side that the polygon's edge lies on: by clipping, or because an edge of the mesh runs along it.
        int side = x.line - 3;
        for (int s = 0; s < 4 && side < 0; ++s)
          if (side_of(x, s) == 0 && side_of(y, s) == 0) side = s;
        if (side < 0) {
          reach(x.line, visit);
          continue;
        }
        const PatchSide other = surface_.neighbours[visit.patch][side];
        if (other.patch < 0) continue;
        const Visit next{other.patch, across(side, other.side) * visit.to_patch};
        if (x.line < 3) {
          reach(x.line, next);
          continue;
        }
        const bool known =
            std::any_of(visits.begin(), visits.end(), [&](const Visit& v) { return v.patch == next.patch && v.to_patch == next.to_patch; });
        if (!known) visits.push_back(next);
        if (visits.size() > 64) throw NoMap("a face of the map spans too many base quads");
      }
    }
  }

  // The face of the repaired surface that a face of the charts lies on, and where on it a point is.
  int source_face(int f) const { return surface_.mesh.source_face.empty() ? f : surface_.mesh.source_face[f]; }
  PointSource source_of(int v) const { return surface_.source.empty() ? PointSource{{v, -1, -1}, {1, 0, 0}} : surface_.source[v]; }

  void add_piece(int f, const Corners& p, const std::vector<Piece>& polygon, Growing& growing) const {
    PatchMap& map = growing.map;
    auto& index = growing.index;
    std::array<std::array<double, 3>, 3> source;  // of the face's corners, in its source face
    const std::array<int, 3>& source_corners = repaired_faces_[source_face(f)];
    for (int k = 0; k < 3; ++k) source[k] = weights_in_face(source_of(c_.mesh.origin[3 * f + k]), source_corners);
    const std::size_t n = polygon.size();
    std::vector<int> points(n);
    std::vector<std::array<double, 3>> weights(n);  // in the face
    for (std::size_t i = 0; i < n; ++i) {
      const Piece& x = polygon[i];
      std::uint64_t key = 0;
      Vec2 uv;
      std::array<double, 3> w{0, 0, 0};
      switch (x.kind) {
        case Piece::Kind::Vertex:
          key = static_cast<std::uint64_t>(c_.mesh.origin[3 * f + x.index]);
          uv = Vec2(static_cast<double>(x.at.x) / kOne, static_cast<double>(x.at.y) / kOne);
          w[x.index] = 1;
          break;
        case Piece::Kind::Corner:
          key = (std::uint64_t{2} << 60) | static_cast<std::uint64_t>(x.index);
          uv = Vec2(static_cast<double>(x.at.x) / kOne, static_cast<double>(x.at.y) / kOne);
          w = barycentrics(p, uv);
          break;
        case Piece::Kind::Crossing: {
          const int h = 3 * f + x.index;
          key = (std::uint64_t{1} << 60) | (static_cast<std::uint64_t>(c_.mesh.edge[h]) << 2) | static_cast<std::uint64_t>(x.side);
          const double along =
              static_cast<double>(static_cast<long double>(x.along) / static_cast<long double>(x.parts) / static_cast<long double>(kOne));
          const double level = x.side == 1 || x.side == 2 ? 1 : 0;
          uv = x.side % 2 == 0 ? Vec2(along, level) : Vec2(level, along);
          // The same point whichever face asks: measured from the edge's lower vertex.
          const int a = x.index, b = (x.index + 1) % 3;
          const std::int64_t da =
              x.side % 2 == 0 ? p[a].y - static_cast<std::int64_t>(level) * kOne : p[a].x - static_cast<std::int64_t>(level) * kOne;
          const std::int64_t db =
              x.side % 2 == 0 ? p[b].y - static_cast<std::int64_t>(level) * kOne : p[b].x - static_cast<std::int64_t>(level) * kOne;
          const double t = static_cast<double>(da) / static_cast<double>(da - db);
          w[a] = 1 - t;
          w[b] = t;
          break;
        }
      }
      weights[i] = w;
      const auto [it, fresh] = index.insert({key, static_cast<int>(map.uv.size())});
      points[i] = it->second;
      if (fresh) {
        map.uv.push_back(uv);
        Vec3 position = Vec3::Zero();
        for (int k = 0; k < 3; ++k)
          if (w[k] != 0) position += w[k] * c_.points[c_.mesh.origin[3 * f + k]];
        map.positions.push_back(position);
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      // Along a side by clipping, or because an edge of the mesh lies on it (the surface's boundary, edges between cones).
      for (int side = 0; side < 4; ++side)
        if (side_of(polygon[i], side) == 0 && side_of(polygon[(i + 1) % n], side) == 0)
          growing.borders.push_back({side, points[i], points[(i + 1) % n]});
    }
    // Triangles, the best ears first.
    std::vector<int> left(n);
    for (std::size_t i = 0; i < n; ++i) left[i] = static_cast<int>(i);
    const auto area = [&](int a, int b, int c) {
      const Vec2 x = map.uv[points[b]] - map.uv[points[a]], y = map.uv[points[c]] - map.uv[points[a]];
      return x.x() * y.y() - x.y() * y.x();
    };
    const auto emit = [&](int a, int b, int c) {
      map.triangles.push_back({points[a], points[b], points[c]});
      map.source_face.push_back(source_face(f));
      std::array<float, 9> s;
      int at = 0;
      for (const int i : {a, b, c})
        for (int k = 0; k < 3; ++k)
          s[at++] = static_cast<float>(weights[i][0] * source[0][k] + weights[i][1] * source[1][k] + weights[i][2] * source[2][k]);
      map.source.push_back(s);
    };
    while (left.size() > 3) {
      const std::size_t m = left.size();
      std::size_t best = 0;
      double most = -1e300;
      for (std::size_t i = 0; i < m; ++i) {
        const int a = left[(i + m - 1) % m], b = left[i], c = left[(i + 1) % m];
        // The remaining polygon must not be flat either: both sides of the cut count.
        double rest = 0;
        for (std::size_t k = 1; k + 2 < m; ++k) rest = std::max(rest, area(c, left[(i + 1 + k) % m], left[(i + 2 + k) % m]));
        const double quality = std::min(area(a, b, c), rest);
        if (quality > most) most = quality, best = i;
      }
      emit(left[(best + m - 1) % m], left[best], left[(best + 1) % m]);
      left.erase(left.begin() + best);
    }
    emit(left[0], left[1], left[2]);
  }

  static std::array<double, 3> barycentrics(const Corners& p, const Vec2& uv) {
    std::array<Vec2, 3> q;
    for (int i = 0; i < 3; ++i) q[i] = Vec2(static_cast<double>(p[i].x) / kOne, static_cast<double>(p[i].y) / kOne) - uv;
    const auto c = [](const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); };
    std::array<double, 3> w{c(q[1], q[2]), c(q[2], q[0]), c(q[0], q[1])};
    const double sum = w[0] + w[1] + w[2];
    for (double& x : w) x /= sum;
    return w;
  }

  // Rounding may have put neighbouring points of a side in one place: their order is known from the pieces, and they are spread a little.
  static void finish_sides(std::size_t q, Growing& growing) {
    const std::array<Vec2, 4> square{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
    PatchMap& map = growing.map;
    for (int side = 0; side < 4; ++side) {
      std::map<int, int> next;
      std::map<int, char> has_previous;
      for (const auto& b : growing.borders)
        if (b.side == side) {
          next[b.from] = b.to;
          has_previous[b.to] = 1;
        }
      int start = -1;
      for (const auto& [from, to] : next)
        if (!has_previous.count(from)) {
          if (start >= 0) throw NoMap("a side of base quad " + std::to_string(q) + " is not covered");
          start = from;
        }
      if (start < 0) throw NoMap("a side of base quad " + std::to_string(q) + " is not covered");
      std::vector<int> chain{start};
      while (next.count(chain.back())) {
        chain.push_back(next[chain.back()]);
        if (chain.size() > next.size() + 1) throw NoMap("a side of base quad " + std::to_string(q) + " runs in a circle");
      }
      const int axis = side % 2;
      const double sign = side < 2 ? 1 : -1;
      if (map.uv[chain.front()] != square[side] || map.uv[chain.back()] != square[(side + 1) % 4])
        throw NoMap("a side of base quad " + std::to_string(q) + " does not end at its corners");
      double last = map.uv[chain.front()][axis];
      for (std::size_t k = 1; k + 1 < chain.size(); ++k) {
        double& x = map.uv[chain[k]][axis];
        if (sign * (x - last) < 1e-14) x = last + sign * 1e-14;
        last = x;
      }
      double bound = map.uv[chain.back()][axis];
      for (std::size_t k = chain.size() - 1; k-- > 1;) {
        double& x = map.uv[chain[k]][axis];
        if (sign * (bound - x) < 1e-14) x = bound - sign * 1e-14;
        bound = x;
      }
    }
  }

  const ChartMesh& c_;
  const PatchedSurface& surface_;
  const std::vector<std::array<int, 3>>& repaired_faces_;
  std::vector<GridPoint> grid_;
  std::vector<std::vector<Part>> parts_;  // per patch, in the order in which they are met
};

}  // namespace

std::vector<PatchMap> extract_patch_maps(const ChartMesh& charts, const PatchedSurface& surface,
                                         const std::vector<std::array<int, 3>>& repaired_faces, const Progress& progress) {
  return Extraction(charts, surface, repaired_faces).run(progress);
}

}  // namespace hybrid_mesh
