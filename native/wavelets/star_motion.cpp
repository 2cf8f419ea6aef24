// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Zorin, Schroeder, Sweldens, Interactive multiresolution mesh editing, 1997 (details in local frames).
#include "wavelets/star_motion.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "base/tolerances.h"

namespace hybrid_mesh {

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > tolerance::cancelled_normals * svd.singularValues()[0])) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d left = svd.matrixU();
  if (left.determinant() * svd.matrixV().determinant() < 0) left.col(2) = -left.col(2);
  return left * svd.matrixV().transpose();
}

// A star's normal with some tangents, as columns, and the sum of its edges' lengths.
struct VertexStars::Shape {
  Eigen::Matrix3d frame;
  double length = 0;
  bool valid = false;
};

VertexStars::VertexStars(const QuadMesh& mesh) : first_(mesh.vertex_count() + 1, 0), neighbours_(mesh.indices.size()) {
  for (const int v : mesh.indices) ++first_[v + 1];
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) first_[v + 1] += first_[v];
  std::vector<int> next = first_;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int64_t begin = mesh.offsets[f], count = mesh.offsets[f + 1] - begin;
    for (std::int64_t i = 0; i < count; ++i)
      neighbours_[next[mesh.indices[begin + i]]++] = {mesh.indices[begin + (i + 1) % count], mesh.indices[begin + (i + count - 1) % count]};
  }
}

bool VertexStars::any(const std::vector<char>& flags, int vertex) const {
  if (flags[vertex]) return true;
  for (int i = first_[vertex]; i < first_[vertex + 1]; ++i)
    if (flags[neighbours_[i][0]] || flags[neighbours_[i][1]]) return true;
  return false;
}

Motion VertexStars::motion(int vertex, const std::vector<Vec3>& before, const std::vector<Vec3>& after) const {
  const auto shape_of = [&](const std::vector<Vec3>& points) {
    Shape shape;
    Vec3 normal = Vec3::Zero();
    double area = 0;
    for (int i = first_[vertex]; i < first_[vertex + 1]; ++i) {
      const Vec3 next = points[neighbours_[i][0]] - points[vertex], previous = points[neighbours_[i][1]] - points[vertex];
      const Vec3 corner = next.cross(previous);
      normal += corner;
      area += corner.norm();
      shape.length += next.norm() + previous.norm();
    }
    shape.valid = normal.norm() > tolerance::cancelled_normals * area;
    if (!shape.valid) return shape;
    shape.frame.col(2) = normal.normalized();
    shape.frame.col(0) = shape.frame.col(2).unitOrthogonal();
    shape.frame.col(1) = shape.frame.col(2).cross(shape.frame.col(0));
    return shape;
  };
  const Shape old_shape = shape_of(before), new_shape = shape_of(after);
  Motion motion;
  if (old_shape.length > 0 && new_shape.length > 0) motion.scale = new_shape.length / old_shape.length;
  if (!old_shape.valid || !new_shape.valid) {
    // A fold: its edges alone tell how it turns, if they are not on one line.
    Eigen::Matrix3d pairs = Eigen::Matrix3d::Zero();
    for (int i = first_[vertex]; i < first_[vertex + 1]; ++i)
      for (const int neighbour : neighbours_[i]) pairs += (after[neighbour] - after[vertex]) * (before[neighbour] - before[vertex]).transpose();
    motion.rotation = nearest_rotation(pairs);
    return motion;
  }
  // Around the normal, as a complex number.
  double cosine = 0, sine = 0;
  for (int i = first_[vertex]; i < first_[vertex + 1]; ++i)
    for (const int neighbour : neighbours_[i]) {
      const Vec3 from = old_shape.frame.transpose() * (before[neighbour] - before[vertex]);
      const Vec3 to = new_shape.frame.transpose() * (after[neighbour] - after[vertex]);
      cosine += from.x() * to.x() + from.y() * to.y();
      sine += from.x() * to.y() - from.y() * to.x();
    }
  const double length = std::hypot(cosine, sine);
  if (!(length > 0)) return motion;
  Eigen::Matrix3d around = Eigen::Matrix3d::Identity();
  around.topLeftCorner<2, 2>() << cosine / length, -sine / length, sine / length, cosine / length;
  motion.rotation = new_shape.frame * around * old_shape.frame.transpose();
  return motion;
}

}  // namespace hybrid_mesh
