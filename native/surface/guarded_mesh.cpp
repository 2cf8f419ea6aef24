// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/guarded_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybrid_mesh {
namespace {

// Flips that are worth their while: rounding must not make them go round in circles.
constexpr double kGain = 1 + 1e-7;
// A collapse may leave other needles around the vertex about as thin as they were; there is a vertex less, so that it cannot go round in circles.
constexpr double kWorth = 0.9;

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// Of the triangle's corners.
double smallest_angle_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  if (ab <= bc && ab <= ca) return angle_between(a - c, b - c);
  return bc <= ca ? angle_between(b - a, c - a) : angle_between(c - b, a - b);
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double square = d.squaredNorm();
  const double t = square > 0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0;
  return (p - a - t * d).norm();
}

}  // namespace

GuardedMesh::GuardedMesh(const TriangleSurface& input, const GuardOptions& options)
    : options_(options),
      sharp_cosine_(std::cos(options.sharp_angle * std::numbers::pi / 180)),
      input_(input),
      mesh_(input),
      points_(input.points),
      place_(input.points.size()),
      released_(input.faces.size(), 0),
      moved_(input.faces.size(), 0),
      inside_(input.faces.size()),
      passed_(mesh_.edge_count) {
  for (int h = 3 * static_cast<int>(input.faces.size()); h-- > 0;) {
    SurfacePoint& place = place_[input.from(h)];
    place = {h / 3, {0, 0, 0}};
    place.weights[h % 3] = 1;
    inside_[h / 3] = h / 3;
  }
}

int GuardedMesh::longest(int f) const {
  const double a = length(3 * f), b = length(3 * f + 1), c = length(3 * f + 2);
  return 3 * f + (a >= b && a >= c ? 0 : b >= c ? 1 : 2);
}

int GuardedMesh::shortest(int f) const {
  const double a = length(3 * f), b = length(3 * f + 1), c = length(3 * f + 2);
  return 3 * f + (a <= b && a <= c ? 0 : b <= c ? 1 : 2);
}

double GuardedMesh::corner_angle(int h) const {
  const Vec3& p = points_[mesh_.from(h)];
  return angle_between(points_[mesh_.to(h)] - p, points_[mesh_.apex(h)] - p);
}

Vec3 GuardedMesh::area_vector(const Vec3& a, const Vec3& b, const Vec3& c) const { return (b - a).cross(c - a); }

// The two pairs of triangles over the four points are the sides of a tetrahedron: they are farthest apart where the diagonals cross.
double GuardedMesh::bulge(int h) const {
  const int o = mesh_.opposite[h];
  if (o < 0) return 0;
  const Vec3 &a = points_[mesh_.from(h)], &b = points_[mesh_.to(h)], &c = points_[mesh_.apex(h)], &d = points_[mesh_.apex(o)];
  const Vec3 across = (b - a).cross(d - c);
  const double size = across.norm();
  if (!(size > 0)) return std::max(distance_to_segment(c, a, b), distance_to_segment(d, a, b));
  return std::abs((c - a).dot(across)) / size;
}

bool GuardedMesh::is_curve(int h) const {
  const int o = mesh_.opposite[h];
  if (o < 0) return true;
  const Vec3 m = area_vector(h / 3), n = area_vector(o / 3);
  const double a = m.norm(), b = n.norm();
  if (m.dot(n) >= sharp_cosine_ * a * b) return false;
  return std::min(a, b) > tolerance_at(h) * length(h);
}

double GuardedMesh::distance_to_input(const Vec3& p, int guess) const { return std::sqrt(query().closest(p, guess).squared_distance); }

bool GuardedMesh::flip(int h) {
  const int o = mesh_.opposite[h];
  if (o < 0) return false;
  const Vec3 &a = points_[mesh_.from(h)], &b = points_[mesh_.to(h)], &c = points_[mesh_.apex(h)], &d = points_[mesh_.apex(o)];
  const double before = std::min(smallest_angle(h / 3), smallest_angle(o / 3));
  if (!(std::min(smallest_angle_of(a, d, c), smallest_angle_of(d, b, c)) > kGain * before)) return false;
  const double moves = bulge(h);
  // Both surfaces would be within the tolerance of the input. A fold bulges nowhere.
  const double tolerance = tolerance_at(h);
  if (moves > 2 * tolerance || is_curve(h)) return false;
  if (tolerance == 0 && inside_[h / 3] != inside_[o / 3]) return false;
  const Vec3 up = area_vector(h / 3) + area_vector(o / 3);
  if (!(area_vector(a, d, c).dot(up) > 0 && area_vector(d, b, c).dot(up) > 0)) return false;
  if (!mesh_.can_flip(h)) return false;
  double moved = std::max(moved_[h / 3], moved_[o / 3]) + moves;
  if (moved > tolerance) {
    moved = 0;
    const int guess = place_[mesh_.from(h)].face;
    constexpr int parts = 8;
    for (int k = 1; k < parts; ++k) moved = std::max(moved, distance_to_input(c + (d - c) * (static_cast<double>(k) / parts), guess));
    for (const Vec3& p : {a, b}) moved = std::max(moved, distance_to_input((c + d + p) / 3, guess));
    if (moved > tolerance) return false;
  }
  mesh_.flip(h);
  moved_[h / 3] = moved_[o / 3] = moved;
  if (inside_[h / 3] != inside_[o / 3]) inside_[h / 3] = inside_[o / 3] = -1;
  return true;
}

// What is around a vertex that is to move onto a neighbour.
struct GuardedMesh::Star {
  struct Face {
    int face, a, b;  // the corners that stay
    int sector;
  };
  std::vector<Face> faces;                             // those that stay
  std::array<Vec3, 2> up{Vec3::Zero(), Vec3::Zero()};  // area vectors of the two sides of the curve through the vertex; without one there is one side
  std::vector<int> ring_sector;                        // per face that stays, of its corner a
  int curve = -1;                                      // the half-edge of the curve that leaves the vertex, other than h
  double before = 1e300;                               // smallest angle
  double moved = 0;                                    // bound of the faces
  double curve_moved = 0;
  int inside = -2;
  std::vector<Vec3> passed;
};

// False where the vertex may not move along h.
bool GuardedMesh::gather(int h, Star& star) const {
  const int v = mesh_.from(h);
  const bool along_curve = is_curve(h);
  int curves = along_curve;
  // Counter-clockwise from h; a vertex of the boundary moves along it, so that h comes first there too.
  int sector = 0;
  for (int g = h;;) {
    const int f = g / 3;
    if (!released_[f]) return false;
    star.up[sector] += area_vector(f);
    star.before = std::min(star.before, smallest_angle(f));
    star.moved = std::max(star.moved, moved_[f]);
    star.inside = star.inside == -2 || star.inside == inside_[f] ? inside_[f] : -1;
    if (f != h / 3 && f != (mesh_.opposite[h] >= 0 ? mesh_.opposite[h] / 3 : -1)) star.faces.push_back({f, mesh_.to(g), mesh_.apex(g), sector});
    const int n = mesh_.ccw(g);
    if (n == h) break;
    if (n < 0) {
      ++curves;
      star.curve = EditMesh::prev(g);
      break;
    }
    if (is_curve(n)) {
      ++curves;
      star.curve = n;
      sector = 1;
    }
    g = n;
  }
  if (mesh_.is_boundary(v) && mesh_.opposite[h] >= 0) return false;
  return curves == 0 || (curves == 2 && along_curve);
}

// The curve through from(h) would go straight to to(h): do the points that it goes through stay on it?
bool GuardedMesh::stays_on_curve(int h, Star& star) const {
  const int v = mesh_.from(h), u = mesh_.to(h), w = mesh_.from(star.curve) == v ? mesh_.to(star.curve) : mesh_.from(star.curve);
  const int o = mesh_.opposite[h];
  if (w == mesh_.apex(h) || (o >= 0 && w == mesh_.apex(o))) return false;
  star.passed = passed_[mesh_.edge[h]];
  const std::vector<Vec3>& more = passed_[mesh_.edge[star.curve]];
  star.passed.insert(star.passed.end(), more.begin(), more.end());
  star.passed.push_back(points_[v]);
  for (const Vec3& p : star.passed) star.curve_moved = std::max(star.curve_moved, distance_to_segment(p, points_[u], points_[w]));
  return star.curve_moved <= options_.tolerance;
}

double GuardedMesh::deviation_of_star(const Star& star, int u) const {
  const Vec3& p = points_[u];
  const int guess = place_[u].face;
  double most = 0;
  constexpr int parts = 6;
  for (const Star::Face& f : star.faces) {
    const Vec3 &a = points_[f.a], &b = points_[f.b];
    most = std::max(most, distance_to_input((p + a + b) / 3, guess));
    for (int k = 1; k < parts && most <= options_.tolerance; ++k)
      most = std::max(most, distance_to_input(p + (a - p) * (static_cast<double>(k) / parts), guess));
    if (most > options_.tolerance) break;
  }
  return most;
}

bool GuardedMesh::collapse(int h, double enough) {
  const int v = mesh_.from(h), u = mesh_.to(h);
  if (!mesh_.can_collapse(h)) return false;
  Star star;
  if (!gather(h, star)) return false;
  const Vec3 &from = points_[v], &to = points_[u];
  std::array<double, 2> thickness{0, 0};
  double after = 1e300;
  for (const Star::Face& f : star.faces) {
    const Vec3 &a = points_[f.a], &b = points_[f.b], &up = star.up[f.sector];
    after = std::min(after, smallest_angle_of(to, a, b));
    const Vec3 fresh = area_vector(to, a, b);
    const double size = up.norm();
    // Nowhere may the surface turn over, and in a flat star not even its slivers.
    if (!(fresh.dot(up) > 0.3 * fresh.norm() * size)) return false;
    for (const Vec3& p : {to, a, b}) thickness[f.sector] = std::max(thickness[f.sector], std::abs((p - from).dot(up)) / size);
  }
  if (!(after >= kWorth * star.before || after >= enough)) return false;
  if (star.curve >= 0 && !stays_on_curve(h, star)) return false;
  // Old and new faces lie in a slab over the same polygon.
  double moved = star.moved + 2 * std::max(thickness[0], thickness[1]) + star.curve_moved;
  if (moved > options_.tolerance) {
    moved = deviation_of_star(star, u);
    if (moved > options_.tolerance) return false;
  }
  const int curve_name = star.curve >= 0 ? mesh_.edge[star.curve] : -1;
  mesh_.collapse(h);
  if (curve_name >= 0) passed_[curve_name] = std::move(star.passed);
  for (const Star::Face& f : star.faces) {
    moved_[f.face] = moved;
    inside_[f.face] = star.inside;
  }
  return true;
}

// The place of a point of an edge, where a face beside it lies in a face of the input. What is nearest need not be it: caps coincide.
std::optional<SurfacePoint> GuardedMesh::place_on_edge(int h, double fraction) const {
  for (const int g : {h, mesh_.opposite[h]}) {
    const int face = g < 0 ? -1 : inside_[g / 3];
    std::array<double, 3> from, to;
    if (face < 0 || !weights_on(place_[mesh_.from(h)], face, input_, from) || !weights_on(place_[mesh_.to(h)], face, input_, to)) continue;
    SurfacePoint place{face, {}};
    for (int k = 0; k < 3; ++k) place.weights[k] = (1 - fraction) * from[k] + fraction * to[k];
    return place;
  }
  return std::nullopt;
}

int GuardedMesh::split(int h, double fraction) {
  const int a = mesh_.from(h), b = mesh_.to(h), o = mesh_.opposite[h];
  const Vec3 p = points_[a], d = points_[b] - p;
  Vec3 at = p + fraction * d;
  const int name = mesh_.edge[h];
  const std::vector<Vec3> passed = std::move(passed_[name]);
  passed_[name].clear();
  if (!passed.empty()) {
    const auto off = [&](const Vec3& x) { return std::abs((x - p).dot(d) / d.squaredNorm() - fraction); };
    const Vec3& nearest = *std::min_element(passed.begin(), passed.end(), [&](const Vec3& x, const Vec3& y) { return off(x) < off(y); });
    constexpr double near = 0.2;  // a rather even split is worth more than a point that was there before
    if (off(nearest) < near) at = nearest;
  }
  std::optional<SurfacePoint> place;
  if (passed.empty()) place = place_on_edge(h, fraction);
  if (!place) {
    const ClosestPoint closest = query().closest(at, place_[a].face);
    constexpr double rounding = 1e-13;
    if (std::sqrt(closest.squared_distance) > rounding) {
      at = Vec3::Zero();
      for (int k = 0; k < 3; ++k) at += closest.weights[k] * input_.points[input_.faces[closest.face][k]];
    }
    place = {closest.face, closest.weights};
  }
  const int m = mesh_.split(h);
  points_.push_back(at);
  place_.push_back(*place);
  passed_.resize(mesh_.edge_count);
  const int beyond = mesh_.edge[EditMesh::next(mesh_.opposite[EditMesh::next(h)])];
  // As far as the point went from the edge, that is: not what it is off the input.
  const double off_edge = distance_to_segment(at, p, p + d);
  for (const int g : {h, o}) {
    if (g < 0) continue;
    moved_[g / 3] += off_edge;
    moved_.push_back(moved_[g / 3]);
    inside_.push_back(inside_[g / 3]);
    released_.push_back(released_[g / 3]);
  }
  for (const Vec3& x : passed)
    if (x != at) passed_[(x - p).dot(d) < (at - p).dot(d) ? name : beyond].push_back(x);
  return m;
}

TriangleSurface GuardedMesh::packed(std::vector<SurfacePoint>& place) const {
  TriangleSurface surface;
  place.clear();
  std::vector<int> number(points_.size(), -1);
  for (std::size_t v = 0; v < points_.size(); ++v) {
    if (!mesh_.vertex_live[v]) continue;
    number[v] = static_cast<int>(surface.points.size());
    surface.points.push_back(points_[v]);
    place.push_back(place_[v]);
  }
  for (int f = 0; f < face_count(); ++f) {
    if (!mesh_.alive[f]) continue;
    const int a = mesh_.origin[3 * f], b = mesh_.origin[3 * f + 1], c = mesh_.origin[3 * f + 2];
    surface.faces.push_back({number[a], number[b], number[c]});
    surface.source_face.push_back(inside_[f] >= 0 ? inside_[f] : query().closest((points_[a] + points_[b] + points_[c]) / 3, place_[a].face).face);
  }
  connect_half_edges(surface);
  return surface;
}

}  // namespace hybrid_mesh
