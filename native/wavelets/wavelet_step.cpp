// SPDX-License-Identifier: GPL-3.0-or-later
#include "wavelets/wavelet_step.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "hierarchy/flat_points.h"
#include "subdivision/harmonic_extension.h"
#include "wavelets/square_system.h"

namespace hybrid_mesh {

namespace {

// Of the largest coordinate, from the centre: what analysis leaves of an error. A remainder beyond it is kept.
constexpr double analysis_accuracy = 1e-13;

std::shared_ptr<const QuadMesh> shared_level(const HybridMesh& hierarchy, int level) {
  return std::make_shared<const QuadMesh>(hierarchy.level_mesh(level));
}

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

void check_points(const std::vector<Vec3>& points, std::size_t count, const std::string& what) {
  if (points.size() != count) refuse(std::to_string(points.size()) + " " + what + "; there must be " + std::to_string(count));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite()) refuse("number " + std::to_string(i) + " of the " + what + " is not finite");
}

}  // namespace

// Of the vertices of M^j that are made of refined quads there is a row each. The unknowns of analysis have the same order: the row of a corner stands
// for its coarse vertex, that of a midpoint or centre for its detail.
struct WaveletStep::Parts {
  std::shared_ptr<const QuadMesh> coarse, fine;
  LevelStep step;
  std::vector<int> unknown_of;                 // #coarse: row of the vertex, -1
  std::vector<LevelPrediction::Mean> closing;  // of the coarse mesh, which the fine one does not determine
  // Rows of coarse vertices that an operation takes away, and the coarse vertices around each, which may be of that kind, too.
  struct Taken {
    int row = -1;
    std::vector<int> around;
  };
  std::vector<Taken> taken;

  Parts(const HybridMesh& hierarchy, int level, std::shared_ptr<const QuadMesh> coarse, std::shared_ptr<const QuadMesh> fine, BoundaryRule boundary);
  const LevelPrediction& prediction() const { return step.prediction(); }
  const RefinedRows& rows() const { return prediction().rows(); }
  int vertex_at(int row) const { return prediction().vertex_at[row]; }
  // The coarse vertex of a corner's row.
  int parent(int row) const { return prediction().quads().in_mesh[rows().source(row)]; }
  // Of analysis, made when it is asked for.
  struct Equations {
    SparseRows subdivision;  // S
    SquareSystem system;
  };
  const Equations& equations() const;
  void sort_coarse_vertices(const HybridMesh& hierarchy);
  // W where there are a vertex and a detail.
  template <class Body>
  void for_wavelets(const Body& body) const {
    WaveletColumns columns = step.columns();
    for (int column = rows().corners(); column < rows().size(); ++column) {
      const int detail = step.detail_of()[column];
      if (detail < 0) continue;
      columns.for_entries(column, [&](int row, double value) {
        if (const int vertex = vertex_at(row); vertex >= 0) body(vertex, detail, row, column, value);
      });
    }
  }
  SparseRows square_matrix(const SparseRows& subdivision) const;
  Columns right_side(const SparseRows& subdivision, const std::vector<Vec3>& fine, const std::vector<Vec3>& coarse, const Vec3& centre) const;

 private:
  mutable std::once_flag equations_made_;
  mutable std::optional<Equations> equations_;
};

WaveletStep::Parts::Parts(const HybridMesh& hierarchy, int level, std::shared_ptr<const QuadMesh> coarse_mesh,
                          std::shared_ptr<const QuadMesh> fine_mesh, BoundaryRule boundary)
    : coarse(std::move(coarse_mesh)), fine(std::move(fine_mesh)), step(hierarchy, *coarse, *fine, level, boundary) {
  sort_coarse_vertices(hierarchy);
}

const WaveletStep::Parts::Equations& WaveletStep::Parts::equations() const {
  std::call_once(equations_made_, [&] {
    SparseRows subdivision = subdivision_matrix(prediction());
    SquareSystem system(square_matrix(subdivision));
    equations_.emplace(Equations{std::move(subdivision), std::move(system)});
  });
  return *equations_;
}

void WaveletStep::Parts::sort_coarse_vertices(const HybridMesh& hierarchy) {
  const VertexIndex find(coarse->vertex);
  unknown_of.assign(coarse->vertex_count(), -1);
  std::vector<char> determined(coarse->vertex_count(), 0);
  for (const auto& [c, v] : prediction().stays) determined[c] = 1;
  for (int r = 0; r < rows().corners(); ++r) unknown_of[parent(r)] = r;
  for (int c = 0; c < static_cast<int>(coarse->vertex_count()); ++c)
    if (unknown_of[c] < 0 && !determined[c]) closing.push_back(vertices_closed(hierarchy, find, coarse->vertex[c], c));
  for (int r = 0; r < rows().corners(); ++r)
    if (vertex_at(r) < 0) taken.push_back({r, {}});
  if (taken.empty()) return;
  // An operation that takes a vertex away takes all quads around it, so that all coarse quads around it are refined.
  std::vector<std::vector<int>> around(coarse->vertex_count());
  const LevelQuads& quads = prediction().quads();
  for (int q = 0; q < quads.quad_count(); ++q)
    for (int i = 0; i < 4 && rows().is_refined(q); ++i) {
      const int a = quads.in_mesh[quads.vertex[4 * q + i]], b = quads.in_mesh[quads.vertex[4 * q + (i + 1) % 4]];
      if (vertex_at(unknown_of[a]) < 0) around[a].push_back(b);
      if (vertex_at(unknown_of[b]) < 0) around[b].push_back(a);
    }
  for (Taken& vertex : taken) vertex.around = std::move(around[parent(vertex.row)]);
}

SparseRows WaveletStep::Parts::square_matrix(const SparseRows& subdivision) const {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(subdivision.nonZeros() + 25 * static_cast<std::size_t>(rows().size() - rows().corners()));
  for (int r = 0; r < rows().size(); ++r) {
    if (vertex_at(r) < 0) {
      entries.emplace_back(r, r, 1.0);
      continue;
    }
    for (SparseRows::InnerIterator entry(subdivision, r); entry; ++entry)
      if (const int unknown = unknown_of[entry.col()]; unknown >= 0) entries.emplace_back(r, unknown, entry.value());
  }
  for_wavelets([&](int, int, int row, int column, double value) { entries.emplace_back(row, column, value); });
  for (const auto& [row, around] : taken)
    for (const int c : around) entries.emplace_back(row, unknown_of[c], -1.0 / static_cast<double>(around.size()));
  SparseRows matrix(rows().size(), rows().size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Numbers are smallest, and rounding least, around the centre.
Columns WaveletStep::Parts::right_side(const SparseRows& subdivision, const std::vector<Vec3>& fine_points, const std::vector<Vec3>& coarse_points,
                                       const Vec3& centre) const {
  Columns right = Columns::Zero(rows().size(), 3);
  for (int r = 0; r < rows().size(); ++r) {
    if (vertex_at(r) < 0) continue;
    right.row(r) = (fine_points[vertex_at(r)] - centre).transpose();
    for (SparseRows::InnerIterator entry(subdivision, r); entry; ++entry)
      if (unknown_of[entry.col()] < 0) right.row(r) -= entry.value() * (coarse_points[entry.col()] - centre).transpose();
  }
  return right;
}

WaveletStep::WaveletStep(std::unique_ptr<const Parts> parts) : parts_(std::move(parts)) {}

WaveletStep::WaveletStep(const HybridMesh& hierarchy, int level, BoundaryRule boundary) {
  if (level < 1 || level > hierarchy.depth())
    refuse("there is no step to level " + std::to_string(level) + ": the hierarchy has levels 0 to " + std::to_string(hierarchy.depth()));
  parts_ = std::make_unique<const Parts>(hierarchy, level, shared_level(hierarchy, level - 1), shared_level(hierarchy, level), boundary);
}

std::vector<WaveletStep> wavelet_steps(const HybridMesh& hierarchy) {
  std::vector<WaveletStep> steps;
  std::shared_ptr<const QuadMesh> coarse = shared_level(hierarchy, 0);
  for (int level = 1, depth = hierarchy.depth(); level <= depth; ++level) {
    std::shared_ptr<const QuadMesh> fine = shared_level(hierarchy, level);
    steps.push_back(WaveletStep(std::make_unique<const WaveletStep::Parts>(hierarchy, level, std::move(coarse), fine, BoundaryRule::EdgesOnly)));
    coarse = std::move(fine);
  }
  return steps;
}

WaveletStep::~WaveletStep() = default;
WaveletStep::WaveletStep(WaveletStep&&) noexcept = default;
WaveletStep& WaveletStep::operator=(WaveletStep&&) noexcept = default;

const QuadMesh& WaveletStep::coarse() const { return *parts_->coarse; }
const QuadMesh& WaveletStep::fine() const { return *parts_->fine; }
const std::vector<DetailVertex>& WaveletStep::details() const { return parts_->step.details(); }

std::vector<Vec3> WaveletStep::synthesise(const LevelAnalysis& analysis) const {
  return detailed(subdivided(analysis.coarse), analysis.details, analysis.remainder);
}

std::vector<Vec3> WaveletStep::subdivided(const std::vector<Vec3>& coarse) const {
  check_points(coarse, parts_->coarse->vertex_count(), "coarse positions");
  std::vector<Point3> fine(parts_->fine->vertex_count());
  parts_->step.subdivided(flat_points(coarse).data(), fine.data());
  return vectors_of(fine);
}

std::vector<Vec3> WaveletStep::detailed(std::vector<Vec3> fine, const std::vector<Vec3>& details, const std::vector<Vec3>& remainder) const {
  const Parts& parts = *parts_;
  check_points(fine, parts.fine->vertex_count(), "fine positions");
  check_points(details, parts.step.details().size(), "details");
  if (!remainder.empty()) check_points(remainder, parts.fine->vertex_count(), "remainders");
  std::vector<Point3> points = flat_points(fine);
  parts.step.add_details(points.data(), flat_points(details).data(), remainder.empty() ? nullptr : flat_points(remainder).data());
  return vectors_of(points);
}

SparseRows WaveletStep::synthesis() const {
  const Parts& parts = *parts_;
  const auto rows = static_cast<Eigen::Index>(parts.fine->vertex_count()), first = static_cast<Eigen::Index>(parts.coarse->vertex_count());
  const std::vector<DetailVertex>& of = parts.step.details();
  const Eigen::Index columns = first + static_cast<Eigen::Index>(of.size());
  const auto matrix_of = [](Eigen::Index height, Eigen::Index width, const std::vector<Eigen::Triplet<double>>& entries) {
    SparseRows matrix(height, width);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  };
  std::vector<Eigen::Triplet<double>> refined, inserted, closed, closing;
  for (const auto& [c, v] : parts.prediction().stays) refined.emplace_back(v, c, 1.0);
  const SparseRows subdivision = subdivision_matrix(parts.prediction());
  for (int r = 0; r < parts.rows().size(); ++r)
    for (SparseRows::InnerIterator entry(subdivision, r); entry && parts.vertex_at(r) >= 0; ++entry)
      refined.emplace_back(parts.vertex_at(r), entry.col(), entry.value());
  parts.for_wavelets([&](int vertex, int detail, int, int, double value) { refined.emplace_back(vertex, first + detail, value); });
  for (std::size_t d = 0; d < of.size(); ++d) {
    const auto& [v, kind] = of[d];
    if (kind == DetailKind::Inserted) inserted.emplace_back(v, first + static_cast<Eigen::Index>(d), 1.0);
    if (kind == DetailKind::Closing) closing.emplace_back(v, first + static_cast<Eigen::Index>(d), 1.0);
  }
  std::vector<char> is_closing(parts.fine->vertex_count(), 0);
  for (const LevelPrediction::Mean& mean : parts.prediction().closing) {
    is_closing[mean.vertex] = 1;
    for (int i = 0; i < mean.count; ++i) closed.emplace_back(mean.vertex, mean.of[i], 1.0 / static_cast<double>(mean.count));
  }
  std::vector<char> is_known(parts.fine->vertex_count(), 1);
  for (const int v : parts.prediction().inserted) is_known[v] = 0;
  for (Eigen::Index v = 0; v < rows; ++v)
    if (!is_closing[v]) closed.emplace_back(v, v, 1.0);
  SparseRows matrix = matrix_of(rows, columns, refined);
  if (!inserted.empty()) matrix = SparseRows(harmonic_extension(*parts.step.extension(), is_known) * matrix) + matrix_of(rows, columns, inserted);
  if (!closing.empty()) matrix = SparseRows(matrix_of(rows, rows, closed) * matrix) + matrix_of(rows, columns, closing);
  return matrix;
}

LevelAnalysis WaveletStep::analyse(const std::vector<Vec3>& fine) const {
  const Parts& parts = *parts_;
  const std::vector<DetailVertex>& of = parts.step.details();
  check_points(fine, parts.fine->vertex_count(), "positions");
  LevelAnalysis result;
  result.coarse.assign(parts.coarse->vertex_count(), Vec3::Zero());
  result.details.assign(of.size(), Vec3::Zero());
  for (const auto& [c, v] : parts.prediction().stays) result.coarse[c] = fine[v];
  const std::vector<Point3> points = flat_points(fine);
  std::vector<Point3> predicted = points;
  parts.step.extend(predicted.data());
  for (const LevelPrediction::Mean& mean : parts.prediction().closing) predicted[mean.vertex] = mean_of(points.data(), mean);
  for (std::size_t d = 0; d < of.size(); ++d)
    if (const auto& [v, kind] = of[d]; kind == DetailKind::Inserted || kind == DetailKind::Closing)
      result.details[d] = fine[v] - Vec3(predicted[v].x, predicted[v].y, predicted[v].z);

  Vec3 centre = Vec3::Zero();
  for (const Vec3& point : fine) centre += point / static_cast<double>(fine.size());
  const Parts::Equations& equations = parts.equations();
  const Columns right = parts.right_side(equations.subdivision, fine, result.coarse, centre);
  Columns guess = Columns::Zero(right.rows(), 3);
  for (int r = 0; r < parts.rows().corners(); ++r)
    if (parts.vertex_at(r) >= 0) guess.row(r) = (fine[parts.vertex_at(r)] - centre).transpose();
  const auto [solution, residual] = equations.system.solve(right, guess, analysis_accuracy);
  for (int r = 0; r < parts.rows().size(); ++r) {
    const Vec3 value = solution.row(r).transpose();
    if (parts.rows().is_corner(r))
      result.coarse[parts.parent(r)] = value + centre;
    else if (parts.step.detail_of()[r] >= 0)
      result.details[parts.step.detail_of()[r]] = value;
  }
  if (residual.rows() > 0) result.remainder.assign(fine.size(), Vec3::Zero());
  for (int r = 0; r < residual.rows(); ++r)
    if (parts.vertex_at(r) >= 0) result.remainder[parts.vertex_at(r)] = residual.row(r).transpose();
  const std::vector<Point3> coarse = flat_points(result.coarse);
  for (const LevelPrediction::Mean& mean : parts.closing) {
    const Point3 middle = mean_of(coarse.data(), mean);
    result.coarse[mean.vertex] = Vec3(middle.x, middle.y, middle.z);
  }
  return result;
}

}  // namespace hybrid_mesh
