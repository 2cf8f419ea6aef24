// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Lee, Preparata, Euclidean shortest paths in the presence of rectilinear barriers, 1984.
#include "layout/curves/face_strip.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hybrid_mesh {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
double cross(const Vec2& apex, const Vec2& a, const Vec2& b) { return cross(Vec2(a - apex), Vec2(b - apex)); }

}  // namespace

FaceStrip::FaceStrip(const EditMesh& mesh, const std::vector<Vec3>& points, const std::vector<int>& half_edges, const Vec3& start, const Vec3& end) {
  // Where a point p beyond the edge from r to l lies: on the left of the way from left to right.
  const auto lay = [](const Vec2& right, const Vec2& left, const Vec3& r, const Vec3& l, const Vec3& p) {
    const Vec3 along = l - r, to = p - r;
    const double length = along.norm();
    if (!(length > 0)) return right;
    const Vec2 d = (left - right).normalized();
    return Vec2(right + d * (to.dot(along) / length) + Vec2(d.y(), -d.x()) * (to.cross(along).norm() / length));
  };
  const auto ends = [&](int h) { return std::pair(mesh.from(h), mesh.to(h)); };
  for (std::size_t i = 0; i < half_edges.size(); ++i) {
    const auto [r, l] = ends(half_edges[i]);
    Portal p;
    if (i == 0) {
      p.right = Vec2(0, 0);
      p.left = Vec2(-(points[l] - points[r]).norm(), 0);
      // Behind the edge: the other way round.
      start_ = lay(p.left, p.right, points[l], points[r], start);
    } else {
      const Portal& before = portals_.back();
      const auto [br, bl] = ends(half_edges[i - 1]);
      const bool left_stays = l == bl;
      const Vec2 fresh = lay(before.right, before.left, points[br], points[bl], points[left_stays ? r : l]);
      p.right = left_stays ? fresh : before.right;
      p.left = left_stays ? before.left : fresh;
    }
    p.right_bound = p.right, p.left_bound = p.left;
    portals_.push_back(p);
  }
  const auto [r, l] = ends(half_edges.back());
  end_ = lay(portals_.back().right, portals_.back().left, points[r], points[l], end);
}

void FaceStrip::narrow(int portal, double from, double to) {
  Portal& p = portals_[portal];
  const Vec2 along = p.left - p.right;
  if (from > 0) p.right_bound = p.right + from * along;
  if (to < 1) p.left_bound = p.right + to * along;
}

void FaceStrip::find_shortest() {
  bends_.clear();
  const int count = static_cast<int>(portals_.size());
  // What can be seen from the last bend: between `right` and `left`, reached at the portals of those numbers.
  Vec2 apex = start_, left = start_, right = start_;
  int left_at = -1, right_at = -1;
  const auto bend = [&](bool on_left) {
    apex = on_left ? left : right;
    const int at = on_left ? left_at : right_at;
    if (!bends_.empty() && bends_.back().at == apex && bends_.back().left == on_left)
      bends_.back().last = at;
    else
      bends_.push_back({at, at, on_left, apex});
    left = right = apex;
    left_at = right_at = at;
    return at;
  };
  for (int i = 0; i <= count; ++i) {
    if (i == count) {
      if (left != apex && cross(apex, left, end_) > 0)
        i = bend(true);
      else if (right != apex && cross(apex, right, end_) < 0)
        i = bend(false);
      continue;
    }
    const Vec2 &l = portals_[i].left_bound, &r = portals_[i].right_bound;
    if (cross(apex, right, r) >= 0) {
      if (right == apex || cross(apex, left, r) < 0) {
        right = r, right_at = i;
      } else {
        i = bend(true);
        continue;
      }
    }
    if (cross(apex, left, l) <= 0) {
      if (left == apex || cross(apex, right, l) > 0)
        left = l, left_at = i;
      else
        i = bend(false);
    }
  }
}

double FaceStrip::length() const {
  double sum = 0;
  Vec2 at = start_;
  for (const Bend& b : bends_) {
    sum += (b.at - at).norm();
    at = b.at;
  }
  return sum + (end_ - at).norm();
}

double FaceStrip::turn(std::size_t bend) const {
  const Vec2 in = bends_[bend].at - (bend > 0 ? bends_[bend - 1].at : start_),
             out = (bend + 1 < bends_.size() ? bends_[bend + 1].at : end_) - bends_[bend].at;
  return std::abs(std::atan2(cross(in, out), in.dot(out)));
}

std::vector<double> FaceStrip::fractions() const {
  std::vector<double> out(portals_.size(), 0.5);
  const auto fraction = [](const Portal& p, const Vec2& at) {
    const Vec2 along = p.left - p.right;
    const double size = along.squaredNorm();
    return size > 0 ? Vec2(at - p.right).dot(along) / size : 0.5;
  };
  Vec2 from = start_;
  int next = 0;
  for (std::size_t b = 0; b <= bends_.size(); ++b) {
    const Vec2 to = b < bends_.size() ? bends_[b].at : end_;
    const int stop = b < bends_.size() ? bends_[b].first : static_cast<int>(portals_.size());
    for (; next < stop; ++next) {
      const Portal& p = portals_[next];
      const double r = cross(from, to, p.right), l = cross(from, to, p.left);
      const double low = fraction(p, p.right_bound), high = fraction(p, p.left_bound);
      out[next] = l > r ? -r / (l - r) : 0.5;
      if (low < high) out[next] = std::clamp(out[next], low, high);
    }
    if (b < bends_.size())
      for (; next <= bends_[b].last; ++next) out[next] = fraction(portals_[next], to);
    from = to;
  }
  return out;
}

}  // namespace hybrid_mesh
