// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/layout_transfer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <set>
#include <tuple>
#include <unordered_map>

#include "base/error.h"
#include "layout/curve_tightening.h"
#include "layout/surface_frame.h"
#include "layout/vertex_placing.h"
#include "surface/closest_point.h"

namespace hybrid_mesh {
namespace {

constexpr double kCrossingCost = 0.3;   // of the diagonal: a way that has to cross a curve crosses as few as that makes worth while
constexpr int kMostReplacements = 30;   // of one curve
constexpr double kDetourCost = 8;       // a way far from its guide counts as so many times longer
constexpr double kFar = 0.05;           // of the diagonal
constexpr int kGuidePoints = 24;

// The components of a mesh of polygons: which of them holds each point; of each its Euler number and its number of boundary loops.
struct Components {
  std::vector<int> of;
  std::vector<std::array<int, 2>> topology;
};

// `next`: per point on the boundary the one that follows, else -1; `boundary_sides`: per face.
template <class Faces>
Components find_components(int points, const Faces& faces, const std::vector<int>& next, int sides, const std::vector<int>& boundary_sides) {
  std::vector<int> parent(points);
  for (int v = 0; v < points; ++v) parent[v] = v;
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& f : faces)
    for (const int v : f) parent[root(v)] = root(f[0]);
  // Points - edges + faces; a side is half an edge, one on the boundary a whole one.
  std::map<int, std::array<int, 2>> twice;
  for (int v = 0; v < points; ++v) twice[root(v)][0] += 2;
  for (std::size_t f = 0; f < faces.size(); ++f) twice[root(faces[f][0])][0] += 2 - sides - boundary_sides[f];
  std::vector<char> seen(points, 0);
  for (int v = 0; v < points; ++v) {
    if (next[v] < 0 || seen[v]) continue;
    ++twice[root(v)][1];
    for (int w = v; !seen[w]; w = next[w]) seen[w] = 1;
  }
  Components out;
  std::map<int, int> number;
  for (const auto& [v, t] : twice) {
    number[v] = static_cast<int>(out.topology.size());
    out.topology.push_back({t[0] / 2, t[1]});
  }
  for (int v = 0; v < points; ++v) out.of.push_back(number[root(v)]);
  return out;
}

Components components_of(const TriangleSurface& s) {
  std::vector<int> next(s.points.size(), -1), boundary(s.faces.size(), 0);
  for (int h = 0; h < static_cast<int>(s.opposite.size()); ++h)
    if (s.opposite[h] < 0) next[s.from(h)] = s.to(h), ++boundary[h / 3];
  return find_components(static_cast<int>(s.points.size()), s.faces, next, 3, boundary);
}

// A side that two quads share, from node to node as its first quad runs along it.
struct Edge {
  int from = -1, to = -1;
  PatchSide left, right;
};
struct EdgeEnd {
  int edge = -1;
  bool at_start = true;
  friend bool operator==(const EdgeEnd&, const EdgeEnd&) = default;
};

// The quads as a surface: edges, and their ends around each node.
class QuadComplex {
 public:
  explicit QuadComplex(const LayoutOutline& outline) : outline_(outline), neighbours_(outline.neighbours) {
    for (const auto& quad : outline.quads)
      for (const int n : quad)
        if (n < 0 || n >= static_cast<int>(outline.nodes.size())) throw Error(ErrorCode::InvalidInput, "a quad has the node " + std::to_string(n) + ", which does not exist");
    for (const Vec3& p : outline.nodes)
      if (!std::isfinite(p.x()) || !std::isfinite(p.y()) || !std::isfinite(p.z())) throw Error(ErrorCode::InvalidInput, "a node of a layout is not finite");
    if (!outline.sides.empty() && outline.sides.size() != outline.quads.size()) throw Error(ErrorCode::InvalidInput, "there must be lines for the sides of every quad, or none");
    if (neighbours_.empty()) find_neighbours();
    check_neighbours();
    edge_.resize(quads(), {-1, -1, -1, -1});
    for (int q = 0; q < quads(); ++q)
      for (int i = 0; i < 4; ++i) {
        const PatchSide other = neighbours_[q][i];
        if (other.patch < 0 || edge_[q][i] >= 0) continue;
        edge_[q][i] = edge_[other.patch][other.side] = static_cast<int>(edges.size());
        edges.push_back({node(q, i), node(q, i + 1), {q, i}, other});
      }
    order_nodes();
  }

  int quads() const { return static_cast<int>(outline_.quads.size()); }
  int node(int q, int i) const { return outline_.quads[q][i % 4]; }
  int edge(int q, int i) const { return edge_[q][i]; }
  bool is_left(int q, int i) const { return edges[edge_[q][i]].left.patch == q && edges[edge_[q][i]].left.side == i; }
  Components components() const {
    std::vector<int> boundary(quads(), 0);
    for (int q = 0; q < quads(); ++q)
      for (const PatchSide& s : neighbours_[q]) boundary[q] += s.patch < 0;
    return find_components(static_cast<int>(outline_.nodes.size()), outline_.quads, next_on_boundary, 4, boundary);
  }
  std::vector<Edge> edges;
  std::vector<std::vector<EdgeEnd>> around;  // per node, counter-clockwise; on the boundary from the clockwise-most on
  std::vector<int> next_on_boundary;         // per node: the one that the boundary leads to, -1 inside

 private:
  void find_neighbours() {
    neighbours_.assign(quads(), {});
    std::map<std::pair<int, int>, PatchSide> sides;
    for (int q = 0; q < quads(); ++q)
      for (int i = 0; i < 4; ++i)
        if (!sides.insert({{node(q, i), node(q, i + 1)}, {q, i}}).second)
          throw Error(ErrorCode::InvalidInput, "two quads run from node " + std::to_string(node(q, i)) + " to node " + std::to_string(node(q, i + 1)) + ": their neighbours must be given");
    for (const auto& [ends, side] : sides)
      if (const auto at = sides.find({ends.second, ends.first}); at != sides.end()) neighbours_[side.patch][side.side] = at->second;
  }

  void check_neighbours() const {
    if (static_cast<int>(neighbours_.size()) != quads()) throw Error(ErrorCode::InvalidInput, "there must be neighbours for every quad, or none");
    for (int q = 0; q < quads(); ++q)
      for (int i = 0; i < 4; ++i) {
        const PatchSide other = neighbours_[q][i];
        if (other.patch < 0) continue;
        const bool mutual = other.patch < quads() && other.side >= 0 && other.side < 4 && neighbours_[other.patch][other.side].patch == q && neighbours_[other.patch][other.side].side == i;
        if (!mutual || std::pair(other.patch, other.side) == std::pair(q, i) || node(q, i) != node(other.patch, other.side + 1) || node(q, i + 1) != node(other.patch, other.side))
          throw Error(ErrorCode::InvalidInput, "side " + std::to_string(i) + " of quad " + std::to_string(q) + " and the side across do not match");
      }
  }

  void order_nodes() {
    around.resize(outline_.nodes.size());
    next_on_boundary.assign(outline_.nodes.size(), -1);
    std::vector<int> corners(outline_.nodes.size(), 0);
    std::vector<PatchSide> first(outline_.nodes.size());
    for (int q = 0; q < quads(); ++q)
      for (int i = 0; i < 4; ++i) {
        const int n = node(q, i);
        ++corners[n];
        if (neighbours_[q][i].patch < 0) {
          if (next_on_boundary[n] >= 0) throw Error(ErrorCode::InvalidInput, "the boundary of the quads touches itself at node " + std::to_string(n));
          next_on_boundary[n] = node(q, i + 1);
          first[n] = {q, i};
        } else if (first[n].patch < 0) {
          first[n] = {q, i};
        }
      }
    for (int n = 0; n < static_cast<int>(around.size()); ++n) {
      if (corners[n] == 0) throw Error(ErrorCode::InvalidInput, "node " + std::to_string(n) + " is in no quad");
      PatchSide s = first[n];
      do {
        --corners[n];
        if (const int e = edge_[s.patch][s.side]; e >= 0) around[n].push_back({e, is_left(s.patch, s.side)});
        s = neighbours_[s.patch][(s.side + 3) % 4];
      } while (s.patch >= 0 && !(s.patch == first[n].patch && s.side == first[n].side) && corners[n] > 0);
      if (corners[n] != 0) throw Error(ErrorCode::InvalidInput, "the quads at node " + std::to_string(n) + " do not surround it once");
    }
  }

  const LayoutOutline& outline_;
  std::vector<std::array<PatchSide, 4>> neighbours_;
  std::vector<std::array<int, 4>> edge_;
};

class LayoutTracer {
 public:
  LayoutTracer(const TriangleSurface& surface, const LayoutOutline& outline, const Progress& progress)
      : surface_(surface), outline_(outline), progress_(progress), complex_(outline), frame_(surface.points), unit_(frame_.to_unit(surface)), curves_(unit_, unit_.points) {}

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
  static std::string name(const Edge& e) { return "the curve from node " + std::to_string(e.from) + " to node " + std::to_string(e.to); }

  bool has_topology() {
    ours_ = components_of(unit_), theirs_ = complex_.components();
    std::vector<std::array<int, 2>> a = ours_.topology, b = theirs_.topology;
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    if (a == b) return true;
    if (a.size() != b.size()) return fail("the surface has " + std::to_string(a.size()) + " components, the quads have " + std::to_string(b.size()));
    const std::size_t k = std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin();
    const auto describe = [](const std::array<int, 2>& t) { return "Euler number " + std::to_string(t[0]) + " and " + std::to_string(t[1]) + " boundary loops"; };
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

  bool place_nodes() {
    VertexPlacing placing(curves_);
    const int nodes = static_cast<int>(outline_.nodes.size());
    std::vector<Vec3> wanted;
    for (const Vec3& p : outline_.nodes) wanted.push_back(frame_.to_unit(p));
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
      if (complex_.next_on_boundary[n] < 0 || cycle[n] >= 0) continue;
      std::vector<int>& own = cycles.emplace_back();
      for (int m = n; cycle[m] < 0; m = complex_.next_on_boundary[m]) {
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

    std::vector<FacePoint> place(nodes);
    for (int n = 0; n < nodes; ++n) {
      const int c = component[theirs_.of[n]];
      const ClosestPoint closest = query[c].closest(wanted[n]);
      place[n].face = faces[c][closest.face];
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
      if (node_of[v] != complex_.next_on_boundary[n])
        return fail("on the boundary, node " + std::to_string(node_of[v]) + " follows node " + std::to_string(n) + " instead of node " + std::to_string(complex_.next_on_boundary[n]));
    }
    return true;
  }

  // --- ways between curves -------------------------------------------------------------------------------------------------------
  // Where a curve may leave a node: between the ends that are its neighbours in the order around it.
  struct Sector {
    std::set<std::pair<int, int>> corners;  // spoke, rank
    std::set<int> spokes;                   // edges that are free
  };

  Sector sector(int node, const EdgeEnd& end) const {
    const EditMesh& mesh = curves_.mesh();
    const std::vector<EdgeEnd>& order = complex_.around[node];
    const auto place = [&](const EdgeEnd& e) { return static_cast<int>(std::find(order.begin(), order.end(), e) - order.begin()); };
    const int v = vertex_[node], own = place(end), count = static_cast<int>(order.size());
    // All directions counter-clockwise: placed ends, the corners between them, and free edges.
    struct Direction {
      int placed = -1;             // place of an end in the order
      int spoke = -1, rank = -1;   // rank -1: the edge itself
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
    Sector out;
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
    const Edge& e = complex_.edges[k];
    const std::vector<Vec3>& line = outline_.sides[e.left.patch][e.left.side];
    std::vector<Vec3> guide;
    const int count = std::min(static_cast<int>(line.size()), kGuidePoints);
    for (int i = 0; i < count; ++i) guide.push_back(frame_.to_unit(line[count > 1 ? i * (line.size() - 1) / (count - 1) : 0]));
    return guide;
  }

  struct Way {
    std::vector<SurfaceCurves::Gap> gaps;
    std::set<int> crossed;  // curves
  };

  // The shortest way for an edge, through gaps; if `crossing`, over curves too.
  std::optional<Way> find(int k, bool crossing) {
    const EditMesh& mesh = curves_.mesh();
    const std::vector<Vec3>& points = curves_.points();
    const Edge& edge = complex_.edges[k];
    const int a = vertex_[edge.from], b = vertex_[edge.to];
    const Sector leaving = sector(edge.from, {k, true}), arriving = sector(edge.to, {k, false});
    struct State {
      SurfaceCurves::Gap gap;
      Vec3 at;
      double cost;
      int previous;
      int crossed;
      int sample;
    };
    std::vector<State> states;
    SurfaceCurves::FaceCells cells;
    ++search_;
    best_undivided_.resize(3 * mesh.origin.size(), {0, 0});
    best_.clear();
    // The best state known for a gap and sample, -1: none yet. Most edges have one gap.
    const auto known = [&](const SurfaceCurves::Gap& gap, int sample) -> int& {
      if (gap.rank > 0) return best_.insert({(static_cast<std::uint64_t>(gap.half_edge) << 24) | (static_cast<std::uint64_t>(gap.rank) << 2) | static_cast<std::uint64_t>(sample), -1}).first->second;
      auto& [search, state] = best_undivided_[3 * gap.half_edge + sample];
      if (search != search_) search = search_, state = -1;
      return state;
    };
    struct Entry {
      double estimate;
      int state;
      bool operator>(const Entry& e) const { return estimate != e.estimate ? estimate > e.estimate : state > e.state; }
    };
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    constexpr std::array<double, 3> samples{0.15, 0.5, 0.85};
    const std::vector<Vec3> guide = guide_of(k);
    const auto price = [&](const Vec3& from, const Vec3& to) {
      const double length = (to - from).norm();
      if (guide.empty()) return length;
      double nearest = kFar * kFar;
      for (std::size_t i = 1; i < guide.size(); ++i) {
        const Vec3 along = guide[i] - guide[i - 1];
        const double size = along.squaredNorm(), t = size > 0 ? std::clamp((to - guide[i - 1]).dot(along) / size, 0.0, 1.0) : 0;
        nearest = std::min(nearest, (to - guide[i - 1] - t * along).squaredNorm());
      }
      return length * (1 + kDetourCost * std::sqrt(nearest) / kFar);
    };
    const auto reach = [&](const SurfaceCurves::Gap& gap, int previous, const Vec3& from, double cost, int crossed) {
      for (int s = 0; s < 3; ++s) {
        const double t = gap.from + samples[s] * (gap.to - gap.from);
        const Vec3 at = points[mesh.from(gap.half_edge)] + t * (points[mesh.to(gap.half_edge)] - points[mesh.from(gap.half_edge)]);
        const double c = cost + price(from, at);
        int& state = known(gap, s);
        if (state >= 0 && states[state].cost <= c) continue;
        state = static_cast<int>(states.size());
        states.push_back({gap, at, c, previous, crossed, s});
        queue.push({c + (points[b] - at).norm(), state});
      }
    };
    // A side that is a curve: over it.
    const auto reach_curve = [&](int h, int previous, const Vec3& from, double cost) {
      const int c = curves_.along(mesh.edge[h]);
      if (crossing && c >= 0 && mesh.opposite[h] >= 0) reach({h, 0, -1, 0, 1, -1}, previous, from, cost + kCrossingCost, c);
    };
    for (const auto& [spoke, rank] : leaving.corners) {
      curves_.find_cells(spoke / 3, cells);
      for (const SurfaceCurves::CornerGap& corner : cells.corners) {
        if (corner.spoke != spoke || corner.rank != rank) continue;
        for (const SurfaceCurves::Gap& gap : cells.gaps)
          if (gap.half_edge == EditMesh::next(spoke) && gap.cell == corner.cell) reach(gap, -1, points[a], 0, -1);
        reach_curve(EditMesh::next(spoke), -1, points[a], 0);
      }
    }
    double best = std::numeric_limits<double>::infinity();
    int last = -1;
    for (const int g : leaving.spokes)
      if (mesh.to(g) == b && arriving.spokes.count(mesh.opposite[g])) best = (points[b] - points[a]).norm();
    while (!queue.empty() && queue.top().estimate < best) {
      const auto [estimate, i] = queue.top();
      queue.pop();
      const State state = states[i];
      const int h = state.gap.half_edge;
      if (known(state.gap, state.sample) != i) continue;  // there is a shorter way to it
      const int o = mesh.opposite[h];
      curves_.find_cells(o / 3, cells);
      int cell = -1;
      if (curves_.along(mesh.edge[h]) >= 0) {
        // Beside the curve: the cell of its corner, before all curves that end there.
        for (const SurfaceCurves::CornerGap& corner : cells.corners)
          if (corner.spoke == o && corner.rank == 0) cell = corner.cell;
      }
      for (const SurfaceCurves::Gap& gap : cells.gaps)
        if (gap.half_edge == o && gap.rank == state.gap.rank) cell = gap.cell;
      if (mesh.apex(o) == b)
        for (const SurfaceCurves::CornerGap& corner : cells.corners)
          if (corner.cell == cell && corner.spoke == EditMesh::prev(o) && arriving.corners.count({corner.spoke, corner.rank}))
            if (const double c = state.cost + (points[b] - state.at).norm(); c < best) best = c, last = i;
      for (const SurfaceCurves::Gap& gap : cells.gaps) {
        if (gap.half_edge == o) {
          // Over a curve beside the gap, then on from there.
          if (!crossing || std::abs(gap.rank - state.gap.rank) != 1) continue;
          SurfaceCurves::Gap beside = gap;
          beside.half_edge = h;
          beside.from = 1 - gap.to, beside.to = 1 - gap.from;
          reach(beside, i, state.at, state.cost + kCrossingCost, curves_.crossing(gap.rank > state.gap.rank ? gap.below : state.gap.below).curve);
        } else if (gap.cell == cell) {
          reach(gap, i, state.at, state.cost, -1);
        }
      }
      for (const int side : {EditMesh::next(o), EditMesh::prev(o)}) reach_curve(side, i, state.at, state.cost);
    }
    if (!(best < std::numeric_limits<double>::infinity())) return std::nullopt;
    Way way;
    for (int i = last; i >= 0; i = states[i].previous) {
      way.gaps.push_back(states[i].gap);
      if (states[i].crossed >= 0) way.crossed.insert(states[i].crossed);
    }
    std::reverse(way.gaps.begin(), way.gaps.end());
    if (!crossing) erase_loops(way.gaps);
    return way;
  }

  // Along a guide the cheapest way may come through a gap once more: what lies between is left out.
  void erase_loops(std::vector<SurfaceCurves::Gap>& gaps) const {
    std::vector<SurfaceCurves::Gap> kept;
    std::map<std::pair<int, int>, std::size_t> place;  // edge, rank
    for (const SurfaceCurves::Gap& gap : gaps) {
      const auto key = [&](const SurfaceCurves::Gap& g) { return std::pair(curves_.mesh().edge[g.half_edge], g.rank); };
      const auto before = place.find(key(gap));
      if (before == place.end()) {
        place[key(gap)] = kept.size();
        kept.push_back(gap);
        continue;
      }
      // The same way through, or back.
      const std::size_t left = before->second + (kept[before->second].half_edge == gap.half_edge ? 1 : 0);
      while (kept.size() > left) {
        place.erase(key(kept.back()));
        kept.pop_back();
      }
    }
    gaps = std::move(kept);
  }

  // Shortest ones first. One that finds no way takes the place of those that bar it, which are traced anew.
  bool trace() {
    const int count = static_cast<int>(complex_.edges.size());
    std::vector<int> order(count), replaced(count, 0);
    for (int k = 0; k < count; ++k) {
      order[k] = k;
      if (complex_.edges[k].from == complex_.edges[k].to) return fail(name(complex_.edges[k]) + " is closed: there is no telling which way around the surface it goes");
    }
    const auto distance = [&](int k) { return (curves_.points()[vertex_[complex_.edges[k].from]] - curves_.points()[vertex_[complex_.edges[k].to]]).norm(); };
    std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return distance(i) < distance(j); });
    std::deque<int> pending(order.begin(), order.end());
    while (!pending.empty()) {
      progress_.check();
      const int k = pending.front();
      pending.pop_front();
      std::optional<Way> way = find(k, false);
      if (!way) {
        way = find(k, true);
        if (!way) return fail("there is no way for " + name(complex_.edges[k]));
        for (const int c : way->crossed) {
          const int other = curves_.curve(c).stroke;
          if (++replaced[other] > kMostReplacements)
            return fail("there is no way for " + name(complex_.edges[k]) + " that leaves one for " + name(complex_.edges[other]));
          curves_.remove(c);
          pending.push_back(other);
        }
        way = find(k, false);
        if (!way) return fail("there is no way for " + name(complex_.edges[k]));
      }
      if (curves_.add(vertex_[complex_.edges[k].from], vertex_[complex_.edges[k].to], way->gaps, k) < 0)
        return fail("nothing is left of " + name(complex_.edges[k]) + ": the surface is too coarse there");
    }
    curves_.spread();
    return true;
  }

  // Is this the side of a face that side i of quad q is to be?
  bool is_side(const PatchLayout& layout, const PatchLayout::Side& s, int q, int i) const {
    const PatchLayout::Curve& c = layout.curves[s.curve];
    const int e = complex_.edge(q, i);
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
    std::vector<int> curve(complex_.edges.size(), -1), from_node(outline_.nodes.size(), -1);
    for (int c = 0; c < static_cast<int>(layout.curves.size()); ++c) (layout.curves[c].boundary ? from_node[layout.curves[c].from] : curve[layout.curves[c].stroke]) = c;
    std::vector<PatchLayout::Face> faces;
    std::vector<int> renumbered(layout.faces.size(), -1);
    for (int q = 0; q < complex_.quads(); ++q) {
      const int e = complex_.edge(q, 0), c = e >= 0 ? curve[e] : from_node[complex_.node(q, 0)];
      const int f = c < 0 ? -1 : of_side[2 * c + (e < 0 || complex_.is_left(q, 0))];
      if (f < 0 || renumbered[f] >= 0) return false;
      PatchLayout::Face face = layout.faces[f];
      std::vector<PatchLayout::Side>& cycle = face.cycles[0];
      std::rotate(cycle.begin(), std::find_if(cycle.begin(), cycle.end(), [&](const PatchLayout::Side& s) { return is_side(layout, s, q, 0); }), cycle.end());
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
  SurfaceFrame frame_;
  TriangleSurface unit_;
  SurfaceCurves curves_;
  Components ours_, theirs_;
  std::vector<int> vertex_;  // per node
  std::string failure_;
  // Of the search at hand: see find().
  int search_ = 0;
  std::vector<std::pair<int, int>> best_undivided_;
  std::unordered_map<std::uint64_t, int> best_;
};

}  // namespace

TransferredLayout transfer_layout(const TriangleSurface& surface, const LayoutOutline& outline, const Progress& progress) {
  if (surface.empty() || outline.quads.empty()) throw Error(ErrorCode::InvalidInput, "a layout needs a surface and quads");
  TransferredLayout out = LayoutTracer(surface, outline, progress).run();
  progress(1);
  return out;
}

}  // namespace hybrid_mesh
