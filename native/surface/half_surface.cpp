// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/half_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "surface/closest_point.h"
#include "surface/placement.h"

namespace hybrid_mesh {
namespace {

constexpr double kSnap = 2e-5, kSnapOfEdge = 0.02;  // of the diagonal, of a vertex's shortest edge
constexpr double kSameSide = 0.3;                   // cosine between normals of counterparts

using Edge = std::pair<int, int>;

class Cut {
 public:
  Cut(const TriangleSurface& whole, const MirrorPlane& plane)
      : whole_(whole), plane_(plane), side_(whole.points.size(), 0), kept_(whole.points.size(), -1) {}

  HalfSurface run() {
    tell_sides();
    if (std::find(side_.begin(), side_.end(), 1) == side_.end() || std::find(side_.begin(), side_.end(), -1) == side_.end())
      throw Error(ErrorCode::InvalidInput, "the surface lies wholly on one side of the plane of symmetry");
    for (std::size_t f = 0; f < whole_.faces.size(); ++f) clip(static_cast<int>(f));
    connect_half_edges(out_.mesh);
    part_fans();
    split_bridges();
    mark();
    return std::move(out_);
  }

 private:
  void tell_sides() {
    const double most = kSnap * placement_of(whole_.points).diagonal;
    std::vector<double> shortest(whole_.points.size(), std::numeric_limits<double>::infinity());
    for (int h = 0; h < static_cast<int>(whole_.opposite.size()); ++h) {
      const double length = (whole_.points[whole_.to(h)] - whole_.points[whole_.from(h)]).norm();
      for (const int v : {whole_.from(h), whole_.to(h)}) shortest[v] = std::min(shortest[v], length);
    }
    for (std::size_t v = 0; v < side_.size(); ++v) {
      const double height = plane_.height(whole_.points[v]);
      if (std::abs(height) > std::min(most, kSnapOfEdge * shortest[v])) side_[v] = height > 0 ? 1 : -1;
    }
  }

  int add(const Vec3& p, const SurfacePoint& place, bool in_plane) {
    out_.mesh.points.push_back(p);
    out_.place.push_back(place);
    in_plane_.push_back(in_plane);
    return static_cast<int>(out_.mesh.points.size()) - 1;
  }

  int kept(int f, int i) {
    const int v = whole_.faces[f][i];
    if (kept_[v] < 0) {
      SurfacePoint place{f, {0, 0, 0}};
      place.weights[i] = 1;
      kept_[v] = add(side_[v] == 0 ? plane_.onto(whole_.points[v]) : whole_.points[v], place, side_[v] == 0);
    }
    return kept_[v];
  }

  // Where the plane crosses side i of a face.
  int crossing(int f, int i) {
    const int j = (i + 1) % 3, a = whole_.faces[f][i], b = whole_.faces[f][j];
    const auto [at, fresh] = crossings_.insert({std::minmax(a, b), -1});
    if (fresh) {
      const double ha = plane_.height(whole_.points[a]), hb = plane_.height(whole_.points[b]), t = ha / (ha - hb);
      SurfacePoint place{f, {0, 0, 0}};
      place.weights[i] = 1 - t, place.weights[j] = t;
      at->second = add(plane_.onto((1 - t) * whole_.points[a] + t * whole_.points[b]), place, true);
    }
    return at->second;
  }

  void clip(int f) {
    const auto side = [&](int i) { return side_[whole_.faces[f][i % 3]]; };
    if (side(0) <= 0 && side(1) <= 0 && side(2) <= 0) return;
    std::vector<int> polygon;
    for (int i = 0; i < 3; ++i) {
      if (side(i) >= 0) polygon.push_back(kept(f, i));
      if (side(i) * side(i + 1) < 0) polygon.push_back(crossing(f, i));
    }
    const std::vector<Vec3>& p = out_.mesh.points;
    if (polygon.size() == 4 && (p[polygon[1]] - p[polygon[3]]).squaredNorm() < (p[polygon[0]] - p[polygon[2]]).squaredNorm())
      std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k) add_face({polygon[0], polygon[k], polygon[k + 1]}, f);
  }
  void add_face(const std::array<int, 3>& face, int source) {
    out_.mesh.faces.push_back(face);
    out_.mesh.source_face.push_back(source);
  }

  // Faces that share a point without sharing edges there get points of their own.
  void part_fans() {
    TriangleSurface& mesh = out_.mesh;
    std::vector<char> seen(mesh.opposite.size(), 0), used(mesh.points.size(), 0);
    for (int start = 0; start < static_cast<int>(seen.size()); ++start) {
      if (seen[start]) continue;
      int h = start;
      // Clockwise to the fan's first half-edge, or once around.
      while (mesh.opposite[h] >= 0 && (h = TriangleSurface::next(mesh.opposite[h])) != start) {
      }
      const int first = h, v = mesh.from(h);
      int name = v;
      if (used[v]) {
        const SurfacePoint place = out_.place[v];
        name = add(Vec3(mesh.points[v]), place, in_plane_[v]);
      } else {
        used[v] = 1;
      }
      do {
        seen[h] = 1;
        mesh.faces[h / 3][h % 3] = name;
        h = mesh.opposite[TriangleSurface::previous(h)];
      } while (h >= 0 && h != first);
    }
  }

  // A boundary of the whole surface that runs in the plane is joined with its image as well.
  bool is_cut(int h) const { return out_.mesh.opposite[h] < 0 && in_plane_[out_.mesh.from(h)] && in_plane_[out_.mesh.to(h)]; }

  std::vector<char> cut_points() const {
    std::vector<char> on(out_.mesh.points.size(), 0);
    for (int h = 0; h < static_cast<int>(out_.mesh.opposite.size()); ++h)
      if (is_cut(h)) on[out_.mesh.from(h)] = on[out_.mesh.to(h)] = 1;
    return on;
  }

  void split_bridges() {
    TriangleSurface& mesh = out_.mesh;
    const std::vector<char> on = cut_points();
    std::map<Edge, int> middles;
    for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
      const int a = mesh.from(h), b = mesh.to(h);
      if (!on[a] || !on[b] || is_cut(h)) continue;
      const auto [at, fresh] = middles.insert({std::minmax(a, b), -1});
      if (!fresh) continue;
      const int f = mesh.source_face[h / 3];
      std::array<double, 3> wa{}, wb{};
      SurfacePoint place{f, {1, 0, 0}};
      if (weights_on(out_.place[a], f, whole_, wa) && weights_on(out_.place[b], f, whole_, wb))
        for (int i = 0; i < 3; ++i) place.weights[i] = 0.5 * (wa[i] + wb[i]);
      at->second = add(0.5 * (mesh.points[a] + mesh.points[b]), place, false);
    }
    if (middles.empty()) return;
    const std::vector<std::array<int, 3>> faces = std::exchange(mesh.faces, {});
    const std::vector<int> sources = std::exchange(mesh.source_face, {});
    for (std::size_t f = 0; f < faces.size(); ++f) {
      std::array<int, 3> c = faces[f], m{};
      int split = 0;
      const auto find = [&] {
        split = 0;
        for (int i = 0; i < 3; ++i) {
          const auto at = middles.find(std::minmax(c[i], c[(i + 1) % 3]));
          m[i] = at == middles.end() ? -1 : at->second;
          split += m[i] >= 0;
        }
      };
      find();
      // One split side: side 0. Two: sides 0 and 1.
      while (split > 0 && split < 3 && !(m[0] >= 0 && m[2] < 0)) {
        std::rotate(c.begin(), c.begin() + 1, c.end());
        find();
      }
      const int source = sources[f];
      if (split == 0) {
        add_face(c, source);
      } else if (split == 1) {
        add_face({c[0], m[0], c[2]}, source);
        add_face({m[0], c[1], c[2]}, source);
      } else if (split == 2) {
        add_face({m[0], c[1], m[1]}, source);
        add_face({c[0], m[0], m[1]}, source);
        add_face({c[0], m[1], c[2]}, source);
      } else {
        for (int i = 0; i < 3; ++i) add_face({c[i], m[i], m[(i + 2) % 3]}, source);
        add_face(m, source);
      }
    }
    connect_half_edges(mesh);
  }

  void mark() {
    out_.on_plane = cut_points();
    out_.corner.assign(out_.mesh.points.size(), 0);
    out_.cut_euler = static_cast<int>(std::count(out_.on_plane.begin(), out_.on_plane.end(), 1));
    for (int h = 0; h < static_cast<int>(out_.mesh.opposite.size()); ++h) {
      if (is_cut(h)) {
        --out_.cut_euler;
      } else if (out_.mesh.opposite[h] < 0) {
        for (const int v : {out_.mesh.from(h), out_.mesh.to(h)}) out_.corner[v] = out_.on_plane[v];
      }
    }
  }

  const TriangleSurface& whole_;
  const MirrorPlane& plane_;
  HalfSurface out_;
  std::vector<int> side_;       // per point of the whole
  std::vector<int> kept_;       // per point of the whole
  std::vector<char> in_plane_;  // per point of the half
  std::map<Edge, int> crossings_;
};

std::vector<Vec3> face_normals(const TriangleSurface& surface) {
  std::vector<Vec3> normals;
  for (const auto& f : surface.faces) {
    const Vec3& a = surface.points[f[0]];
    normals.push_back((surface.points[f[1]] - a).cross(surface.points[f[2]] - a));
  }
  return normals;
}

}  // namespace

HalfSurface cut_in_half(const TriangleSurface& whole, const MirrorPlane& plane) { return Cut(whole, plane).run(); }

TriangleSurface joined_with_image(const HalfSurface& half, const MirrorPlane& plane) {
  TriangleSurface out = half.mesh;
  std::vector<int> image;
  for (std::size_t v = 0; v < half.mesh.points.size(); ++v) {
    image.push_back(half.on_plane[v] ? static_cast<int>(v) : static_cast<int>(out.points.size()));
    if (!half.on_plane[v]) out.points.push_back(plane.reflected(half.mesh.points[v]));
  }
  for (std::size_t f = 0; f < half.mesh.faces.size(); ++f) {
    const auto& c = half.mesh.faces[f];
    out.faces.push_back({image[c[0]], image[c[2]], image[c[1]]});
    out.source_face.push_back(half.mesh.source_face[f]);
  }
  connect_half_edges(out);
  return out;
}

TriangleSurface averaged_with_image(const TriangleSurface& whole, const MirrorPlane& plane, const Progress& progress) {
  const int count = static_cast<int>(whole.points.size());
  const SurfaceDistanceQuery query(whole, progress);
  const std::vector<Vec3> of_face = face_normals(whole);
  std::vector<Vec3> normal(count, Vec3::Zero()), move(count, Vec3::Zero());
  std::vector<std::vector<int>> around(count);
  for (std::size_t f = 0; f < whole.faces.size(); ++f)
    for (int i = 0; i < 3; ++i) {
      normal[whole.faces[f][i]] += of_face[f];
      around[whole.faces[f][i]].push_back(whole.faces[f][(i + 1) % 3]);
      around[whole.faces[f][i]].push_back(whole.faces[f][(i + 2) % 3]);
    }
  std::vector<char> known(count, 0);
  const MirrorPlane through_origin{plane.normal, 0};
  parallel_for_each_index(count, [&](std::int64_t v) {
    if (v % 256 == 0) progress.check();
    const ClosestPoint c = query.closest(plane.reflected(whole.points[v]));
    Vec3 nearest = Vec3::Zero();
    for (int k = 0; k < 3; ++k) nearest += c.weights[k] * whole.points[whole.faces[c.face][k]];
    const Vec3 facing = through_origin.reflected(normal[v]);
    if (facing.dot(of_face[c.face]) < kSameSide * facing.norm() * of_face[c.face].norm()) return;
    known[v] = 1;
    move[v] = 0.5 * (plane.reflected(nearest) - whole.points[v]);
  });
  // What has no counterpart follows its surroundings, outwards from those that have one.
  for (bool any = true; any;) {
    any = false;
    const std::vector<char> before = known;
    for (int v = 0; v < count; ++v) {
      if (before[v]) continue;
      Vec3 sum = Vec3::Zero();
      int n = 0;
      for (const int w : around[v])
        if (before[w]) sum += move[w], ++n;
      if (n == 0) continue;
      move[v] = sum / n;
      known[v] = 1;
      any = true;
    }
  }
  TriangleSurface out = whole;
  for (int v = 0; v < count; ++v) out.points[v] += move[v];
  return out;
}

}  // namespace hybrid_mesh
