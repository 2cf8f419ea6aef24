// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/level_chain.h"

#include <utility>

#include "decoder/planes/coefficient_scale.h"
#include "decoder/transform/surface_frames.h"
#include "hierarchy/flat_points.h"

namespace hybrid_mesh {

namespace {

constexpr int base_kind = 2;  // its vertices are moved by what moves them alone, as corners are

Columns columns_of(const std::vector<Vec3>& points) {
  Columns columns(static_cast<Eigen::Index>(points.size()), 3);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) columns.row(i) = points[i].transpose();
  return columns;
}

std::vector<Vec3> points_of(const Columns& columns) {
  std::vector<Vec3> points;
  points.reserve(columns.rows());
  for (Eigen::Index i = 0; i < columns.rows(); ++i) points.emplace_back(columns.row(i).transpose());
  return points;
}

LevelChain::Axes axes_of(const Frame& frame) {
  LevelChain::Axes axes;
  for (int i = 0; i < 3; ++i) axes[i] = Vec3(frame[i].x, frame[i].y, frame[i].z);
  return axes;
}

Vec3 turned_in(const LevelChain::Axes& frame, const Vec3& v) { return {frame[0].dot(v), frame[1].dot(v), frame[2].dot(v)}; }
Vec3 turned_out(const LevelChain::Axes& frame, const Vec3& c) { return c[0] * frame[0] + c[1] * frame[1] + c[2] * frame[2]; }

}  // namespace

LevelChain::LevelChain(const HybridMesh& hierarchy) : steps_(wavelet_steps(hierarchy)) {
  const int depth = hierarchy.depth();
  const auto add_part = [&](std::size_t rows) { first_.push_back(first_.back() + static_cast<Eigen::Index>(rows)); };
  first_.push_back(0);
  const std::size_t base = hierarchy.level_mesh(0).vertex_count();
  add_part(base);
  weight_.assign(base, coefficient_weight(base_kind, depth));
  slides_.assign(base, 0);
  for (int j = 1; j <= depth; ++j) {
    const WaveletStep& step = steps_[j - 1];
    matrix_.push_back(step.synthesis());
    transposed_.emplace_back(matrix_.back().transpose());
    add_part(step.details().size());
    for (const DetailVertex& detail : step.details()) {
      weight_.push_back(coefficient_weight(coefficient_kind(detail.kind), depth - j));
      slides_.push_back(detail.kind != DetailKind::Inserted);
    }
  }
  frames_.assign(weight_.size(), axes_of(coordinate_axes));
}

void LevelChain::set_frames(int level, const std::vector<Vec3>& subdivided) {
  const WaveletStep& step = steps_[level - 1];
  const std::vector<Point3> points = flat_points(subdivided);
  const SurfaceFrames frames(step.fine().offsets, step.fine().indices, points.data(), points.size());
  for (std::size_t d = 0; d < step.details().size(); ++d)
    if (const auto row = first_[level] + static_cast<Eigen::Index>(d); slides_[row]) frames_[row] = axes_of(frames(step.details()[d].vertex));
}

Columns LevelChain::details_of(const Columns& coefficients, int level) const {
  Columns details(first_[level + 1] - first_[level], 3);
  for (Eigen::Index d = 0; d < details.rows(); ++d) {
    const Eigen::Index row = first_[level] + d;
    details.row(d) = turned_out(frames_[row], coefficients.row(row).transpose()).transpose() / weight_[row];
  }
  return details;
}

Columns LevelChain::analyse(const std::vector<Vec3>& points) {
  std::vector<std::vector<Vec3>> levels(depth() + 1), details(depth() + 1);
  levels[depth()] = points;
  for (int j = depth(); j > 0; --j) {
    LevelAnalysis analysis = steps_[j - 1].analyse(levels[j]);
    levels[j - 1] = std::move(analysis.coarse);
    details[j] = std::move(analysis.details);
  }
  Columns coefficients(rows(), 3);
  coefficients.topRows(first_[1]) = weight_[0] * columns_of(levels[0]);
  for (int j = 1; j <= depth(); ++j) {
    set_frames(j, steps_[j - 1].subdivided(levels[j - 1]));
    for (Eigen::Index row = first_[j]; row < first_[j + 1]; ++row)
      coefficients.row(row) = weight_[row] * turned_in(frames_[row], details[j][row - first_[j]]).transpose();
  }
  return coefficients;
}

Columns LevelChain::reframed(const Columns& coefficients) {
  Columns result = coefficients;
  std::vector<Vec3> points = points_of(coefficients.topRows(first_[1]) / weight_[0]);
  for (int j = 1; j <= depth(); ++j) {
    const Columns details = details_of(coefficients, j);
    std::vector<Vec3> subdivided = steps_[j - 1].subdivided(points);
    set_frames(j, subdivided);
    for (Eigen::Index d = 0; d < details.rows(); ++d)
      result.row(first_[j] + d) = weight_[first_[j] + d] * turned_in(frames_[first_[j] + d], details.row(d).transpose()).transpose();
    points = steps_[j - 1].detailed(std::move(subdivided), points_of(details), {});
  }
  return result;
}

std::vector<Vec3> LevelChain::synthesise(const Columns& coefficients) const { return points_of(product(coefficients)); }

Columns LevelChain::product(const Columns& coefficients) const {
  Columns points = coefficients.topRows(first_[1]) / weight_[0];
  for (int j = 1; j <= depth(); ++j) {
    Columns both(points.rows() + first_[j + 1] - first_[j], 3);
    both << points, details_of(coefficients, j);
    points = matrix_[j - 1] * both;
  }
  return points;
}

Columns LevelChain::transposed_product(const Columns& points) const {
  Columns result(rows(), 3), fine = points;
  for (int j = depth(); j > 0; --j) {
    const Columns both = transposed_[j - 1] * fine;
    const Eigen::Index details = first_[j + 1] - first_[j], coarse = both.rows() - details;
    for (Eigen::Index d = 0; d < details; ++d) {
      const Eigen::Index row = first_[j] + d;
      result.row(row) = turned_in(frames_[row], both.row(coarse + d).transpose()).transpose() / weight_[row];
    }
    fine = both.topRows(coarse);
  }
  result.topRows(first_[1]) = fine / weight_[0];
  return result;
}

}  // namespace hybrid_mesh
