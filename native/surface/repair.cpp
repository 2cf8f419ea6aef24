// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "surface/coincident_points.h"
#include "surface/repair_stages.h"
#include "surface/scaled_points.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {

bool RepairReport::changed() const {
  return merged_points || isolated_points || duplicate_faces || degenerate_faces || reoriented_faces || nonmanifold_edges || nonmanifold_vertices ||
         one_sided_cuts || dropped_components;
}

void RepairMesh::keep_faces(const std::vector<char>& keep) {
  std::vector<int> renamed(faces.size(), -1);
  int kept = 0;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (keep[f]) renamed[f] = kept++;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!keep[f]) continue;
    const int k = renamed[f];
    for (int i = 0; i < 3; ++i) {
      const int m = mate[3 * f + i];
      mate[3 * k + i] = m >= 0 && keep[m / 3] ? 3 * renamed[m / 3] + m % 3 : -1;
    }
    faces[k] = faces[f];
    source[k] = source[f];
  }
  faces.resize(kept);
  source.resize(kept);
  mate.resize(3 * static_cast<std::size_t>(kept));
}

std::vector<int> RepairMesh::components(int& count) const {
  std::vector<int> component(faces.size(), -1), pending;
  count = 0;
  for (int seed = 0; seed < static_cast<int>(faces.size()); ++seed) {
    if (component[seed] >= 0) continue;
    component[seed] = count;
    pending.push_back(seed);
    while (!pending.empty()) {
      const int f = pending.back();
      pending.pop_back();
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (mate[h] >= 0 && component[mate[h] / 3] < 0) component[mate[h] / 3] = count, pending.push_back(mate[h] / 3);
    }
    ++count;
  }
  return component;
}

namespace {

// Points, scaled into [-1, 1], at multiples of some hundred times a double's precision. What a program computes twice differs by less: 0 in one face
// is 1e-17 in the next, and would be a crack between them.
std::vector<Vec3> rounded(std::vector<Vec3> points) {
  constexpr double unit = 0x1p-46;
  for (Vec3& p : points) p = (p / unit).array().round() * unit;
  return points;
}

// The triangles of the soup over merged points, without those that have a corner twice.
RepairMesh gather(const PolygonSoup& soup, RepairReport& report) {
  const Triangulation triangulation = triangulate(soup);
  if (triangulation.triangles.size() > static_cast<std::size_t>(std::numeric_limits<int>::max() / 3))
    throw Error(ErrorCode::Unsupported, "too many faces: " + std::to_string(triangulation.triangles.size()));
  if (triangulation.triangles.empty()) throw Error(ErrorCode::InvalidInput, "no faces");
  const int point_count = static_cast<int>(soup.points.size());
  RepairMesh mesh;
  mesh.points = scaled(soup.points, scale_exponent(soup.points));
  const std::vector<std::int32_t> first = first_coincident(rounded(mesh.points));
  std::vector<char> used(point_count, 0);
  for (const auto& triangle : triangulation.triangles)
    for (const int v : triangle) used[first[v]] = 1;
  for (int p = 0; p < point_count; ++p) {
    report.merged_points += first[p] != p;
    report.isolated_points += first[p] == p && !used[p];
  }

  mesh.origin.resize(point_count);
  for (int p = 0; p < point_count; ++p) mesh.origin[p] = p;
  for (std::size_t t = 0; t < triangulation.triangles.size(); ++t) {
    const auto& triangle = triangulation.triangles[t];
    const std::array<int, 3> face{first[triangle[0]], first[triangle[1]], first[triangle[2]]};
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
      ++report.degenerate_faces;
      continue;
    }
    mesh.faces.push_back(face);
    mesh.source.push_back(static_cast<int>(t));
  }
  mesh.mate.assign(3 * mesh.faces.size(), -1);
  if (mesh.faces.empty()) throw Error(ErrorCode::InvalidInput, "all " + std::to_string(triangulation.triangles.size()) + " faces are degenerate");
  return mesh;
}

void drop_components(RepairMesh& mesh, double fraction, RepairReport& report) {
  int count = 0;
  const std::vector<int> component = mesh.components(count);
  std::vector<double> area(count, 0);
  double total = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& face = mesh.faces[f];
    const Vec3& a = mesh.position(face[0]);
    const double twice = (mesh.position(face[1]) - a).cross(mesh.position(face[2]) - a).norm();
    area[component[f]] += twice;
    total += twice;
  }
  std::vector<char> keep(mesh.faces.size());
  for (std::size_t f = 0; f < keep.size(); ++f) keep[f] = area[component[f]] >= fraction * total;
  report.dropped_components = std::count_if(area.begin(), area.end(), [&](double a) { return !(a >= fraction * total); });
  if (report.dropped_components == count)
    throw Error(ErrorCode::InvalidInput, "none of the " + std::to_string(count) + " components has the fraction " + std::to_string(fraction) +
                                             " of the whole area that is asked for");
  if (report.dropped_components > 0) mesh.keep_faces(keep);
}

TriangleSurface extract(const RepairMesh& mesh, const std::vector<Vec3>& points) {
  TriangleSurface surface;
  std::vector<char> used(mesh.origin.size(), 0);
  for (const auto& face : mesh.faces)
    for (const int v : face) used[v] = 1;
  std::vector<int> renamed(mesh.origin.size(), -1);
  for (std::size_t v = 0; v < mesh.origin.size(); ++v)
    if (used[v]) {
      renamed[v] = static_cast<int>(surface.points.size());
      surface.points.push_back(points[mesh.origin[v]]);
    }
  surface.faces = mesh.faces;
  for (auto& face : surface.faces)
    for (int& v : face) v = renamed[v];
  surface.source_face = mesh.source;
  try {
    connect_half_edges(surface);
  } catch (const Error& error) {
    throw Error(ErrorCode::Internal, std::string("repair left a surface that is no manifold: ") + error.what());
  }
  return surface;
}

}  // namespace

TriangleSurface repair(const PolygonSoup& soup, const RepairOptions& options, RepairReport& report, const Progress& progress) {
  report = {};
  progress(0);
  RepairMesh mesh = gather(soup, report);
  const std::int64_t triangle_count = static_cast<std::int64_t>(mesh.faces.size()) + report.degenerate_faces;
  progress(0.3);
  remove_duplicate_faces(mesh, report);
  pair_half_edges(mesh, report);
  progress(0.6);
  orient(mesh, report);
  progress(0.7);
  separate_fans(mesh);
  progress(0.8);
  const std::size_t face_count = mesh.faces.size();
  remove_degenerate_faces(mesh, report);
  if (mesh.faces.empty()) throw Error(ErrorCode::InvalidInput, "all " + std::to_string(triangle_count) + " faces are degenerate");
  if (mesh.faces.size() != face_count) separate_fans(mesh);
  if (options.drop_components > 0) drop_components(mesh, options.drop_components, report);
  progress(0.9);
  TriangleSurface surface = extract(mesh, soup.points);
  progress(1);
  return surface;
}

}  // namespace hybrid_mesh
