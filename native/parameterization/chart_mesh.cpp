// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/chart_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <utility>

#include "base/error.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

double cross(const Complex& a, const Complex& b) { return a.real() * b.imag() - a.imag() * b.real(); }

}  // namespace

Transition Transition::inverse() const {
  Transition t{(4u - turns) & 3u, 0, 0};
  const Complex c = t.rotate(-offset());
  t.x = static_cast<std::int32_t>(c.real());
  t.y = static_cast<std::int32_t>(c.imag());
  return t;
}

Transition operator*(const Transition& a, const Transition& b) {
  const Complex c = a(b.offset());
  return {(a.turns + b.turns) & 3u, static_cast<std::int32_t>(c.real()), static_cast<std::int32_t>(c.imag())};
}

Transition across(int side, int other_side) {
  static const std::array<Complex, 4> square{Complex(0, 0), Complex(1, 0), Complex(1, 1), Complex(0, 1)};
  Transition t{static_cast<unsigned>(other_side + 2 - side + 4) & 3u, 0, 0};
  const Complex c = square[(other_side + 1) % 4] - t.rotate(square[side]);
  t.x = static_cast<std::int32_t>(c.real());
  t.y = static_cast<std::int32_t>(c.imag());
  return t;
}

ChartMesh::ChartMesh(const PatchedSurface& surface, const std::vector<std::array<Vec2, 3>>& corners)
    : mesh(surface.mesh), points(surface.mesh.points), fineness(fineness_at_points(surface.mesh)), chart(surface.patch), sizes_(surface.mesh.sizes) {
  const TriangleSurface& fine = surface.mesh;
  const int faces = static_cast<int>(fine.faces.size());
  gluing.resize(3 * faces);
  corner.resize(3 * faces);
  uv.assign(points.size(), Complex(0, 0));
  kind.assign(points.size(), Kind::Free);
  double area = 0;
  for (const auto& f : fine.faces) {
    const double finer = fineness_on_face(fineness, f[0], f[1], f[2]);
    area += 0.5 * (points[f[1]] - points[f[0]]).cross(points[f[2]] - points[f[0]]).norm() * finer * finer;
  }
  scale = std::sqrt(surface.patch_count() / area);

  // Half-edges along the patches' sides.
  std::vector<int> valence(surface.node_count, 0), vertex_of_node(surface.node_count, -1);
  for (int q = 0; q < surface.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      ++valence[surface.nodes[q][i]];
      vertex_of_node[surface.nodes[q][i]] = surface.sides[q][i].front();
      const PatchSide other = surface.neighbours[q][i];
      if (other.patch < 0) continue;
      const std::vector<int>& side = surface.sides[q][i];
      for (std::size_t k = 1; k < side.size(); ++k) {
        const int h = mesh.find(side[k - 1], side[k]);
        if (h < 0 || surface.patch[h / 3] != q) throw Error(ErrorCode::Internal, "a patch's side is not made of the mesh's edges");
        gluing[h] = across(i, other.side);
      }
    }
  const auto given = [&](int h) { return Complex(corners[h / 3][h % 3].x(), corners[h / 3][h % 3].y()); };
  for (int n = 0; n < surface.node_count; ++n) {
    const int v = vertex_of_node[n];
    if (v < 0) continue;
    const bool boundary = mesh.is_boundary(v);
    if (!boundary && valence[n] != 4) kind[v] = Kind::Cone;
    if (boundary && valence[n] != 2) kind[v] = Kind::Pinned;
  }
  for (int v = 0; v < static_cast<int>(points.size()); ++v) {
    if (!mesh.vertex_alive(v)) continue;
    int h = mesh.out[v];
    if (kind[v] == Kind::Cone) {
      do {
        const Complex z = given(h);
        corner[h] = {0, static_cast<std::int32_t>(std::lround(z.real())), static_cast<std::int32_t>(std::lround(z.imag()))};
        h = mesh.ccw(h);
      } while (h != mesh.out[v]);
      continue;
    }
    uv[v] = given(h);
    corner[h] = Transition();
    for (int g = mesh.ccw(h); g >= 0 && g != mesh.out[v]; g = mesh.ccw(h)) {
      corner[g] = gluing[EditMesh::prev(h)] * corner[h];
      h = g;
    }
    if (mesh.is_boundary(v) && kind[v] == Kind::Free) {
      const Complex d = given(EditMesh::next(mesh.out[v])) - uv[v];
      kind[v] = std::abs(d.real()) > std::abs(d.imag()) ? Kind::SlideU : Kind::SlideV;
    }
  }
  if (surface.sharp.empty()) return;
  sharp.assign(mesh.edge_count, 0);
  for (int q = 0; q < surface.patch_count(); ++q)
    for (int i = 0; i < 4; ++i)
      for (std::size_t k = 1; surface.sharp[q][i] && k < surface.sides[q][i].size(); ++k)
        sharp[mesh.edge[mesh.find(surface.sides[q][i][k - 1], surface.sides[q][i][k])]] = 1;
  hold_features(surface.sharp_corner);
}

// Vertices of features slide along them, but where these turn, branch or end.
void ChartMesh::hold_features(const std::vector<char>& corner) {
  for (int v = 0; v < static_cast<int>(points.size()); ++v) {
    if (!mesh.vertex_alive(v) || kind[v] == Kind::Cone) continue;
    const bool is_corner = v < static_cast<int>(corner.size()) && corner[v];
    std::vector<Complex> along;
    for_star(v, [&](int g, const Complex& a, const Complex&) {
      if (is_sharp(g)) along.push_back(a - uv[v]);
    });
    if (along.empty() && is_corner && mesh.is_boundary(v)) {
      kind[v] = Kind::Pinned;
      held.resize(points.size(), 0);
      held[v] = 1;
    }
    if (along.empty()) continue;
    kind[v] = Kind::Pinned;
    if (is_corner || along.size() != 2 || mesh.is_boundary(v)) continue;
    const bool along_u = std::abs(along[0].real()) > std::abs(along[0].imag());
    const double across = along_u ? std::abs(along[1].imag()) : std::abs(along[1].real());
    if (across == 0 && (along[0] * std::conj(along[1])).real() < 0) kind[v] = along_u ? Kind::SlideU : Kind::SlideV;
  }
}

ChartMesh::ChartMesh(const ChartMesh& charts, EditMesh collapsed, const TriangleSurface& fine, const std::vector<int>& vertex_of,
                     std::vector<char> sharp_edges)
    : mesh(std::move(collapsed)),
      points(fine.points),
      fineness(fineness_at_points(fine)),
      sharp(std::move(sharp_edges)),
      scale(charts.scale),
      sizes_(fine.sizes) {
  const std::size_t halves = mesh.origin.size();
  uv.assign(points.size(), Complex(0, 0));
  kind.assign(points.size(), Kind::Free);
  chart.assign(halves / 3, -1);
  corner.resize(halves);
  gluing.resize(halves);
  flat_.reserve(halves / 3);  // once all is back; what is grown step by step takes twice the room
  double area = 0;
  for (int f = 0; f < static_cast<int>(charts.mesh.alive.size()); ++f)
    if (charts.mesh.alive[f]) {
      const Vec3& a = charts.points[charts.mesh.origin[3 * f]];
      const double finer = charts.finer_on(f);
      area += 0.5 * (charts.points[charts.mesh.origin[3 * f + 1]] - a).cross(charts.points[charts.mesh.origin[3 * f + 2]] - a).norm() * finer * finer;
    }
  scale *= std::sqrt(area / measured_area(fine));
  if (charts.mesh.face_count != mesh.face_count) throw Error(ErrorCode::Internal, "charts are carried to a mesh with other triangles");
  for (int f = 0; f < static_cast<int>(charts.mesh.alive.size()); ++f) {
    if (!charts.mesh.alive[f]) continue;
    const int h = mesh.find(vertex_of[charts.mesh.from(3 * f)], vertex_of[charts.mesh.to(3 * f)]);
    if (h < 0 || mesh.apex(h) != vertex_of[charts.mesh.apex(3 * f)])
      throw Error(ErrorCode::Internal, "charts are carried to a mesh with other triangles");
    chart[h / 3] = charts.chart[f];
    for (int i = 0, g = h; i < 3; ++i, g = EditMesh::next(g)) {
      corner[g] = charts.corner[3 * f + i];
      gluing[g] = charts.gluing[3 * f + i];
    }
  }
  for (int v = 0; v < static_cast<int>(charts.points.size()); ++v)
    if (charts.mesh.vertex_alive(v)) {
      uv[vertex_of[v]] = charts.uv[v];
      kind[vertex_of[v]] = charts.kind[v];
    }
  if (!charts.held.empty()) {
    held.assign(points.size(), 0);
    for (int v = 0; v < static_cast<int>(charts.points.size()); ++v)
      if (charts.mesh.vertex_alive(v)) held[vertex_of[v]] = charts.held[v];
  }
}

std::vector<int> ChartMesh::movable_vertices() const {
  std::vector<int> vertices;
  for (int v = 0; v < static_cast<int>(points.size()); ++v)
    if (mesh.vertex_alive(v) && movable(v)) vertices.push_back(v);
  return vertices;
}

const FlatTriangle& ChartMesh::flat(int f) const {
  if (flat_scale_ != scale) {
    for (Flat& known : flat_) known.corners = {-1, -1, -1};
    flat_scale_ = scale;
  }
  if (flat_at_.size() != chart.size()) flat_at_.resize(chart.size(), -1);
  if (flat_at_[f] < 0) {
    flat_at_[f] = static_cast<std::int32_t>(flat_.size());
    flat_.emplace_back();
  }
  Flat& known = flat_[flat_at_[f]];
  const int a = mesh.origin[3 * f], b = mesh.origin[3 * f + 1], c = mesh.origin[3 * f + 2];
  if (known.corners[0] != a || known.corners[1] != b || known.corners[2] != c)
    known = {{a, b, c}, flatten(points[a], points[b], points[c], scale * fineness_on_face(fineness, a, b, c))};
  return known.triangle;
}

void ChartMesh::remember_flat() const {
  flat_.reserve(mesh.face_count);
  for (int f = 0; f < static_cast<int>(mesh.alive.size()); ++f)
    if (mesh.alive[f]) flat(f);
}

void ChartMesh::forget_flat() {
  flat_ = {};
  flat_at_ = {};
}

double ChartMesh::finer_on(int f) const { return fineness_on_face(fineness, mesh.origin[3 * f], mesh.origin[3 * f + 1], mesh.origin[3 * f + 2]); }

double ChartMesh::squared_length(int a, int b) const {
  const double finer = fineness_on_edge(fineness, a, b);
  return (points[b] - points[a]).squaredNorm() * finer * finer;
}

void ChartMesh::move_point(int v, const Vec3& place) {
  points[v] = place;
  if (!fineness.empty()) fineness[v] = sizes_->fineness(place);
  for (Flat& known : flat_)
    if (std::find(known.corners.begin(), known.corners.end(), v) != known.corners.end()) known.corners = {-1, -1, -1};
}

double ChartMesh::determinant(int f) const {
  const Complex a = at(3 * f), b = at(3 * f + 1), c = at(3 * f + 2);
  return 0.5 * cross(b - a, c - a) / flat(f).area;
}

bool ChartMesh::can_collapse(int h) const {
  const int v = mesh.from(h);
  if (kind[v] == Kind::Cone || kind[v] == Kind::Pinned) return false;
  if (slides_inside(v)) {
    // Along its line only, the rest of which must not be merged with an edge beside it.
    if (!is_sharp(h) || is_sharp(EditMesh::prev(h)) || is_sharp(EditMesh::next(mesh.opposite[h]))) return false;
  }
  return mesh.can_collapse(h);
}

bool ChartMesh::collapse_keeps_map(int h, double least_determinant, double least_shape) const {
  const int v = mesh.from(h), u = mesh.to(h);
  const Complex target = corner[h].back(at(EditMesh::next(h)));
  bool good = true;
  double fan = 0;  // the angle that the new triangles fill at u
  for_star(v, [&](int g, const Complex& a, const Complex& b) {
    const int p = mesh.to(g), q = mesh.apex(g);
    if (!good || p == u || q == u) return;
    const Vec3 x = points[p] - points[u], y = points[q] - points[u];
    const double area = x.cross(y).norm(), sum = x.squaredNorm() + y.squaredNorm() + (x - y).squaredNorm();
    if (!(area > least_shape * sum)) {
      good = false;
      return;
    }
    const double signed_area = 0.5 * cross(b - a, target - a), length = scale * fineness_on_face(fineness, p, q, u);
    if (!(signed_area > least_determinant * 0.5 * area * length * length)) good = false;
    fan += std::arg((b - target) * std::conj(a - target));
  });
  // v could not come back into a fan of a full turn, which only a cone of five or more quads has room for. The fan may still widen, and u become
  // such a cone.
  return good && fan < (kind[u] == Kind::Cone ? 3.0 : 4.0);
}

bool ChartMesh::collapse_keeps_area(int h) const {
  const int v = mesh.from(h);
  const Vec3& target = points[mesh.to(h)];
  double before = 0, after = 0;
  for_star(v, [&](int g, const Complex&, const Complex&) {
    const Vec3 &p = points[mesh.to(g)], &q = points[mesh.apex(g)];
    before += (p - points[v]).cross(q - points[v]).norm();
    after += (p - target).cross(q - target).norm();
  });
  return after <= before * (1 + 1e-9);
}

void ChartMesh::collapse(int h) {
  const int o = mesh.opposite[h];
  const auto glue = [&](int kept, int lost) {  // of a dead face, as in EditMesh
    const int x = mesh.opposite[kept], y = mesh.opposite[lost];
    if (x < 0 || y < 0) return;
    gluing[x] = gluing[lost] * gluing[x];
    gluing[y] = gluing[x].inverse();
  };
  // u's transitions in the faces that it takes over, walking around v from the face that holds both.
  Transition t = corner[EditMesh::next(h)];
  int g = h;
  for (;;) {
    const int n = mesh.ccw(g);
    if (n < 0 || n == h) break;
    t = gluing[EditMesh::prev(g)] * t;
    g = n;
    if (o < 0 || g / 3 != o / 3) corner[g] = t;
  }
  glue(EditMesh::next(h), EditMesh::prev(h));
  if (o >= 0) glue(EditMesh::prev(o), EditMesh::next(o));
  mesh.collapse(h);
}

bool ChartMesh::undo_collapse(int h) {
  const int o = mesh.opposite[h];
  const int h1 = EditMesh::next(h), h2 = EditMesh::prev(h), x = mesh.opposite[h1], y = mesh.opposite[h2];
  // The revived face shares the chart of its neighbour in v's star, or of its other neighbour where there is none.
  chart[h / 3] = chart[(y >= 0 ? y : x) / 3];
  if (y >= 0) {
    corner[h1] = corner[y];
    corner[h2] = corner[EditMesh::next(y)];
    gluing[h1] = gluing[y];
    gluing[h2] = gluing[y] = Transition();
  } else {
    corner[h1] = corner[EditMesh::next(x)];
    corner[h2] = corner[x];
    gluing[h1] = gluing[x] = Transition();
  }
  if (o >= 0) {
    const int o1 = EditMesh::next(o), o2 = EditMesh::prev(o), x2 = mesh.opposite[o1];
    // v is interior, or the collapse went along the boundary with no face here: x2 exists.
    chart[o / 3] = chart[x2 / 3];
    corner[o] = corner[EditMesh::next(x2)];
    corner[o2] = corner[x2];
    gluing[o2] = gluing[x2];
    gluing[o1] = gluing[x2] = Transition();
  }
  mesh.undo_collapse(h);
  const int v = mesh.from(h);
  // v's frame is the chart of the revived face.
  corner[h] = Transition();
  Transition t;
  int g = h;
  for (;;) {
    const int n = mesh.ccw(g);
    if (n < 0 || n == h) break;
    t = gluing[EditMesh::prev(g)] * t;
    g = n;
    corner[g] = t;
  }
  if (o >= 0) {
    gluing[o] = corner[EditMesh::next(o)].inverse();  // from the second revived face to the first, whose chart is v's frame
    gluing[h] = corner[EditMesh::next(o)];
  }
  return place(v);
}

double ChartMesh::angle_at(int v) const {
  double sum = 0;
  int h = mesh.out[v];
  do {
    const Complex p = at(h);
    sum += std::arg((at(EditMesh::prev(h)) - p) * std::conj(at(EditMesh::next(h)) - p));
    h = mesh.ccw(h);
  } while (h >= 0 && h != mesh.out[v]);
  return sum;
}

bool ChartMesh::place(int v) {
  std::vector<Complex> from, to, line;  // line: its neighbours on the boundary or a feature
  for_star(v, [&](int h, const Complex& a, const Complex& b) {
    from.push_back(a);
    to.push_back(b);
    if (is_sharp(h)) line.push_back(a);
  });
  const std::size_t n = from.size();
  if (mesh.is_boundary(v)) line = {from.front(), to.back()};
  // Least doubled area of the star's triangles; not positive where they wind around v more than once, as they can beside a cone of many quads.
  const auto depth = [&](const Complex& p) {
    double least = 1e300, angle = 0;
    for (std::size_t i = 0; i < n; ++i) {
      least = std::min(least, cross(to[i] - from[i], p - from[i]));
      angle += std::arg((to[i] - p) * std::conj(from[i] - p));
    }
    return angle < 9 ? least : -1.0;
  };
  if (!line.empty()) {
    // Between its neighbours there, which lie on one line of the grid.
    const Complex a = line.front(), b = line.back(), d = b - a;
    const bool along_u = std::abs(d.real()) > std::abs(d.imag());
    kind[v] = along_u ? Kind::SlideU : Kind::SlideV;
    for (const double t : {0.5, 0.7, 0.3, 0.85, 0.15, 0.95, 0.05, 0.99, 0.01, 0.999, 0.001}) {
      uv[v] = along_u ? Complex(a.real() + t * d.real(), a.imag()) : Complex(a.real(), a.imag() + t * d.imag());
      if (depth(uv[v]) > 0) return true;
    }
    return false;
  }
  kind[v] = Kind::Free;
  Complex mean(0, 0);
  for (const Complex& p : from) mean += p;
  mean /= static_cast<double>(n);
  Complex best = mean;
  double most = depth(mean);
  // Otherwise the middle of the kernel: a box around the ring, cut by the line of every edge.
  if (!(most > 0)) {
    double left = 1e300, right = -1e300, bottom = 1e300, top = -1e300;
    for (const Complex& p : from) {
      left = std::min(left, p.real()), right = std::max(right, p.real());
      bottom = std::min(bottom, p.imag()), top = std::max(top, p.imag());
    }
    std::vector<Complex> kernel{{left, bottom}, {right, bottom}, {right, top}, {left, top}}, cut;
    for (std::size_t i = 0; i < n && !kernel.empty(); ++i) {
      cut.clear();
      const Complex edge = to[i] - from[i];
      for (std::size_t k = 0; k < kernel.size(); ++k) {
        const Complex &a = kernel[k], &b = kernel[(k + 1) % kernel.size()];
        const double da = cross(edge, a - from[i]), db = cross(edge, b - from[i]);
        if (da >= 0) cut.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) cut.push_back(a + (b - a) * (da / (da - db)));
      }
      kernel.swap(cut);
    }
    Complex middle(0, 0);
    for (const Complex& p : kernel) middle += p / static_cast<double>(kernel.size());
    if (!kernel.empty() && depth(middle) > most) most = depth(middle), best = middle;
  }
  uv[v] = best;
  return most > 0;
}

}  // namespace hybrid_mesh
