// SPDX-License-Identifier: GPL-3.0-or-later
// Branch and bound: a face, or a part of one, is settled when no point of it can be much farther away than the farthest point known, and is
// halved if not. The bound of a part by the distances of its corners to one face is that of: Tang, Lee, Kim, Interactive Hausdorff distance
// computation for general polygonal models, 2009. Alone it would cut every part that lies over several faces down to the size of the
// distance, most of two surfaces that are close; a sheet over all of a part settles these at once.
#include "surface/one_sided_hausdorff.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace hybrid_mesh {

namespace {

// A face or a part of one; an edge has its second corner twice.
struct Part {
  std::array<Vec3, 3> corners;
  std::array<double, 3> distances;
  std::array<int, 3> closest;  // faces
  double at_most = std::numeric_limits<double>::infinity();

  double largest() const { return std::max({distances[0], distances[1], distances[2]}); }
};

// The points that lie over or under a triangle, along its normal, no farther than some height.
//
// It holds a sheet of a surface if it can be told that every point of the triangle has a point of the surface over or under it there.
// Where the surface neither ends inside the prism nor leaves it by its two caps, it is, modulo 2, a chain whose boundary lies beside the
// prism: the number of its sheets has one parity over all of the triangle, and if it is odd in one point it is nowhere zero.
class Prism {
 public:
  Prism(const SurfaceFaces& surface, const SurfaceDistanceQuery& query) : surface_(surface), query_(query) {}

  bool holds_sheet(const std::array<Vec3, 3>& corners, double height) {
    if (surface_.rim.empty() || !place(corners, height)) return false;
    const Vec3 middle = origin_ + axes_ * (low_ + high_) / 2, reach = axes_.cwiseAbs() * (high_ - low_) / 2;
    if (!query_.faces_in_box(middle - reach, middle + reach, most_faces, near_)) return false;
    const Vec2 inside = 0.3183 * corners_[0] + 0.3678 * corners_[1] + 0.3139 * corners_[2];
    bool odd = false;
    for (const int f : near_) {
      std::array<Vec3, 3> p;
      for (int i = 0; i < 3; ++i) p[i] = local(surface_.points[surface_.faces[f][i]]);
      const Vec3 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]), high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
      if ((low.array() > high_.array()).any() || (high.array() < low_.array()).any()) continue;
      if (surface_.rim[f] || ((low.z() < -height || high.z() > height) && !stays_between_caps(p))) return false;
      // The same products for both faces of an edge: where one ends, the other begins.
      std::array<double, 3> turn;
      for (int i = 0; i < 3; ++i) turn[i] = cross(p[i].head<2>() - inside, p[(i + 1) % 3].head<2>() - inside);
      if (turn[0] == 0 || turn[1] == 0 || turn[2] == 0) return false;
      if ((turn[0] > 0) == (turn[1] > 0) && (turn[1] > 0) == (turn[2] > 0)) odd = !odd;
    }
    return odd;
  }

 private:
  static constexpr std::size_t most_faces = 200;

  static double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
  Vec3 local(const Vec3& p) const { return axes_.transpose() * (p - origin_); }

  // False if the triangle is too thin to have a normal.
  bool place(const std::array<Vec3, 3>& corners, double height) {
    origin_ = corners[0];
    const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[0], normal = a.cross(b);
    const double area = normal.norm();
    if (!(area > 1e-6 * std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()})) || !std::isfinite(area)) return false;
    axes_.col(0) = a.normalized();
    axes_.col(2) = normal.normalized();
    axes_.col(1) = axes_.col(2).cross(axes_.col(0));
    for (int i = 0; i < 3; ++i) corners_[i] = local(corners[i]).head<2>();
    low_ << corners_[0].cwiseMin(corners_[1]).cwiseMin(corners_[2]), -height;
    high_ << corners_[0].cwiseMax(corners_[1]).cwiseMax(corners_[2]), height;
    return true;
  }

  // Whether the part of a face that lies over or under the triangle does so no farther than the height.
  bool stays_between_caps(const std::array<Vec3, 3>& face) const {
    // Clipped by the three sides, a triangle has six corners at most; up to nine where it is so thin that rounding makes it wind to and fro across
    // a side.
    std::array<Vec3, 9> polygon{face[0], face[1], face[2]}, clipped;
    int count = 3;
    for (int i = 0; i < 3; ++i) {
      const Vec2 &a = corners_[i], side = corners_[(i + 1) % 3] - a;
      const auto value = [&](const Vec3& p) { return cross(side, p.head<2>() - a); };
      int kept = 0;
      for (int k = 0; k < count; ++k) {
        const Vec3 &p = polygon[k], &q = polygon[k + 1 < count ? k + 1 : 0];
        const double at_p = value(p), at_q = value(q);
        if (at_p >= 0) clipped[kept++] = p;
        if ((at_p < 0) != (at_q < 0)) clipped[kept++] = p + at_p / (at_p - at_q) * (q - p);
      }
      polygon = clipped;
      count = kept;
    }
    for (int k = 0; k < count; ++k)
      if (!(std::abs(polygon[k].z()) <= high_.z())) return false;
    return true;
  }

  const SurfaceFaces& surface_;
  const SurfaceDistanceQuery& query_;
  Vec3 origin_, low_, high_;  // the box in the triangle's axes
  Eigen::Matrix3d axes_;
  std::array<Vec2, 3> corners_;
  std::vector<int> near_;
};

class Search {
 public:
  Search(const SurfaceFaces& from, const SurfaceFaces& to, const SurfaceDistanceQuery& query, const HausdorffOptions& options,
         const Progress& progress)
      : from_(from), to_(to), query_(query), options_(options), progress_(progress), best_(options.known), best_at_(options.known_at) {}

  HausdorffBounds run() {
    measure_points();
    std::int64_t splits_left = options_.most_splits;
    std::vector<Part> parts = unsettled(static_cast<std::int64_t>(from_.faces.size()), [&](std::int64_t f) {
      Part part;
      for (int i = 0; i < 3; ++i) {
        const int v = from_.faces[f][i];
        part.corners[i] = from_.points[v], part.distances[i] = distance_[v], part.closest[i] = closest_[v];
      }
      return part;
    });
    double given_up = 0;
    while (!parts.empty()) {
      if (static_cast<std::int64_t>(parts.size()) > splits_left) {
        std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.largest() > b.largest(); });
        for (std::size_t i = splits_left; i < parts.size(); ++i) given_up = std::max(given_up, parts[i].at_most);
        parts.resize(splits_left);
      }
      splits_left -= static_cast<std::int64_t>(parts.size());
      parts = split(parts);
      parts = unsettled(static_cast<std::int64_t>(parts.size()), [&](std::int64_t i) { return parts[i]; });
    }
    return {best_, best_at_, std::max(threshold(), given_up)};
  }

 private:
  static constexpr std::int64_t block_size = 1024;

  double threshold() const { return best_ + std::max(options_.tolerance * best_, options_.least_tolerance); }

  void keep_farthest(double distance, const Vec3& p) {
    if (distance > best_) best_ = distance, best_at_ = p;
  }

  // Calls work(begin, end, block) for the blocks of [0, count) in parallel.
  template <class Work>
  void over_blocks(std::int64_t count, Work work) const {
    parallel_for_each_index((count + block_size - 1) / block_size, [&](std::int64_t block) {
      progress_.check();
      work(block * block_size, std::min(count, (block + 1) * block_size), block);
    });
  }

  void measure_points() {
    const auto count = static_cast<std::int64_t>(from_.points.size());
    std::vector<char> used(count, 0);
    for (const auto& face : from_.faces)
      for (const int v : face) used[v] = 1;
    distance_.assign(count, 0);
    closest_.assign(count, -1);
    over_blocks(count, [&](std::int64_t begin, std::int64_t end, std::int64_t) {
      int guess = -1;
      for (std::int64_t v = begin; v < end; ++v) {
        if (!used[v]) continue;
        const ClosestPoint closest = query_.closest(from_.points[v], guess);
        closest_[v] = guess = closest.face;
        distance_[v] = std::sqrt(closest.squared_distance);
      }
    });
    for (std::int64_t v = 0; v < count; ++v) keep_farthest(distance_[v], from_.points[v]);
  }

  // Those of the parts part(0), part(1), ... of which it cannot be said that all their points are nearer than the threshold.
  template <class PartAt>
  std::vector<Part> unsettled(std::int64_t count, PartAt part_at) const {
    std::vector<std::vector<Part>> blocks((count + block_size - 1) / block_size);
    over_blocks(count, [&](std::int64_t begin, std::int64_t end, std::int64_t block) {
      Prism prism(to_, query_);
      for (std::int64_t i = begin; i < end; ++i) {
        Part part = part_at(i);
        if (!settled(part, prism)) blocks[block].push_back(part);
      }
    });
    std::vector<Part> parts;
    for (const auto& block : blocks) parts.insert(parts.end(), block.begin(), block.end());
    return parts;
  }

  bool settled(Part& part, Prism& prism) const {
    const double enough = threshold();
    const auto& p = part.corners;
    const double longest = std::sqrt(std::max({(p[0] - p[1]).squaredNorm(), (p[1] - p[2]).squaredNorm(), (p[2] - p[0]).squaredNorm()}));
    // No point of a triangle is farther from the nearest corner than in an equilateral one, and the distance changes by no more than the way.
    part.at_most = std::min(part.at_most, part.largest() + longest / std::sqrt(3.0));
    if (part.at_most <= enough) return true;
    // The distance to one face is convex: its maximum is in a corner.
    for (int i = 0; i < 3; ++i) {
      const int face = part.closest[i];
      if ((i > 0 && face == part.closest[0]) || (i > 1 && face == part.closest[1])) continue;
      double squared = 0;
      for (int k = 0; k < 3 && squared <= enough * enough; ++k)
        squared = std::max(squared, part.closest[k] == face ? part.distances[k] * part.distances[k] : query_.squared_distance(p[k], face));
      if (squared <= enough * enough) return true;
    }
    return prism.holds_sheet(part.corners, enough);
  }

  // Halves every part across its longest side.
  std::vector<Part> split(const std::vector<Part>& parts) {
    std::vector<Part> halves(2 * parts.size());
    over_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t begin, std::int64_t end, std::int64_t) {
      for (std::int64_t i = begin; i < end; ++i) {
        const Part& part = parts[i];
        int longest = 0;
        for (int k = 1; k < 3; ++k)
          if (side(part, k) > side(part, longest)) longest = k;
        const int a = longest, b = (longest + 1) % 3;
        const Vec3 middle = (part.corners[a] + part.corners[b]) / 2;
        const ClosestPoint closest = query_.closest(middle, part.closest[a]);
        for (const int end : {a, b}) {
          Part& half = halves[2 * i + (end == b)] = part;
          // Both copies of an edge's second corner move.
          for (int k = 0; k < 3; ++k) {
            if (part.corners[k] != part.corners[end]) continue;
            half.corners[k] = middle, half.distances[k] = std::sqrt(closest.squared_distance), half.closest[k] = closest.face;
          }
        }
      }
    });
    for (const Part& part : halves)
      for (int k = 0; k < 3; ++k) keep_farthest(part.distances[k], part.corners[k]);
    return halves;
  }
  static double side(const Part& part, int k) { return (part.corners[k] - part.corners[(k + 1) % 3]).squaredNorm(); }

  const SurfaceFaces &from_, &to_;
  const SurfaceDistanceQuery& query_;
  const HausdorffOptions& options_;
  const Progress& progress_;
  double best_;
  Vec3 best_at_;
  std::vector<double> distance_;  // of the points
  std::vector<int> closest_;
};

}  // namespace

HausdorffBounds one_sided_hausdorff(const SurfaceFaces& from, const SurfaceFaces& to, const SurfaceDistanceQuery& query,
                                    const HausdorffOptions& options, const Progress& progress) {
  return Search(from, to, query, options, progress).run();
}

}  // namespace hybrid_mesh
