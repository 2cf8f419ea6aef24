// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/ring_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <utility>

#include "base/error.h"
#include "layout/regions/disk_drawing.h"
#include "surface/boundary_loop.h"

namespace hybrid_mesh {
namespace {

using DirectedEdge = std::pair<int, int>;

// Faces by the edges that run along them, counter-clockwise.
template <std::size_t N>
std::map<DirectedEdge, std::pair<int, int>> edges_of(const std::vector<std::array<int, N>>& faces) {
  std::map<DirectedEdge, std::pair<int, int>> out;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t i = 0; i < N; ++i) out[{faces[f][i], faces[f][(i + 1) % N]}] = {static_cast<int>(f), static_cast<int>(i)};
  return out;
}

// Cuts faces apart along a way between two boundaries: to its right vertex k of the way becomes `fresh` + k.
template <std::size_t N>
void cut_along(std::vector<std::array<int, N>>& faces, const std::vector<int>& way, int fresh) {
  const auto edges = edges_of(faces);
  std::vector<std::pair<std::pair<int, int>, int>> changes;  // face and corner; what it becomes
  const std::size_t last = way.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const int v = way[k], new_name = fresh + static_cast<int>(k);
    // Around the vertex from one edge of the way to the other, or to the boundary: clockwise from the edge onwards, at the way's end
    // counter-clockwise from the edge back.
    const bool clockwise = k < last;
    int at = clockwise ? way[k + 1] : way[k - 1];
    const int stop = clockwise && k > 0 ? way[k - 1] : -1;
    while (at != stop) {
      const auto found = edges.find(clockwise ? DirectedEdge{at, v} : DirectedEdge{v, at});
      if (found == edges.end()) break;
      const auto [f, i] = found->second;
      const std::size_t corner = clockwise ? (i + 1) % N : i;
      changes.push_back({{f, static_cast<int>(corner)}, new_name});
      at = faces[f][clockwise ? (corner + 1) % N : (corner + N - 1) % N];
    }
  }
  for (const auto& [place, name] : changes) faces[place.first][place.second] = name;
}

class RingDrawing {
 public:
  RingDrawing(RegionSurface& ring, const LayoutEdit& edit, const std::vector<int>& spoke) : ring_(ring), edit_(edit), spoke_(spoke) {
    corners_ = static_cast<int>(ring.sides.size());
    first_ = rim_end();
  }

  PatchedSurface run() {
    if (spoke_.size() < 2) throw NoMap("no quads' sides lead across the ring");
    find_other_side();
    split_chords();
    find_way();
    spread_nodes();
    RegionSurface disk = cut_open();
    PatchedSurface piece = draw_quads(disk, edit_of_disk());
    return closed(std::move(disk), std::move(piece));
  }

 private:
  TriangleSurface& mesh() { return ring_.mesh; }

  // Sides of the first rim.
  int rim_end() const {
    int k = 1;
    while (k < corners_ && ring_.sides[k - 1].back() == ring_.sides[k].front()) ++k;
    return k;
  }

  // The other boundary's nodes in its own direction from the spoke's end on, and the lines between them.
  void find_other_side() {
    if (corners_ > first_) {
      const int m = corners_ - first_, shift = spoke_.back() - first_;
      if (shift < 0 || shift >= m) throw NoMap("no quads' sides lead across the ring");
      for (int i = 0; i < m; ++i) {
        other_nodes_.push_back(first_ + (shift + i) % m);
        other_sides_.push_back(ring_.sides[first_ + (shift + i) % m]);
      }
      return;
    }
    // The quads' boundary, from the spoke's end on.
    const auto edges = edges_of(edit_.quads);
    std::map<int, int> next;
    for (const auto& [edge, place] : edges)
      if (!edges.count({edge.second, edge.first})) next[edge.first] = edge.second;
    int v = spoke_.back();
    do {
      other_nodes_.push_back(v);
      if (!next.count(v)) throw NoMap("no quads' sides lead across the ring");
      v = next[v];
    } while (v != spoke_.back() && other_nodes_.size() <= next.size());
    divide_open_loop();
  }

  // Gives the open loop as many points at even distances as there are nodes on it, the first one near corner 0.
  void divide_open_loop() {
    const TriangleSurface before = mesh();
    const std::vector<Vec3>& points = before.points;
    const std::set<int> rim = [&] {
      const std::vector<int> all = ring_.rim();
      return std::set<int>(all.begin(), all.end());
    }();
    const std::vector<BoundaryLoop> loops = boundary_loops(before);
    const auto is_open = [&](const BoundaryLoop& loop) { return !rim.count(loop.vertex(0)); };
    const auto at = std::find_if(loops.begin(), loops.end(), is_open);
    if (at == loops.end()) throw NoMap("the ring has no other boundary");
    const BoundaryLoop& loop = *at;
    // The nodes on it are beside the first rim's corners, which run the other way around.
    const int m = static_cast<int>(other_nodes_.size());
    constexpr int tries = 64;
    const auto wrapped = [&](double arc) { return arc - std::floor(arc / loop.length()) * loop.length(); };
    double best = std::numeric_limits<double>::infinity(), begin = 0;
    for (int t = 0; t < tries; ++t) {
      const double start = t * loop.length() / tries;
      double sum = 0;
      for (int i = 0; i < first_; ++i) sum += (loop.at(wrapped(start - i * loop.length() / first_)) - points[ring_.corner(i)]).squaredNorm();
      if (sum < best) best = sum, begin = start;
    }
    // Cut into the edges that hold them.
    std::vector<std::pair<double, int>> wanted;  // arc, place in the order of nodes
    for (int j = 0; j < m; ++j) wanted.push_back({wrapped(begin + j * loop.length() / m), j});
    std::sort(wanted.begin(), wanted.end());
    std::vector<int> line;        // all points of the loop, old and new
    std::vector<int> node_at(m);  // places in it
    std::size_t w = 0;
    for (int i = 0; i < loop.size(); ++i) {
      const double from = loop.arc(i), to = loop.arc(i + 1);
      int a = loop.vertex(i);
      const int b = loop.vertex(i + 1);
      line.push_back(a);
      double done = from;
      for (; w < wanted.size() && wanted[w].first < to; ++w) {
        const double t = (wanted[w].first - done) / (to - done);
        // What is at a point already, or nearly, takes that one.
        constexpr double near = 1e-3;
        const bool taken = w > 0 && node_at[wanted[w - 1].second] == static_cast<int>(line.size()) - 1;
        if (t > near || taken) {
          a = split_boundary_edge(a, b, std::clamp(t, near, 1 - near));
          line.push_back(a);
          done = wanted[w].first;
        }
        node_at[wanted[w].second] = static_cast<int>(line.size()) - 1;
      }
    }
    for (int j = 0; j < m; ++j) {
      const int size = static_cast<int>(line.size()), stop = node_at[(j + 1) % m];
      std::vector<int>& side = other_sides_.emplace_back();
      for (int k = node_at[j];; k = (k + 1) % size) {
        side.push_back(line[k]);
        if (k == stop && side.size() > 1) break;
      }
    }
  }

  int half_edge(int a, int b) {
    for (int h = 0; h < static_cast<int>(mesh().opposite.size()); ++h)
      if (mesh().from(h) == a && mesh().to(h) == b) return h;
    throw Error(ErrorCode::Internal, "a boundary of a ring is not made of the mesh's edges");
  }

  int split_boundary_edge(int a, int b, double t) {
    TriangleSurface& m = mesh();
    const int h = half_edge(a, b), f = h / 3, i = h % 3;
    const int v = static_cast<int>(m.points.size());
    m.points.push_back((1 - t) * m.points[a] + t * m.points[b]);
    ring_.source.push_back(combine({&ring_.source[a], &ring_.source[b], &ring_.source[a]}, {1 - t, t, 0}));
    ring_.point.push_back(-1);
    std::array<int, 3> second = m.faces[f];
    m.faces[f][(i + 1) % 3] = v;
    second[i] = v;
    m.faces.push_back(second);
    m.source_face.push_back(m.source_face[f]);
    connect_half_edges(m);
    return v;
  }

  std::vector<char> boundary_vertices() {
    std::vector<char> on(mesh().points.size(), 0);
    for (int h = 0; h < static_cast<int>(mesh().opposite.size()); ++h)
      if (mesh().opposite[h] < 0) on[mesh().from(h)] = on[mesh().to(h)] = 1;
    return on;
  }

  void split(const std::vector<int>& halves) {
    for (const int h : halves) split_inner_edge(mesh(), ring_.source, h);
    ring_.point.resize(mesh().points.size(), -1);
    if (!halves.empty()) connect_half_edges(mesh());
  }

  // Inner edges between two points of the boundary get a point: then there is a way inside from any point to any other. A face has one split at a
  // time.
  void split_chords() {
    for (;;) {
      const std::vector<char> on = boundary_vertices();
      std::vector<char> touched(mesh().faces.size(), 0);
      std::vector<int> halves;
      for (int h = 0; h < static_cast<int>(mesh().opposite.size()); ++h) {
        const int o = mesh().opposite[h];
        if (o < h || !on[mesh().from(h)] || !on[mesh().to(h)] || touched[h / 3] || touched[o / 3]) continue;
        touched[h / 3] = touched[o / 3] = 1;
        halves.push_back(h);
      }
      if (halves.empty()) return;
      split(halves);
    }
  }

  void find_way() {
    const std::vector<char> on = boundary_vertices();
    const int from = ring_.corner(0), to = other_sides_.front().front();
    const TriangleSurface& m = mesh();
    std::vector<std::vector<int>> leaving(m.points.size());
    for (int h = 0; h < static_cast<int>(m.opposite.size()); ++h)
      if (m.opposite[h] >= 0) leaving[m.from(h)].push_back(m.to(h));
    std::vector<double> distance(m.points.size(), std::numeric_limits<double>::infinity());
    std::vector<int> before(m.points.size(), -1);
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> queue;
    queue.push({distance[from] = 0, from});
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > distance[v]) continue;
      for (const int w : leaving[v]) {
        if (on[w] && w != to) continue;
        const double along = d + (m.points[w] - m.points[v]).norm();
        if (along < distance[w]) {
          before[w] = v;
          queue.push({distance[w] = along, w});
        }
      }
    }
    if (before[to] < 0) throw NoMap("there is no way across the ring");
    for (int v = to; v >= 0; v = before[v]) way_.push_back(v);
    std::reverse(way_.begin(), way_.end());
  }

  // Nodes of the spoke at points of the way, about evenly: it gets as many points as it needs.
  void spread_nodes() {
    const std::size_t steps = spoke_.size() - 1;
    const auto length = [&](std::size_t k) { return (mesh().points[way_[k + 1]] - mesh().points[way_[k]]).norm(); };
    while (way_.size() < steps + 1) {
      std::size_t longest = 0;
      for (std::size_t k = 1; k + 1 < way_.size(); ++k)
        if (length(k) > length(longest)) longest = k;
      split({half_edge(way_[longest], way_[longest + 1])});
      way_.insert(way_.begin() + static_cast<std::ptrdiff_t>(longest) + 1, static_cast<int>(mesh().points.size()) - 1);
    }
    std::vector<double> at{0};
    for (std::size_t k = 0; k + 1 < way_.size(); ++k) at.push_back(at.back() + length(k));
    node_at_ = {0};
    for (std::size_t s = 1; s < steps; ++s) {
      std::size_t k = node_at_.back() + 1;
      const double wanted = at.back() * static_cast<double>(s) / static_cast<double>(steps);
      // As many points have to be left as there are nodes to come.
      while (k + 1 + (steps - s) <= way_.size() - 1 && std::abs(at[k + 1] - wanted) < std::abs(at[k] - wanted)) ++k;
      node_at_.push_back(k);
    }
    node_at_.push_back(way_.size() - 1);
  }

  // Its boundary: the first rim from corner 0 around, the way across, the other boundary, the way back. What is right of the way has points of its
  // own.
  RegionSurface cut_open() {
    RegionSurface disk = ring_;
    fresh_ = static_cast<int>(disk.mesh.points.size());
    for (const int v : way_) {
      disk.mesh.points.push_back(ring_.mesh.points[v]);
      disk.source.push_back(ring_.source[v]);
      disk.point.push_back(-1);
    }
    cut_along(disk.mesh.faces, way_, fresh_);
    connect_half_edges(disk.mesh);
    // The surface is left of its boundary: the rim leaves corner 0 with the way's right side behind it, and comes back to the way's left side.
    disk.sides.assign(ring_.sides.begin(), ring_.sides.begin() + first_);
    disk.sides.front().front() = fresh_;
    const std::size_t steps = spoke_.size() - 1;
    for (std::size_t s = 0; s < steps; ++s)
      disk.sides.push_back(
          {way_.begin() + static_cast<std::ptrdiff_t>(node_at_[s]), way_.begin() + static_cast<std::ptrdiff_t>(node_at_[s + 1]) + 1});
    disk.sides.insert(disk.sides.end(), other_sides_.begin(), other_sides_.end());
    disk.sides.back().back() = fresh_ + static_cast<int>(way_.size()) - 1;
    for (std::size_t s = steps; s > 0; --s) {
      std::vector<int>& side = disk.sides.emplace_back();
      for (std::size_t k = node_at_[s] + 1; k-- > node_at_[s - 1];) side.push_back(fresh_ + static_cast<int>(k));
    }
    return disk;
  }

  // The edit's quads by the disk's corners.
  LayoutEdit edit_of_disk() const {
    const int nodes = corners_ + edit_.inner_nodes, steps = static_cast<int>(spoke_.size()) - 1;
    LayoutEdit disk;
    disk.quads = edit_.quads;
    cut_along(disk.quads, spoke_, nodes);
    std::vector<int> number(nodes + steps + 1, -1);
    int count = 0;
    const auto add = [&](int node) { number[node] = count++; };
    add(nodes);  // right of the spoke
    for (int i = 1; i < first_; ++i) add(i);
    for (int s = 0; s < steps; ++s) add(spoke_[s]);
    for (const int node : other_nodes_) add(node);
    for (int s = steps; s > 0; --s) add(nodes + s);
    const int around = count;
    for (int node = 0; node < static_cast<int>(number.size()); ++node)
      if (number[node] < 0) add(node);
    disk.inner_nodes = count - around;
    for (auto& quad : disk.quads)
      for (int& n : quad) n = number[n];
    return disk;
  }

  // The disk's points along the way are one again.
  PatchedSurface closed(RegionSurface disk, PatchedSurface piece) {
    const int way = static_cast<int>(way_.size());
    std::vector<int> number(std::max(disk.mesh.points.size(), piece.mesh.points.size()));
    for (int v = 0; v < static_cast<int>(number.size()); ++v) number[v] = v < fresh_ ? v : v < fresh_ + way ? way_[v - fresh_] : v - way;
    const auto drop = [&](auto& of_points) { of_points.erase(of_points.begin() + fresh_, of_points.begin() + fresh_ + way); };
    const auto renumber = [&](auto& lists) {
      for (auto& list : lists)
        for (int& v : list) v = number[v];
    };
    drop(disk.mesh.points);
    drop(disk.source);
    disk.point.resize(number.size(), -1);
    drop(disk.point);
    disk.point.resize(disk.mesh.points.size(), -1);
    renumber(disk.mesh.faces);
    connect_half_edges(disk.mesh);
    disk.sides = ring_.sides;
    ring_ = std::move(disk);

    drop(piece.mesh.points);
    drop(piece.source);
    for (PointSource& s : piece.source)
      for (int& v : s.vertices)
        if (v >= 0) v = number[v];
    renumber(piece.mesh.faces);
    connect_half_edges(piece.mesh);
    for (auto& sides : piece.sides) renumber(sides);
    piece.nodes = edit_.quads;
    piece.node_count = corners_ + edit_.inner_nodes;
    const auto edges = edges_of(edit_.quads);
    for (std::size_t q = 0; q < piece.nodes.size(); ++q)
      for (int i = 0; i < 4; ++i) {
        const auto other = edges.find({piece.nodes[q][(i + 1) % 4], piece.nodes[q][i]});
        piece.neighbours[q][i] = other == edges.end() ? PatchSide() : PatchSide{other->second.first, other->second.second};
      }
    return piece;
  }

  RegionSurface& ring_;
  const LayoutEdit& edit_;
  const std::vector<int>& spoke_;
  int corners_ = 0, first_ = 0;                // of all rims; of the first one
  std::vector<int> other_nodes_;               // on the other boundary, from the spoke's end on
  std::vector<std::vector<int>> other_sides_;  // between them
  std::vector<int> way_;                       // points from corner 0 to the other boundary
  std::vector<std::size_t> node_at_;           // per node of the spoke: its place on the way
  int fresh_ = 0;                              // the first point that was doubled
};

}  // namespace

PatchedSurface draw_ring(RegionSurface& ring, const LayoutEdit& edit, const std::vector<int>& spoke) { return RingDrawing(ring, edit, spoke).run(); }

std::vector<int> find_spoke(const std::vector<std::array<int, 4>>& quads, int corners, int first) {
  const auto edges = edges_of(quads);
  int nodes = corners;
  for (const auto& quad : quads) nodes = std::max(nodes, *std::max_element(quad.begin(), quad.end()) + 1);
  std::vector<char> boundary(nodes, 0);
  std::vector<std::vector<int>> beside(nodes);
  for (const auto& [edge, place] : edges) {
    const bool inner = edges.count({edge.second, edge.first}) > 0;
    if (!inner) boundary[edge.first] = boundary[edge.second] = 1;
    if (inner) beside[edge.first].push_back(edge.second);
  }
  std::vector<int> before(nodes, -1);
  std::vector<int> queue{0};
  before[0] = 0;
  for (std::size_t i = 0; i < queue.size(); ++i)
    for (const int w : beside[queue[i]]) {
      if (before[w] >= 0 || w < first) continue;
      before[w] = queue[i];
      if (!boundary[w]) {
        queue.push_back(w);
        continue;
      }
      std::vector<int> spoke{w};
      while (spoke.back() != 0) spoke.push_back(before[spoke.back()]);
      std::reverse(spoke.begin(), spoke.end());
      return spoke;
    }
  return {};
}

}  // namespace hybrid_mesh
