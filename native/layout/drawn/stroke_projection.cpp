// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/stroke_projection.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/tolerances.h"

namespace hybrid_mesh {
namespace {

constexpr int kMostSamples = 50000;       // a stroke
constexpr double kDensest = 0.2;          // of a step
constexpr std::size_t kMostPieces = 100;  // of a stroke that leaves the surface and comes back: each would be a curve of its own

bool is_finite(const Vec3& p) { return std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z()); }

double length(const std::vector<Vec3>& line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += (line[i] - line[i - 1]).norm();
  return sum;
}

}  // namespace

StrokeProjection::StrokeProjection(const TriangleSurface& surface, const Options& options)
    : surface_(surface), options_(options), query_(surface), boundary_point_(surface.points.size(), 0) {
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h)
    if (surface.opposite[h] < 0) boundary_point_[surface.from(h)] = 1;
}

Vec3 StrokeProjection::normal(int face) const {
  const auto& f = surface_.faces[face];
  return (surface_.points[f[1]] - surface_.points[f[0]]).cross(surface_.points[f[2]] - surface_.points[f[0]]).normalized();
}

bool StrokeProjection::on_boundary(int face, const std::array<double, 3>& weights) const {
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 1 && boundary_point_[surface_.faces[face][i]]) return true;
    if (weights[(i + 2) % 3] == 0 && surface_.opposite[3 * face + i] < 0) return true;
  }
  return false;
}

StrokeProjection::Sample StrokeProjection::sample(const Vec3& p, int guess) const {
  const ClosestPoint c = query_.closest(p, guess);
  Sample s;
  s.drawn = p;
  s.face = c.face;
  s.distance = std::sqrt(c.squared_distance);
  s.on_surface = Vec3::Zero();
  for (int i = 0; i < 3; ++i) s.on_surface += c.weights[i] * surface_.points[surface_.faces[c.face][i]];
  s.boundary = on_boundary(c.face, c.weights);
  return s;
}

// The nearest point on the faces around the sample before.
StrokeProjection::Sample StrokeProjection::nearby(const Vec3& p, const Sample& before) const {
  const double room = 4 * std::max(options_.step, (p - before.drawn).norm());
  Sample best;
  best.distance = std::numeric_limits<double>::infinity();
  std::vector<int> faces{before.face};
  for (std::size_t i = 0; i < faces.size() && i < 200; ++i) {
    const auto& f = surface_.faces[faces[i]];
    std::array<double, 3> w{1, 0, 0};
    const double d = std::sqrt(nearest_in_triangle(p, {surface_.points[f[0]], surface_.points[f[1]], surface_.points[f[2]]}, w));
    if (d < best.distance) {
      best.distance = d;
      best.face = faces[i];
      best.on_surface = w[0] * surface_.points[f[0]] + w[1] * surface_.points[f[1]] + w[2] * surface_.points[f[2]];
      best.boundary = on_boundary(faces[i], w);
    }
    for (int h = 3 * faces[i]; h < 3 * faces[i] + 3; ++h) {
      const int o = surface_.opposite[h];
      if (o < 0 || std::find(faces.begin(), faces.end(), o / 3) != faces.end()) continue;
      if (query_.squared_distance(before.on_surface, o / 3) <= room * room) faces.push_back(o / 3);
    }
  }
  best.drawn = p;
  return best;
}

std::vector<StrokeProjection::Sample> StrokeProjection::samples(const std::vector<Vec3>& stroke) const {
  const double step = std::max(options_.step, length(stroke) / kMostSamples);
  std::vector<Sample> out;
  const auto add = [&](const Vec3& p) {
    Sample s = sample(p, out.empty() ? -1 : out.back().face);
    if (!out.empty()) {
      // Closest points jump where a stroke is as near to another part of the surface. The part where it is now keeps it, unless that is clearly
      // farther.
      const Sample& before = out.back();
      const bool jumps = (s.on_surface - before.on_surface).norm() > 3 * (p - before.drawn).norm() + tolerance::same_place ||
                         normal(s.face).dot(normal(before.face)) < 0;
      if (jumps) {
        const Sample near = nearby(p, before);
        if (near.distance <= 1.5 * s.distance + 0.5 * step) s = near;
      }
    }
    out.push_back(s);
  };
  add(stroke[0]);
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    const Vec3 a = stroke[i - 1], b = stroke[i];
    const int pieces = static_cast<int>(std::ceil((b - a).norm() / step));
    // Where the line between two drawn points is far from the surface, it tells nothing: the way between them is found on the surface.
    bool near = true;
    for (int k = 1; k < pieces && near; ++k)
      near = std::sqrt(query_.closest(a + (static_cast<double>(k) / pieces) * (b - a), out.back().face).squared_distance) <= options_.reach;
    for (int k = 1; k < pieces && near; ++k) add(a + (static_cast<double>(k) / pieces) * (b - a));
    add(b);
  }
  return out;
}

std::vector<ProjectedStroke> StrokeProjection::operator()(int number, const std::vector<Vec3>& drawn, std::vector<LayoutProblem>& problems) const {
  using Kind = LayoutProblem::Kind;
  std::vector<ProjectedStroke> out;
  std::vector<Vec3> stroke, finite;
  for (const Vec3& p : drawn) {
    if (is_finite(p)) finite.push_back(p);
    // Points much closer than the steps tell nothing; the last one counts.
    if (!stroke.empty() && (p - stroke.back()).norm() < kDensest * options_.step) {
      if (&p == &drawn.back() && stroke.size() > 1) stroke.back() = p;
      continue;
    }
    stroke.push_back(p);
  }
  if (finite.size() < drawn.size()) {
    problems.push_back({Kind::Unusable, "a stroke has points that are not finite", finite, number, -1});
    return out;
  }
  if (stroke.size() < 2) {
    problems.push_back({Kind::Unusable, drawn.empty() ? "a stroke has no points" : "a stroke is a single point", stroke, number, -1});
    return out;
  }
  std::vector<Vec3> off;
  int guess = -1;
  for (const Vec3& p : stroke) {
    if (!(p.cwiseAbs().maxCoeff() < 1e6)) {
      off.push_back(p);
      continue;
    }
    const ClosestPoint c = query_.closest(p, guess);
    guess = c.face;
    if (!(std::sqrt(c.squared_distance) <= options_.reach)) off.push_back(p);
  }
  if (!off.empty()) {
    problems.push_back({Kind::OffSurface, "a stroke is too far from the surface", off, number, -1});
    return out;
  }

  // Beyond the boundary, closest points lie on it: there the stroke ends; where it goes over a hole, it is two.
  const std::vector<Sample> all = samples(stroke);
  const int count = static_cast<int>(all.size());
  std::vector<std::array<int, 2>> pieces;
  for (int i = 0; i < count;) {
    // A run inside, with short notches.
    if (all[i].boundary) {
      ++i;
      continue;
    }
    int last = i;
    for (int k = i; k < count; ++k) {
      if (!all[k].boundary) {
        last = k;
        continue;
      }
      if (all[k].distance > 0.5 * options_.snap) break;
    }
    pieces.push_back({std::max(i - 1, 0), std::min(last + 1, count - 1)});
    i = last + 1;
  }
  if (pieces.empty() || pieces.size() > kMostPieces) {
    std::vector<Vec3> line;
    for (const Sample& s : all) line.push_back(s.on_surface);
    if (pieces.empty())
      problems.push_back({Kind::Overlap, "a stroke runs along the boundary, which is a side already", line, number, -1});
    else
      problems.push_back({Kind::Unusable, "a stroke leaves the surface and comes back too often", line, number, -1});
    return out;
  }
  for (const auto& [first, last] : pieces) {
    ProjectedStroke piece;
    piece.stroke = number;
    std::vector<Vec3> line;
    for (int k = first; k <= last; ++k) {
      if (!line.empty() && (all[k].on_surface - line.back()).norm() < tolerance::same_place) continue;
      line.push_back(all[k].on_surface);
      piece.points.push_back({all[k].face, all[k].on_surface});
    }
    piece.at_boundary = {all[first].boundary, all[last].boundary};
    if (line.size() > 1 && length(line) >= options_.snap)
      out.push_back(std::move(piece));
    else
      problems.push_back({Kind::Unusable, "a stroke is too short", line, number, -1});
  }
  return out;
}

}  // namespace hybrid_mesh
