// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/patch_layout.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

// Half-edges of a mesh that lie on curves, by their ends.
class CurveHalfEdges {
 public:
  explicit CurveHalfEdges(const PatchLayout& layout) : mesh_(layout.mesh) {
    for (int h = 0; h < static_cast<int>(layout.along.size()); ++h)
      if (layout.along[h] >= 0) sorted_.push_back(h);
    std::sort(sorted_.begin(), sorted_.end(), [&](int g, int h) { return ends(g) < ends(h); });
  }
  int operator()(int from, int to) const {
    const auto at =
        std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(from, to), [&](int h, const std::pair<int, int>& e) { return ends(h) < e; });
    if (at == sorted_.end() || ends(*at) != std::pair(from, to))
      throw Error(ErrorCode::Internal, "a curve of a layout is not made of the mesh's edges");
    return *at;
  }

 private:
  std::pair<int, int> ends(int h) const { return {mesh_.from(h), mesh_.to(h)}; }
  const TriangleSurface& mesh_;
  std::vector<int> sorted_;
};

class LayoutBuilder {
 public:
  LayoutBuilder(const TriangleSurface& surface, const SurfaceCurves& curves) : surface_(surface), curves_(curves) {}

  PatchLayout run(const std::vector<int>& nodes) {
    CutMesh cut = curves_.cut();
    out_.mesh = std::move(cut.mesh);
    out_.source = std::move(cut.source);
    out_.along.assign(out_.mesh.opposite.size(), -1);
    place_points();
    number_nodes(nodes);
    std::vector<int> number(curves_.curve_count(), -1);
    for (int c = 0; c < curves_.curve_count(); ++c) {
      const SurfaceCurves::Curve& curve = curves_.curve(c);
      if (!curve.alive) continue;
      number[c] = static_cast<int>(out_.curves.size());
      out_.curves.push_back({node_[curve.start], node_[curve.end], std::move(cut.chains[c]), curve.stroke, false});
    }
    for (std::size_t h = 0; h < cut.curve.size(); ++h)
      if (cut.curve[h] >= 0) out_.along[h] = number[cut.curve[h]];
    add_boundary();
    fill_faces();
    walk_cycles();
    count_euler();
    return std::move(out_);
  }

 private:
  void place_points() {
    for (std::size_t v = 0; v < out_.source.size(); ++v) {
      Vec3 at = Vec3::Zero();
      for (int k = 0; k < 3; ++k)
        if (out_.source[v].vertices[k] >= 0) at += out_.source[v].weights[k] * surface_.points[out_.source[v].vertices[k]];
      out_.mesh.points[v] = at;
    }
  }

  void number_nodes(const std::vector<int>& nodes) {
    node_.assign(out_.mesh.points.size(), -1);
    const auto add = [&](int v) {
      if (node_[v] >= 0) return;
      node_[v] = static_cast<int>(out_.nodes.size());
      out_.nodes.push_back(v);
    };
    for (const int v : nodes) add(v);
    for (int v = 0; v < static_cast<int>(curves_.points().size()); ++v)
      if (curves_.degree(v) > 0) add(v);
    // Boundary loops without nodes: their first point.
    next_on_boundary_.assign(out_.mesh.points.size(), -1);
    for (int h = 0; h < static_cast<int>(out_.mesh.opposite.size()); ++h)
      if (out_.mesh.opposite[h] < 0) next_on_boundary_[out_.mesh.from(h)] = h;
    std::vector<char> seen(out_.mesh.points.size(), 0);
    for (int v = 0; v < static_cast<int>(seen.size()); ++v) {
      if (next_on_boundary_[v] < 0 || seen[v]) continue;
      bool found = false;
      for (int w = v; !seen[w]; w = out_.mesh.to(next_on_boundary_[w])) {
        seen[w] = 1;
        found = found || node_[w] >= 0;
      }
      if (!found) add(v);
    }
  }

  void add_boundary() {
    // Nodes in order, which may grow no more.
    for (std::size_t i = 0; i < out_.nodes.size(); ++i) {
      int v = out_.nodes[i];
      if (next_on_boundary_[v] < 0) continue;
      PatchLayout::Curve curve;
      curve.boundary = true;
      curve.from = static_cast<int>(i);
      curve.points.push_back(v);
      do {
        const int h = next_on_boundary_[v];
        out_.along[h] = static_cast<int>(out_.curves.size());
        v = out_.mesh.to(h);
        curve.points.push_back(v);
      } while (node_[v] < 0);
      curve.to = node_[v];
      out_.curves.push_back(std::move(curve));
    }
  }

  void fill_faces() {
    const TriangleSurface& mesh = out_.mesh;
    out_.face.assign(mesh.faces.size(), -1);
    std::vector<int> stack;
    for (int first = 0; first < static_cast<int>(mesh.faces.size()); ++first) {
      if (out_.face[first] >= 0) continue;
      const int number = static_cast<int>(out_.faces.size());
      out_.faces.emplace_back();
      out_.face[first] = number;
      stack.push_back(first);
      while (!stack.empty()) {
        const int f = stack.back();
        stack.pop_back();
        for (int h = 3 * f; h < 3 * f + 3; ++h) {
          const int o = mesh.opposite[h];
          if (out_.along[h] >= 0 || out_.face[o / 3] >= 0) continue;
          out_.face[o / 3] = number;
          stack.push_back(o / 3);
        }
      }
    }
  }

  // The next side of a face after one of its sides is the first curve met clockwise around the node.
  void walk_cycles() {
    const TriangleSurface& mesh = out_.mesh;
    const CurveHalfEdges half_edge(out_);
    const int count = static_cast<int>(out_.curves.size());
    std::vector<int> first(2 * count, -1), last(2 * count, -1), side_from(mesh.opposite.size(), -1);
    for (int c = 0; c < count; ++c) {
      const std::vector<int>& p = out_.curves[c].points;
      first[2 * c] = half_edge(p[0], p[1]);
      last[2 * c] = half_edge(p[p.size() - 2], p.back());
      first[2 * c + 1] = mesh.opposite[last[2 * c]];
      last[2 * c + 1] = mesh.opposite[first[2 * c]];
      for (int d = 0; d < 2; ++d)
        if (first[2 * c + d] >= 0) side_from[first[2 * c + d]] = 2 * c + d;
    }
    std::vector<char> done(2 * count, 0);
    for (int s = 0; s < 2 * count; ++s) {
      if (done[s] || first[s] < 0) continue;
      std::vector<PatchLayout::Side> cycle;
      for (int at = s; !done[at];) {
        done[at] = 1;
        cycle.push_back({at / 2, at % 2 == 0});
        int g = TriangleSurface::next(last[at]);
        while (out_.along[g] < 0) g = TriangleSurface::next(mesh.opposite[g]);
        at = side_from[g];
        if (at < 0) throw Error(ErrorCode::Internal, "a face of a layout is entered amid a curve");
      }
      out_.faces[out_.face[first[s] / 3]].cycles.push_back(std::move(cycle));
    }
  }

  void count_euler() {
    const TriangleSurface& mesh = out_.mesh;
    std::vector<int> twice_edges(out_.faces.size(), 0);
    std::vector<char> met(mesh.points.size(), 0);  // by a curve
    for (std::size_t h = 0; h < mesh.opposite.size(); ++h)
      if (out_.along[h] >= 0) met[mesh.from(static_cast<int>(h))] = met[mesh.to(static_cast<int>(h))] = 1;
    for (PatchLayout::Face& f : out_.faces) f.euler = 0;
    std::vector<char> counted(mesh.points.size(), 0);
    for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
      const int f = out_.face[h / 3], v = mesh.from(h);
      twice_edges[f] += out_.along[h] >= 0 ? 2 : 1;
      // A fan of the face's triangles around a point begins at a curve, or is the whole star.
      if (met[v] ? out_.along[h] >= 0 : !counted[v]) ++out_.faces[f].euler;
      counted[v] = 1;
      if (h % 3 == 0) ++out_.faces[f].euler;
    }
    for (std::size_t f = 0; f < out_.faces.size(); ++f) out_.faces[f].euler -= twice_edges[f] / 2;
  }

  const TriangleSurface& surface_;
  const SurfaceCurves& curves_;
  PatchLayout out_;
  std::vector<int> node_, next_on_boundary_;  // per point
};

}  // namespace

int PatchLayout::Face::side_count() const {
  int count = 0;
  for (const std::vector<Side>& cycle : cycles) count += static_cast<int>(cycle.size());
  return count;
}

std::vector<int> PatchLayout::points(const Side& s) const {
  std::vector<int> out = curves[s.curve].points;
  if (!s.forward) std::reverse(out.begin(), out.end());
  return out;
}

bool PatchLayout::is_quads() const {
  return std::all_of(faces.begin(), faces.end(), [](const Face& f) { return f.is_disk() && f.side_count() == 4; });
}

const char* name_of(LayoutProblem::Kind kind) {
  switch (kind) {
    case LayoutProblem::Kind::Unusable:
      return "unusable";
    case LayoutProblem::Kind::OffSurface:
      return "off_surface";
    case LayoutProblem::Kind::Disconnected:
      return "disconnected";
    case LayoutProblem::Kind::Overlap:
      return "overlap";
    case LayoutProblem::Kind::BetweenNodes:
      return "between_nodes";
    case LayoutProblem::Kind::Dangling:
      return "dangling";
    case LayoutProblem::Kind::Uncovered:
      return "uncovered";
    case LayoutProblem::Kind::NotADisk:
      return "not_a_disk";
    case LayoutProblem::Kind::TooFewSides:
      return "too_few_sides";
    case LayoutProblem::Kind::OddSides:
      return "odd_sides";
    case LayoutProblem::Kind::ManySides:
      return "many_sides";
    case LayoutProblem::Kind::TouchesItself:
      return "touches_itself";
  }
  return "";
}

PatchLayout make_patch_layout(const TriangleSurface& surface, const SurfaceCurves& curves, const std::vector<int>& nodes) {
  return LayoutBuilder(surface, curves).run(nodes);
}

namespace {

// The shortest way along the edges of a face from its first rim to another one: a line on the face itself, and where a curve may divide it.
std::vector<Vec3> find_way_across(const PatchLayout& layout, int f) {
  const LayoutFacePart part = cut_out(layout, f);
  const TriangleSurface& mesh = part.mesh;
  std::vector<char> is_rim(mesh.points.size(), 0), is_first(mesh.points.size(), 0);
  std::vector<std::vector<int>> around(mesh.points.size());
  for (std::size_t h = 0; h < 3 * mesh.faces.size(); ++h) {
    const int from = mesh.faces[h / 3][h % 3], to = mesh.faces[h / 3][(h + 1) % 3];
    around[from].push_back(to);
    around[to].push_back(from);
    if (mesh.opposite[h] < 0) is_rim[from] = is_rim[to] = 1;
  }
  for (const std::vector<int>& side : part.sides)
    for (const int v : side) is_first[v] = 1;
  std::vector<double> length(mesh.points.size(), std::numeric_limits<double>::infinity());
  std::vector<int> previous(mesh.points.size(), -1);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (int v = 0; v < static_cast<int>(mesh.points.size()); ++v)
    if (is_first[v]) length[v] = 0, queue.push({0, v});
  while (!queue.empty()) {
    const auto [at, v] = queue.top();
    queue.pop();
    if (at > length[v]) continue;
    if (is_rim[v] && !is_first[v]) {
      std::vector<Vec3> way;
      for (int w = v; w >= 0; w = previous[w]) way.push_back(mesh.points[w]);
      return way;
    }
    for (const int w : around[v]) {
      const double next = at + (mesh.points[w] - mesh.points[v]).norm();
      if (!(next < length[w])) continue;
      length[w] = next;
      previous[w] = v;
      queue.push({next, w});
    }
  }
  return {};
}

}  // namespace

std::vector<LayoutProblem> find_problems(const PatchLayout& layout) {
  using Kind = LayoutProblem::Kind;
  std::vector<LayoutProblem> problems;
  std::vector<int> degree(layout.nodes.size(), 0);
  for (const PatchLayout::Curve& c : layout.curves) ++degree[c.from], ++degree[c.to];
  std::vector<char> dangles(layout.curves.size(), 0);
  for (std::size_t c = 0; c < layout.curves.size(); ++c) {
    const PatchLayout::Curve& curve = layout.curves[c];
    for (const int node : {curve.from, curve.to}) {
      if (degree[node] > 1) continue;
      dangles[c] = 1;
      problems.push_back({Kind::Dangling, "a curve ends where no other does", {layout.mesh.points[layout.nodes[node]]}, curve.stroke, -1});
    }
  }
  std::vector<int> triangle(layout.faces.size(), -1);  // the first of each face
  for (std::size_t t = layout.face.size(); t-- > 0;) triangle[layout.face[t]] = static_cast<int>(t);
  for (int f = 0; f < static_cast<int>(layout.faces.size()); ++f) {
    const PatchLayout::Face& face = layout.faces[f];
    std::vector<Vec3> rim;
    bool dangling = false;
    for (const auto& cycle : face.cycles)
      for (const PatchLayout::Side& s : cycle) {
        dangling = dangling || dangles[s.curve];
        for (const int v : layout.points(s)) rim.push_back(layout.mesh.points[v]);
      }
    const int rims = static_cast<int>(face.cycles.size()), sides = face.side_count();
    if (rims == 0) {
      problems.push_back(
          {Kind::Uncovered, "a component of the surface has no curves", {layout.mesh.points[layout.mesh.faces[triangle[f]][0]]}, -1, f});
    } else if (!face.is_disk()) {
      const int handles = (2 - rims - face.euler) / 2;
      std::string message = rims == 2 && handles == 0 ? "a face is a ring" : "a face is no disk";
      message += ": it has " + std::to_string(rims) + (rims == 1 ? " rim" : " separate rims");
      if (handles > 0) message += " and " + std::to_string(handles) + (handles == 1 ? " handle" : " handles");
      // The rims are the neighbours' as well, and the middle between them may be far from the face.
      const std::vector<Vec3> across = rims > 1 ? find_way_across(layout, f) : std::vector<Vec3>();
      problems.push_back({Kind::NotADisk, message, across.empty() ? rim : across, -1, f});
    } else if (dangling) {
      continue;
    } else if (sides < 3) {
      problems.push_back({Kind::TooFewSides, "a face has " + std::to_string(sides) + (sides == 1 ? " side" : " sides") + " only", rim, -1, f});
    } else if (sides % 2 == 1) {
      problems.push_back({Kind::OddSides, "a face has " + std::to_string(sides) + " sides, an odd number", rim, -1, f});
    } else {
      std::vector<int> corners;
      for (const PatchLayout::Side& s : face.cycles[0]) corners.push_back(layout.start(s));
      std::sort(corners.begin(), corners.end());
      if (std::adjacent_find(corners.begin(), corners.end()) != corners.end())
        problems.push_back({Kind::TouchesItself, "a face touches itself, and has to be divided", rim, -1, f});
    }
  }
  return problems;
}

PatchedSurface to_patched_surface(const PatchLayout& layout) {
  if (!layout.is_quads()) throw Error(ErrorCode::InvalidInput, "a layout has faces that are no disks with four sides");
  PatchedSurface out;
  out.mesh = layout.mesh;
  out.source = layout.source;
  out.patch = layout.face;
  out.node_count = static_cast<int>(layout.nodes.size());
  const int count = static_cast<int>(layout.faces.size());
  out.nodes.resize(count);
  out.neighbours.resize(count);
  out.sides.resize(count);
  std::vector<std::array<PatchSide, 2>> beside(layout.curves.size());  // on the left of the curve forward and backward
  for (int q = 0; q < count; ++q)
    for (int i = 0; i < 4; ++i) {
      const PatchLayout::Side& s = layout.faces[q].cycles[0][i];
      beside[s.curve][s.forward ? 0 : 1] = {q, i};
      out.nodes[q][i] = layout.start(s);
      out.sides[q][i] = layout.points(s);
    }
  for (int q = 0; q < count; ++q)
    for (int i = 0; i < 4; ++i) {
      const PatchLayout::Side& s = layout.faces[q].cycles[0][i];
      out.neighbours[q][i] = beside[s.curve][s.forward ? 1 : 0];
    }
  return out;
}

LayoutFacePart cut_out(const PatchLayout& layout, int face) {
  LayoutFacePart part;
  const TriangleSurface& whole = layout.mesh;
  std::vector<int> local(whole.faces.size(), -1);
  for (int f = 0; f < static_cast<int>(whole.faces.size()); ++f)
    if (layout.face[f] == face) {
      local[f] = static_cast<int>(part.face.size());
      part.face.push_back(f);
    }
  TriangleSurface& mesh = part.mesh;
  const int count = static_cast<int>(part.face.size());
  mesh.opposite.resize(3 * count);
  const auto in_whole = [&](int h) { return 3 * part.face[h / 3] + h % 3; };
  for (int h = 0; h < 3 * count; ++h) {
    const int o = whole.opposite[in_whole(h)];
    mesh.opposite[h] = layout.along[in_whole(h)] >= 0 ? -1 : 3 * local[o / 3] + o % 3;
  }
  // A point a fan of faces: corners are walked around, clockwise first to where the fan begins.
  std::vector<int> point_of_corner(3 * count, -1);
  for (int h = 0; h < 3 * count; ++h) {
    if (point_of_corner[h] >= 0) continue;
    int first = h;
    for (int o = mesh.opposite[first]; o >= 0; o = mesh.opposite[first]) {
      first = TriangleSurface::next(o);
      if (first == h) break;
    }
    int g = first;
    do {
      point_of_corner[g] = static_cast<int>(part.point.size());
      g = mesh.opposite[TriangleSurface::previous(g)];
    } while (g >= 0 && g != first);
    part.point.push_back(whole.from(in_whole(h)));
  }
  for (int f = 0; f < count; ++f) {
    mesh.faces.push_back({point_of_corner[3 * f], point_of_corner[3 * f + 1], point_of_corner[3 * f + 2]});
    mesh.source_face.push_back(whole.source_face[part.face[f]]);
  }
  for (const int v : part.point) mesh.points.push_back(whole.points[v]);
  if (layout.faces[face].cycles.empty()) return part;
  const CurveHalfEdges half_edge(layout);
  for (const PatchLayout::Side& s : layout.faces[face].cycles[0]) {
    const std::vector<int> points = layout.points(s);
    std::vector<int>& side = part.sides.emplace_back();
    for (std::size_t k = 1; k < points.size(); ++k) {
      const int h = half_edge(points[k - 1], points[k]), at = 3 * local[h / 3] + h % 3;
      if (k == 1) side.push_back(point_of_corner[at]);
      side.push_back(point_of_corner[TriangleSurface::next(at)]);
    }
  }
  return part;
}

}  // namespace hybrid_mesh
