// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangulation.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <queue>

#include "base/error.h"
#include "surface/scaled_points.h"

namespace hybrid_mesh {

namespace {

// The cosine between the normals of abc and acd.
double flatness(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 m = (b - a).cross(c - a), n = (c - a).cross(d - a);
  const double l = std::sqrt(m.squaredNorm() * n.squaredNorm());
  return l > 0 ? m.dot(n) / l : -1;
}

double cross(const Vec2& a, const Vec2& b, const Vec2& c) { return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(); }

// Twice the area over the squared edge lengths, signed: largest for an equilateral triangle, 0 without area.
double roundness(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double edges = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return edges > 0 ? cross(a, b, c) / edges : 0;
}

// Splits one polygon of five corners or more.
class PolygonSplitter {
 public:
  // Corners are numbered from 0 in the triangles.
  const std::vector<std::array<int, 3>>& split(const std::vector<Vec3>& corners) {
    project(corners);
    clip_ears();
    flip_diagonals();
    return triangles_;
  }

 private:
  void project(const std::vector<Vec3>& corners) {
    const int n = static_cast<int>(corners.size());
    Vec3 lowest = corners[0], highest = corners[0];
    for (const Vec3& p : corners) lowest = lowest.cwiseMin(p), highest = highest.cwiseMax(p);
    const Vec3 centre = (lowest + highest) / 2;
    const double size = (highest - lowest).maxCoeff();
    const auto place = [&](int i) -> Vec3 { return size > 0 ? Vec3((corners[i] - centre) / size) : Vec3::Zero(); };
    Vec3 normal = Vec3::Zero();
    for (int i = 0; i < n; ++i) normal += place(i).cross(place((i + 1) % n));
    if (normal.norm() < 1e-12) normal = Vec3::UnitZ();
    normal.normalize();
    const Vec3 axis = std::abs(normal.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY();
    const Vec3 u = axis.cross(normal).normalized(), v = normal.cross(u);
    flat_.resize(n);
    for (int i = 0; i < n; ++i) flat_[i] = {place(i).dot(u), place(i).dot(v)};
  }

  bool is_ear(int i) {
    const int a = previous_[i], c = next_[i];
    if (cross(flat_[a], flat_[i], flat_[c]) <= 0) return false;
    for (std::size_t r = 0; r < reflex_corners_.size();) {
      const int k = reflex_corners_[r];
      if (!reflex_[k]) {  // clipped or convex by now
        listed_[k] = 0;
        reflex_corners_[r] = reflex_corners_.back();
        reflex_corners_.pop_back();
        continue;
      }
      ++r;
      if (k == a || k == i || k == c) continue;
      if (--tests_left_ < 0) return true;  // a polygon made to be slow: any split will do
      const Vec2& p = flat_[k];
      if (p == flat_[a] || p == flat_[i] || p == flat_[c]) continue;
      if (cross(flat_[a], flat_[i], p) >= 0 && cross(flat_[i], flat_[c], p) >= 0 && cross(flat_[c], flat_[a], p) >= 0) return false;
    }
    return true;
  }

  struct Ear {
    double roundness;
    int corner, version;
    bool operator<(const Ear& other) const { return roundness != other.roundness ? roundness < other.roundness : corner > other.corner; }
  };

  void mark_reflex(int i) {
    reflex_[i] = cross(flat_[previous_[i]], flat_[i], flat_[next_[i]]) <= 0;
    if (!reflex_[i] || listed_[i]) return;
    listed_[i] = 1;
    reflex_corners_.push_back(i);
  }

  void consider(int i) {
    mark_reflex(i);
    ++version_[i];
    if (is_ear(i)) ears_.push({roundness(flat_[previous_[i]], flat_[i], flat_[next_[i]]), i, version_[i]});
  }

  int next_ear() {
    while (!ears_.empty()) {
      const Ear best = ears_.top();
      ears_.pop();
      if (version_[best.corner] == best.version) return best.corner;
    }
    return -1;
  }

  void clip_ears() {
    const int n = static_cast<int>(flat_.size());
    tests_left_ = 20'000'000;
    ears_ = {};
    triangles_.clear();
    previous_.resize(n), next_.resize(n);
    version_.assign(n, 0);
    reflex_.assign(n, 0);
    listed_.assign(n, 0);
    reflex_corners_.clear();
    for (int i = 0; i < n; ++i) previous_[i] = (i + n - 1) % n, next_[i] = (i + 1) % n;
    for (int i = 0; i < n; ++i) mark_reflex(i);
    for (int i = 0; i < n; ++i) consider(i);
    int some = 0;  // a corner that is left
    for (int left = n; left > 3; --left) {
      // Clipping elsewhere never spoils an ear, as corners only disappear, but it can make one where a reflex corner was in the way.
      int ear = next_ear();
      if (ear < 0 && tests_left_ > 0) {
        tests_left_ -= left;
        int i = some;
        do consider(i), i = next_[i];
        while (i != some);
        ear = next_ear();
      }
      if (ear < 0) ear = some;  // crossing itself or without area: clip whatever comes
      const int a = previous_[ear], c = next_[ear];
      triangles_.push_back({a, ear, c});
      next_[a] = c, previous_[c] = a;
      version_[ear] = -1;
      reflex_[ear] = 0;
      some = c;
      consider(a);
      consider(c);
    }
    triangles_.push_back({previous_[some], some, next_[some]});
  }

  // Flips diagonals while the less round of two triangles becomes rounder. Matters where corners lie on a straight side: ears
  // clipped there leave triangles of no area.
  void flip_diagonals() {
    const int count = static_cast<int>(triangles_.size());
    // Diagonals are found by their ends; a corner has few triangles on average, the fan of one that has many is not searched twice.
    std::vector<std::vector<int>> around(flat_.size());
    for (int t = 0; t < count; ++t)
      for (const int corner : triangles_[t]) around[corner].push_back(t);
    std::vector<int> pending(count);
    for (int t = 0; t < count; ++t) pending[t] = t;
    long steps = 20L * count;
    while (!pending.empty() && steps-- > 0) {
      const int t = pending.back();
      pending.pop_back();
      for (int i = 0; i < 3; ++i) {
        const int a = triangles_[t][i], b = triangles_[t][(i + 1) % 3], c = triangles_[t][(i + 2) % 3];
        const int s = across(around, a, b, t);
        if (s < 0) continue;
        const int d = other_corner(s, a, b);
        const double before = std::min(roundness(flat_[a], flat_[b], flat_[c]), roundness(flat_[b], flat_[a], flat_[d]));
        const double after = std::min(roundness(flat_[a], flat_[d], flat_[c]), roundness(flat_[d], flat_[b], flat_[c]));
        if (after <= before + 1e-9) continue;
        std::erase(around[b], t), std::erase(around[a], s);
        around[d].push_back(t), around[c].push_back(s);
        triangles_[t] = {a, d, c};
        triangles_[s] = {d, b, c};
        pending.push_back(t), pending.push_back(s);
        break;
      }
    }
  }

  // The triangle that runs from b to a.
  int across(const std::vector<std::vector<int>>& around, int a, int b, int t) const {
    const std::vector<int>& candidates = around[a].size() < around[b].size() ? around[a] : around[b];
    if (candidates.size() > 1000) return -1;
    for (const int s : candidates) {
      if (s == t) continue;
      for (int i = 0; i < 3; ++i)
        if (triangles_[s][i] == b && triangles_[s][(i + 1) % 3] == a) return s;
    }
    return -1;
  }
  int other_corner(int t, int a, int b) const {
    for (const int corner : triangles_[t])
      if (corner != a && corner != b) return corner;
    return a;
  }

  std::vector<Vec2> flat_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> previous_, next_, version_;
  std::vector<char> reflex_, listed_;
  std::vector<int> reflex_corners_;  // all that are reflex, and some that no longer are
  std::priority_queue<Ear> ears_;
  std::int64_t tests_left_ = 0;
};

}  // namespace

Triangulation triangulate(const PolygonSoup& soup) {
  const int exponent = scale_exponent(soup.points);
  const std::size_t count = soup.indices.size() - std::min(soup.indices.size(), 2 * soup.polygon_count());
  if (soup.indices.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error(ErrorCode::Unsupported, "too many faces: " + std::to_string(soup.polygon_count()));
  Triangulation out;
  out.triangles.reserve(count);
  out.polygon.reserve(count);
  PolygonSplitter splitter;
  std::vector<Vec3> corners;
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    const std::int32_t* index = soup.indices.data() + soup.offsets[p];
    const std::int64_t n = soup.offsets[p + 1] - soup.offsets[p];
    const auto add = [&](int a, int b, int c) {
      out.triangles.push_back({index[a], index[b], index[c]});
      out.polygon.push_back(static_cast<std::int32_t>(p));
    };
    if (n == 3) add(0, 1, 2);
    if (n <= 3) continue;
    corners.clear();
    for (std::int64_t i = 0; i < n; ++i) corners.push_back(scaled(soup.points[index[i]], exponent));
    if (n == 4) {
      const double first = flatness(corners[0], corners[1], corners[2], corners[3]),
                   second = flatness(corners[1], corners[2], corners[3], corners[0]);
      // Differences of rounding alone do not decide: a flat quad is the same surface either way.
      const bool equal = std::abs(first - second) < 1e-9;
      if (equal ? (corners[0] - corners[2]).squaredNorm() <= (corners[1] - corners[3]).squaredNorm() : first > second)
        add(0, 1, 2), add(0, 2, 3);
      else
        add(1, 2, 3), add(1, 3, 0);
    } else {
      for (const auto& t : splitter.split(corners)) add(t[0], t[1], t[2]);
    }
  }
  return out;
}

}  // namespace hybrid_mesh
