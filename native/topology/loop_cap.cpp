// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Guskov, Khodakovsky, Schroeder, Sweldens, Hybrid meshes, 2002, section 3.3 (hole stitching).
#include "topology/loop_cap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "topology/cap_shaping.h"

namespace hybrid_mesh {
namespace {

// Height of an equilateral triangle by its side.
const double row_height = std::sqrt(3.0) / 2;
// How much larger the triangles of a ring are than those of the ring outside.
constexpr double growth = 1.12;

// A closed polygon by its relative arc length, in [0, 1).
class ClosedCurve {
 public:
  explicit ClosedCurve(const std::vector<Vec3>& points) : points_(points), at_(points.size() + 1, 0) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) at_[i + 1] = at_[i] + (points[(i + 1) % n] - points[i]).norm();
    length_ = at_[n];
    for (std::size_t i = 0; i <= n; ++i) at_[i] = length_ > 0 ? at_[i] / length_ : static_cast<double>(i) / static_cast<double>(n);
  }
  double length() const { return length_; }
  double mean_edge() const { return length_ / static_cast<double>(points_.size()); }
  std::vector<double> places() const { return {at_.begin(), at_.end() - 1}; }
  Vec3 operator()(double place) const {
    place -= std::floor(place);
    const auto next = std::upper_bound(at_.begin() + 1, at_.end() - 1, place);
    const auto i = static_cast<std::size_t>(next - at_.begin()) - 1;
    const double width = at_[i + 1] - at_[i];
    const double t = width > 0 ? std::clamp((place - at_[i]) / width, 0.0, 1.0) : 0;
    return (1 - t) * points_[i] + t * points_[(i + 1) % points_.size()];
  }
  Vec3 middle() const {
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vec3 &a = points_[i], &b = points_[(i + 1) % points_.size()];
      sum += (a - b).norm() * (a + b) / 2;
      weight += (a - b).norm();
    }
    return weight > 0 ? Vec3(sum / weight) : points_[0];
  }

 private:
  const std::vector<Vec3>& points_;
  std::vector<double> at_;
  double length_ = 0;
};

// Points of a patch that form a ring, and where each is on the way round, in [0, 1), ascending.
struct Ring {
  std::vector<int> points;
  std::vector<double> places;
};

// So many points, evenly spaced, numbered from `first`.
Ring even_ring(int first, int count, double shift) {
  Ring ring;
  for (int i = 0; i < count; ++i) {
    ring.points.push_back(first + i);
    ring.places.push_back((i + shift) / count);
  }
  return ring;
}

// Faces between two rings that go the same way round; they run along `outer` in its direction.
void join(const Ring& outer, const Ring& inner, std::vector<std::array<int, 3>>& faces) {
  const int n = static_cast<int>(outer.points.size()), m = static_cast<int>(inner.points.size());
  const auto apart = [](double a, double b) { return std::abs(a - b - std::round(a - b)); };
  int start = 0;  // the inner point beside the first outer one
  for (int j = 1; j < m; ++j)
    if (apart(inner.places[j], outer.places[0]) < apart(inner.places[start], outer.places[0])) start = j;
  const double turn = std::round(outer.places[0] - inner.places[start]);
  const auto outer_place = [&](int i) { return outer.places[i % n] + i / n; };
  const auto inner_place = [&](int j) { return inner.places[(start + j) % m] + (start + j) / m + turn; };
  // No point meets all of the other ring, or one edge would arise twice.
  int i = 0, j = 0, i_of_first = 0, j_of_first = 0;
  while (i < n || j < m) {
    if (j == 0) i_of_first = i;
    if (i == 0) j_of_first = j;
    bool along_outer = j == m || (i < n && outer_place(i + 1) <= inner_place(j + 1));
    if (i < n && j == m - 1 && i == i_of_first) along_outer = true;
    if (j < m && i == n - 1 && j == j_of_first) along_outer = false;
    const int a = outer.points[i % n], b = inner.points[(start + j) % m];
    if (along_outer) {
      faces.push_back({a, outer.points[(i + 1) % n], b});
      ++i;
    } else {
      faces.push_back({a, inner.points[(start + j + 1) % m], b});
      ++j;
    }
  }
}

}  // namespace

RimPatch cap_loop(const std::vector<Vec3>& rim) {
  const ClosedCurve curve(rim);
  const Vec3 middle = curve.middle();
  const int count = static_cast<int>(rim.size());
  RimPatch cap;
  Ring ring = even_ring(0, count, 0);
  ring.places = curve.places();
  // Of a round rim as long as this one.
  const double radius = curve.length() / (2 * std::numbers::pi);
  double edge = curve.mean_edge(), at = radius;
  for (int number = 1;; ++number) {
    at -= row_height * edge;
    edge *= growth;
    if (!(at > 0.7 * edge)) break;
    const int points = std::max(5, static_cast<int>(std::lround(2 * std::numbers::pi * at / edge)));
    if (points >= static_cast<int>(ring.points.size()) && number > 1) break;
    const Ring next = even_ring(count + static_cast<int>(cap.points.size()), points, number % 2 ? 0.5 : 0);
    for (const double place : next.places) cap.points.push_back(middle + at / radius * (curve(place) - middle));
    join(ring, next, cap.faces);
    ring = next;
  }
  const int center = count + static_cast<int>(cap.points.size());
  cap.points.push_back(middle);
  const std::size_t n = ring.points.size();
  for (std::size_t i = 0; i < n; ++i) cap.faces.push_back({ring.points[i], ring.points[(i + 1) % n], center});
  return shaped_cap(rim, cap);
}

RimPatch tube_between(const std::vector<Vec3>& first, const std::vector<Vec3>& second, int least_rows) {
  const std::vector<Vec3> turned(second.rbegin(), second.rend());
  const ClosedCurve from(first), to(turned);
  const int n = static_cast<int>(first.size()), m = static_cast<int>(second.size());
  // The turn by which the rims are nearest to each other.
  const std::vector<double> from_places = from.places(), to_places = to.places();
  double shift = 0, least = std::numeric_limits<double>::infinity(), gap = 0;
  for (const double turn : to_places) {
    double sum = 0, way = 0;
    for (int i = 0; i < n; ++i) {
      const double square = (first[i] - to(from_places[i] + turn)).squaredNorm();
      sum += square;
      way += std::sqrt(square) / n;
    }
    if (sum < least) least = sum, shift = turn, gap = way;
  }
  const double edge = (from.mean_edge() + to.mean_edge()) / 2;
  constexpr int most_rows = 256;
  const int rows = std::clamp(edge > 0 ? static_cast<int>(std::lround(std::min(gap / (row_height * edge), 1e6))) : 1, least_rows, most_rows);
  RimPatch tube;
  Ring ring = even_ring(0, n, 0);
  ring.places = from_places;
  for (int row = 1; row < rows; ++row) {
    const double t = static_cast<double>(row) / rows;
    const int points = std::max(3, static_cast<int>(std::lround(n + t * (m - n))));
    const Ring next = even_ring(n + m + static_cast<int>(tube.points.size()), points, row % 2 ? 0.5 : 0);
    for (const double place : next.places) tube.points.push_back((1 - t) * from(place) + t * to(place + shift));
    join(ring, next, tube.faces);
    ring = next;
  }
  // Backwards along the second rim, from where it is nearest to the first one's start.
  Ring last;
  const int begin = static_cast<int>(std::find(to_places.begin(), to_places.end(), shift) - to_places.begin());
  for (int j = 0; j < m; ++j) {
    const int k = (begin + j) % m;
    last.points.push_back(n + m - 1 - k);
    last.places.push_back(to_places[k] - shift + (to_places[k] < shift ? 1 : 0));
  }
  join(ring, last, tube.faces);
  return tube;
}

}  // namespace hybrid_mesh
