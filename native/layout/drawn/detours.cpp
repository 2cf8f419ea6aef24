// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/detours.h"

#include <algorithm>
#include <limits>

#include "layout/curves/curve_tightening.h"
#include "layout/curves/surface_paths.h"

namespace hybrid_mesh {
namespace {

// Of a curve's length: half of a circle is 0.32 off its chord, a line by an unsteady hand some 0.05.
constexpr double kFar = 0.2;

double distance(const Vec3& p, const std::vector<Vec3>& line) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vec3 &a = line[i - 1], &b = line[i];
    best = std::min(best, (p - a - nearest_on_segment(p, a, b) * (b - a)).norm());
  }
  return best;
}

}  // namespace

std::vector<char> find_detours(const SurfaceCurves& curves, const std::vector<char>& fixed, double least, const Progress& progress) {
  SurfaceCurves tight = curves;
  CurveTightener(tight, fixed).tighten_all(progress);
  std::vector<char> detours(curves.curve_count(), 0);
  for (int c = 0; c < curves.curve_count(); ++c) {
    if (fixed[c] || !curves.curve(c).alive) continue;
    const double far = std::max(least, kFar * curves.length(c));
    const std::vector<Vec3> shortest = tight.polyline(c);
    for (const Vec3& p : curves.polyline(c)) detours[c] = detours[c] || distance(p, shortest) > far;
  }
  return detours;
}

}  // namespace hybrid_mesh
