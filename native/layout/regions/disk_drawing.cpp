// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/disk_drawing.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>
#include <string>
#include <utility>

#include "base/found.h"
#include "layout/base/curve_network.h"
#include "layout/base/quad_layout.h"
#include "parameterization/convex_map.h"

namespace hybrid_mesh {
namespace {

// How far, as a fraction of a face, a node keeps off the face's sides. Where nodes lie close to one another in a large face it must be little, or
// their quads fold.
constexpr std::array<double, 3> kRoom{0.02, 1e-3, 1e-5};

class QuadDrawing {
 public:
  QuadDrawing(RegionSurface& disk, const LayoutEdit& edit) : disk_(disk), edit_(edit) {}

  PatchedSurface run() {
    embed();
    const RegionSurface disk = disk_;
    const std::vector<Vec2> uv = uv_;
    std::string failure;
    for (const double room : kRoom) {
      Found<PatchedSurface> drawn = found([&] {
        place_nodes(room);
        return cut();
      });
      if (drawn) return std::move(*drawn);
      failure = drawn.reason;
      disk_ = disk;
      uv_ = uv;
      inner_vertex_.clear();
    }
    throw NoMap(failure);
  }

 private:
  TriangleSurface& disk() { return disk_.mesh; }

  void embed() {
    const int n = static_cast<int>(disk_.sides.size());
    std::vector<DiskSide> sides;
    for (int k = 0; k < n; ++k) {
      sides.push_back({disk_.sides[k], {}});
      const double angle = 2 * std::numbers::pi * k / n;
      polygon_.push_back(Vec2(std::cos(angle), std::sin(angle)));
    }
    rim_ = disk_.rim();
    ConvexMap convex_map(disk());
    std::vector<int> faces;
    for (;;) {
      faces.resize(disk().faces.size());
      std::iota(faces.begin(), faces.end(), 0);
      const std::vector<int> chords = convex_map.side_chords(faces, sides);
      if (chords.empty()) break;
      for (const int h : chords) split_inner_edge(disk(), disk_.source, h);
      connect_half_edges(disk());
    }
    std::vector<std::array<Vec2, 3>> corners(disk().faces.size());
    if (!convex_map(faces, sides, polygon_, corners)) throw NoMap("the map of a disk to a polygon degenerates in double precision");
    uv_.resize(disk().points.size());
    for (const int f : faces)
      for (int i = 0; i < 3; ++i) uv_[disk().faces[f][i]] = corners[f][i];
  }

  // Where a point lies between a centre (0) and the polygon's rim (1).
  double gauge(const Vec2& p, const Vec2& centre) const {
    double most = 0;
    for (std::size_t k = 0; k < polygon_.size(); ++k) {
      const Vec2 a = polygon_[k], e = polygon_[(k + 1) % polygon_.size()] - a;
      const auto inside = [&](const Vec2& x) { return e.x() * (x.y() - a.y()) - e.y() * (x.x() - a.x()); };
      const double at_centre = inside(centre);
      if (at_centre > 0) most = std::max(most, 1 - inside(p) / at_centre);
    }
    return most;
  }

  // Where the tower's rings lie, as gauges: equally high above the region's boundary.
  std::vector<double> ring_gauges(Vec2& centre) {
    const std::vector<double> depth = edge_distances(disk(), rim_);
    const std::size_t tip = std::max_element(depth.begin(), depth.end()) - depth.begin();
    // The tip itself may be next to the rim in the plane: the rings keep some room.
    centre = 0.9 * uv_[tip];
    const double side = loop_length(disk(), rim_) / static_cast<double>(polygon_.size());
    // The last one as far from the tip as a square's sides are from its middle, or at the height that leaves as much above it as is between two, less
    // a little.
    const double rings = edit_.rings;
    const double last = std::max((rings - 0.1) / (rings + 1) * depth[tip], depth[tip] - 0.6 * side);
    std::vector<double> gauges;
    double outer = 1;
    for (int r = 0; r < edit_.rings; ++r) {
      const double wanted = last * (r + 1) / rings, width = 0.2 * last / rings;
      std::vector<double> at;
      for (std::size_t v = 0; v < depth.size(); ++v)
        if (std::abs(depth[v] - wanted) < width) at.push_back(gauge(uv_[v], centre));
      double shrink = 0.5 * outer;
      if (!at.empty()) {
        std::nth_element(at.begin(), at.begin() + at.size() / 2, at.end());
        shrink = std::clamp(at[at.size() / 2], 0.02 * outer, 0.9 * outer);
      }
      gauges.push_back(outer = shrink);
    }
    return gauges;
  }

  // Tutte's embedding of quads' sides in the polygon, whose corners are their first nodes: every quad is convex.
  std::vector<Vec2> embedded(const std::vector<std::array<int, 4>>& quads, int inner_nodes) const {
    const int n = static_cast<int>(polygon_.size()), all = n + inner_nodes;
    std::vector<Vec2> nodes = polygon_;
    if (inner_nodes == 0) return nodes;
    std::vector<std::vector<int>> beside(all);
    for (const auto& quad : quads)
      for (int i = 0; i < 4; ++i)
        if (quad[i] >= n) {
          beside[quad[i]].push_back(quad[(i + 1) % 4]);
          beside[quad[i]].push_back(quad[(i + 3) % 4]);
        }
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(inner_nodes, 2);
    for (int k = n; k < all; ++k) {
      entries.emplace_back(k - n, k - n, static_cast<double>(beside[k].size()));
      for (const int w : beside[k]) {
        if (w >= n)
          entries.emplace_back(k - n, w - n, -1.0);
        else
          right.row(k - n) += polygon_[w].transpose();
      }
    }
    Eigen::SparseMatrix<double> matrix(inner_nodes, inner_nodes);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::MatrixXd at = solver.solve(right);
    for (int k = 0; k < inner_nodes; ++k) nodes.push_back(at.row(k).transpose());
    return nodes;
  }

  // Rings around the tip, and on top of the last one the region's own quads.
  std::vector<Vec2> tower_nodes() {
    const int n = static_cast<int>(polygon_.size()), rings = edit_.rings;
    Vec2 centre(0, 0);
    const std::vector<double> gauges = ring_gauges(centre);
    std::vector<Vec2> nodes = polygon_;
    for (int k = 0; k < n * rings; ++k) nodes.push_back(Vec2(centre + gauges[k / n] * (polygon_[k % n] - centre)));
    const int left = edit_.inner_nodes - n * rings;
    if (left == 1) nodes.push_back(centre);
    if (left <= 1) return nodes;
    std::vector<std::array<int, 4>> top(edit_.quads.begin() + n * rings, edit_.quads.end());
    for (auto& quad : top)
      for (int& k : quad) k -= n * rings;
    const std::vector<Vec2> flat = embedded(top, left);
    for (int k = n; k < n + left; ++k) nodes.push_back(Vec2(centre + gauges.back() * (flat[k] - centre)));
    return nodes;
  }

  void place_nodes(double room) {
    const std::vector<Vec2> nodes = edit_.rings > 0 ? tower_nodes() : embedded(edit_.quads, edit_.inner_nodes);
    for (std::size_t k = polygon_.size(); k < nodes.size(); ++k) inner_vertex_.push_back(insert(nodes[k], room));
    connect_half_edges(disk());
  }

  // Splits the face that holds a point of the plane.
  int insert(const Vec2& p, double room) {
    TriangleSurface& mesh = disk();
    int face = 0;
    double best = -1e300;
    std::array<double, 3> weights{1, 0, 0};
    for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
      const std::array<int, 3>& c = mesh.faces[f];
      const auto area = [&](const Vec2& x, const Vec2& y, const Vec2& z) {
        return (y.x() - x.x()) * (z.y() - x.y()) - (y.y() - x.y()) * (z.x() - x.x());
      };
      const double whole = area(uv_[c[0]], uv_[c[1]], uv_[c[2]]);
      if (!(whole > 0)) continue;
      const std::array<double, 3> w{area(uv_[c[1]], uv_[c[2]], p) / whole, area(uv_[c[2]], uv_[c[0]], p) / whole,
                                    area(uv_[c[0]], uv_[c[1]], p) / whole};
      const double least = std::min({w[0], w[1], w[2]});
      if (least > best) best = least, face = f, weights = w;
    }
    double sum = 0;
    for (double& w : weights) sum += w = std::max(w, room);
    for (double& w : weights) w /= sum;
    const std::array<int, 3> c = mesh.faces[face];
    const int v = static_cast<int>(mesh.points.size());
    mesh.points.push_back(weights[0] * mesh.points[c[0]] + weights[1] * mesh.points[c[1]] + weights[2] * mesh.points[c[2]]);
    uv_.push_back(weights[0] * uv_[c[0]] + weights[1] * uv_[c[1]] + weights[2] * uv_[c[2]]);
    std::vector<PointSource>& source = disk_.source;
    const PointSource s = combine({&source[c[0]], &source[c[1]], &source[c[2]]}, weights);
    source.push_back(s);
    mesh.faces[face] = {c[0], c[1], v};
    mesh.faces.push_back({c[1], c[2], v});
    mesh.faces.push_back({c[2], c[0], v});
    mesh.source_face.insert(mesh.source_face.end(), 2, mesh.source_face[face]);
    return v;
  }

  PatchedSurface cut() {
    const int n = static_cast<int>(disk_.sides.size());
    QuadLayout layout;
    for (const std::vector<int>& side : disk_.sides) layout.node_vertex.push_back(side.front());
    layout.node_vertex.insert(layout.node_vertex.end(), inner_vertex_.begin(), inner_vertex_.end());
    std::map<std::pair<int, int>, int> curve_of;
    for (const auto& nodes : edit_.quads) {
      QuadLayout::Quad quad;
      quad.nodes = nodes;
      for (int i = 0; i < 4; ++i) {
        const int a = nodes[i], b = nodes[(i + 1) % 4];
        if (a < n && b == (a + 1) % n) continue;  // along the boundary
        const auto [it, fresh] = curve_of.insert({std::minmax(a, b), static_cast<int>(layout.curves.size())});
        if (fresh) layout.curves.push_back({layout.node_vertex[a], layout.node_vertex[b], -1});
        quad.sides[i] = {it->second, layout.curves[it->second].start == layout.node_vertex[a]};
      }
      layout.quads.push_back(quad);
    }
    return cut_along_segments(disk(), uv_, layout);
  }

  RegionSurface& disk_;
  const LayoutEdit& edit_;
  std::vector<Vec2> uv_, polygon_;
  std::vector<int> rim_, inner_vertex_;
};

}  // namespace

PatchedSurface draw_quads(RegionSurface& disk, const LayoutEdit& edit) { return QuadDrawing(disk, edit).run(); }

PointSource traced(const PointSource& point, const std::vector<PointSource>& sources) {
  std::array<const PointSource*, 3> of{nullptr, nullptr, nullptr};
  for (int k = 0; k < 3; ++k)
    if (point.vertices[k] >= 0) of[k] = &sources[point.vertices[k]];
  return combine(of, point.weights);
}

std::vector<double> edge_distances(const TriangleSurface& mesh, const std::vector<int>& from) {
  std::vector<std::vector<int>> leaving(mesh.points.size());
  for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
    leaving[mesh.from(h)].push_back(mesh.to(h));
    if (mesh.opposite[h] < 0) leaving[mesh.to(h)].push_back(mesh.from(h));
  }
  std::vector<double> distance(mesh.points.size(), 1e300);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  for (const int v : from) queue.push({distance[v] = 0, v});
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[v]) continue;
    for (const int w : leaving[v]) {
      const double along = d + (mesh.points[w] - mesh.points[v]).norm();
      if (along < distance[w]) queue.push({distance[w] = along, w});
    }
  }
  return distance;
}

double loop_length(const TriangleSurface& mesh, const std::vector<int>& loop) {
  double length = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) length += (mesh.points[loop[k]] - mesh.points[loop[(k + 1) % loop.size()]]).norm();
  return length;
}

}  // namespace hybrid_mesh
