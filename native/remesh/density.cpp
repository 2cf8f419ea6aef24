// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/density.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

constexpr double kMostFactor = 4;   // of an edge's length, either way
constexpr double kSame = 1 + 1e-9;  // times as large: by rounding, of sums for one
// Sizes, of which the mean is 1, grow by no more than this over the width of a quad of an even mesh of so many: a step in the attribute is a slope
// that the maps of a base of some hundred quads can follow. It depends on the surface alone, so that a plan gives the same base for any number of
// vertices.
constexpr double kSlope = 0.5, kQuadsOfSlope = 1500;

using Values = std::vector<double>;

std::string quoted_name(const std::string& name) { return "the density '" + name + "'"; }

void check(const PolygonSoup& input, const std::string& name) {
  const auto refuse = [&](const std::string& what) { throw Error(ErrorCode::InvalidInput, quoted_name(name) + " " + what); };
  if (input.density.size() != input.points.size())
    refuse("has " + std::to_string(input.density.size()) + " values for " + std::to_string(input.points.size()) + " points");
  for (std::size_t v = 0; v < input.density.size(); ++v)
    if (!std::isfinite(input.density[v])) refuse("is not a finite number at point " + std::to_string(v));
}

// Repair moves no point, so that places tell which are the same.
Values values_at_points(const PolygonSoup& input, const TriangleSurface& repaired) {
  const auto place = [](const Vec3& p) { return std::array{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}; };  // -0 is 0
  std::map<std::array<double, 3>, std::pair<double, int>> sums;
  for (std::size_t v = 0; v < input.points.size(); ++v) {
    auto& [sum, count] = sums[place(input.points[v])];
    sum += input.density[v];
    ++count;
  }
  Values values(repaired.points.size());
  std::vector<char> known(values.size(), 0);
  for (std::size_t v = 0; v < values.size(); ++v)
    if (const auto at = sums.find(place(repaired.points[v])); at != sums.end()) {
      values[v] = at->second.first / at->second.second;
      known[v] = 1;
    }
  // Points of caps, over handles that are closed for good, have what is beside them.
  for (bool any = true; any;) {
    any = false;
    Values sum(values.size(), 0);
    std::vector<int> count(values.size(), 0);
    for (const auto& f : repaired.faces)
      for (int i = 0; i < 3; ++i)
        for (const int w : {f[(i + 1) % 3], f[(i + 2) % 3]})
          if (!known[f[i]] && known[w]) sum[f[i]] += values[w], ++count[f[i]];
    for (std::size_t v = 0; v < values.size(); ++v)
      if (count[v] > 0) values[v] = sum[v] / count[v], known[v] = 1, any = true;
  }
  return values;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double size_at_density(double value) { return std::pow(kMostFactor, 1 - 2 * std::clamp(value, 0.0, 1.0)); }

std::shared_ptr<const SizeField> gradual_sizes(const TriangleSurface& placed, std::vector<double> size) {
  const double slope = kSlope * std::sqrt(kQuadsOfSlope / surface_area(placed));
  // Sizes that a surface has on average are 1.
  const SizeField steep(placed, size);
  const double mean = 1 / (steep.fineness(placed.points.front()) * size.front());
  for (double& s : size) s *= mean;
  return std::make_shared<const SizeField>(placed, graded(placed, std::move(size), slope));
}

Density read_density(const PolygonSoup& input, const std::string& name, const TriangleSurface& repaired, const Placement& placement) {
  Density density;
  if (name.empty() && input.density.empty()) return density;
  density.name = name.empty() ? "density" : name;
  check(input, density.name);
  density.values = values_at_points(input, repaired);
  Values size;
  for (const double value : density.values) {
    density.outside += value < 0 || value > 1;
    size.push_back(size_at_density(value));
  }
  density.smallest = *std::min_element(size.begin(), size.end());
  density.largest = *std::max_element(size.begin(), size.end());
  const TriangleSurface placed = placement.to_unit(repaired);
  density.wanted = std::make_shared<const SizeField>(placed, size);
  if (density.largest <= kSame * density.smallest) return density;
  density.sizes = gradual_sizes(placed, std::move(size));
  return density;
}

double median_size_error(const QuadMesh& mesh, const SizeField& wanted) {
  std::vector<Vec3> middles(mesh.face_count());
  Values lengths(mesh.face_count(), 0);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int64_t begin = mesh.offsets[f], sides = mesh.offsets[f + 1] - begin;
    middles[f] = Vec3::Zero();
    for (std::int64_t i = 0; i < sides; ++i) {
      const Vec3 &a = mesh.points[mesh.indices[begin + i]], &b = mesh.points[mesh.indices[begin + (i + 1) % sides]];
      middles[f] += a / static_cast<double>(sides);
      lengths[f] += (b - a).norm() / static_cast<double>(sides);
    }
  }
  Values error = wanted.fineness(middles);
  for (std::size_t f = 0; f < error.size(); ++f) error[f] = std::log(std::max(lengths[f], 1e-300) * error[f]);
  const double factor = median(error);
  for (double& e : error) e = std::abs(e - factor);
  return median(std::move(error));
}

nlohmann::ordered_json describe_density(const Density& density, const QuadMesh& mesh) {
  return {{"name", density.name}, {"smallest", density.smallest}, {"largest", density.largest}, {"met", median_size_error(mesh, *density.wanted)}};
}

}  // namespace hybrid_mesh
