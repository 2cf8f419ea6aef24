// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/harmonic_extension.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "base/error.h"

namespace hybrid_mesh {

int extend_harmonically(const std::vector<std::array<int, 2>>& edges, const std::vector<Known>& known, std::vector<Vec3>& values) {
  // Values that a known one reaches.
  std::vector<int> row(values.size(), -1), queue;
  std::vector<std::vector<int>> neighbours(values.size());  // of unknown vertices
  for (const auto& [a, b] : edges) {
    if (a == b || known[a] == Known::Absent || known[b] == Known::Absent) continue;
    if (known[a] == Known::No) neighbours[a].push_back(b);
    if (known[b] == Known::No) neighbours[b].push_back(a);
  }
  const auto reach = [&](int v) {
    if (row[v] >= 0) return;
    row[v] = static_cast<int>(queue.size());
    queue.push_back(v);
  };
  int unknown = 0;
  for (int v = 0; v < static_cast<int>(known.size()); ++v) {
    if (known[v] != Known::No) continue;
    ++unknown;
    for (const int w : neighbours[v])
      if (known[w] == Known::Yes) reach(v);
  }
  for (std::size_t i = 0; i < queue.size(); ++i)
    for (const int w : neighbours[queue[i]])
      if (known[w] == Known::No) reach(w);
  if (queue.empty()) return unknown;

  const auto size = static_cast<Eigen::Index>(queue.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(size, 3);
  for (Eigen::Index i = 0; i < size; ++i) {
    const std::vector<int>& around = neighbours[queue[i]];
    entries.emplace_back(i, i, static_cast<double>(around.size()));
    for (const int w : around) {
      if (known[w] == Known::Yes)
        right.row(i) += values[w].transpose();
      else
        entries.emplace_back(i, row[w], -1.0);
    }
  }
  Eigen::SparseMatrix<double> laplacian(size, size);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  if (solver.info() != Eigen::Success) throw Error(ErrorCode::Internal, "the harmonic extension has no solution");
  const Eigen::MatrixX3d solution = solver.solve(right);
  for (Eigen::Index i = 0; i < size; ++i) values[queue[i]] = solution.row(i).transpose();
  return unknown - static_cast<int>(size);
}

}  // namespace hybrid_mesh
