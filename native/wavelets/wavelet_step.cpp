// SPDX-License-Identifier: GPL-3.0-or-later
#include "wavelets/wavelet_step.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "hierarchy/vertex_index.h"
#include "subdivision/harmonic_extension.h"
#include "wavelets/level_prediction.h"
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

// Of the vertices of M^j that are made of refined quads there is a row each, in the order of StepMatrix::fine. The unknowns of analysis have the same
// order: the row of a corner stands for its coarse vertex, that of a midpoint or centre for its detail.
struct WaveletStep::Parts {
  std::shared_ptr<const QuadMesh> coarse, fine;
  LevelPrediction prediction;  // of the fine mesh
  WaveletFilters filters;
  std::vector<int> unknown_of;  // #coarse: row of the vertex, -1
  std::vector<DetailVertex> details;
  std::vector<int> detail_of;                  // #rows: -1
  std::vector<Known> known;                    // #fine: all but an operation's vertices; empty if there are none of these
  std::vector<std::array<int, 2>> edges;       // of the operations' quads, if they have vertices
  std::vector<LevelPrediction::Mean> closing;  // of the coarse mesh, which the fine one does not determine
  // Rows of coarse vertices that an operation takes away, and the coarse vertices around each, which may be of that kind, too.
  std::vector<LevelPrediction::Mean> taken;

  Parts(const HybridMesh& hierarchy, int level, std::shared_ptr<const QuadMesh> coarse, std::shared_ptr<const QuadMesh> fine, BoundaryRule boundary);
  // Of analysis, which no reader of a stream needs: made when it is asked for.
  const SquareSystem& system() const;
  void find_details();
  void find_operations(const HybridMesh& hierarchy, int level);
  void sort_coarse_vertices(const HybridMesh& hierarchy);
  // Calls body(vertex, detail, row, column, value) for the entries of W where there are a vertex and a detail that is wanted, by ascending column.
  template <class Wanted, class Body>
  void for_filters(const Wanted& wanted, const Body& body) const {
    for (int column = prediction.step.corners; column < static_cast<int>(detail_of.size()); ++column) {
      const int detail = detail_of[column];
      if (detail < 0 || !wanted(detail)) continue;
      for (std::size_t e = filters.first[column]; e < filters.first[column + 1]; ++e) {
        const auto& [row, value] = filters.entries[e];
        if (const int vertex = prediction.vertex_at[row]; vertex >= 0) body(vertex, detail, row, column, value);
      }
    }
  }
  template <class Body>
  void for_filters(const Body& body) const {
    for_filters([](int) { return true; }, body);
  }
  SparseRows equations() const;
  Columns right_side(const std::vector<Vec3>& fine, const std::vector<Vec3>& coarse, const Vec3& centre) const;
  // Puts the operations' vertices in the harmonic extension of the others.
  void extend(std::vector<Vec3>& points) const;

 private:
  mutable std::once_flag system_made_;
  mutable std::optional<SquareSystem> system_;
};

WaveletStep::Parts::Parts(const HybridMesh& hierarchy, int level, std::shared_ptr<const QuadMesh> coarse_mesh,
                          std::shared_ptr<const QuadMesh> fine_mesh, BoundaryRule boundary)
    : coarse(std::move(coarse_mesh)),
      fine(std::move(fine_mesh)),
      prediction(hierarchy, *coarse, *fine, level, boundary),
      filters(wavelet_filters(hierarchy, prediction.step)) {
  find_details();
  find_operations(hierarchy, level);
  sort_coarse_vertices(hierarchy);
}

const SquareSystem& WaveletStep::Parts::system() const {
  std::call_once(system_made_, [&] { system_.emplace(equations()); });
  return *system_;
}

void WaveletStep::Parts::find_details() {
  const StepMatrix& step = prediction.step;
  for (int r = step.corners; r < static_cast<int>(step.fine.size()); ++r)
    if (prediction.vertex_at[r] >= 0)
      details.push_back({prediction.vertex_at[r], r < step.corners + step.midpoints ? DetailKind::Edge : DetailKind::Face});
  for (const int v : prediction.inserted) details.push_back({v, DetailKind::Inserted});
  for (const LevelPrediction::Mean& mean : prediction.closing) details.push_back({mean.vertex, DetailKind::Closing});
  std::sort(details.begin(), details.end(), [](const DetailVertex& a, const DetailVertex& b) { return a.vertex < b.vertex; });
  std::vector<int> at(fine->vertex_count(), -1);
  for (std::size_t d = 0; d < details.size(); ++d) at[details[d].vertex] = static_cast<int>(d);
  for (const int v : prediction.vertex_at) detail_of.push_back(v < 0 ? -1 : at[v]);
}

void WaveletStep::Parts::find_operations(const HybridMesh& hierarchy, int level) {
  if (prediction.inserted.empty()) return;
  known.assign(fine->vertex_count(), Known::Yes);
  for (const int v : prediction.inserted) known[v] = Known::No;
  const VertexIndex find(fine->vertex);
  for (int o = 0; o < hierarchy.operation_count(); ++o) {
    const HybridMesh::Operation& operation = hierarchy.operation(o);
    if (!operation.enabled || operation.repatch.level != level) continue;
    for (const int root : operation.roots)
      for (int i = 0; i < 4; ++i) edges.push_back({find(hierarchy.corner(root, i)), find(hierarchy.corner(root, (i + 1) % 4))});
  }
}

void WaveletStep::Parts::sort_coarse_vertices(const HybridMesh& hierarchy) {
  const StepMatrix& step = prediction.step;
  const VertexIndex find(coarse->vertex);
  unknown_of.assign(coarse->vertex_count(), -1);
  std::vector<char> determined(coarse->vertex_count(), 0);
  for (const auto& [c, v] : prediction.stays) determined[c] = 1;
  for (int r = 0; r < step.corners; ++r) unknown_of[step.parent[r]] = r;
  for (int c = 0; c < static_cast<int>(coarse->vertex_count()); ++c)
    if (unknown_of[c] < 0 && !determined[c]) closing.push_back({c, vertices_closed(hierarchy, find, coarse->vertex[c])});
  for (int r = 0; r < step.corners; ++r)
    if (prediction.vertex_at[r] < 0) taken.push_back({r, {}});
  if (taken.empty()) return;
  // An operation that takes a vertex away takes all quads around it, so that all coarse quads around it are refined.
  std::vector<std::vector<int>> around(coarse->vertex_count());
  for (const int node : step.refined)
    for (int i = 0; i < 4; ++i) {
      const int a = find(hierarchy.corner(node, i)), b = find(hierarchy.corner(node, (i + 1) % 4));
      if (prediction.vertex_at[unknown_of[a]] < 0) around[a].push_back(b);
      if (prediction.vertex_at[unknown_of[b]] < 0) around[b].push_back(a);
    }
  for (auto& [row, of] : taken) of = std::move(around[step.parent[row]]);
}

SparseRows WaveletStep::Parts::equations() const {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(prediction.step.weights.nonZeros() + filters.entries.size());
  const auto size = static_cast<int>(prediction.step.fine.size());
  for (int r = 0; r < size; ++r) {
    if (prediction.vertex_at[r] < 0) {
      entries.emplace_back(r, r, 1.0);
      continue;
    }
    for (SparseRows::InnerIterator entry(prediction.step.weights, r); entry; ++entry)
      if (const int unknown = unknown_of[entry.col()]; unknown >= 0) entries.emplace_back(r, unknown, entry.value());
  }
  for_filters([&](int, int, int row, int column, double value) { entries.emplace_back(row, column, value); });
  for (const auto& [row, around] : taken)
    for (const int c : around) entries.emplace_back(row, unknown_of[c], -1.0 / static_cast<double>(around.size()));
  SparseRows matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Numbers are smallest, and rounding least, around the centre.
Columns WaveletStep::Parts::right_side(const std::vector<Vec3>& fine_points, const std::vector<Vec3>& coarse_points, const Vec3& centre) const {
  Columns right = Columns::Zero(static_cast<Eigen::Index>(prediction.vertex_at.size()), 3);
  for (std::size_t r = 0; r < prediction.vertex_at.size(); ++r) {
    if (prediction.vertex_at[r] < 0) continue;
    const auto row = static_cast<Eigen::Index>(r);
    right.row(row) = (fine_points[prediction.vertex_at[r]] - centre).transpose();
    for (SparseRows::InnerIterator entry(prediction.step.weights, row); entry; ++entry)
      if (unknown_of[entry.col()] < 0) right.row(row) -= entry.value() * (coarse_points[entry.col()] - centre).transpose();
  }
  return right;
}

void WaveletStep::Parts::extend(std::vector<Vec3>& points) const {
  if (prediction.inserted.empty()) return;
  for (const int v : prediction.inserted) points[v].setZero();
  extend_harmonically(edges, known, points);
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
const std::vector<DetailVertex>& WaveletStep::details() const { return parts_->details; }

std::vector<Vec3> WaveletStep::synthesise(const LevelAnalysis& analysis) const {
  return detailed(subdivided(analysis.coarse), analysis.details, analysis.remainder);
}

std::vector<Vec3> WaveletStep::subdivided(const std::vector<Vec3>& coarse) const {
  check_points(coarse, parts_->coarse->vertex_count(), "coarse positions");
  std::vector<Vec3> fine = parts_->prediction.regular(coarse);
  parts_->extend(fine);
  parts_->prediction.close(fine);
  return fine;
}

std::vector<Vec3> WaveletStep::detailed(std::vector<Vec3> fine, const std::vector<Vec3>& details, const std::vector<Vec3>& remainder) const {
  const Parts& parts = *parts_;
  check_points(fine, parts.fine->vertex_count(), "fine positions");
  check_points(details, parts.details.size(), "details");
  if (!remainder.empty()) check_points(remainder, parts.fine->vertex_count(), "remainders");
  const auto add_details = [&](DetailKind kind) {
    for (std::size_t d = 0; d < details.size(); ++d)
      if (parts.details[d].kind == kind) fine[parts.details[d].vertex] += details[d];
  };
  // Each vertex has its sum in the order of the columns.
  parts.for_filters([&](int detail) { return details[detail] != Vec3::Zero(); },
                    [&](int vertex, int detail, int, int, double value) { fine[vertex] += value * details[detail]; });
  for (std::size_t v = 0; v < remainder.size(); ++v) fine[v] += remainder[v];
  parts.extend(fine);
  add_details(DetailKind::Inserted);
  parts.prediction.close(fine);
  add_details(DetailKind::Closing);
  return fine;
}

SparseRows WaveletStep::synthesis() const {
  const Parts& parts = *parts_;
  const auto rows = static_cast<Eigen::Index>(parts.fine->vertex_count()), first = static_cast<Eigen::Index>(parts.coarse->vertex_count());
  const Eigen::Index columns = first + static_cast<Eigen::Index>(parts.details.size());
  const auto matrix_of = [](Eigen::Index height, Eigen::Index width, const std::vector<Eigen::Triplet<double>>& entries) {
    SparseRows matrix(height, width);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  };
  std::vector<Eigen::Triplet<double>> refined, inserted, closed, closing;
  for (const auto& [c, v] : parts.prediction.stays) refined.emplace_back(v, c, 1.0);
  for (std::size_t r = 0; r < parts.prediction.vertex_at.size(); ++r) {
    const int v = parts.prediction.vertex_at[r];
    if (v < 0) continue;
    for (SparseRows::InnerIterator entry(parts.prediction.step.weights, static_cast<Eigen::Index>(r)); entry; ++entry)
      refined.emplace_back(v, entry.col(), entry.value());
  }
  parts.for_filters([&](int vertex, int detail, int, int, double value) { refined.emplace_back(vertex, first + detail, value); });
  for (std::size_t d = 0; d < parts.details.size(); ++d) {
    const auto& [v, kind] = parts.details[d];
    if (kind == DetailKind::Inserted) inserted.emplace_back(v, first + static_cast<Eigen::Index>(d), 1.0);
    if (kind == DetailKind::Closing) closing.emplace_back(v, first + static_cast<Eigen::Index>(d), 1.0);
  }
  std::vector<char> is_closing(parts.fine->vertex_count(), 0);
  for (const LevelPrediction::Mean& mean : parts.prediction.closing) {
    is_closing[mean.vertex] = 1;
    for (const int v : mean.of) closed.emplace_back(mean.vertex, v, 1.0 / static_cast<double>(mean.of.size()));
  }
  for (Eigen::Index v = 0; v < rows; ++v)
    if (!is_closing[v]) closed.emplace_back(v, v, 1.0);
  SparseRows matrix = matrix_of(rows, columns, refined);
  if (!inserted.empty()) matrix = SparseRows(harmonic_extension(parts.edges, parts.known) * matrix) + matrix_of(rows, columns, inserted);
  if (!closing.empty()) matrix = SparseRows(matrix_of(rows, rows, closed) * matrix) + matrix_of(rows, columns, closing);
  return matrix;
}

LevelAnalysis WaveletStep::analyse(const std::vector<Vec3>& fine) const {
  const Parts& parts = *parts_;
  check_points(fine, parts.fine->vertex_count(), "positions");
  LevelAnalysis result;
  result.coarse.assign(parts.coarse->vertex_count(), Vec3::Zero());
  result.details.assign(parts.details.size(), Vec3::Zero());
  for (const auto& [c, v] : parts.prediction.stays) result.coarse[c] = fine[v];
  std::vector<Vec3> predicted = fine;
  parts.extend(predicted);
  for (const LevelPrediction::Mean& mean : parts.prediction.closing) predicted[mean.vertex] = mean_of(fine, mean.of);
  for (std::size_t d = 0; d < parts.details.size(); ++d)
    if (const auto& [v, kind] = parts.details[d]; kind == DetailKind::Inserted || kind == DetailKind::Closing)
      result.details[d] = fine[v] - predicted[v];

  Vec3 centre = Vec3::Zero();
  for (const Vec3& point : fine) centre += point / static_cast<double>(fine.size());
  const Columns right = parts.right_side(fine, result.coarse, centre);
  Columns guess = Columns::Zero(right.rows(), 3);
  for (int r = 0; r < parts.prediction.step.corners; ++r)
    if (parts.prediction.vertex_at[r] >= 0) guess.row(r) = (fine[parts.prediction.vertex_at[r]] - centre).transpose();
  const auto [solution, residual] = parts.system().solve(right, guess, analysis_accuracy);
  for (int r = 0; r < static_cast<int>(parts.prediction.vertex_at.size()); ++r) {
    const Vec3 value = solution.row(r).transpose();
    if (r < parts.prediction.step.corners)
      result.coarse[parts.prediction.step.parent[r]] = value + centre;
    else if (parts.detail_of[r] >= 0)
      result.details[parts.detail_of[r]] = value;
  }
  if (residual.rows() > 0) result.remainder.assign(fine.size(), Vec3::Zero());
  for (int r = 0; r < residual.rows(); ++r)
    if (parts.prediction.vertex_at[r] >= 0) result.remainder[parts.prediction.vertex_at[r]] = residual.row(r).transpose();
  for (const LevelPrediction::Mean& mean : parts.closing) result.coarse[mean.vertex] = mean_of(result.coarse, mean.of);
  return result;
}

}  // namespace hybrid_mesh
