// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/element_cholesky.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Cholesky>
#include <random>

namespace hybrid_mesh {
namespace {

struct System {
  std::vector<ElementCholesky::Element> elements;
  std::vector<ElementCholesky::Matrix> matrices;
  Eigen::VectorXd right;
  int unknowns = 0;

  // The sum of the elements, times x.
  Eigen::VectorXd times(const Eigen::VectorXd& x) const {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(unknowns);
    for (std::size_t i = 0; i < elements.size(); ++i)
      for (int a = 0; a < 6; ++a)
        for (int b = 0; b < 6; ++b)
          if (elements[i][a] >= 0 && elements[i][b] >= 0) y[elements[i][a]] += matrices[i](a, b) * x[elements[i][b]];
    return y;
  }
};

// Random elements on a grid of `side` x `side` nodes, cut into triangles. Some unknowns are held, and some nodes.
System random_system(int side, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  System s;
  std::vector<std::array<int, 2>> unknown(side * side);
  for (auto& [x, y] : unknown) {
    const unsigned kind = random() % 16;
    x = kind == 0 || kind == 1 ? -1 : s.unknowns++;
    y = kind == 0 || kind == 2 ? -1 : s.unknowns++;
  }
  for (int i = 0; i + 1 < side; ++i)
    for (int j = 0; j + 1 < side; ++j) {
      const int a = i * side + j, b = a + side, c = b + 1, d = a + 1;
      for (const std::array<int, 3>& t : {std::array<int, 3>{a, b, c}, {c, d, a}}) {
        ElementCholesky::Element& e = s.elements.emplace_back();
        for (int k = 0; k < 6; ++k) e[k] = unknown[t[k / 2]][k % 2];
        const ElementCholesky::Matrix m = ElementCholesky::Matrix::NullaryExpr([&] { return normal(random); });
        s.matrices.push_back(m * m.transpose());
      }
    }
  s.right = Eigen::VectorXd::NullaryExpr(s.unknowns, [&] { return normal(random); });
  return s;
}

TEST(ElementCholesky, SolvesSystemsOfAnySize) {
  for (const int side : {2, 3, 5, 12, 60}) {
    const System s = random_system(side, side);
    ElementCholesky solver(s.elements, s.unknowns);
    ASSERT_TRUE(solver.factorize(s.matrices));
    const Eigen::VectorXd x = solver.solve(s.right);
    EXPECT_LT((s.times(x) - s.right).norm(), 1e-7 * s.right.norm()) << side;
  }
}

TEST(ElementCholesky, IsTheDenseSolution) {
  const System s = random_system(6, 7);
  Eigen::MatrixXd dense(s.unknowns, s.unknowns);
  for (int i = 0; i < s.unknowns; ++i) dense.col(i) = s.times(Eigen::VectorXd::Unit(s.unknowns, i));
  ElementCholesky solver(s.elements, s.unknowns);
  ASSERT_TRUE(solver.factorize(s.matrices));
  const Eigen::VectorXd expected = dense.llt().solve(s.right);
  EXPECT_LT((solver.solve(s.right) - expected).norm(), 1e-8 * expected.norm());
}

TEST(ElementCholesky, RefusesWhatIsNotPositiveDefiniteAndFactorizesAgain) {
  System s = random_system(20, 3);
  ElementCholesky solver(s.elements, s.unknowns);
  const std::vector<ElementCholesky::Matrix> good = s.matrices;
  for (ElementCholesky::Matrix& m : s.matrices) m -= 10 * ElementCholesky::Matrix::Identity();
  EXPECT_FALSE(solver.factorize(s.matrices));
  s.matrices = good;
  ASSERT_TRUE(solver.factorize(s.matrices));
  EXPECT_LT((s.times(solver.solve(s.right)) - s.right).norm(), 1e-7 * s.right.norm());
}

TEST(ElementCholesky, DoesNotDependOnTheNumberOfThreads) {
  const System s = random_system(80, 5);
  std::vector<Eigen::VectorXd> x;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    ElementCholesky solver(s.elements, s.unknowns);
    ASSERT_TRUE(solver.factorize(s.matrices));
    x.push_back(solver.solve(s.right));
  }
  EXPECT_EQ(x[0], x[1]);
  EXPECT_EQ(x[0], x[2]);
}

}  // namespace
}  // namespace hybrid_mesh
