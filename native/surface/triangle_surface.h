// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace hybrid_mesh {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

// A point on a triangulated surface: face index and barycentric weights of the face's corners, in their order.
struct SurfacePoint {
  int face = -1;
  std::array<double, 3> weights{0, 0, 0};
};

class SizeField;

// An oriented 2-manifold triangle mesh (with boundary) and its half-edges: half-edge 3 f + i runs from corner i of face f
// to corner (i + 1) % 3. Every point is used by a face; the faces around a point form one fan.
struct TriangleSurface {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  std::vector<int> opposite;               // #F * 3: the half-edge across, -1 at the boundary
  std::vector<int> source_face;            // #F: triangle of the soup as it was read and triangulated, before repair
  std::shared_ptr<const SizeField> sizes;  // that quads on it are to have, where they are not to be even; none: they are

  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int from(int h) const { return faces[h / 3][h % 3]; }
  int to(int h) const { return faces[h / 3][(h + 1) % 3]; }
  bool empty() const { return faces.empty(); }
};

// The weights of a place for the corners of a face; false if it does not lie on the face, an edge or corner of it.
bool weights_on(const SurfacePoint& place, int face, const TriangleSurface& surface, std::array<double, 3>& weights);

double surface_area(const TriangleSurface& surface);

// Fills `opposite` from `faces`. Throws Error{InvalidInput} if an edge has more than two faces or two faces that run
// along it in the same direction.
void connect_half_edges(TriangleSurface& surface);

}  // namespace hybrid_mesh
