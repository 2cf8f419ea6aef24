// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Cignoni, Rocchini, Scopigno, Metro: measuring error on simplified surfaces, 1998.
#include "surface/distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "surface/closest_point.h"
#include "surface/edge_groups.h"
#include "surface/one_sided_hausdorff.h"
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
  Vec3 from_local(const Vec3& p) const { return centre + p * diagonal; }
};

struct Faces {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;  // of some area
  std::vector<double> area_up_to;             // inclusive
  std::vector<char> rim;                      // of the triangles, see SurfaceFaces
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

// Spreads the lowest 21 bits: two zeros after each.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffffull;
  x = (x | x << 16) & 0x001f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & 0x1249249249249249ull;
}

// In Morton order: what is worked on one after the other is near, in space and in memory.
// `on_rim` marks the points where polygons are missing, and is given those of the triangles left out.
void add_triangles(const PolygonSoup& soup, std::vector<char>& on_rim, Faces& faces) {
  struct Entry {
    std::uint64_t code;
    std::array<int, 3> triangle;
    double area;
  };
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const int v : soup.indices) low = low.cwiseMin(faces.points[v]), high = high.cwiseMax(faces.points[v]);
  const double cells = 0x1fffff / std::max((high - low).maxCoeff(), std::numeric_limits<double>::min());
  std::vector<Entry> entries;
  for (const auto& t : triangulate(soup).triangles) {
    const Vec3 &a = faces.points[t[0]], &b = faces.points[t[1]], &c = faces.points[t[2]];
    const double area = (b - a).cross(c - a).norm() / 2;
    if (!(area > 0)) {
      for (const int v : t) on_rim[v] = 1;
      continue;
    }
    const Vec3 cell = ((a + b + c) / 3 - low) * cells;
    std::uint64_t code = 0;
    for (int i = 0; i < 3; ++i) code |= spread(static_cast<std::uint64_t>(std::clamp(cell[i], 0.0, double{0x1fffff}))) << i;
    entries.push_back({code, {t[0], t[1], t[2]}, area});
  }
  if (entries.empty()) throw Error(ErrorCode::InvalidInput, "a surface without area has no distances");
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& e, const Entry& f) { return e.code < f.code; });
  double total = 0;
  faces.triangles.reserve(entries.size());
  faces.rim.reserve(entries.size());
  faces.area_up_to.reserve(entries.size());
  for (const Entry& e : entries) {
    faces.triangles.push_back(e.triangle);
    faces.rim.push_back(on_rim[e.triangle[0]] + on_rim[e.triangle[1]] + on_rim[e.triangle[2]] > 1);
    faces.area_up_to.push_back(total += e.area);
  }
}

Faces place(const PolygonSoup& soup, const Frame& frame) {
  Faces faces;
  faces.points.reserve(soup.points.size());
  for (const Vec3& p : soup.points) {
    faces.points.push_back(frame.local(p));
    if (!(faces.points.back().cwiseAbs().maxCoeff() < 1e100)) throw Error(ErrorCode::InvalidInput, "the surfaces are too far apart to be compared");
  }
  const int corner_count = static_cast<int>(soup.indices.size());
  std::vector<int> next(corner_count);
  for (std::size_t p = 0; p < soup.polygon_count(); ++p)
    for (std::int64_t c = soup.offsets[p]; c < soup.offsets[p + 1]; ++c)
      next[c] = static_cast<int>(c + 1 < soup.offsets[p + 1] ? c + 1 : soup.offsets[p]);
  const auto from = [&](int c) { return soup.indices[c]; };
  const auto to = [&](int c) { return soup.indices[next[c]]; };
  const EdgeGroups edges = group_edges(static_cast<int>(soup.points.size()), corner_count, from, to);
  std::vector<char> on_rim(soup.points.size(), 0);
  for (int e = 0; e < edges.count(); ++e) {
    const int a = from(edges.of(e)[0]), b = to(edges.of(e)[0]);
    if (edges.size(e) % 2) on_rim[a] = on_rim[b] = 1;
    if (edges.size(e) == 1 && faces.points[a] != faces.points[b]) faces.boundary.push_back({a, b, b});
  }
  add_triangles(soup, on_rim, faces);
  return faces;
}

struct Sums {
  double squares = 0, distances = 0, largest = 0;  // `largest` squared
  Vec3 farthest = Vec3::Zero();

  void add_largest(double squared, const Vec3& p) {
    if (squared > largest) largest = squared, farthest = p;
  }
};

constexpr std::int64_t block_size = 4096;

// Calls add(sums, block, begin, end) for the blocks of [0, count) in parallel and adds their sums in order: the result does not depend on the
// threads.
template <class Add>
Sums over_blocks(std::int64_t count, const Progress& progress, Add add) {
  const std::int64_t block_count = (count + block_size - 1) / block_size;
  std::vector<Sums> blocks(block_count);
  parallel_for_each_index(block_count, [&](std::int64_t block) {
    progress.check();
    add(blocks[block], block, block * block_size, std::min(count, (block + 1) * block_size));
  });
  Sums sums;
  for (const Sums& s : blocks) {
    sums.squares += s.squares;
    sums.distances += s.distances;
    sums.add_largest(s.largest, s.farthest);
  }
  return sums;
}

Sums sample(const Faces& from, const SurfaceDistanceQuery& to, const DistanceOptions& options, std::uint64_t direction, const Progress& progress) {
  const double total = from.area_up_to.back();
  return over_blocks(options.samples, progress, [&](Sums& block_sums, std::int64_t block, std::int64_t begin, std::int64_t end) {
    Random random(options.seed, 2 * static_cast<std::uint64_t>(block) + direction);
    int guess = -1;  // the samples follow the order of the faces, so that the last one is often near
    for (std::int64_t i = begin; i < end; ++i) {
      const double pick = (static_cast<double>(i) + random.unit()) / static_cast<double>(options.samples) * total;
      const auto at = std::upper_bound(from.area_up_to.begin(), from.area_up_to.end(), pick) - from.area_up_to.begin();
      const auto& t = from.triangles[std::min<std::size_t>(at, from.triangles.size() - 1)];
      const double r = std::sqrt(random.unit()), s = random.unit();
      const Vec3 p = (1 - r) * from.points[t[0]] + r * (1 - s) * from.points[t[1]] + r * s * from.points[t[2]];
      const ClosestPoint closest = to.closest(p, guess);
      guess = closest.face;
      block_sums.squares += closest.squared_distance;
      block_sums.distances += std::sqrt(closest.squared_distance);
      block_sums.add_largest(closest.squared_distance, p);
    }
  });
}

// The larger direction; `known` are the sums over some samples.
HausdorffBounds hausdorff(const SurfaceFaces& a, const SurfaceFaces& b, const SurfaceDistanceQuery& on_a, const SurfaceDistanceQuery& on_b,
                          const Sums& known, const Progress& progress) {
  HausdorffOptions options;
  options.known = std::sqrt(known.largest);
  options.known_at = known.farthest;
  const HausdorffBounds ab = one_sided_hausdorff(a, b, on_b, options, progress);
  progress(0.5);
  options.known = ab.reached;
  options.known_at = ab.at;
  const HausdorffBounds ba = one_sided_hausdorff(b, a, on_a, options, progress);
  return {ba.reached, ba.at, std::max(ab.at_most, ba.at_most)};
}

void check(const PolygonSoup& soup) {
  if (soup.polygon_count() == 0) throw Error(ErrorCode::InvalidInput, "a surface without faces has no distances");
  if (soup.indices.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) throw Error(ErrorCode::Unsupported, "too many faces");
  for (const int v : soup.indices)
    if (v < 0 || v >= static_cast<int>(soup.points.size()))
      throw Error(ErrorCode::InvalidInput, "a face has the point " + std::to_string(v) + ", which does not exist");
}

}  // namespace

class DistanceReference::Prepared {
 public:
  Prepared(const PolygonSoup& soup, const Frame& in) : frame(in), faces(place(soup, frame)), query(faces.points, faces.triangles) {
    if (!faces.boundary.empty()) edges.emplace(faces.points, faces.boundary);
  }

  Frame frame;
  Faces faces;
  SurfaceDistanceQuery query;
  std::optional<SurfaceDistanceQuery> edges;  // of the boundary
};

DistanceReference::DistanceReference(const PolygonSoup& surface) {
  check(surface);
  prepared_ = std::make_unique<const Prepared>(surface, frame_of(surface));
}

DistanceReference::DistanceReference(const PolygonSoup& surface, double diagonal) {
  check(surface);
  Frame frame = frame_of(surface);
  frame.scale = diagonal / 2;
  frame.diagonal = diagonal;
  prepared_ = std::make_unique<const Prepared>(surface, frame);
}

DistanceReference::~DistanceReference() = default;

SurfaceDistance DistanceReference::distance(const PolygonSoup& other, const DistanceOptions& options, const Progress& progress) const {
  if (options.samples < 1) throw Error(ErrorCode::InvalidInput, "the number of samples must be positive, not " + std::to_string(options.samples));
  check(other);
  const Faces &fa = prepared_->faces, fb = place(other, prepared_->frame);
  progress(0.1);
  const SurfaceDistanceQuery &on_a = prepared_->query, on_b(fb.points, fb.triangles);
  progress(0.2);
  const Sums ab = sample(fa, on_b, options, 0, progress);
  progress(0.45);
  const Sums ba = sample(fb, on_a, options, 1, progress);
  progress(0.7);
  const double n = static_cast<double>(options.samples);
  SurfaceDistance d;
  d.diagonal = prepared_->frame.diagonal;
  d.l2_ab = std::sqrt(ab.squares / n);
  d.l2_ba = std::sqrt(ba.squares / n);
  d.l2 = std::max(d.l2_ab, d.l2_ba);
  d.mean = std::max(ab.distances, ba.distances) / n;
  Sums known = ab;
  known.add_largest(ba.largest, ba.farthest);
  const HausdorffBounds bounds =
      hausdorff({fa.points, fa.triangles, fa.rim}, {fb.points, fb.triangles, fb.rim}, on_a, on_b, known, progress.part(0.7, 0.95));
  const Frame& frame = prepared_->frame;
  d.hausdorff = bounds.reached;
  d.farthest = frame.from_local(bounds.at);
  d.hausdorff_bound = bounds.at_most;
  if (prepared_->edges && !fb.boundary.empty()) {
    const std::vector<char> none;
    const SurfaceDistanceQuery &edges_of_a = *prepared_->edges, edges_of_b(fb.points, fb.boundary);
    const HausdorffBounds apart =
        hausdorff({fa.points, fa.boundary, none}, {fb.points, fb.boundary, none}, edges_of_a, edges_of_b, {}, progress.part(0.95, 1));
    d.boundary_hausdorff = apart.reached;
    d.boundary_farthest = frame.from_local(apart.at);
  }
  progress(1);
  return d;
}

SurfaceDistance surface_distance(const PolygonSoup& a, const PolygonSoup& b, const DistanceOptions& options, const Progress& progress) {
  return DistanceReference(a).distance(b, options, progress);
}

}  // namespace hybrid_mesh
