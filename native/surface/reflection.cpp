// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Besl, McKay, A method for registration of 3-D shapes, 1992 (closest points in turns with the best motion, here a reflection).
#include "surface/reflection.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "base/r2_sequence.h"
#include "surface/closest_point.h"
#include "surface/placement.h"

namespace hybrid_mesh {
namespace {

// A surface is symmetric if the mirror images of its points are no farther from it than this, in the mean square, and at most; of the diagonal.
constexpr double kSymmetric = 0.01, kMostAsymmetric = 0.06;
// A plane across an axis is taken rather than one that is only so many times better, or by so little: nobody puts a model askew by a hair.
constexpr double kAboutAsGood = 1.25, kLittle = 1e-4;
constexpr int kDirections = 400;     // of the planes that are tried, over half a sphere
constexpr int kFewSamples = 150;     // with each of these
constexpr int kManySamples = 20000;  // to measure the result
constexpr int kSamples = 2000;       // to move a plane, and to compare it with others
constexpr std::size_t kMoved = 8;    // planes
constexpr int kRounds = 25;

// Points spread over the surface by area, the same for the same surface.
std::vector<Vec3> spread_points(const TriangleSurface& surface, int count) {
  std::vector<double> area_up_to;
  double total = 0;
  for (const auto& f : surface.faces) {
    const Vec3& a = surface.points[f[0]];
    area_up_to.push_back(total += 0.5 * (surface.points[f[1]] - a).cross(surface.points[f[2]] - a).norm());
  }
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const auto at = std::upper_bound(area_up_to.begin(), area_up_to.end(), (i + 0.5) / count * total) - area_up_to.begin();
    const auto& f = surface.faces[std::min<std::size_t>(at, surface.faces.size() - 1)];
    const auto [u, v] = r2_in_triangle(i);
    points.push_back(surface.points[f[0]] + u * (surface.points[f[1]] - surface.points[f[0]]) + v * (surface.points[f[2]] - surface.points[f[0]]));
  }
  return points;
}

// Of unit size.
class ReflectionFinder {
 public:
  explicit ReflectionFinder(const TriangleSurface& surface) : surface_(surface), query_(surface) {}

  Asymmetry measure(const MirrorPlane& plane, const std::vector<Vec3>& points, const Progress& progress) const {
    const std::vector<Vec3> nearest = images(plane, points, progress);
    Asymmetry a;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double squared = (nearest[i] - plane.reflected(points[i])).squaredNorm();
      a.rms += squared;
      a.largest = std::max(a.largest, squared);
    }
    return {std::sqrt(a.rms / static_cast<double>(std::max<std::size_t>(1, points.size()))), std::sqrt(a.largest)};
  }

  ReflectionSearch run(const Progress& progress) const {
    const std::vector<Vec3> few = spread_points(surface_, kFewSamples), some = spread_points(surface_, kSamples),
                            many = spread_points(surface_, kManySamples);
    Vec3 centroid = Vec3::Zero();
    for (const Vec3& p : many) centroid += p / static_cast<double>(many.size());
    struct Try {
      MirrorPlane plane;
      double rms;
    };
    std::vector<Try> tries;
    for (const Vec3& n : directions(many, centroid)) tries.push_back({{n, n.dot(centroid)}, 0});
    for (Try& t : tries) t.rms = measure(t.plane, few, progress).rms;
    // The axes and those of inertia, which come first, are moved in any case.
    std::stable_sort(tries.begin() + kFirst, tries.end(), [](const Try& a, const Try& b) { return a.rms < b.rms; });
    tries.resize(std::min(tries.size(), kFirst + kMoved));
    ReflectionSearch best;
    bool any = false;
    for (std::size_t i = 0; i < tries.size(); ++i) {
      progress(static_cast<double>(i) / static_cast<double>(tries.size()));
      for (const MirrorPlane& plane : {tries[i].plane, moved(tries[i].plane, some, i < 3, progress)}) {
        const Asymmetry a = measure(plane, some, progress);
        if (any && kAboutAsGood * a.rms + kLittle > best.asymmetry.rms) continue;
        best = {plane, a};
        any = true;
      }
    }
    if (best.asymmetry.rms > kSymmetric || best.asymmetry.largest > kMostAsymmetric) best.plane.reset();
    return best;
  }

 private:
  static constexpr std::size_t kFirst = 6;

  std::vector<Vec3> images(const MirrorPlane& plane, const std::vector<Vec3>& points, const Progress& progress) const {
    std::vector<Vec3> nearest(points.size());
    parallel_for_each_index(static_cast<std::int64_t>(points.size()), [&](std::int64_t i) {
      if (i % 256 == 0) progress.check();
      const ClosestPoint c = query_.closest(plane.reflected(points[i]));
      nearest[i] = Vec3::Zero();
      for (int k = 0; k < 3; ++k) nearest[i] += c.weights[k] * surface_.points[surface_.faces[c.face][k]];
    });
    return nearest;
  }

  static std::vector<Vec3> directions(const std::vector<Vec3>& points, const Vec3& centroid) {
    std::vector<Vec3> out{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (const Vec3& p : points) moments += (p - centroid) * (p - centroid).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments);
    for (int i = 0; i < 3; ++i) out.emplace_back(axes.eigenvectors().col(i));
    // A spiral over half a sphere.
    for (int i = 0; i < kDirections; ++i) {
      const double z = (i + 0.5) / kDirections, r = std::sqrt(1 - z * z), turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
      out.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    }
    return out;
  }

  // To where the points are nearest to what they are mirrored to. `keeps_normal`: along its normal only.
  MirrorPlane moved(MirrorPlane plane, const std::vector<Vec3>& points, bool keeps_normal, const Progress& progress) const {
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<Vec3> nearest = images(plane, points, progress);
      Vec3 p = Vec3::Zero(), q = Vec3::Zero();
      for (std::size_t i = 0; i < points.size(); ++i) p += points[i], q += nearest[i];
      p /= static_cast<double>(points.size()), q /= static_cast<double>(points.size());
      if (!keeps_normal) {
        // The sum of squared distances from q to the image of p is least for the eigenvector of the least eigenvalue of sum q p^T's symmetric part.
        Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
        for (std::size_t i = 0; i < points.size(); ++i) h += (nearest[i] - q) * (points[i] - p).transpose();
        const Vec3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(h + h.transpose()).eigenvectors().col(0);
        plane.normal = normal.dot(plane.normal) < 0 ? Vec3(-normal) : normal;
      }
      plane.offset = plane.normal.dot(0.5 * (p + q));
    }
    return plane;
  }

  const TriangleSurface& surface_;
  const SurfaceDistanceQuery query_;
};

MirrorPlane placed(const MirrorPlane& plane, const Placement& placement) {
  return {plane.normal, (plane.offset - plane.normal.dot(placement.center)) / placement.diagonal};
}

}  // namespace

int MirrorPlane::axis() const {
  for (int i = 0; i < 3; ++i)
    if (std::abs(normal[i]) == 1) return i;
  return -1;
}

Vec3 MirrorPlane::onto(const Vec3& p) const {
  if (const int i = axis(); i >= 0) {
    Vec3 q = p;
    q[i] = offset * normal[i] + 0.0;  // never -0
    return q;
  }
  return p - height(p) * normal;
}

Vec3 MirrorPlane::reflected(const Vec3& p) const {
  if (const int i = axis(); i >= 0) {
    Vec3 q = p;
    q[i] = 2 * (offset * normal[i]) - p[i];
    return q;
  }
  return p - 2 * height(p) * normal;
}

Asymmetry asymmetry(const TriangleSurface& surface, const MirrorPlane& plane, const Progress& progress) {
  const Placement placement = placement_of(surface.points);
  const TriangleSurface unit = placement.to_unit(surface);
  return ReflectionFinder(unit).measure(placed(plane, placement), spread_points(unit, kManySamples), progress);
}

ReflectionSearch find_reflection(const TriangleSurface& surface, const Progress& progress) {
  const Placement placement = placement_of(surface.points);
  const TriangleSurface unit = placement.to_unit(surface);
  ReflectionSearch found = ReflectionFinder(unit).run(progress);
  if (found.plane) {
    MirrorPlane& plane = *found.plane;
    // The larger part of the normal points along its axis.
    Eigen::Index largest = 0;
    plane.normal.cwiseAbs().maxCoeff(&largest);
    if (plane.normal[largest] < 0) plane = {-plane.normal, -plane.offset};
    plane.offset = plane.offset * placement.diagonal + plane.normal.dot(placement.center);
    // What is meant to stand at the origin does.
    if (plane.axis() >= 0 && std::abs(plane.offset) < kLittle * placement.diagonal &&
        asymmetry(surface, {plane.normal, 0}, progress).rms <= kAboutAsGood * found.asymmetry.rms + kLittle)
      plane.offset = 0;
    found.asymmetry = asymmetry(surface, plane, progress);
  }
  return found;
}

}  // namespace hybrid_mesh
