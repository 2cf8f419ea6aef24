// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/harmonic_extension.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

// The equations of the unknown values that a known one reaches.
struct HarmonicSystem {
  std::vector<int> reached;                  // in the order of the equations
  std::vector<int> row;                      // of each value: its equation, -1
  std::vector<std::vector<int>> neighbours;  // of unknown values
  int unknown = 0;                           // all of them
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;

  HarmonicSystem(const std::vector<std::array<int, 2>>& edges, const std::vector<Known>& known) : row(known.size(), -1), neighbours(known.size()) {
    for (const auto& [a, b] : edges) {
      if (a == b || known[a] == Known::Absent || known[b] == Known::Absent) continue;
      if (known[a] == Known::No) neighbours[a].push_back(b);
      if (known[b] == Known::No) neighbours[b].push_back(a);
    }
    find_reached(known);
    if (!reached.empty()) factorize(known);
  }

 private:
  void reach(int v) {
    if (row[v] >= 0) return;
    row[v] = static_cast<int>(reached.size());
    reached.push_back(v);
  }
  void find_reached(const std::vector<Known>& known) {
    for (int v = 0; v < static_cast<int>(known.size()); ++v) {
      if (known[v] != Known::No) continue;
      ++unknown;
      for (const int w : neighbours[v])
        if (known[w] == Known::Yes) reach(v);
    }
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (const int w : neighbours[reached[i]])
        if (known[w] == Known::No) reach(w);
  }
  void factorize(const std::vector<Known>& known) {
    const auto size = static_cast<Eigen::Index>(reached.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index i = 0; i < size; ++i) {
      const std::vector<int>& around = neighbours[reached[i]];
      entries.emplace_back(i, i, static_cast<double>(around.size()));
      for (const int w : around)
        if (known[w] != Known::Yes) entries.emplace_back(i, row[w], -1.0);
    }
    Eigen::SparseMatrix<double> laplacian(size, size);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    solver.compute(laplacian);
    if (solver.info() != Eigen::Success) throw Error(ErrorCode::Internal, "the harmonic extension has no solution");
  }
};

}  // namespace

int extend_harmonically(const std::vector<std::array<int, 2>>& edges, const std::vector<Known>& known, std::vector<Vec3>& values) {
  const HarmonicSystem system(edges, known);
  const auto size = static_cast<Eigen::Index>(system.reached.size());
  if (size == 0) return system.unknown;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(size, 3);
  for (Eigen::Index i = 0; i < size; ++i)
    for (const int w : system.neighbours[system.reached[i]])
      if (known[w] == Known::Yes) right.row(i) += values[w].transpose();
  const Eigen::MatrixX3d solution = system.solver.solve(right);
  for (Eigen::Index i = 0; i < size; ++i) values[system.reached[i]] = solution.row(i).transpose();
  return system.unknown - static_cast<int>(size);
}

Eigen::SparseMatrix<double, Eigen::RowMajor> harmonic_extension(const std::vector<std::array<int, 2>>& edges, const std::vector<Known>& known) {
  const HarmonicSystem system(edges, known);
  const auto count = static_cast<Eigen::Index>(known.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < count; ++v)
    if (known[v] == Known::Yes) entries.emplace_back(v, v, 1.0);
  std::vector<std::vector<int>> reaches(known.size());  // of each known value: the equations that it is in, once for each edge
  for (const int v : system.reached)
    for (const int w : system.neighbours[v])
      if (known[w] == Known::Yes) reaches[w].push_back(system.row[v]);
  // A column at a time: most are zero nearly everywhere, since an operation's vertices depend on those around it alone.
  Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.reached.size()));
  for (std::size_t w = 0; w < reaches.size(); ++w) {
    if (reaches[w].empty()) continue;
    for (const int equation : reaches[w]) right[equation] += 1;
    const Eigen::VectorXd solution = system.solver.solve(right);
    for (const int equation : reaches[w]) right[equation] = 0;
    for (Eigen::Index i = 0; i < solution.size(); ++i)
      if (solution[i] != 0) entries.emplace_back(system.reached[i], static_cast<Eigen::Index>(w), solution[i]);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace hybrid_mesh
