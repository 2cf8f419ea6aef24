// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/patch_energy.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "parameterization/distortion.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

constexpr double kMostDensity = 100;  // energy a unit of area: a sliver, in which rounding decides, counts for as little as it covers

// Of one face: its energy less its area. A face is a piece of one on which the map is linear.
double face_excess(const std::array<Vec3, 3>& p, const std::array<Vec2, 3>& uv, double scale, const Distortion& density) {
  const Vec3 e1 = scale * (p[1] - p[0]), e2 = scale * (p[2] - p[0]);
  const double l = e1.norm(), twice_area = e1.cross(e2).norm();
  if (!(l > 0 && twice_area > 1e-12)) return 0;
  const double x = e1.dot(e2) / l, y = twice_area / l;
  const Vec2 du = (uv[1] - uv[0]) / l, dv = (uv[2] - uv[0] - x * du) / y;
  const Complex a = 0.5 * Complex(du.x() + dv.y(), du.y() - dv.x()), b = 0.5 * Complex(du.x() - dv.y(), du.y() + dv.x());
  const double s = std::norm(a), t = std::norm(b);
  return 0.5 * twice_area * ((s > t ? std::min(density.value(s, t), kMostDensity) : kMostDensity) - 1);
}

std::vector<double> fineness_of(const PatchMap& map, const SizeField* sizes) {
  return sizes ? sizes->fineness(map.positions) : std::vector<double>();
}

}  // namespace

std::vector<double> patch_energies(const MappedSurface& mapped, double scale, double theta) {
  const Distortion density{theta};
  std::vector<double> energy(mapped.surface.patch_count(), 0);
  const std::vector<Vec3>& points = mapped.surface.mesh.points;
  const std::vector<double> fineness = fineness_at_points(mapped.surface.mesh);
  for (std::size_t f = 0; f < mapped.surface.patch.size(); ++f) {
    const std::array<int, 3>& c = mapped.surface.mesh.faces[f];
    const double length = scale * fineness_on_face(fineness, c[0], c[1], c[2]);
    energy[mapped.surface.patch[f]] += face_excess({points[c[0]], points[c[1]], points[c[2]]}, mapped.corners[f], length, density);
  }
  return energy;
}

double map_energy(const PatchMap& map, double scale, double theta, const SizeField* sizes) {
  const Distortion density{theta};
  const std::vector<double> fineness = fineness_of(map, sizes);
  double energy = 0;
  for (const auto& t : map.triangles)
    energy += face_excess({map.positions[t[0]], map.positions[t[1]], map.positions[t[2]]}, {map.uv[t[0]], map.uv[t[1]], map.uv[t[2]]},
                          scale * fineness_on_face(fineness, t[0], t[1], t[2]), density);
  return energy;
}

double map_area(const PatchMap& map, const SizeField* sizes) {
  const std::vector<double> fineness = fineness_of(map, sizes);
  double area = 0;
  for (const auto& t : map.triangles) {
    const double finer = fineness_on_face(fineness, t[0], t[1], t[2]);
    area += 0.5 * (map.positions[t[1]] - map.positions[t[0]]).cross(map.positions[t[2]] - map.positions[t[0]]).norm() * finer * finer;
  }
  return area;
}

}  // namespace hybrid_mesh
