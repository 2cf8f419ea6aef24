// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/rate_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/r2_sequence.h"
#include "codec/level_chain.h"
#include "remesh/block_matrix.h"
#include "remesh/fit.h"
#include "surface/closest_point.h"
#include "surface/placement.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {

namespace {

constexpr std::int64_t block = 4096;      // of samples that one task looks at
constexpr int samples_of_a_triangle = 3;  // of the mesh
constexpr std::int64_t least_samples = 5000, most_samples = 4000000;
// Cosine of the angle between a mesh's normal and that of the surface's closest point: below, the mesh is folded there.
constexpr double unfolded = 0.2;
// A place has gone astray where its mean square distance is more than that of the given mesh there so many times and the mean of all so many times.
constexpr double farther = 2, much_farther = 10;
constexpr int soft_rings = 6;  // around it, between what starts anew and what does not: a seam costs bits

using Triangle = std::array<int, 3>;

Vec3 area_vector(const std::vector<Vec3>& points, const Triangle& t) { return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]) / 2; }

template <class Body>
void for_all(std::int64_t count, const Body& body) {
  parallel_for_each_index((count + block - 1) / block, [&](std::int64_t b) {
    for (std::int64_t i = b * block; i < std::min(count, (b + 1) * block); ++i) body(i);
  });
}

// A surface of triangles, placed.
struct Surface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<int> polygon;

  Surface(const PolygonSoup& soup, const Placement& placement) {
    for (const Vec3& point : soup.points) points.push_back(placement.to_unit(point));
    Triangulation split = triangulate(soup);
    polygon.assign(split.polygon.begin(), split.polygon.end());
    for (const auto& t : split.triangles) triangles.push_back({t[0], t[1], t[2]});
  }
};

// Spread evenly over a surface, without faces of the mesh yet.
std::vector<FitSample> even_samples(const Surface& surface, std::int64_t count) {
  double total = 0;
  for (const Triangle& t : surface.triangles) total += area_vector(surface.points, t).norm();
  if (!(total > 0)) throw Error(ErrorCode::InvalidInput, "a surface without area");
  std::vector<FitSample> samples;
  samples.reserve(count);
  double area = 0;
  for (const Triangle& t : surface.triangles) {
    const Vec3 normal = area_vector(surface.points, t);
    const double size = normal.norm();
    area += size;
    for (const auto target = static_cast<std::int64_t>(area / total * static_cast<double>(count));
         static_cast<std::int64_t>(samples.size()) < target;) {
      const auto [a, b] = r2_in_triangle(static_cast<std::int64_t>(samples.size()));
      samples.push_back({(1 - a - b) * surface.points[t[0]] + a * surface.points[t[1]] + b * surface.points[t[2]], normal / size});
    }
  }
  return samples;
}

// Gives samples the face that has their closest point.
void find_faces(const QuadMesh& mesh, std::vector<FitSample>& samples) {
  const Surface faces(to_soup(mesh), Placement());
  const SurfaceDistanceQuery query(faces.points, faces.triangles);
  for_all(static_cast<std::int64_t>(samples.size()),
          [&](std::int64_t i) { samples[i].face = faces.polygon[query.closest(samples[i].position).face]; });
}

// Distances to be made small, as equations of the mesh's vertices: squares of them by a metric, with a weight.
struct Equations {
  BlockMatrix matrix;
  std::vector<Vec3> right;  // less what the matrix makes of the present points

  explicit Equations(const QuadMesh& mesh) : matrix(mesh), right(mesh.points.size(), Vec3::Zero()) { clear(); }
  void clear() {
    for (Eigen::Matrix3d& b : matrix.block) b.setZero();
    for (Vec3& r : right) r.setZero();
  }
  void add(const Triangle& vertices, const std::array<double, 3>& weights, const Eigen::Matrix3d& metric, const Vec3& way) {
    for (int p = 0; p < 3; ++p) {
      if (weights[p] == 0) continue;
      right[vertices[p]] += weights[p] * (metric * way);
      for (int q = 0; q < 3; ++q)
        if (weights[q] != 0) matrix.block[matrix.find(vertices[p], vertices[q])] += weights[p] * weights[q] * metric;
    }
  }
  Columns product(const Columns& x) const {
    Columns y(x.rows(), 3);
    for_all(x.rows(), [&](std::int64_t v) {
      Vec3 sum = Vec3::Zero();
      for (int k = matrix.row[v]; k < matrix.row[v + 1]; ++k) sum.noalias() += matrix.block[k] * x.row(matrix.column[k]).transpose();
      y.row(v) = sum.transpose();
    });
    return y;
  }
};

class RateFit {
 public:
  RateFit(const HybridMesh& hierarchy, const PolygonSoup& surface, const RateFitOptions& options, const Progress& progress)
      : options_(options),
        progress_(progress),
        mesh_(hierarchy.final_mesh()),
        placement_(placement_of(surface.points)),
        surface_(surface, placement_),
        query_(surface_.points, surface_.triangles),
        chain_(hierarchy),
        equations_(mesh_),
        held_(held_vertices(mesh_)) {
    for (Vec3& point : mesh_.points) point = placement_.to_unit(point);
    given_ = mesh_.points;
    errors_.resize(given_.size());
    const auto count = std::clamp(options.samples * static_cast<std::int64_t>(given_.size()), least_samples, most_samples);
    samples_ = even_samples(surface_, count);
    find_faces(mesh_, samples_);
    homes_ = closest_anchors(mesh_, samples_);
    for (const FitSample& sample : samples_) home_faces_.push_back(sample.face);
  }

  QuadMesh run() {
    set_equations();
    errors_given_ = errors_;
    coefficients_ = chain_.analyse(mesh_.points);
    const int depth = chain_.depth(), all = depth * options_.coarse_rounds + options_.rounds;
    // Finer levels start with nothing: what coarser ones cannot do is left to them.
    const Eigen::Index base = chain_.part(1);
    coefficients_.bottomRows(coefficients_.rows() - base).setZero();
    int done = 0;
    for (int level = 0; level <= depth; ++level)
      for (int round = 0; round < (level < depth ? options_.coarse_rounds : options_.rounds); ++round, ++done) {
        progress_(static_cast<double>(done) / all);
        coefficients_ = chain_.reframed(coefficients_);
        mesh_.points = chain_.synthesise(coefficients_);
        set_equations();
        if (level == depth && round >= options_.free_rounds && start_anew()) set_equations();
        const double cost = level == depth && round + 1 == options_.rounds ? options_.last : 1;
        solve(chain_.part(level + 1), penalties(level == depth && round >= options_.rounds / 2, cost));
      }
    mesh_.points = chain_.synthesise(coefficients_);
    set_equations();
    start_anew();
    for (Vec3& point : mesh_.points) point = placement_.from_unit(point);
    return std::move(mesh_);
  }

 private:
  // Of the way from a point to the closest one. Where that is not along the normal, the surface ends there or bends away: it counts all the same.
  Eigen::Matrix3d metric(const Vec3& normal, const Vec3& way) const {
    Eigen::Matrix3d result = options_.along_surface * Eigen::Matrix3d::Identity() + normal * normal.transpose();
    const double squared = way.squaredNorm(), across = normal.dot(way);
    if (squared > 0) result += (1 - across * across / squared) / squared * way * way.transpose();
    return result;
  }

  // Means over vertices and their neighbours.
  std::vector<double> spread(const std::vector<double>& values) const {
    const BlockMatrix& matrix = equations_.matrix;
    std::vector<double> result(values.size());
    for (std::size_t v = 0; v < values.size(); ++v) {
      for (int k = matrix.row[v]; k < matrix.row[v + 1]; ++k) result[v] += values[matrix.column[k]];
      result[v] /= matrix.row[v + 1] - matrix.row[v];
    }
    return result;
  }

  // Where coarse levels lie on the wrong side of something thin, or what is small and bent got folded, closest points lead no way back: such places
  // start from the given points, with samples where they were on these. Whether there are any.
  bool start_anew() {
    const std::vector<double> now = spread(spread(errors_)), given = spread(spread(errors_given_));
    double mean = 0;
    for (const double error : given) mean += error / static_cast<double>(given.size());
    std::vector<double> share(now.size());
    bool any = false;
    for (std::size_t v = 0; v < now.size(); ++v)
      if (now[v] > farther * given[v] + much_farther * mean) {
        share[v] = 1;
        any = true;
      }
    if (!any) return false;
    share = spread(share);
    for (double& s : share) s = s > 0 ? 1 : 0;
    for (int ring = 0; ring < soft_rings; ++ring) share = spread(share);
    for (std::size_t v = 0; v < share.size(); ++v) mesh_.points[v] += share[v] * (given_[v] - mesh_.points[v]);
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (share[homes_[i].vertices[0]] > 0.5) samples_[i].face = home_faces_[i];
    coefficients_ = chain_.analyse(mesh_.points);
    return true;
  }

  void set_equations() {
    equations_.clear();
    std::fill(errors_.begin(), errors_.end(), 0);
    const std::vector<FitAnchor> anchors = closest_anchors(mesh_, samples_);
    const double weight = 0.5 / static_cast<double>(samples_.size());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const FitAnchor& anchor = anchors[i];
      for (int p = 0; p < 3; ++p) errors_[homes_[i].vertices[p]] += weight * homes_[i].weights[p] * anchor.squared_distance;
      Vec3 at = Vec3::Zero();
      for (int p = 0; p < 3; ++p) at += anchor.weights[p] * mesh_.points[anchor.vertices[p]];
      equations_.add(anchor.vertices, anchor.weights, weight * metric(samples_[i].normal, samples_[i].position - at), samples_[i].position - at);
    }
    progress_.check();
    add_points_of_mesh();
    const double hold = 1.0 / static_cast<double>(given_.size());
    for (int v = 0; v < static_cast<int>(held_.size()); ++v)
      if (held_[v]) equations_.add({v, v, v}, {1, 0, 0}, hold * Eigen::Matrix3d::Identity(), given_[v] - mesh_.points[v]);
  }

  // Points of the mesh, drawn to the closest ones of the surface.
  void add_points_of_mesh() {
    std::vector<Triangle> triangles;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f)
      for (std::int64_t c = mesh_.offsets[f] + 1; c + 1 < mesh_.offsets[f + 1]; ++c)
        triangles.push_back({mesh_.indices[mesh_.offsets[f]], mesh_.indices[c], mesh_.indices[c + 1]});
    struct Pull {
      Triangle vertices;
      std::array<double, 3> weights;
      Vec3 normal, way;
      double area = 0;
    };
    std::vector<Pull> pulls(samples_of_a_triangle * triangles.size());
    for_all(static_cast<std::int64_t>(pulls.size()), [&](std::int64_t i) {
      const Triangle& t = triangles[i / samples_of_a_triangle];
      const auto [a, b] = r2_in_triangle(i);
      const std::array<double, 3> weights = {1 - a - b, a, b};
      const Vec3 at = weights[0] * mesh_.points[t[0]] + weights[1] * mesh_.points[t[1]] + weights[2] * mesh_.points[t[2]];
      const Vec3 area = area_vector(mesh_.points, t);
      const ClosestPoint closest = query_.closest(at);
      const Triangle& on = surface_.triangles[closest.face];
      Vec3 to = Vec3::Zero();
      for (int p = 0; p < 3; ++p) to += closest.weights[p] * surface_.points[on[p]];
      const Vec3 normal = area_vector(surface_.points, on).normalized();
      // A fold looks the other way: it is drawn to the surface whichever way that looks.
      const bool same = normal.dot(area) > unfolded * area.norm();
      pulls[i] = {t, weights, same ? normal : Vec3(Vec3::Zero()), to - at, area.norm()};
    });
    double total = 0;
    for (const Pull& pull : pulls) total += pull.area;
    for (const Pull& pull : pulls) {
      const double weight = 0.5 * pull.area / total;
      for (int p = 0; p < 3; ++p) errors_[pull.vertices[p]] += weight * pull.weights[p] * pull.way.squaredNorm();
      equations_.add(pull.vertices, pull.weights, weight * metric(pull.normal, pull.way), pull.way);
    }
  }

  // Of each coefficient, over the vertices.
  Columns penalties(bool sparse, double times) const {
    const double mean = 1.0 / static_cast<double>(given_.size());
    Columns cost = Columns::Zero(coefficients_.rows(), 3);
    int level = 1;
    for (Eigen::Index row = chain_.part(1); row < cost.rows(); ++row)
      for (int c = 0; c < 3; ++c) {
        while (row >= chain_.part(level + 1)) ++level;
        const double squared = coefficients_(row, c) * coefficients_(row, c);
        cost(row, c) = options_.across_details;
        // Bits grow as the logarithm. All of a large one's square would pull vertices around what is small and bent, where they fold.
        if (c > 0 && chain_.slides(row)) {
          const double large = options_.large_along * options_.large_along;
          cost(row, c) = options_.along_details * large / (squared + large);
        }
        cost(row, c) *= std::pow(options_.coarser, chain_.depth() - level);
        if (!sparse || options_.sparse == 0) continue;
        // The square that touches y^2 e^2 / (y^2 + e^2) where y is now (iteratively reweighted least squares).
        const double e = options_.sparse * options_.sparse;
        cost(row, c) += 2 * (e / (squared + e)) * (e / (squared + e));
      }
    return times * mean * cost;
  }

  // Gauss-Newton: the least squares of the coefficients in the first `free` rows, by conjugate gradients.
  void solve(Eigen::Index free, const Columns& cost) {
    const double mean = 1.0 / static_cast<double>(given_.size());
    const double caution = options_.caution * mean;
    Columns precondition(coefficients_.rows(), 3);
    for (Eigen::Index row = 0; row < precondition.rows(); ++row)
      for (int c = 0; c < 3; ++c) {
        const double held = !chain_.slides(row) ? 0.5 : c == 0 ? 1 : options_.along_surface;
        precondition(row, c) = row < free ? 1 / (mean * held + cost(row, c) + caution) : 0;
      }
    Columns right(static_cast<Eigen::Index>(given_.size()), 3);
    for (Eigen::Index v = 0; v < right.rows(); ++v) right.row(v) = equations_.right[v].transpose();
    Columns residual = chain_.transposed_product(right) - cost.cwiseProduct(coefficients_);
    Columns z = precondition.cwiseProduct(residual), direction = z;
    double rho = residual.cwiseProduct(z).sum();
    const double first = rho;
    for (int i = 0; i < options_.iterations && rho > 1e-8 * first; ++i) {
      progress_.check();
      const Columns image =
          chain_.transposed_product(equations_.product(chain_.product(direction))) + cost.cwiseProduct(direction) + caution * direction;
      const double curvature = direction.cwiseProduct(image).sum();
      if (!(curvature > 0)) break;
      coefficients_ += rho / curvature * direction;
      residual -= rho / curvature * image;
      z = precondition.cwiseProduct(residual);
      const double fresh = residual.cwiseProduct(z).sum();
      direction = z + fresh / rho * direction;
      rho = fresh;
    }
  }

  const RateFitOptions& options_;
  const Progress& progress_;
  QuadMesh mesh_;
  const Placement placement_;
  const Surface surface_;
  const SurfaceDistanceQuery query_;
  LevelChain chain_;
  Equations equations_;
  const std::vector<char> held_;
  std::vector<Vec3> given_;  // the mesh's points before
  std::vector<FitSample> samples_;
  std::vector<FitAnchor> homes_;               // of the samples on the given mesh
  std::vector<int> home_faces_;                // ... and the faces that these are on
  std::vector<double> errors_, errors_given_;  // mean square distances, as parts of them at each vertex: now, of the given mesh
  Columns coefficients_;
};

}  // namespace

QuadMesh fit_for_rate(const HybridMesh& hierarchy, const PolygonSoup& surface, const RateFitOptions& options, const Progress& progress) {
  return RateFit(hierarchy, surface, options, progress).run();
}

bool lies_on(const QuadMesh& mesh, const PolygonSoup& surface, const Progress& progress) {
  progress.check();
  std::vector<FitSample> samples = even_samples(Surface(surface, Placement()), std::max<std::int64_t>(least_samples, 2 * mesh.face_count()));
  find_faces(mesh, samples);
  const std::vector<double> squared = squared_distances(mesh, samples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double longest = 0;
    const std::size_t f = samples[i].face;
    for (std::int64_t c = mesh.offsets[f]; c < mesh.offsets[f + 1]; ++c)
      longest = std::max(longest, (mesh.points[mesh.indices[c]] - mesh.points[mesh.indices[mesh.offsets[f]]]).squaredNorm());
    if (squared[i] > longest) return false;
  }
  return true;
}

}  // namespace hybrid_mesh
