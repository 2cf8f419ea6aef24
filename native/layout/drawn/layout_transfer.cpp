// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/layout_transfer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <set>
#include <tuple>

#include "base/error.h"
#include "layout/curves/curve_search.h"
#include "layout/curves/curve_tightening.h"
#include "layout/curves/vertex_placing.h"
#include "layout/drawn/quad_complex.h"
#include "surface/closest_point.h"
#include "surface/placement.h"

namespace hybrid_mesh {
namespace {

constexpr int kMostSearches = 4;       // a side, on average
constexpr int kMostReplacements = 30;  // of one curve
constexpr int kGuidePoints = 24;
constexpr double kTellingNormal = 0.8;  // length of the sum of unit sides' cross products at a node
constexpr double kNear = 0.1;           // in diagonals
constexpr double kFarOff = 1e6;         // in diagonals

class LayoutTracer {
 public:
  LayoutTracer(const TriangleSurface& surface, const LayoutOutline& outline, const Progress& progress)
      : surface_(surface),
        outline_(outline),
        progress_(progress),
        complex_(outline),
        frame_(placement_of(surface.points)),
        unit_(frame_.to_unit(surface)),
        curves_(unit_, unit_.points) {}

  TransferredLayout run() {
    if (!has_topology() || !place_nodes()) return {{}, failure_};
    progress_(0.1);
    if (!trace()) return {{}, failure_};
    progress_(0.7);
    TransferredLayout out;
    out.layout = make_patch_layout(surface_, curves_, vertex_);
    if (!order_faces(out.layout)) return {{}, "the curves that join the nodes do not bound the quads"};
    CurveTightener(curves_, {}).tighten_all(progress_);
    out.layout = make_patch_layout(surface_, curves_, vertex_);
    order_faces(out.layout);
    return out;
  }

 private:
  bool fail(const std::string& why) {
    failure_ = why;
    return false;
  }
  static std::string name(const QuadComplex::Edge& e) { return "the curve from node " + std::to_string(e.from) + " to node " + std::to_string(e.to); }

  bool has_topology() {
    ours_ = components_of(unit_), theirs_ = complex_.components();
    std::vector<std::array<int, 2>> a = ours_.topology, b = theirs_.topology;
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    if (a == b) return true;
    if (a.size() != b.size()) return fail("the surface has " + std::to_string(a.size()) + " components, the quads have " + std::to_string(b.size()));
    const std::size_t k = std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin();
    const auto describe = [](const std::array<int, 2>& t) {
      return "Euler number " + std::to_string(t[0]) + " and " + std::to_string(t[1]) + " boundary loops";
    };
    return fail("the surface has a component of " + describe(a[k]) + ", the quads one of " + describe(b[k]));
  }

  // Pairs the rows with the columns so that the nearest are together.
  template <class Distance>
  static std::vector<int> pair_nearest(int rows, int columns, const Distance& distance) {
    std::vector<std::tuple<double, int, int>> all;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j)
        if (const double d = distance(i, j); d >= 0) all.push_back({d, i, j});
    std::sort(all.begin(), all.end());
    std::vector<int> pair(rows, -1);
    std::vector<char> taken(columns, 0);
    for (const auto& [d, i, j] : all)
      if (pair[i] < 0 && !taken[j]) pair[i] = j, taken[j] = 1;
    return pair;
  }

  // Given with the quad on its left or on its right.
  std::vector<Vec3> line_of(const QuadComplex::Edge& e) const {
    const std::vector<Vec3>& line = outline_.sides[e.left.patch][e.left.side];
    if (!line.empty() || e.right.patch < 0) return line;
    const std::vector<Vec3>& back = outline_.sides[e.right.patch][e.right.side];
    return {back.rbegin(), back.rend()};
  }
  // From a node along the quad's side i, or against side i - 1.
  Vec3 direction(int q, int i, bool forward) const {
    const int side = forward ? i : (i + 3) % 4;
    const int a = complex_.node(q, i), b = complex_.node(q, forward ? (i + 1) % 4 : side);
    Vec3 towards = outline_.nodes[b];
    if (const int e = complex_.edge_at(q, side); e >= 0 && !outline_.sides.empty()) {
      const QuadComplex::Edge& edge = complex_.edge(e);
      const std::vector<Vec3> line = line_of(edge);
      if (line.size() > 1) towards = forward == complex_.is_left(q, side) ? line[1] : line[line.size() - 2];
    }
    return (towards - outline_.nodes[a]).normalized();
  }
  // Which way the surface faced at each node: zero where its quads do not tell.
  std::vector<Vec3> node_normals() const {
    std::vector<Vec3> normal(outline_.nodes.size(), Vec3::Zero());
    for (int q = 0; q < complex_.quads(); ++q)
      for (int i = 0; i < 4; ++i) normal[complex_.node(q, i)] += direction(q, i, true).cross(direction(q, i, false));
    for (Vec3& n : normal) n = n.norm() > kTellingNormal ? n.normalized().eval() : Vec3::Zero();
    return normal;
  }
  Vec3 normal_of(int f) const {
    const auto& c = unit_.faces[f];
    return (unit_.points[c[1]] - unit_.points[c[0]]).cross(unit_.points[c[2]] - unit_.points[c[0]]).normalized();
  }
  bool is_near(int f, const Vec3& p) const { return (unit_.points[unit_.faces[f][0]] - p).squaredNorm() < kNear * kNear; }

  bool place_nodes() {
    VertexPlacing placing(curves_);
    const int nodes = static_cast<int>(outline_.nodes.size());
    std::vector<Vec3> wanted;
    for (int n = 0; n < nodes; ++n) {
      wanted.push_back(frame_.to_unit(outline_.nodes[n]));
      if (!(wanted[n].cwiseAbs().maxCoeff() < kFarOff)) return fail("node " + std::to_string(n) + " is far off the surface");
    }
    // Which component is which, then which boundary is which.
    const int components = static_cast<int>(ours_.topology.size());
    std::vector<std::vector<int>> faces(components);
    for (int f = 0; f < static_cast<int>(unit_.faces.size()); ++f) faces[ours_.of[unit_.faces[f][0]]].push_back(f);
    std::vector<SurfaceDistanceQuery> query;
    for (const std::vector<int>& of : faces) {
      std::vector<std::array<int, 3>> corners;
      for (const int f : of) corners.push_back(unit_.faces[f]);
      query.emplace_back(unit_.points, corners);
    }
    std::vector<std::vector<int>> members(components), cycles;
    for (int n = 0; n < nodes; ++n) members[theirs_.of[n]].push_back(n);
    const std::vector<int> component = pair_nearest(components, components, [&](int i, int j) {
      if (theirs_.topology[i] != ours_.topology[j]) return -1.0;
      double sum = 0;
      if (components > 1)
        for (const int n : members[i]) sum += std::sqrt(query[j].closest(wanted[n]).squared_distance);
      return sum;
    });
    std::vector<int> cycle(nodes, -1);
    for (int n = 0; n < nodes; ++n) {
      if (complex_.next_on_boundary(n) < 0 || cycle[n] >= 0) continue;
      std::vector<int>& own = cycles.emplace_back();
      for (int m = n; cycle[m] < 0; m = complex_.next_on_boundary(m)) {
        cycle[m] = static_cast<int>(cycles.size()) - 1;
        own.push_back(m);
      }
    }
    const std::vector<int> loop = pair_nearest(static_cast<int>(cycles.size()), placing.loops(), [&](int i, int j) {
      if (ours_.of[placing.vertex_of_loop(j)] != component[theirs_.of[cycles[i][0]]]) return -1.0;
      double sum = 0;
      for (const int n : cycles[i]) sum += (placing.nearest_on_boundary(wanted[n], std::numeric_limits<double>::infinity(), j).at - wanted[n]).norm();
      return sum;
    });

    const std::vector<Vec3> normal = node_normals();
    std::vector<FacePoint> place(nodes);
    for (int n = 0; n < nodes; ++n) {
      const int c = component[theirs_.of[n]];
      ClosestPoint closest = query[c].closest(wanted[n]);
      // The other side of a thin sheet may be nearer.
      if (normal[n].dot(normal_of(faces[c][closest.face])) < 0) {
        std::vector<std::array<int, 3>> corners;
        std::vector<int> facing;
        for (const int f : faces[c])
          if (normal[n].dot(normal_of(f)) > 0 && is_near(f, wanted[n])) {
            corners.push_back(unit_.faces[f]);
            facing.push_back(f);
          }
        if (!facing.empty()) {
          closest = SurfaceDistanceQuery(unit_.points, corners).closest(wanted[n]);
          place[n].face = facing[closest.face];
        }
      }
      if (place[n].face < 0) place[n].face = faces[c][closest.face];
      for (int i = 0; i < 3; ++i) place[n].at += closest.weights[i] * unit_.points[unit_.faces[place[n].face][i]];
    }
    // Those of the boundary first: they have less choice; then those that are vertices already, or nearly so.
    const EditMesh& mesh = curves_.mesh();
    std::vector<std::tuple<bool, double, int>> order;
    for (int n = 0; n < nodes; ++n) {
      const FacePoint at = cycle[n] >= 0 ? placing.nearest_on_boundary(wanted[n], std::numeric_limits<double>::infinity(), loop[cycle[n]]) : place[n];
      double nearest = std::numeric_limits<double>::infinity();
      for (int i = 0; i < 3; ++i) nearest = std::min(nearest, (curves_.points()[mesh.from(3 * at.face + i)] - at.at).norm());
      order.push_back({cycle[n] < 0, nearest, n});
    }
    std::sort(order.begin(), order.end());
    vertex_.assign(nodes, -1);
    for (const auto& [inside, nearest, n] : order) vertex_[n] = inside ? placing.inside(place[n]) : placing.on_boundary(wanted[n], loop[cycle[n]]);
    std::vector<int> node_of(curves_.points().size(), -1);
    for (int n = 0; n < nodes; ++n) node_of[vertex_[n]] = n;
    for (int n = 0; n < nodes; ++n) {
      if (cycle[n] < 0) continue;
      int v = vertex_[n];
      do v = mesh.to(mesh.out[v]);
      while (node_of[v] < 0);
      if (node_of[v] != complex_.next_on_boundary(n))
        return fail("on the boundary, node " + std::to_string(node_of[v]) + " follows node " + std::to_string(n) + " instead of node " +
                    std::to_string(complex_.next_on_boundary(n)));
    }
    return true;
  }

  // Where a curve may leave a node: between the ends that are its neighbours in the order around it.
  CurveSector sector(int node, const QuadComplex::EdgeEnd& end) const {
    const EditMesh& mesh = curves_.mesh();
    const std::vector<QuadComplex::EdgeEnd>& order = complex_.around(node);
    const auto place = [&](const QuadComplex::EdgeEnd& e) { return static_cast<int>(std::find(order.begin(), order.end(), e) - order.begin()); };
    const int v = vertex_[node], own = place(end), count = static_cast<int>(order.size());
    // All directions counter-clockwise: placed ends, the corners between them, and free edges.
    struct Direction {
      int placed = -1;            // place of an end in the order
      int spoke = -1, rank = -1;  // rank -1: the edge itself
    };
    std::vector<Direction> directions;
    const std::vector<SurfaceCurves::End> ends = curves_.ends_at(v);
    std::size_t next = 0;
    int g = mesh.out[v];
    do {
      const auto add_end = [&] {
        directions.push_back({place({curves_.curve(ends[next].curve).stroke, ends[next].at_start}), -1, -1});
        ++next;
      };
      if (next < ends.size() && ends[next].spoke == g && ends[next].along)
        add_end();
      else if (mesh.opposite[g] >= 0 && curves_.on_edge(mesh.edge[g]).empty())
        directions.push_back({-1, g, -1});
      int rank = 0;
      directions.push_back({-1, g, rank});
      while (next < ends.size() && ends[next].spoke == g) {
        add_end();
        directions.push_back({-1, g, ++rank});
      }
      g = mesh.ccw(g);
    } while (g >= 0 && g != mesh.out[v]);

    // From the placed end before it in the order, up to the next one.
    const bool closed = !mesh.is_boundary(v);
    const int size = static_cast<int>(directions.size());
    int begin = -1, best = closed ? count + 1 : own + 1;
    for (int i = 0; i < size; ++i) {
      if (directions[i].placed < 0 || directions[i].placed == own) continue;
      const int before = closed ? (own - directions[i].placed + count) % count : own - directions[i].placed;
      if (before > 0 && before < best) best = before, begin = i;
    }
    CurveSector out;
    for (int k = 0; k < size; ++k) {
      const Direction& d = directions[(begin + 1 + k) % size];
      if (!closed && begin + 1 + k >= size) break;
      if (d.placed >= 0) break;
      if (d.rank < 0)
        out.spokes.insert(d.spoke);
      else
        out.corners.insert({d.spoke, d.rank});
    }
    return out;
  }

  // The line along which an edge lay, thinned out; empty if it is not known.
  std::vector<Vec3> guide_of(int k) const {
    if (outline_.sides.empty()) return {};
    const QuadComplex::Edge& e = complex_.edge(k);
    const std::vector<Vec3> line = line_of(e);
    std::vector<Vec3> guide;
    const int count = std::min(static_cast<int>(line.size()), kGuidePoints);
    for (int i = 0; i < count; ++i) guide.push_back(frame_.to_unit(line[count > 1 ? i * (line.size() - 1) / (count - 1) : 0]));
    return guide;
  }

  std::optional<CurveWay> find(int k, CurveSearch::Barriers barriers, bool guided) {
    const QuadComplex::Edge& e = complex_.edge(k);
    return search_(vertex_[e.from], vertex_[e.to], sector(e.from, {k, true}), sector(e.to, {k, false}), guided ? guide_of(k) : std::vector<Vec3>(),
                   barriers);
  }

  // Curves that are edges opposite to the ends of edge k.
  std::set<int> walls(int k) const {
    const EditMesh& mesh = curves_.mesh();
    std::set<int> out;
    for (const int v : {vertex_[complex_.edge(k).from], vertex_[complex_.edge(k).to]}) {
      int h = mesh.out[v];
      do {
        if (const int c = curves_.along(mesh.edge[EditMesh::next(h)]); c >= 0) out.insert(c);
        h = mesh.ccw(h);
      } while (h >= 0 && h != mesh.out[v]);
    }
    return out;
  }

  // Shortest ones first. One that finds no way takes the place of those that bar it, which are traced anew.
  bool trace() {
    const int count = complex_.edges();
    std::vector<int> order(count), replaced(count, 0);
    for (int k = 0; k < count; ++k) {
      order[k] = k;
      if (complex_.edge(k).from == complex_.edge(k).to)
        return fail(name(complex_.edge(k)) + " is closed: there is no telling which way around the surface it goes");
    }
    const auto distance = [&](int k) {
      return (curves_.points()[vertex_[complex_.edge(k).from]] - curves_.points()[vertex_[complex_.edge(k).to]]).norm();
    };
    std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return distance(i) < distance(j); });
    std::deque<int> pending(order.begin(), order.end());
    std::int64_t searches = 0;
    while (!pending.empty()) {
      // Where curves keep taking each other's place there is none for all of them.
      if (++searches > kMostSearches * static_cast<std::int64_t>(count) + 100) return fail("its sides find no places beside each other");
      progress_(0.1 + 0.6 * (count - static_cast<double>(pending.size())) / count);
      const int k = pending.front();
      pending.pop_front();
      std::optional<CurveWay> way = find(k, CurveSearch::Barriers::Respect, true);
      if (!way) {
        const auto displace = [&](int c) {
          const int other = curves_.curve(c).stroke;
          curves_.remove(c);
          pending.push_back(other);
          return ++replaced[other] <= kMostReplacements ||
                 fail("there is no way for " + name(complex_.edge(k)) + " that leaves one for " + name(complex_.edge(other)));
        };
        // Where curves end side by side, those that bar the way come to light one after another.
        for (int tries = 0; !way && tries < kMostReplacements; ++tries) {
          way = find(k, CurveSearch::Barriers::Cross, true);
          if (way && way->crossed.empty()) break;
          // A curve that is an edge cannot be crossed everywhere. Once another one crosses its edge it will find itself another way.
          const std::set<int> barring = way ? way->crossed : walls(k);
          for (const int c : barring)
            if (!displace(c)) return false;
          if (barring.empty()) break;
          way = find(k, CurveSearch::Barriers::Respect, true);
        }
        if (!way) return fail("there is no way for " + name(complex_.edge(k)));
      }
      if (!add(k, *way)) return fail("nothing is left of " + name(complex_.edge(k)) + ": the surface is too coarse there");
    }
    curves_.spread();
    return true;
  }

  bool add(int k, const CurveWay& way) {
    const int a = vertex_[complex_.edge(k).from], b = vertex_[complex_.edge(k).to];
    const int c = curves_.add(a, b, way.gaps, k);
    if (c < 0 || curves_.is_clear(c)) return c >= 0;
    // A guide may lead a curve over itself; the shortest way does not.
    curves_.remove(c);
    const std::optional<CurveWay> shortest = find(k, CurveSearch::Barriers::Respect, false);
    return shortest && curves_.add(a, b, shortest->gaps, k) >= 0;
  }

  // Is this the side of a face that side i of quad q is to be?
  bool is_side(const PatchLayout& layout, const PatchLayout::Side& s, int q, int i) const {
    const PatchLayout::Curve& c = layout.curves[s.curve];
    const int e = complex_.edge_at(q, i);
    if (e < 0) return c.boundary && c.from == complex_.node(q, i);
    return !c.boundary && c.stroke == e && s.forward == complex_.is_left(q, i);
  }

  // Faces in the order of the quads, beginning with their first corners. False if they are not the quads.
  bool order_faces(PatchLayout& layout) const {
    std::vector<int> of_side(2 * layout.curves.size(), -1);
    for (int f = 0; f < static_cast<int>(layout.faces.size()); ++f) {
      if (!layout.faces[f].is_disk() || layout.faces[f].side_count() != 4) return false;
      for (const PatchLayout::Side& s : layout.faces[f].cycles[0]) of_side[2 * s.curve + s.forward] = f;
    }
    std::vector<int> curve(complex_.edges(), -1), from_node(outline_.nodes.size(), -1);
    for (int c = 0; c < static_cast<int>(layout.curves.size()); ++c)
      (layout.curves[c].boundary ? from_node[layout.curves[c].from] : curve[layout.curves[c].stroke]) = c;
    std::vector<PatchLayout::Face> faces;
    std::vector<int> renumbered(layout.faces.size(), -1);
    for (int q = 0; q < complex_.quads(); ++q) {
      const int e = complex_.edge_at(q, 0), c = e >= 0 ? curve[e] : from_node[complex_.node(q, 0)];
      const int f = c < 0 ? -1 : of_side[2 * c + (e < 0 || complex_.is_left(q, 0))];
      if (f < 0 || renumbered[f] >= 0) return false;
      PatchLayout::Face face = layout.faces[f];
      std::vector<PatchLayout::Side>& cycle = face.cycles[0];
      std::rotate(cycle.begin(), std::find_if(cycle.begin(), cycle.end(), [&](const PatchLayout::Side& s) { return is_side(layout, s, q, 0); }),
                  cycle.end());
      for (int i = 0; i < 4; ++i)
        if (!is_side(layout, cycle[i], q, i)) return false;
      renumbered[f] = q;
      faces.push_back(std::move(face));
    }
    if (faces.size() != layout.faces.size()) return false;
    layout.faces = std::move(faces);
    for (int& f : layout.face) f = renumbered[f];
    for (PatchLayout::Curve& c : layout.curves) c.stroke = -1;
    return true;
  }

  const TriangleSurface& surface_;
  const LayoutOutline& outline_;
  const Progress& progress_;
  QuadComplex complex_;
  Placement frame_;
  TriangleSurface unit_;
  SurfaceCurves curves_;
  MeshComponents ours_, theirs_;
  std::vector<int> vertex_;  // per node
  CurveSearch search_{curves_};
  std::string failure_;
};

}  // namespace

LayoutOutline outline_of(const PatchedSurface& surface) {
  constexpr std::size_t parts = 12;
  LayoutOutline outline;
  outline.nodes.resize(surface.node_count);
  outline.quads = surface.nodes;
  outline.neighbours = surface.neighbours;
  outline.sides.resize(surface.patch_count());
  for (int q = 0; q < surface.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      const std::vector<int>& side = surface.sides[q][i];
      outline.nodes[surface.nodes[q][i]] = surface.mesh.points[side.front()];
      // Each line once.
      const PatchSide& other = surface.neighbours[q][i];
      if (other.patch >= 0 && std::pair(other.patch, other.side) < std::pair(q, i)) continue;
      const std::size_t last = side.size() - 1, count = std::min(parts, last);
      for (std::size_t k = 0; k <= count; ++k) outline.sides[q][i].push_back(surface.mesh.points[side[k * last / count]]);
    }
  return outline;
}

TransferredLayout transfer_layout(const TriangleSurface& surface, const LayoutOutline& outline, const Progress& progress) {
  if (surface.empty() || outline.quads.empty()) throw Error(ErrorCode::InvalidInput, "a layout needs a surface and quads");
  TransferredLayout out = LayoutTracer(surface, outline, progress).run();
  progress(1);
  return out;
}

}  // namespace hybrid_mesh
