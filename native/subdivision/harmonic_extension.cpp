// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/harmonic_extension.h"

#include "hierarchy/flat_points.h"

namespace hybrid_mesh {

int extend_harmonically(const std::vector<std::array<int, 2>>& edges, const std::vector<Known>& known, std::vector<Vec3>& values) {
  const HarmonicExtension extension(edges, known);
  std::vector<Point3> points = flat_points(values);
  extension.extend(points.data());
  for (const int v : extension.reached()) values[v] = Vec3(points[v].x, points[v].y, points[v].z);
  return extension.without_path();
}

Eigen::SparseMatrix<double, Eigen::RowMajor> harmonic_extension(const HarmonicExtension& extension, const std::vector<char>& is_known) {
  const auto count = static_cast<Eigen::Index>(is_known.size());
  const std::vector<int>& reached = extension.reached();
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < count; ++v)
    if (is_known[v]) entries.emplace_back(v, v, 1.0);
  std::vector<std::vector<int>> reaches(is_known.size());  // of each known value: the equations that it is in, once for each edge
  for (int i = 0; i < static_cast<int>(reached.size()); ++i)
    for (const int w : extension.known_beside(i)) reaches[w].push_back(i);
  // A column at a time: most are zero nearly everywhere, since an operation's vertices depend on those around it alone.
  for (std::size_t w = 0; w < reaches.size(); ++w) {
    if (reaches[w].empty()) continue;
    std::vector<double> column(reached.size(), 0);
    for (const int equation : reaches[w]) column[equation] += 1;
    extension.solve(column);
    for (std::size_t i = 0; i < column.size(); ++i)
      if (column[i] != 0) entries.emplace_back(reached[i], static_cast<Eigen::Index>(w), column[i]);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace hybrid_mesh
