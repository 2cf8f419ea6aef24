// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>

#include "base/tolerances.h"
#include "surface/repair_stages.h"

namespace hybrid_mesh {

namespace {

// A face without area has a corner on the line between the two others. To leave it out would tear the surface open there: its long edge
// belongs to one neighbour, its two short edges to others. So the long edge is flipped instead, which splits the neighbour across it at that
// corner: the surface stays the same set of points. Only a face whose long edge is a boundary is left out, and so is a component that
// has no area at all. Where the flip would make an edge that exists already, the face stays.
class DegenerateFaces {
 public:
  explicit DegenerateFaces(RepairMesh& mesh) : mesh_(mesh), dropped_(mesh.faces.size(), 0) {}

  // The number of degenerate faces there were, without those that stay.
  std::int64_t remove() {
    const int face_count = static_cast<int>(mesh_.faces.size());
    std::deque<int> pending;
    std::int64_t found = 0, stuck = 0;
    for (int f = 0; f < face_count; ++f)
      if (degenerate(mesh_.faces[f])) ++found, pending.push_back(f);
    if (found == 0) return 0;
    drop_flat_components();
    // Every flip lowers the number of degenerate faces or, at the same number, the total length of edges, so that this ends; the bound is
    // for rounding.
    for (std::int64_t steps = 64 * found; !pending.empty() && steps > 0; --steps) {
      const int f = pending.front();
      pending.pop_front();
      if (!dropped_[f] && degenerate(mesh_.faces[f])) resolve(f, pending);
    }
    std::vector<char> keep(face_count);
    bool all = true;
    for (int f = 0; f < face_count; ++f) {
      keep[f] = !dropped_[f];
      all = all && keep[f];
      stuck += keep[f] && degenerate(mesh_.faces[f]);
    }
    if (!all) mesh_.keep_faces(keep);
    return std::max<std::int64_t>(0, found - stuck);
  }

 private:
  double length(int a, int b) const { return (mesh_.position(a) - mesh_.position(b)).norm(); }

  bool degenerate(const std::array<int, 3>& face) const {
    const Vec3 &a = mesh_.position(face[0]), &b = mesh_.position(face[1]), &c = mesh_.position(face[2]);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    if (longest == 0) return true;
    // Unit length first: faces may be tiny against the model.
    const double height = ((b - a) / longest).cross((c - a) / longest).norm() * longest;
    const double largest = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
    return height <= tolerance::degenerate_height * largest;
  }

  void drop_flat_components() {
    int count = 0;
    const std::vector<int> component = mesh_.components(count);
    std::vector<char> flat(count, 1);
    for (std::size_t f = 0; f < component.size(); ++f)
      if (flat[component[f]] && !degenerate(mesh_.faces[f])) flat[component[f]] = 0;
    for (std::size_t f = 0; f < component.size(); ++f)
      if (flat[component[f]]) drop(static_cast<int>(f));
  }

  void drop(int f) {
    for (int h = 3 * f; h < 3 * f + 3; ++h) mesh_.cut(h);
    dropped_[f] = 1;
  }

  int longest_edge(int f) const {
    int best = 3 * f;
    double most = -1;
    for (int h = 3 * f; h < 3 * f + 3; ++h)
      if (const double l = length(mesh_.from(h), mesh_.to(h)); l > most) most = l, best = h;
    return best;
  }

  // Whether two vertices are joined by an edge of the first one's fan, gone through from its corner at half-edge h.
  bool joined(int h, int vertex) const {
    int c = h;
    do {
      if (mesh_.to(c) == vertex || mesh_.apex(c) == vertex) return true;
      c = mesh_.mate[TriangleSurface::previous(c)];
    } while (c >= 0 && c != h);
    if (c == h) return false;
    for (c = mesh_.mate[h]; c >= 0; c = mesh_.mate[c]) {
      c = TriangleSurface::next(c);
      if (mesh_.to(c) == vertex || mesh_.apex(c) == vertex) return true;
    }
    return false;
  }

  void resolve(int f, std::deque<int>& pending) {
    const int h = longest_edge(f), g = mesh_.mate[h];
    if (g < 0) {
      std::array<int, 2> beside{mesh_.mate[TriangleSurface::next(h)], mesh_.mate[TriangleSurface::previous(h)]};
      drop(f);
      for (const int m : beside)
        if (m >= 0) pending.push_back(m / 3);
      return;
    }
    // f = (a, b, c), its neighbour (b, a, d): they become (c, a, d) and (c, d, b).
    const int n = g / 3;
    const int a = mesh_.from(h), b = mesh_.to(h), c = mesh_.apex(h), d = mesh_.apex(g);
    if (c == d || joined(TriangleSurface::previous(h), d)) return;
    const std::array<int, 3> first{c, a, d}, second{c, d, b};
    const int before = 1 + degenerate(mesh_.faces[n]), after = degenerate(first) + degenerate(second);
    if (after > before || (after == before && length(c, d) >= length(a, b) * (1 - 1e-12))) return;
    const int bc = mesh_.mate[TriangleSurface::next(h)], ca = mesh_.mate[TriangleSurface::previous(h)];
    const int ad = mesh_.mate[TriangleSurface::next(g)], db = mesh_.mate[TriangleSurface::previous(g)];
    mesh_.faces[f] = first;
    mesh_.faces[n] = second;
    mesh_.source[f] = mesh_.source[n];  // both lie where the neighbour was
    const auto set = [&](int half_edge, int mate) {
      mesh_.mate[half_edge] = mate;
      if (mate >= 0) mesh_.mate[mate] = half_edge;
    };
    set(3 * f, ca), set(3 * f + 1, ad);
    set(3 * n + 1, db), set(3 * n + 2, bc);
    mesh_.glue(3 * f + 2, 3 * n);
    for (const int face : {f, n}) {
      pending.push_back(face);
      for (int k = 3 * face; k < 3 * face + 3; ++k)
        if (mesh_.mate[k] >= 0 && mesh_.mate[k] / 3 != f && mesh_.mate[k] / 3 != n) pending.push_back(mesh_.mate[k] / 3);
    }
  }

  RepairMesh& mesh_;
  std::vector<char> dropped_;
};

}  // namespace

void remove_degenerate_faces(RepairMesh& mesh, RepairReport& report) { report.degenerate_faces += DegenerateFaces(mesh).remove(); }

}  // namespace hybrid_mesh
