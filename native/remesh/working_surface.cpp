// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/working_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "layout/base/base_domain.h"
#include "layout/base/closed_components.h"
#include "parameterization/patched_surface.h"
#include "surface/edit_mesh.h"
#include "surface/size_field.h"
#include "surface/well_shaped.h"

namespace hybrid_mesh {
namespace {

using Weights = std::array<double, 3>;

// Where a point that has just been added lies. `hint`: a face near it.
void place_last_point(WorkingSurface& surface, int hint) {
  const ClosestPoint closest = surface.query->closest(surface.mesh.points.back(), hint);
  surface.place.push_back({closest.face, closest.weights});
}

// The edges of curves, by their ends: what is split changes faces and half-edges.
class CurveEdges {
 public:
  CurveEdges(const TriangleSurface& mesh, const std::vector<char>& marks) {
    for (int h = 0; h < static_cast<int>(marks.size()); ++h)
      if (marks[h]) edges_.insert(std::minmax(mesh.from(h), mesh.to(h)));
  }
  bool has(int a, int b) const { return edges_.count(std::minmax(a, b)) > 0; }
  void split(int a, int b, int middle) {
    edges_.erase(std::minmax(a, b));
    edges_.insert(std::minmax(a, middle));
    edges_.insert(std::minmax(middle, b));
  }
  std::vector<char> marks(const TriangleSurface& mesh) const {
    std::vector<char> marks(mesh.opposite.size(), 0);
    for (int h = 0; h < static_cast<int>(marks.size()); ++h) marks[h] = has(mesh.from(h), mesh.to(h));
    return marks;
  }

 private:
  std::set<std::pair<int, int>> edges_;
};

// Splits the inner edges that `chosen` names, no two of one face at once, until it names none. The new point's number is told to `made`.
template <class Chosen, class Made>
void split_edges(WorkingSurface& surface, const Chosen& chosen, const Made& made) {
  TriangleSurface& mesh = surface.mesh;
  std::vector<PointSource> sources(mesh.points.size());  // asked for, not used: places say more
  for (bool any = true; any;) {
    any = false;
    std::vector<char> split(mesh.faces.size(), 0);
    for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
      const int o = mesh.opposite[h], a = mesh.from(h), b = mesh.to(h);
      if (o < h || split[h / 3] || split[o / 3] || !chosen(a, b)) continue;
      split[h / 3] = split[o / 3] = 1;
      made(a, b, static_cast<int>(mesh.points.size()));
      split_inner_edge(mesh, sources, h);
      place_last_point(surface, mesh.source_face[h / 3]);
      any = true;
    }
    if (any) connect_half_edges(mesh);
  }
}

// A side of the base that runs along a curve (the boundary, a feature) is a straight line in the map: a triangle between an inner edge that joins two
// of its points and that line would have no area. And a curve of one edge has no vertex to give away, where the triangles beside it are odd in
// number.
void split_chords(WorkingSurface& surface, double corner_angle) {
  TriangleSurface& mesh = surface.mesh;
  CurveEdges curves(mesh, surface.features.edges);
  const std::vector<char> corners = surface.features.corners;
  if (!surface.features.empty()) {
    const auto is_corner = [&](int v) { return v < static_cast<int>(corners.size()) && corners[v]; };
    split_edges(
        surface, [&](int a, int b) { return is_corner(a) && is_corner(b) && curves.has(a, b); }, [&](int a, int b, int m) { curves.split(a, b, m); });
  }
  const std::vector<int> component = curve_components(mesh, curves.marks(mesh));
  const auto on_one = [&](int a, int b) {
    const int count = static_cast<int>(component.size());
    return a < count && b < count && component[a] >= 0 && component[a] == component[b] && !curves.has(a, b);
  };
  split_edges(surface, on_one, [](int, int, int) {});
  if (!surface.features.empty()) surface.features = feature_graph(mesh, curves.marks(mesh), corner_angle);
}

// Closed components of few triangles have no room for the quads of a cube: their triangles are quartered until they have.
bool quarter_small_components(WorkingSurface& surface, const TriangleSurface& placed) {
  constexpr int enough = 64;
  bool any = false;
  for (;;) {
    TriangleSurface& mesh = surface.mesh;
    const ClosedComponents components = closed_components(EditMesh(mesh));
    const auto is_small = [&](const std::array<int, 3>& f) { return components.of[f[0]] >= 0 && components.faces[components.of[f[0]]] < enough; };
    if (std::none_of(mesh.faces.begin(), mesh.faces.end(), is_small)) return any;
    if (!surface.query) surface.query = std::make_shared<const SurfaceDistanceQuery>(placed);
    any = true;
    std::map<std::pair<int, int>, int> middles;
    std::vector<std::array<int, 3>> faces;
    std::vector<int> source_face;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      const std::array<int, 3> c = mesh.faces[f];
      const int source = mesh.source_face[f];
      if (!is_small(c)) {
        faces.push_back(c);
        source_face.push_back(source);
        continue;
      }
      std::array<int, 3> m;
      for (int i = 0; i < 3; ++i) {
        const auto [at, fresh] = middles.insert({std::minmax(c[i], c[(i + 1) % 3]), static_cast<int>(mesh.points.size())});
        m[i] = at->second;
        if (!fresh) continue;
        mesh.points.push_back(0.5 * (mesh.points[c[i]] + mesh.points[c[(i + 1) % 3]]));
        place_last_point(surface, source);
      }
      for (const std::array<int, 3>& quarter : {std::array{c[0], m[0], m[2]}, {c[1], m[1], m[0]}, {c[2], m[2], m[1]}, m}) {
        faces.push_back(quarter);
        source_face.push_back(source);
      }
    }
    mesh.faces = std::move(faces);
    mesh.source_face = std::move(source_face);
    connect_half_edges(mesh);
  }
}

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

}  // namespace

Weights weights_in_triangle(const Vec3& p, const std::array<Vec3, 3>& corners) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  Weights w{0, 0, 0};
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    w[i] = std::max(0.0, (corners[(i + 1) % 3] - p).cross(corners[(i + 2) % 3] - p).dot(normal));
    sum += w[i];
  }
  if (!(sum > 0)) return {1, 0, 0};
  for (double& x : w) x /= sum;
  return w;
}

std::int64_t working_faces(double base_quads, std::int64_t vertices) {
  constexpr double faces_a_base_quad = 30;  // at least
  constexpr double most = 2e6;              // ... but no more
  return static_cast<std::int64_t>(std::min(std::max(faces_a_base_quad * base_quads, 2.0 * static_cast<double>(vertices)), most));
}

void WorkingSurface::to_repaired(PatchMap& map, const TriangleSurface& repaired) const {
  for (std::size_t t = 0; t < map.triangles.size(); ++t) {
    const int face = map.source_face[t];
    int original = mesh.source_face[face];
    std::array<Weights, 3> corner;  // of the face, in the original one
    bool on_one = true;
    for (int k = 0; k < 3; ++k) on_one &= weights_on(place[mesh.faces[face][k]], original, repaired, corner[k]);
    std::array<Weights, 3> fresh{};  // of the map's triangle
    if (on_one) {
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i)
          for (int k = 0; k < 3; ++k) fresh[c][i] += map.source[t][3 * c + k] * corner[k][i];
    } else {
      std::array<Vec3, 3> at{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, under;
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k) at[c] += map.source[t][3 * c + k] * mesh.points[mesh.faces[face][k]];
      original = query->closest((at[0] + at[1] + at[2]) / 3, original).face;
      for (int i = 0; i < 3; ++i) under[i] = placement.to_unit(repaired.points[repaired.faces[original][i]]);
      for (int c = 0; c < 3; ++c) fresh[c] = weights_in_triangle(at[c], under);
    }
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i) map.source[t][3 * c + i] = static_cast<float>(fresh[c][i]);
    map.source_face[t] = original;
  }
}

WorkingSurface make_working_surface(const TriangleSurface& repaired, const Placement& placement, std::int64_t faces, const Progress& progress,
                                    const std::vector<char>& held, const std::optional<FeatureOptions>& features,
                                    const std::shared_ptr<const SizeField>& quad_sizes, const WorkingSizes& sizes) {
  TriangleSurface placed = repaired;
  for (Vec3& p : placed.points) p = placement.to_unit(p);
  placed.sizes = quad_sizes;
  const double triangle = measured_area(placed) / static_cast<double>(std::max<std::int64_t>(1, faces));
  const double edge = std::sqrt(4 / std::sqrt(3.0) * triangle);
  WellShapedOptions options;
  options.longest_edge = sizes.longest * edge;
  // Where quads are to be smallest.
  const double least = quad_sizes ? 1 / largest(quad_sizes->fineness(placed.points)) : 1.0;
  options.shortest_edge = sizes.shortest * edge * least;
  options.collapsible = sizes.collapsible * edge * least;
  options.tolerance = std::min(sizes.tolerance * edge * least, sizes.most_tolerance);
  options.held = held;
  options.needles.area = sizes.needle_triangles * triangle;
  WellShaped shaped = make_well_shaped(placed, options, progress);
  WorkingSurface w;
  w.mesh = std::move(shaped.mesh);
  w.mesh.sizes = quad_sizes;
  w.place = std::move(shaped.place);
  w.placement = placement;
  if (!shaped.unchanged) w.query = std::move(shaped.query);
  const bool has_boundary = std::find(placed.opposite.begin(), placed.opposite.end(), -1) != placed.opposite.end();
  const bool quartered = quarter_small_components(w, placed);
  if (features) w.features = find_features(w.mesh, *features);
  if (shaped.unchanged && !has_boundary && !quartered && w.features.empty()) return w;  // every face is one of the repaired surface
  if (!w.query) w.query = std::make_shared<const SurfaceDistanceQuery>(placed);
  if (has_boundary || !w.features.empty()) split_chords(w, features ? features->corner_angle : 0);
  return w;
}

void hold_ends_of_cut(WorkingSurface& surface, const Vec3& normal) {
  const TriangleSurface& mesh = surface.mesh;
  const std::vector<char> on = points_on_mirror(mesh, normal);
  FeatureGraph& features = surface.features;
  std::vector<int> ends;
  for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
    if (mesh.opposite[h] >= 0 || (on[mesh.from(h)] && on[mesh.to(h)])) continue;
    for (const int v : {mesh.from(h), mesh.to(h)})
      if (on[v]) ends.push_back(v);
  }
  if (ends.empty()) return;
  if (features.empty()) features.edges.assign(mesh.opposite.size(), 0);
  features.corners.resize(mesh.points.size(), 0);
  for (const int v : ends) features.corners[v] = 1;
}

}  // namespace hybrid_mesh
