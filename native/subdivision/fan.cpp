// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/fan.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "subdivision/masks.h"

namespace hybrid_mesh {

namespace {

// Fans side by side as one mesh. Of each, the vertex comes first, then the ends of the spokes, then the opposite corners; the spokes are its first
// edges.
class FanMesh {
 public:
  FanMesh(const std::vector<const Fan*>& fans, BoundaryRule boundary) {
    topology_.boundary = boundary;
    for (const Fan* fan : fans) add(*fan);
  }

  const QuadTopology& topology() const { return topology_; }
  const std::vector<Vec3>& points() const { return points_; }
  int centre(std::size_t fan) const { return first_[fan].vertex; }
  int first_edge(std::size_t fan) const { return first_[fan].edge; }
  int first_face(std::size_t fan) const { return first_[fan].face; }

 private:
  void add(const Fan& fan) {
    const int centre = topology_.vertex_count, spokes = fan.spoke_count();
    first_.push_back({centre, topology_.edge_count(), topology_.face_count()});
    points_.push_back(fan.centre);
    points_.insert(points_.end(), fan.ends.begin(), fan.ends.end());
    points_.insert(points_.end(), fan.opposites.begin(), fan.opposites.end());
    topology_.vertex_count += 1 + spokes + fan.face_count;
    topology_.vertex_sharpness.resize(topology_.vertex_count, 0);
    topology_.vertex_sharpness[centre] = fan.vertex_sharpness;
    for (int i = 0; i < spokes; ++i) topology_.edge_sharpness[topology_.add_edge(centre, centre + 1 + i) / 2] = fan.edge_sharpness[i];
    const int spoke = 2 * first_.back().edge;
    for (int i = 0; i < fan.face_count; ++i) {
      const int opposite = centre + 1 + spokes + i;
      const int out = topology_.add_edge(centre + 1 + i, opposite), back = topology_.add_edge(opposite, centre + 1 + fan.next(i));
      topology_.add_face({spoke + 2 * i, out, back, (spoke + 2 * fan.next(i)) ^ 1});
    }
  }

  struct First {
    int vertex, edge, face;
  };
  QuadTopology topology_;
  std::vector<Vec3> points_;
  std::vector<First> first_;
};

using Matrix = Eigen::MatrixXd;
using Row = Eigen::RowVectorXd;

// What one step of subdivision does to the points of a closed fan: centre, ends, opposite corners.
Matrix subdivision_matrix(const Fan& shape) {
  const int n = shape.face_count, size = 2 * n + 1;
  Matrix matrix(size, size);
  const auto point = [&](Fan& fan, int i) -> Vec3& { return i == 0 ? fan.centre : i <= n ? fan.ends[i - 1] : fan.opposites[i - 1 - n]; };
  for (int column = 0; column < size; column += 3) {
    const int width = std::min(3, size - column);
    Fan fan = shape;
    for (int i = 0; i < size; ++i) point(fan, i).setZero();
    for (int k = 0; k < width; ++k) point(fan, column + k)[k] = 1;
    std::vector<Fan*> fans{&fan};
    refine(fans, BoundaryRule::EdgesOnly);
    for (int i = 0; i < size; ++i) matrix.row(i).segment(column, width) = point(fan, i).head(width).transpose();
  }
  return matrix;
}

}  // namespace

Fan fan_of(const QuadTopology& topology, const VertexFans& fans, int vertex, const std::vector<Vec3>& points) {
  Fan fan;
  fan.face_count = fans.face_count(vertex);
  fan.open = fans.is_open(vertex);
  fan.vertex_sharpness = topology.vertex_sharpness[vertex];
  fan.centre = points[vertex];
  for (int i = 0; i < fans.spoke_count(vertex); ++i) {
    const int spoke = fans.spoke(vertex, i);
    fan.edge_sharpness.push_back(topology.is_boundary(spoke >> 1) ? infinite_sharpness : topology.edge_sharpness[spoke >> 1]);
    fan.ends.push_back(points[topology.to(spoke)]);
  }
  for (int i = 0; i < fan.face_count; ++i) {
    const int corner = fans.corner(vertex, i);
    fan.opposites.push_back(points[topology.corners[corner / 4][(corner + 2) % 4]]);
  }
  return fan;
}

Fan part_of(const Fan& fan, int begin, int face_count) {
  Fan part;
  part.face_count = face_count;
  part.open = true;
  part.centre = fan.centre;
  int spoke = begin;
  for (int i = 0; i < face_count; ++i, spoke = fan.next(spoke)) {
    part.ends.push_back(fan.ends[spoke]);
    part.edge_sharpness.push_back(i == 0 ? infinite_sharpness : fan.edge_sharpness[spoke]);
    part.opposites.push_back(fan.opposites[spoke]);
  }
  part.ends.push_back(fan.ends[spoke]);
  part.edge_sharpness.push_back(infinite_sharpness);
  return part;
}

void refine(std::vector<Fan*>& fans, BoundaryRule boundary) {
  const FanMesh mesh({fans.begin(), fans.end()}, boundary);
  const RefinedPoints refined = refine_points(mesh.topology(), VertexFans(mesh.topology()), mesh.points());
  for (std::size_t f = 0; f < fans.size(); ++f) {
    Fan& fan = *fans[f];
    fan.centre = refined.vertices[mesh.centre(f)];
    for (int i = 0; i < fan.spoke_count(); ++i) fan.ends[i] = refined.edges[mesh.first_edge(f) + i];
    for (int i = 0; i < fan.face_count; ++i) fan.opposites[i] = refined.faces[mesh.first_face(f) + i];
    fan.vertex_sharpness = refined_sharpness(fan.vertex_sharpness);
    for (float& sharpness : fan.edge_sharpness) sharpness = refined_sharpness(sharpness);
  }
}

std::vector<VertexLimit> limits_of(const std::vector<Fan>& fans, BoundaryRule boundary) {
  if (fans.empty()) return {};
  std::vector<const Fan*> pointers;
  for (const Fan& fan : fans) pointers.push_back(&fan);
  const FanMesh mesh(pointers, boundary);
  const LimitPoints limit = limit_points(mesh.topology(), VertexFans(mesh.topology()), mesh.points());
  std::vector<VertexLimit> result;
  for (std::size_t f = 0; f < fans.size(); ++f) {
    const int v = mesh.centre(f);
    result.push_back({limit.points[v], limit.tangents[v], limit.cross_tangents[v]});
  }
  return result;
}

// The weights of the limit position and of the tangents are left eigenvectors of the subdivision matrix: that of 1, and the largest of those that the
// mirror at spoke 0 keeps and of those that it turns over. They come out of powers of the matrix.
VertexLimit limit_by_matrix(const Fan& fan) {
  constexpr int kSteps = 400;  // the ratio of one eigenvalue to the next is below 0.9 for up to ten faces
  const int n = fan.face_count, size = 2 * n + 1;
  const Matrix matrix = subdivision_matrix(fan);
  Row position = Row::Constant(size, 1.0 / size);
  for (int i = 0; i < kSteps; ++i) {
    position = position * matrix;
    position /= position.sum();
  }

  const auto mirrored = [&](const Row& row) {
    Row result = row;
    for (int i = 0; i < n; ++i) {
      result[1 + i] = row[1 + (n - i) % n];
      result[1 + n + i] = row[1 + n + (n - 1 - i)];
    }
    return result;
  };
  const auto tangent = [&](double (*wave)(double), double sign) {
    Row row = Row::Zero(size);
    for (int i = 0; i < n; ++i) {
      row[1 + i] = wave(2 * std::numbers::pi * i / n);
      row[1 + n + i] = wave(2 * std::numbers::pi * (i + 0.5) / n);
    }
    for (int i = 0; i < kSteps; ++i) {
      row = row * matrix;
      row = (0.5 * (row + sign * mirrored(row))).eval();
      row -= row.sum() * position;
      row.normalize();
    }
    return row;
  };
  const auto apply = [&](const Row& row) {
    Vec3 sum = row[0] * fan.centre;
    for (int i = 0; i < n; ++i) sum += row[1 + i] * fan.ends[i] + row[1 + n + i] * fan.opposites[i];
    return sum;
  };
  return {apply(position), apply(tangent([](double x) { return std::cos(x); }, 1)), apply(tangent([](double x) { return std::sin(x); }, -1))};
}

}  // namespace hybrid_mesh
