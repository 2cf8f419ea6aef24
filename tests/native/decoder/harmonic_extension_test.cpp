// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/harmonic_extension.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <random>

#include "decoder/transform/minimum_degree.h"

namespace hybrid_mesh {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

Matrix random_laplacian(int size, int edges, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0);
  for (int e = 0; e < edges; ++e) {
    const int a = static_cast<int>(random() % size), b = (a + 1 + static_cast<int>(random() % 7)) % size;
    if (a == b) continue;
    for (const auto& [i, j, value] : {std::tuple(a, a, 1.0), std::tuple(b, b, 1.0), std::tuple(a, b, -1.0), std::tuple(b, a, -1.0)})
      entries.emplace_back(i, j, value);
  }
  Matrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Streams have been written with that order of elimination.
TEST(MinimumDegree, BreaksTiesAsEigenDoes) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const int size = 1 + static_cast<int>(seed % 61) * (seed % 5 == 0 ? 7 : 1);
    const Matrix matrix = random_laplacian(size, static_cast<int>(seed) * size / 60, seed);
    SymmetricPattern pattern;
    for (int j = 0; j < size; ++j) {
      for (Matrix::InnerIterator entry(matrix, j); entry; ++entry) pattern.row.push_back(static_cast<int>(entry.row()));
      pattern.first.push_back(static_cast<int>(pattern.row.size()));
    }
    Eigen::PermutationMatrix<Eigen::Dynamic> order;
    Eigen::AMDOrdering<int>()(matrix, order);
    const std::vector<int> expected(order.indices().data(), order.indices().data() + size);
    EXPECT_EQ(minimum_degree_order(pattern), expected) << seed;
  }
}

TEST(HarmonicExtension, IsThatOfEigenBitByBit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const int width : {2, 3, 5, 9, 20}) {
    std::vector<std::array<int, 2>> edges;
    for (int y = 0; y < width; ++y)
      for (int x = 0; x < width; ++x) {
        if (x + 1 < width) edges.push_back({y * width + x, y * width + x + 1});
        if (y + 1 < width) edges.push_back({y * width + x, (y + 1) * width + x});
        if (x + 1 < width && random() % 3 == 0) edges.push_back({y * width + x, y * width + x + 1});
      }
    const int count = width * width;
    std::vector<Known> known;
    std::vector<Point3> values;
    for (int v = 0; v < count; ++v) {
      known.push_back(random() % 4 == 0 ? Known::Yes : random() % 20 == 0 ? Known::Absent : Known::No);
      values.push_back({uniform(random), uniform(random), uniform(random)});
    }
    const HarmonicExtension extension(edges, known);
    const std::vector<int>& reached = extension.reached();
    std::vector<int> row(count, -1);
    for (std::size_t i = 0; i < reached.size(); ++i) row[reached[i]] = static_cast<int>(i);
    const auto size = static_cast<Eigen::Index>(reached.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(size, 3);
    for (Eigen::Index i = 0; i < size; ++i)
      for (const int w : extension.known_beside(static_cast<int>(i))) right.row(i) += Eigen::RowVector3d(values[w].x, values[w].y, values[w].z);
    for (const auto& [a, b] : edges) {
      if (known[a] == Known::Absent || known[b] == Known::Absent) continue;
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        if (row[from] < 0) continue;
        entries.emplace_back(row[from], row[from], 1.0);
        if (row[to] >= 0) entries.emplace_back(row[from], row[to], -1.0);
      }
    }
    Matrix laplacian(size, size);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    const Eigen::MatrixX3d expected = Eigen::SimplicialLDLT<Matrix>(laplacian).solve(right);
    extension.extend(values.data());
    for (Eigen::Index i = 0; i < size; ++i) {
      const Point3& p = values[reached[i]];
      EXPECT_TRUE(p.x == expected(i, 0) && p.y == expected(i, 1) && p.z == expected(i, 2)) << width << " " << i;
    }
  }
}

}  // namespace
}  // namespace hybrid_mesh
