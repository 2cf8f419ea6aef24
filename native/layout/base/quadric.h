// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Garland, Heckbert, Surface simplification using quadric error metrics, 1997.
#pragma once

#include <algorithm>
#include <vector>

#include "surface/edit_mesh.h"

namespace hybrid_mesh {

// Squared distances to weighted planes: p^T A p + 2 b^T p + c.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, bx = 0, by = 0, bz = 0, c = 0;

  void add_plane(const Vec3& n, double d, double weight) {
    xx += weight * n.x() * n.x(), xy += weight * n.x() * n.y(), xz += weight * n.x() * n.z();
    yy += weight * n.y() * n.y(), yz += weight * n.y() * n.z(), zz += weight * n.z() * n.z();
    bx += weight * d * n.x(), by += weight * d * n.y(), bz += weight * d * n.z();
    c += weight * d * d;
  }
  void operator+=(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    bx += o.bx, by += o.by, bz += o.bz, c += o.c;
  }
  double operator()(const Vec3& p) const {
    const double e =
        p.x() * (xx * p.x() + 2 * (xy * p.y() + xz * p.z() + bx)) + p.y() * (yy * p.y() + 2 * (yz * p.z() + by)) + p.z() * (zz * p.z() + 2 * bz) + c;
    return std::max(e, 0.0);
  }
};

// What a vertex of a decimated mesh stands for: the planes of the faces it came from, and a third of their areas.
struct VertexQuadric {
  Quadric planes;
  double area = 0;
};

// Adds a face's plane and its part of the area to what its corners stand for, and for its boundary sides planes upright on it.
void add_face(const EditMesh& mesh, const std::vector<Vec3>& points, int f, std::vector<VertexQuadric>& quadrics);

}  // namespace hybrid_mesh
