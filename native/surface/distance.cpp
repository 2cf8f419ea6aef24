// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Cignoni, Rocchini, Scopigno, Metro: measuring error on simplified surfaces, 1998.
#include "surface/distance.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "surface/closest_point.h"
#include "surface/edge_groups.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {

namespace {

// Based on: Steele, Lea, Flood, Fast splittable pseudorandom number generators, 2014 (SplitMix64). The same on every platform.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : state_(seed * 0x9e3779b97f4a7c15ull + stream * 0xd1342543de82ef95ull) { next(); }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }  // in [0, 1)

 private:
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

// Both surfaces are placed in one frame, that of the first: its centre in the origin, its diagonal 1.
struct Frame {
  Vec3 centre;
  double scale = 1;  // half the diagonal
  double diagonal = 0;

  Vec3 local(const Vec3& p) const { return (p / 2 - centre / 2) / scale; }
};

struct Faces {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;  // of some area
  std::vector<double> area_up_to;             // inclusive
  std::vector<std::array<int, 3>> boundary;   // edges of one polygon, as triangles without area
};

Frame frame_of(const PolygonSoup& soup) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int v : soup.indices) low = low.cwiseMin(soup.points[v]), high = high.cwiseMax(soup.points[v]);
  Frame frame;
  frame.centre = low / 2 + high / 2;
  const Vec3 half = high / 2 - low / 2;
  const double largest = half.maxCoeff();
  if (!(largest > 0)) throw Error(ErrorCode::InvalidInput, "a surface without extent has no relative distances");
  frame.scale = (half / largest).norm() * largest;
  frame.diagonal = 2 * frame.scale;
  return frame;
}

Faces place(const PolygonSoup& soup, const Frame& frame) {
  Faces faces;
  faces.points.reserve(soup.points.size());
  for (const Vec3& p : soup.points) {
    faces.points.push_back(frame.local(p));
    if (!(faces.points.back().cwiseAbs().maxCoeff() < 1e100)) throw Error(ErrorCode::InvalidInput, "the surfaces are too far apart to be compared");
  }
  double total = 0;
  for (const auto& t : triangulate(soup).triangles) {
    const Vec3 &a = faces.points[t[0]], &b = faces.points[t[1]], &c = faces.points[t[2]];
    const double area = (b - a).cross(c - a).norm() / 2;
    if (!(area > 0)) continue;
    faces.triangles.push_back({t[0], t[1], t[2]});
    faces.area_up_to.push_back(total += area);
  }
  if (faces.triangles.empty()) throw Error(ErrorCode::InvalidInput, "a surface without area has no distances");

  const int corner_count = static_cast<int>(soup.indices.size());
  std::vector<int> next(corner_count);
  for (std::size_t p = 0; p < soup.polygon_count(); ++p)
    for (std::int64_t c = soup.offsets[p]; c < soup.offsets[p + 1]; ++c) next[c] = static_cast<int>(c + 1 < soup.offsets[p + 1] ? c + 1 : soup.offsets[p]);
  const auto from = [&](int c) { return soup.indices[c]; };
  const auto to = [&](int c) { return soup.indices[next[c]]; };
  const EdgeGroups edges = group_edges(static_cast<int>(soup.points.size()), corner_count, from, to);
  for (int e = 0; e < edges.count(); ++e) {
    const int a = from(edges.of(e)[0]), b = to(edges.of(e)[0]);
    if (edges.size(e) == 1 && faces.points[a] != faces.points[b]) faces.boundary.push_back({a, b, b});
  }
  return faces;
}

struct Sums {
  double squares = 0, distances = 0, largest = 0;  // `largest` squared
};

constexpr std::int64_t block_size = 4096;

// Calls add(sums, block, begin, end) for the blocks of [0, count) in parallel and adds their sums in order: the result does not depend on the
// threads.
template <class Add>
Sums over_blocks(std::int64_t count, const Progress& progress, Add add) {
  const std::int64_t block_count = (count + block_size - 1) / block_size;
  std::vector<Sums> blocks(block_count);
  tbb::parallel_for(std::int64_t{0}, block_count, [&](std::int64_t block) {
    progress.check();
    add(blocks[block], block, block * block_size, std::min(count, (block + 1) * block_size));
  });
  Sums sums;
  for (const Sums& s : blocks) {
    sums.squares += s.squares;
    sums.distances += s.distances;
    sums.largest = std::max(sums.largest, s.largest);
  }
  return sums;
}

Sums one_direction(const Faces& from, const Faces& to, const DistanceOptions& options, std::uint64_t direction, const Progress& progress) {
  const SurfaceDistanceQuery query(to.points, to.triangles);
  progress(0.2);
  const double total = from.area_up_to.back();
  Sums sums = over_blocks(options.samples, progress, [&](Sums& block_sums, std::int64_t block, std::int64_t begin, std::int64_t end) {
    Random random(options.seed, 2 * static_cast<std::uint64_t>(block) + direction);
    int guess = -1;  // the samples follow the order of the faces, so that the last one is often near
    for (std::int64_t i = begin; i < end; ++i) {
      const double pick = (static_cast<double>(i) + random.unit()) / static_cast<double>(options.samples) * total;
      const auto at = std::upper_bound(from.area_up_to.begin(), from.area_up_to.end(), pick) - from.area_up_to.begin();
      const auto& t = from.triangles[std::min<std::size_t>(at, from.triangles.size() - 1)];
      const double r = std::sqrt(random.unit()), s = random.unit();
      const Vec3 p = (1 - r) * from.points[t[0]] + r * (1 - s) * from.points[t[1]] + r * s * from.points[t[2]];
      const ClosestPoint closest = query.closest(p, guess);
      guess = closest.face;
      block_sums.squares += closest.squared_distance;
      block_sums.distances += std::sqrt(closest.squared_distance);
      block_sums.largest = std::max(block_sums.largest, closest.squared_distance);
    }
  });
  progress(0.8);
  std::vector<char> used(from.points.size(), 0);
  for (const auto& t : from.triangles)
    for (const int v : t) used[v] = 1;
  const Sums corners = over_blocks(static_cast<std::int64_t>(from.points.size()), progress, [&](Sums& block_sums, std::int64_t, std::int64_t begin, std::int64_t end) {
    int guess = -1;
    for (std::int64_t v = begin; v < end; ++v) {
      if (!used[v]) continue;
      const ClosestPoint closest = query.closest(from.points[v], guess);
      guess = closest.face;
      block_sums.largest = std::max(block_sums.largest, closest.squared_distance);
    }
  });
  sums.largest = std::max(sums.largest, corners.largest);
  progress(1);
  return sums;
}

double boundary_distance(const Faces& from, const Faces& to, const Progress& progress) {
  const SurfaceDistanceQuery query(to.points, to.boundary);
  const Sums sums =
      over_blocks(static_cast<std::int64_t>(from.boundary.size()), progress, [&](Sums& block_sums, std::int64_t, std::int64_t begin, std::int64_t end) {
        int guess = -1;
        for (std::int64_t e = begin; e < end; ++e) {
          const Vec3 &a = from.points[from.boundary[e][0]], &b = from.points[from.boundary[e][1]];
          for (int i = 0; i <= 8; ++i) {
            const ClosestPoint closest = query.closest(a + (b - a) * (i / 8.0), guess);
            guess = closest.face;
            block_sums.largest = std::max(block_sums.largest, closest.squared_distance);
          }
        }
      });
  return std::sqrt(sums.largest);
}

void check(const PolygonSoup& soup) {
  if (soup.polygon_count() == 0) throw Error(ErrorCode::InvalidInput, "a surface without faces has no distances");
  if (soup.indices.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) throw Error(ErrorCode::Unsupported, "too many faces");
  for (const int v : soup.indices)
    if (v < 0 || v >= static_cast<int>(soup.points.size())) throw Error(ErrorCode::InvalidInput, "a face has the point " + std::to_string(v) + ", which does not exist");
}

}  // namespace

SurfaceDistance surface_distance(const PolygonSoup& a, const PolygonSoup& b, const DistanceOptions& options, const Progress& progress) {
  if (options.samples < 1) throw Error(ErrorCode::InvalidInput, "the number of samples must be positive, not " + std::to_string(options.samples));
  check(a);
  check(b);
  const Frame frame = frame_of(a);
  const Faces fa = place(a, frame), fb = place(b, frame);
  progress(0.1);
  const Sums ab = one_direction(fa, fb, options, 0, progress.part(0.1, 0.5));
  const Sums ba = one_direction(fb, fa, options, 1, progress.part(0.5, 0.9));
  const double n = static_cast<double>(options.samples);
  SurfaceDistance d;
  d.diagonal = frame.diagonal;
  d.l2_ab = std::sqrt(ab.squares / n);
  d.l2_ba = std::sqrt(ba.squares / n);
  d.l2 = std::max(d.l2_ab, d.l2_ba);
  d.mean = std::max(ab.distances, ba.distances) / n;
  d.hausdorff = std::sqrt(std::max(ab.largest, ba.largest));
  if (!fa.boundary.empty() && !fb.boundary.empty())
    d.boundary_hausdorff = std::max(boundary_distance(fa, fb, progress), boundary_distance(fb, fa, progress));
  progress(1);
  return d;
}

}  // namespace hybrid_mesh
