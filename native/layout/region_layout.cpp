// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/region_layout.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>
#include <set>

#include <Eigen/SparseCholesky>

#include "base/error.h"
#include "layout/curve_network.h"
#include "layout/decimation.h"
#include "layout/quad_layout.h"
#include "layout/region_pattern.h"
#include "parameterization/convex_map.h"

namespace hybrid_mesh {

std::vector<int> node_valences(const PatchedSurface& surface) {
  std::vector<int> valence(surface.node_count, 0);
  for (const auto& nodes : surface.nodes)
    for (const int n : nodes) ++valence[n];
  return valence;
}

std::vector<char> boundary_nodes(const PatchedSurface& surface) {
  std::vector<char> on(surface.node_count, 0);
  for (int q = 0; q < surface.patch_count(); ++q)
    for (int i = 0; i < 4; ++i)
      if (surface.neighbours[q][i].patch < 0) on[surface.nodes[q][i]] = on[surface.nodes[q][(i + 1) % 4]] = 1;
  return on;
}

std::optional<PatchRegion> make_region(const PatchedSurface& surface, const std::vector<int>& patches, PatchSide start) {
  const auto inside = [&](int q) { return q >= 0 && std::find(patches.begin(), patches.end(), q) != patches.end(); };
  const auto on_rim = [&](const PatchSide& s) { return !inside(surface.neighbours[s.patch][s.side].patch); };
  int rim = 0;
  for (const int q : patches)
    for (int i = 0; i < 4; ++i) {
      if (!on_rim({q, i})) continue;
      ++rim;
      if (start.patch < 0) start = {q, i};
    }
  if (rim == 0 || !inside(start.patch) || !on_rim(start)) return std::nullopt;
  PatchRegion region;
  region.patches = patches;
  PatchSide at = start;
  do {
    if (static_cast<int>(region.boundary.size()) == rim) return std::nullopt;
    region.boundary.push_back(at);
    region.corners.push_back(surface.nodes[at.patch][at.side]);
    at.side = (at.side + 1) % 4;
    while (!on_rim(at)) {
      at = surface.neighbours[at.patch][at.side];
      at.side = (at.side + 1) % 4;
    }
  } while (at.patch != start.patch || at.side != start.side);
  if (static_cast<int>(region.boundary.size()) != rim) return std::nullopt;
  std::vector<int> nodes, corners = region.corners;
  for (const int q : patches) nodes.insert(nodes.end(), surface.nodes[q].begin(), surface.nodes[q].end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::sort(corners.begin(), corners.end());
  if (std::unique(corners.begin(), corners.end()) != corners.end()) return std::nullopt;
  std::set_difference(nodes.begin(), nodes.end(), corners.begin(), corners.end(), std::back_inserter(region.inner_nodes));
  const int quads = static_cast<int>(patches.size()), edges = rim + (4 * quads - rim) / 2;
  if (static_cast<int>(nodes.size()) - edges + quads != 1) return std::nullopt;
  return region;
}

LayoutEdit star_edit(const PatchRegion& region, int parity) {
  const int n = static_cast<int>(region.corners.size());
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  edit.inner_nodes = 1;
  for (int k = parity; k < n; k += 2) edit.quads.push_back({n, k, (k + 1) % n, (k + 2) % n});
  return edit;
}

LayoutEdit chord_edit(const PatchRegion& region, int from) {
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  for (const int k : {from, from + 3}) edit.quads.push_back({k % 6, (k + 1) % 6, (k + 2) % 6, (k + 3) % 6});
  return edit;
}

std::optional<LayoutEdit> tower_edit(const PatchedSurface& surface, const PatchRegion& region, int rings) {
  const int n = static_cast<int>(region.corners.size());
  if (region.inner_nodes.size() > 1) return std::nullopt;
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  edit.rings = rings;
  edit.inner_nodes = n * rings + static_cast<int>(region.inner_nodes.size());
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < n; ++k) edit.quads.push_back({n * r + k, n * r + (k + 1) % n, n * (r + 1) + (k + 1) % n, n * (r + 1) + k});
  for (const int q : region.patches) {
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) {
      const auto at = std::find(region.corners.begin(), region.corners.end(), surface.nodes[q][i]);
      quad[i] = n * rings + (at == region.corners.end() ? n : static_cast<int>(at - region.corners.begin()));
    }
    edit.quads.push_back(quad);
  }
  return edit;
}

std::optional<int> irregular_growth(const PatchedSurface& surface, const PatchRegion& region, const LayoutEdit& edit, const std::vector<int>& valence, const std::vector<char>& on_boundary) {
  const int n = static_cast<int>(region.corners.size());
  std::vector<int> change(n, 0), fresh(edit.inner_nodes, 0);
  for (const auto& quad : edit.quads)
    for (const int k : quad) ++(k < n ? change[k] : fresh[k - n]);
  for (const int q : region.patches)
    for (const int node : surface.nodes[q]) {
      const auto at = std::find(region.corners.begin(), region.corners.end(), node);
      if (at != region.corners.end()) --change[at - region.corners.begin()];
    }
  int growth = 0;
  for (int k = 0; k < n; ++k) {
    const int node = region.corners[k], after = valence[node] + change[k];
    if (change[k] == 0) continue;
    if (on_boundary[node] ? after < 1 || after > 4 : after < 3 || after > 6) return std::nullopt;
    if (!on_boundary[node]) growth += (after != 4) - (valence[node] != 4);
  }
  for (const int v : fresh) {
    if (v < 3 || v > 6) return std::nullopt;
    growth += v != 4;
  }
  for (const int node : region.inner_nodes) growth -= valence[node] != 4;
  return growth;
}

LayoutChange change_layout(PatchedSurface& layout, const LayoutEdit& edit) {
  const std::optional<PatchRegion> region = make_region(layout, edit.patches, edit.start);
  if (!region) throw Error(ErrorCode::Internal, "a region to be laid out anew is no disk");
  const int n = static_cast<int>(region->corners.size());
  const int old_count = layout.patch_count(), removed = static_cast<int>(edit.patches.size()), added = static_cast<int>(edit.quads.size());
  LayoutChange change;
  std::vector<int> holes = edit.patches;
  std::sort(holes.begin(), holes.end());
  change.patch.resize(old_count);
  std::iota(change.patch.begin(), change.patch.end(), 0);
  for (int i = 0; i < added; ++i) change.added.push_back(i < removed ? holes[i] : old_count + i - removed);
  const int count = old_count + added - removed;
  for (int i = added, last = old_count - 1; i < removed && holes[i] < count; ++i) {
    while (std::binary_search(holes.begin(), holes.end(), last)) --last;
    change.patch[last--] = holes[i];
  }
  for (const int q : edit.patches) change.patch[q] = -1;

  std::vector<std::array<int, 4>> nodes(count);
  std::vector<std::array<PatchSide, 4>> neighbours(count);
  for (int q = 0; q < old_count; ++q) {
    if (change.patch[q] < 0) continue;
    nodes[change.patch[q]] = layout.nodes[q];
    for (int i = 0; i < 4; ++i) {
      PatchSide other = layout.neighbours[q][i];
      if (other.patch >= 0) other.patch = change.patch[other.patch];
      neighbours[change.patch[q]][i] = other;
    }
  }
  std::map<std::pair<int, int>, PatchSide> side_between;
  for (int k = 0; k < added; ++k)
    for (int i = 0; i < 4; ++i) side_between[{edit.quads[k][i], edit.quads[k][(i + 1) % 4]}] = {change.added[k], i};
  for (int k = 0; k < added; ++k)
    for (int i = 0; i < 4; ++i) {
      const int a = edit.quads[k][i], b = edit.quads[k][(i + 1) % 4], q = change.added[k];
      nodes[q][i] = a < n ? region->corners[a] : layout.node_count + a - n;
      if (a < n && b == (a + 1) % n) {
        const PatchSide& rim = region->boundary[a];
        PatchSide other = layout.neighbours[rim.patch][rim.side];
        if (other.patch >= 0) {
          other.patch = change.patch[other.patch];
          neighbours[other.patch][other.side] = {q, i};
        }
        neighbours[q][i] = other;
      } else {
        const auto other = side_between.find({b, a});
        if (other == side_between.end()) throw Error(ErrorCode::Internal, "a new quad of a region has a side without a neighbour");
        neighbours[q][i] = other->second;
      }
    }
  change.node.assign(layout.node_count + edit.inner_nodes, -1);
  layout.node_count = 0;
  for (auto& corners : nodes)
    for (int& x : corners) {
      if (change.node[x] < 0) change.node[x] = layout.node_count++;
      x = change.node[x];
    }
  layout.nodes = std::move(nodes);
  layout.neighbours = std::move(neighbours);
  return change;
}

LayoutEdit renumbered(LayoutEdit edit, const LayoutChange& change) {
  for (int& q : edit.patches) q = change.patch[q];
  edit.start.patch = change.patch[edit.start.patch];
  return edit;
}

namespace {

// Lengths of shortest paths along edges from some vertices.
std::vector<double> distances(const TriangleSurface& mesh, const std::vector<int>& from) {
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

double length_of(const TriangleSurface& mesh, const std::vector<int>& loop) {
  double length = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) length += (mesh.points[loop[k]] - mesh.points[loop[(k + 1) % loop.size()]]).norm();
  return length;
}

// The region's boundary in a part made of its patches: all vertices along it.
std::vector<int> rim_of(const PatchedPart& part, const PatchRegion& region) {
  std::vector<int> rim;
  for (const PatchSide& s : region.boundary) {
    const auto patch = std::find(region.patches.begin(), region.patches.end(), s.patch) - region.patches.begin();
    const std::vector<int>& side = part.surface.sides[patch][s.side];
    rim.insert(rim.end(), side.begin(), side.end() - 1);
  }
  return rim;
}

}  // namespace

int tower_height(const PatchedSurface& surface, const PatchRegion& region) {
  const PatchedPart part = part_of(surface, region.patches);
  const std::vector<int> rim = rim_of(part, region);
  const std::vector<double> depth = distances(part.surface.mesh, rim);
  const double side = length_of(part.surface.mesh, rim) / static_cast<double>(region.corners.size());
  return static_cast<int>(std::lround(*std::max_element(depth.begin(), depth.end()) / std::max(side, 1e-300)));
}

namespace {

// One application of an edit.
class Relayout {
 public:
  Relayout(MappedSurface& mapped, const LayoutEdit& edit) : mapped_(mapped), edit_(edit) {}

  LayoutChange run() {
    take_region();
    embed();
    place_nodes();
    cut();
    return merge();
  }

  LayoutChange run(PatchedSurface piece) {
    take_region();
    piece_ = std::move(piece);
    return merge();
  }

 private:
  void take_region() {
    std::optional<PatchRegion> region = make_region(mapped_.surface, edit_.patches, edit_.start);
    if (!region) throw Error(ErrorCode::Internal, "a region to be laid out anew is no disk");
    region_ = std::move(*region);
    part_ = part_of(mapped_.surface, edit_.patches);
  }

  TriangleSurface& disk() { return part_.surface.mesh; }
  int local_patch(int q) const { return static_cast<int>(std::find(edit_.patches.begin(), edit_.patches.end(), q) - edit_.patches.begin()); }

  void embed() {
    const int n = static_cast<int>(region_.corners.size());
    std::vector<DiskSide> sides;
    std::vector<Vec2> polygon;
    for (int k = 0; k < n; ++k) {
      const PatchSide& s = region_.boundary[k];
      sides.push_back({part_.surface.sides[local_patch(s.patch)][s.side], {}});
      const double angle = 2 * std::numbers::pi * k / n;
      polygon.push_back(Vec2(std::cos(angle), std::sin(angle)));
      corner_vertex_.push_back(sides.back().points.front());
    }
    polygon_ = polygon;
    rim_ = rim_of(part_, region_);
    ConvexMap convex_map(disk());
    std::vector<int> faces;
    for (;;) {
      faces.resize(disk().faces.size());
      std::iota(faces.begin(), faces.end(), 0);
      const std::vector<int> chords = convex_map.side_chords(faces, sides);
      if (chords.empty()) break;
      for (const int h : chords) split_inner_edge(disk(), part_.surface.source, h);
      connect_half_edges(disk());
    }
    std::vector<std::array<Vec2, 3>> corners(disk().faces.size());
    if (!convex_map(faces, sides, polygon, corners)) throw Error(ErrorCode::Internal, "the map of a region degenerates in double precision");
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
    const std::vector<double> depth = distances(disk(), rim_);
    const std::size_t tip = std::max_element(depth.begin(), depth.end()) - depth.begin();
    // The tip itself may be next to the rim in the plane: the rings keep some room.
    centre = 0.9 * uv_[tip];
    const double side = length_of(disk(), rim_) / static_cast<double>(polygon_.size());
    // The last one as far from the tip as a square's sides are from its middle, or at the height that leaves as much above it as is between two, less a little.
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

  // Tutte's embedding of the new quads' sides: every quad is convex.
  std::vector<Vec2> drawn_nodes() const {
    const int n = static_cast<int>(polygon_.size()), all = n + edit_.inner_nodes;
    std::vector<std::vector<int>> beside(all);
    for (const auto& quad : edit_.quads)
      for (int i = 0; i < 4; ++i)
        if (quad[i] >= n) {
          beside[quad[i]].push_back(quad[(i + 1) % 4]);
          beside[quad[i]].push_back(quad[(i + 3) % 4]);
        }
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(edit_.inner_nodes, 2);
    for (int k = n; k < all; ++k) {
      entries.emplace_back(k - n, k - n, static_cast<double>(beside[k].size()));
      for (const int w : beside[k]) {
        if (w >= n)
          entries.emplace_back(k - n, w - n, -1.0);
        else
          right.row(k - n) += polygon_[w].transpose();
      }
    }
    Eigen::SparseMatrix<double> matrix(edit_.inner_nodes, edit_.inner_nodes);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::MatrixXd at = solver.solve(right);
    std::vector<Vec2> nodes = polygon_;
    for (int k = 0; k < edit_.inner_nodes; ++k) nodes.push_back(at.row(k).transpose());
    return nodes;
  }

  void place_nodes() {
    const int n = static_cast<int>(polygon_.size());
    std::vector<Vec2> inner;
    if (edit_.rings > 0) {
      Vec2 centre(0, 0);
      const std::vector<double> gauges = ring_gauges(centre);
      for (int k = 0; k < edit_.inner_nodes; ++k) inner.push_back(k < n * edit_.rings ? Vec2(centre + gauges[k / n] * (polygon_[k % n] - centre)) : centre);
    } else if (edit_.inner_nodes > 0) {
      const std::vector<Vec2> nodes = drawn_nodes();
      inner.assign(nodes.begin() + n, nodes.end());
    }
    for (const Vec2& p : inner) inner_vertex_.push_back(insert(p));
    connect_half_edges(disk());
  }

  // Splits the face that holds a point of the plane.
  int insert(const Vec2& p) {
    TriangleSurface& mesh = disk();
    int face = 0;
    double best = -1e300;
    std::array<double, 3> weights{1, 0, 0};
    for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
      const std::array<int, 3>& c = mesh.faces[f];
      const auto area = [&](const Vec2& x, const Vec2& y, const Vec2& z) { return (y.x() - x.x()) * (z.y() - x.y()) - (y.y() - x.y()) * (z.x() - x.x()); };
      const double whole = area(uv_[c[0]], uv_[c[1]], uv_[c[2]]);
      if (!(whole > 0)) continue;
      const std::array<double, 3> w{area(uv_[c[1]], uv_[c[2]], p) / whole, area(uv_[c[2]], uv_[c[0]], p) / whole, area(uv_[c[0]], uv_[c[1]], p) / whole};
      const double least = std::min({w[0], w[1], w[2]});
      if (least > best) best = least, face = f, weights = w;
    }
    double sum = 0;
    for (double& w : weights) sum += w = std::max(w, 0.02);
    for (double& w : weights) w /= sum;
    const std::array<int, 3> c = mesh.faces[face];
    const int v = static_cast<int>(mesh.points.size());
    mesh.points.push_back(weights[0] * mesh.points[c[0]] + weights[1] * mesh.points[c[1]] + weights[2] * mesh.points[c[2]]);
    uv_.push_back(weights[0] * uv_[c[0]] + weights[1] * uv_[c[1]] + weights[2] * uv_[c[2]]);
    std::vector<PointSource>& source = part_.surface.source;
    const PointSource s = combine({&source[c[0]], &source[c[1]], &source[c[2]]}, weights);
    source.push_back(s);
    mesh.faces[face] = {c[0], c[1], v};
    mesh.faces.push_back({c[1], c[2], v});
    mesh.faces.push_back({c[2], c[0], v});
    mesh.source_face.insert(mesh.source_face.end(), 2, mesh.source_face[face]);
    return v;
  }

  void cut() {
    const int n = static_cast<int>(region_.corners.size());
    QuadLayout layout;
    layout.node_vertex = corner_vertex_;
    layout.node_vertex.insert(layout.node_vertex.end(), inner_vertex_.begin(), inner_vertex_.end());
    std::map<std::pair<int, int>, int> curve_of;
    for (const auto& nodes : edit_.quads) {
      QuadLayout::Quad quad;
      quad.nodes = nodes;
      for (int i = 0; i < 4; ++i) {
        const int a = nodes[i], b = nodes[(i + 1) % 4];
        if (a < n && b == (a + 1) % n) continue;  // along the region's boundary
        const auto [it, fresh] = curve_of.insert({std::minmax(a, b), static_cast<int>(layout.curves.size())});
        if (fresh) layout.curves.push_back({layout.node_vertex[a], layout.node_vertex[b], -1});
        quad.sides[i] = {it->second, layout.curves[it->second].start == layout.node_vertex[a]};
      }
      layout.quads.push_back(quad);
    }
    piece_ = cut_along_segments(disk(), uv_, layout);
  }

  LayoutChange merge() {
    PatchedSurface& whole = mapped_.surface;
    PatchedSurface out;
    out.nodes = whole.nodes;
    out.neighbours = whole.neighbours;
    out.node_count = whole.node_count;
    LayoutChange change = change_layout(out, edit_);
    TriangleSurface& mesh = out.mesh;
    mesh.points = std::move(whole.mesh.points);
    out.source = std::move(whole.source);
    std::vector<int> point(piece_.mesh.points.size());
    for (std::size_t v = 0; v < point.size(); ++v) {
      if (v < part_.point.size()) {
        point[v] = part_.point[v];
        continue;
      }
      point[v] = static_cast<int>(mesh.points.size());
      mesh.points.push_back(piece_.mesh.points[v]);
      std::array<const PointSource*, 3> of{nullptr, nullptr, nullptr};
      for (int k = 0; k < 3; ++k)
        if (piece_.source[v].vertices[k] >= 0) of[k] = &part_.surface.source[piece_.source[v].vertices[k]];
      out.source.push_back(combine(of, piece_.source[v].weights));
    }
    std::vector<std::array<Vec2, 3>> corners;
    for (std::size_t f = 0; f < whole.mesh.faces.size(); ++f) {
      if (change.patch[whole.patch[f]] < 0) continue;
      mesh.faces.push_back(whole.mesh.faces[f]);
      mesh.source_face.push_back(whole.mesh.source_face[f]);
      out.patch.push_back(change.patch[whole.patch[f]]);
      corners.push_back(mapped_.corners[f]);
    }
    for (std::size_t f = 0; f < piece_.mesh.faces.size(); ++f) {
      const std::array<int, 3>& c = piece_.mesh.faces[f];
      mesh.faces.push_back({point[c[0]], point[c[1]], point[c[2]]});
      mesh.source_face.push_back(disk().source_face[piece_.mesh.source_face[f]]);
      out.patch.push_back(change.added[piece_.patch[f]]);
      corners.push_back({Vec2(0, 0), Vec2(0, 0), Vec2(0, 0)});
    }
    connect_half_edges(mesh);
    out.sides.resize(out.nodes.size());
    for (std::size_t q = 0; q < change.patch.size(); ++q)
      if (change.patch[q] >= 0) out.sides[change.patch[q]] = std::move(whole.sides[q]);
    for (std::size_t k = 0; k < change.added.size(); ++k)
      for (int i = 0; i < 4; ++i)
        for (const int v : piece_.sides[k][i]) out.sides[change.added[k]][i].push_back(point[v]);
    whole = std::move(out);
    mapped_.corners = std::move(corners);
    return change;
  }

  MappedSurface& mapped_;
  const LayoutEdit& edit_;
  PatchRegion region_;
  PatchedPart part_;
  PatchedSurface piece_;
  std::vector<Vec2> uv_, polygon_;
  std::vector<int> rim_, corner_vertex_, inner_vertex_;
};

}  // namespace

LayoutChange apply_edit(MappedSurface& mapped, const LayoutEdit& edit) { return Relayout(mapped, edit).run(); }

LayoutChange apply_edit(MappedSurface& mapped, DrawnEdit drawn) { return Relayout(mapped, drawn.edit).run(std::move(drawn.piece)); }

namespace {

std::optional<DrawnEdit> decimated_edit(const PatchedSurface& surface, const PatchRegion& region, double quads, double slack, std::uint64_t seed, const Progress& progress) {
  const PatchedPart part = part_of(surface, region.patches);
  const TriangleSurface& disk = part.surface.mesh;
  const int n = static_cast<int>(region.corners.size());
  const std::vector<int> wanted = regular_quads(surface, region);
  std::vector<int> corner_of(disk.points.size(), -1);
  DecimationOptions decimation;
  decimation.seed = seed;
  decimation.fixed.assign(disk.points.size(), 0);
  QuadLayoutOptions options;
  options.size = quads;
  options.seed = seed;
  options.boundary_quads.assign(disk.points.size(), 2);
  for (int k = 0; k < n; ++k) {
    const PatchSide& s = region.boundary[k];
    const int local = static_cast<int>(std::find(region.patches.begin(), region.patches.end(), s.patch) - region.patches.begin());
    const int v = part.surface.sides[local][s.side].front();
    corner_of[v] = k;
    decimation.fixed[v] = 1;
    options.boundary_quads[v] = wanted[k];
  }
  // With more triangles than the quads need, pairs are found more easily beside a boundary that must stay.
  decimation.target_faces = std::max(n - 2, static_cast<int>(slack * quads));
  EditMesh mesh(disk);
  std::vector<MeshEdit> log;
  QuadLayout layout;
  try {
    std::vector<VertexQuadric> quadrics = decimate(mesh, disk.points, decimation, log, progress);
    for (std::size_t v = 0; v < corner_of.size(); ++v)
      if (mesh.vertex_alive(static_cast<int>(v)) && mesh.is_boundary(static_cast<int>(v)) && corner_of[v] < 0) return std::nullopt;
    layout = make_quad_layout(mesh, disk.points, std::move(quadrics), options, log, progress);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::Internal) throw;
    return std::nullopt;
  }
  DrawnEdit out;
  out.edit.patches = region.patches;
  out.edit.start = region.boundary[0];
  std::vector<int> number(layout.node_vertex.size());
  for (std::size_t k = 0; k < number.size(); ++k) {
    const int corner = corner_of[layout.node_vertex[k]];
    number[k] = corner >= 0 ? corner : n + out.edit.inner_nodes++;
  }
  // No two nodes may be joined twice, not even by a side within the region and one outside.
  std::set<std::pair<int, int>> joined = joined_outside(surface, region);
  for (const QuadLayout::Quad& quad : layout.quads) {
    std::array<int, 4> nodes;
    for (int i = 0; i < 4; ++i) nodes[i] = number[quad.nodes[i]];
    for (int i = 0; i < 4; ++i)
      if (nodes[i] == nodes[(i + 2) % 4] || !joined.insert({nodes[i], nodes[(i + 1) % 4]}).second) return std::nullopt;
    out.edit.quads.push_back(nodes);
  }
  out.piece = cut_along_layout(disk, mesh, log, layout, progress);
  return out;
}

}  // namespace

std::optional<DrawnEdit> even_edit(const PatchedSurface& surface, const PatchRegion& region, double quads, std::uint64_t seed, const Progress& progress) {
  for (const double slack : {2.6, 3.1, 3.6, 4.1})
    if (std::optional<DrawnEdit> edit = decimated_edit(surface, region, quads, slack, seed, progress)) return edit;
  return std::nullopt;
}

}  // namespace hybrid_mesh
