// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/edit_mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

namespace hybrid_mesh {
namespace {

// The vertices around one, held without an allocation unless there are uncommonly many.
class SmallRing {
 public:
  void add(int v) {
    if (count_ < std::ssize(few_))
      few_[count_++] = v;
    else
      more_.push_back(v);
  }
  bool has(int v) const {
    return std::find(few_.begin(), few_.begin() + count_, v) != few_.begin() + count_ || std::find(more_.begin(), more_.end(), v) != more_.end();
  }

 private:
  std::array<int, 24> few_;
  std::ptrdiff_t count_ = 0;
  std::vector<int> more_;
};

}  // namespace

EditMesh::EditMesh(const TriangleSurface& surface) {
  const int faces = static_cast<int>(surface.faces.size());
  origin.resize(3 * faces);
  opposite = surface.opposite;
  edge.assign(3 * faces, -1);
  out.assign(surface.points.size(), -1);
  alive.assign(faces, 1);
  vertex_live.assign(surface.points.size(), 0);
  face_count = faces;
  for (int h = 0; h < 3 * faces; ++h) {
    origin[h] = surface.from(h);
    if (edge[h] < 0) {
      edge[h] = edge_count++;
      if (opposite[h] >= 0) edge[opposite[h]] = edge[h];
    }
  }
  for (int h = 0; h < 3 * faces; ++h)
    if (out[origin[h]] < 0 || opposite[h] < 0) out[origin[h]] = h;
  for (std::size_t v = 0; v < out.size(); ++v)
    if (out[v] >= 0) {
      vertex_live[v] = 1;
      ++vertex_count;
    }
}

int EditMesh::valence(int v) const {
  int n = 0;
  int h = out[v];
  do {
    ++n;
    const int g = ccw(h);
    if (g < 0) return n + 1;
    h = g;
  } while (h != out[v]);
  return n;
}

void EditMesh::ring(int v, std::vector<int>& vertices) const {
  vertices.clear();
  for_ring(v, [&](int w) { vertices.push_back(w); });
}

void EditMesh::grow(std::vector<int>& vertices, int rings) const {
  std::vector<int> around;
  for (; rings > 0; --rings) {
    const std::vector<int> seed = vertices;
    for (const int v : seed) {
      ring(v, around);
      for (const int w : around)
        if (std::find(vertices.begin(), vertices.end(), w) == vertices.end()) vertices.push_back(w);
    }
  }
}

std::vector<int> EditMesh::boundary_loops() const {
  std::vector<int> loop(out.size(), -1);
  int count = 0;
  for (int first = 0; first < static_cast<int>(out.size()); ++first) {
    if (!vertex_live[first] || !is_boundary(first) || loop[first] >= 0) continue;
    for (int v = first; loop[v] < 0; v = to(out[v])) loop[v] = count;
    ++count;
  }
  return loop;
}

int EditMesh::find(int a, int b) const {
  int h = out[a];
  do {
    if (to(h) == b) return h;
    h = ccw(h);
  } while (h >= 0 && h != out[a]);
  return -1;
}

void EditMesh::fix_out(int v, int h) {
  out[v] = h;
  for (int g = cw(h); g >= 0; g = cw(g)) {
    if (g == h) return;
    out[v] = g;
  }
}

bool EditMesh::can_collapse(int h) const {
  const int v = from(h), u = to(h), o = opposite[h];
  const int a = apex(h), b = o >= 0 ? apex(o) : -1;
  const bool v_boundary = is_boundary(v);
  if (v_boundary && o >= 0) {
    return false;  // a boundary vertex moves along the boundary only; such an edge has a face on one side
  }
  // An edge whose only face is on the other side is reached through that face's half-edge, which leaves u, not v.
  if (opposite[next(h)] < 0 && opposite[prev(h)] < 0) return false;
  if (o >= 0 && opposite[next(o)] < 0 && opposite[prev(o)] < 0) return false;
  // Inside, fewer than four edges.
  const auto is_thin = [&](int w) {
    int g = out[w];
    for (int n = 0; n < 3; ++n) {
      g = ccw(g);
      if (g < 0) return false;
      if (g == out[w]) return true;
    }
    return false;
  };
  if (is_thin(a) || (b >= 0 && is_thin(b))) return false;
  const bool v_thin = !v_boundary && is_thin(v);
  // A tetrahedron, or v in the middle of a face whose mirror image exists.
  if (v_thin && is_thin(u)) return false;
  // The link condition: the only common neighbours are the apexes.
  SmallRing around_u;
  for_ring(u, [&](int w) { around_u.add(w); });
  bool shared = false;
  for_ring(v, [&](int w) { shared |= w != u && w != a && w != b && around_u.has(w); });
  if (shared) return false;
  // At a valence-3 vertex the new face (u, a, b) must not exist already.
  if (v_thin) {
    const int e = find(u, b);
    if (e >= 0 && apex(e) == a) return false;
  }
  return true;
}

void EditMesh::collapse(int h) {
  const int v = from(h), u = to(h), o = opposite[h];
  int g = out[v];
  const int first = g;
  do {
    const int n = ccw(g);
    if (g != h && g / 3 != (o >= 0 ? o / 3 : -1)) origin[g] = u;
    g = n;
  } while (g >= 0 && g != first);
  const auto glue = [&](int kept, int lost) {  // half-edges of a dead face: its edge at u, its edge at v
    const int x = opposite[kept], y = opposite[lost];
    if (x >= 0) opposite[x] = y;
    if (y >= 0) {
      opposite[y] = x;
      edge[y] = edge[kept];
    }
  };
  const int f = h / 3;
  const int a = apex(h), h1 = next(h), h2 = prev(h);
  glue(h1, h2);
  alive[f] = 0;
  --face_count;
  const int x = opposite[h1], y = opposite[h2];
  int leaving_u = y >= 0 ? y : next(x);
  if (out[a] / 3 == f) fix_out(a, x >= 0 ? x : next(y));
  if (o >= 0) {
    const int b = apex(o), o1 = next(o), o2 = prev(o);
    glue(o2, o1);
    alive[o / 3] = 0;
    --face_count;
    const int x2 = opposite[o1], y2 = opposite[o2];
    if (out[b] / 3 == o / 3) fix_out(b, x2 >= 0 ? x2 : next(y2));
    if (leaving_u < 0) leaving_u = x2 >= 0 ? next(x2) : y2;
  }
  fix_out(u, leaving_u);
  vertex_live[v] = 0;
  --vertex_count;
}

void EditMesh::undo_collapse(int h) {
  const int v = from(h), u = to(h), o = opposite[h];
  const auto unglue = [&](int kept, int lost) {
    const int x = opposite[kept], y = opposite[lost];
    if (x >= 0) opposite[x] = kept;
    if (y >= 0) {
      opposite[y] = lost;
      edge[y] = edge[lost];
    }
  };
  unglue(next(h), prev(h));
  alive[h / 3] = 1;
  ++face_count;
  if (o >= 0) {
    unglue(prev(o), next(o));
    alive[o / 3] = 1;
    ++face_count;
  }
  vertex_live[v] = 1;
  ++vertex_count;
  int g = h;
  do {
    origin[g] = v;
    const int n = ccw(g);
    if (n < 0) break;
    g = n;
  } while (g != h);
  if (g != h || ccw(g) < 0) {
    for (g = cw(h); g >= 0 && g != h; g = cw(g)) origin[g] = v;
  }
  fix_out(v, h);
  fix_out(u, next(h));
  fix_out(apex(h), prev(h));
  if (o >= 0) fix_out(apex(o), prev(o));
}

bool EditMesh::can_flip(int h) const {
  const int o = opposite[h];
  if (o < 0) return false;
  return !adjacent(apex(h), apex(o));
}

void EditMesh::flip(int h) {
  const int o = opposite[h];
  const int n = next(h), p = prev(h), on = next(o), op = prev(o);
  const int a = origin[h], b = origin[o], c = origin[p], d = origin[op];
  const int x_n = opposite[n], x_p = opposite[p], x_on = opposite[on], x_op = opposite[op];
  const int e_n = edge[n], e_p = edge[p], e_on = edge[on], e_op = edge[op];
  origin[h] = d, origin[n] = c, origin[p] = a;
  origin[o] = c, origin[on] = d, origin[op] = b;
  const auto link = [&](int x, int y, int name) {
    opposite[x] = y;
    edge[x] = name;
    if (y >= 0) opposite[y] = x;
  };
  link(n, x_p, e_p);
  link(p, x_on, e_on);
  link(on, x_op, e_op);
  link(op, x_n, e_n);
  fix_out(a, p);
  fix_out(b, op);
  fix_out(c, n);
  fix_out(d, on);
}

void EditMesh::undo_flip(int h) {
  for (int i = 0; i < 3; ++i) flip(h);
}

int EditMesh::split(int h) {
  const int o = opposite[h], m = static_cast<int>(out.size());
  out.push_back(-1);
  vertex_live.push_back(1);
  ++vertex_count;
  const int far_name = edge_count++;  // of the half beyond the new vertex
  // The face beside g = (x, y, z) keeps x, the fresh one has y: (m, y, z).
  const auto halve = [&](int g) {
    const int n = next(g), y = origin[n], z = origin[prev(g)], f = static_cast<int>(origin.size());
    origin.insert(origin.end(), {m, y, z});
    const int beyond = opposite[n];
    opposite.insert(opposite.end(), {-1, beyond, n});
    if (beyond >= 0) opposite[beyond] = f + 1;
    edge.insert(edge.end(), {-1, edge[n], edge_count});
    edge[n] = edge_count++;
    origin[n] = m;
    opposite[n] = f + 2;
    alive.push_back(1);
    ++face_count;
    if (out[y] == n) out[y] = f + 1;
    return f;
  };
  const int fresh = halve(h);
  edge[fresh] = far_name;
  out[m] = fresh;
  if (o >= 0) {
    const int across = halve(o);
    edge[across] = edge[h];
    edge[o] = far_name;
    opposite[h] = across, opposite[across] = h;
    opposite[o] = fresh, opposite[fresh] = o;
  }
  return m;
}

}  // namespace hybrid_mesh
