// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/region_layout.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>

#include "base/error.h"
#include "layout/curve_network.h"
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
  if (rim == 0) return std::nullopt;
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

std::optional<LayoutEdit> ring_edit(const PatchedSurface& surface, const PatchRegion& region) {
  const int n = static_cast<int>(region.corners.size());
  if (region.inner_nodes.size() > 1) return std::nullopt;
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  edit.ring = n;
  edit.inner_nodes = n + static_cast<int>(region.inner_nodes.size());
  for (int k = 0; k < n; ++k) edit.quads.push_back({k, (k + 1) % n, n + (k + 1) % n, n + k});
  for (const int q : region.patches) {
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) {
      const auto at = std::find(region.corners.begin(), region.corners.end(), surface.nodes[q][i]);
      quad[i] = at == region.corners.end() ? 2 * n : n + static_cast<int>(at - region.corners.begin());
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

namespace {

// One application of an edit.
class Relayout {
 public:
  Relayout(MappedSurface& mapped, const LayoutEdit& edit) : mapped_(mapped), edit_(edit) {}

  std::vector<int> run() {
    std::optional<PatchRegion> region = make_region(mapped_.surface, edit_.patches, edit_.start);
    if (!region) throw Error(ErrorCode::Internal, "a region to be laid out anew is no disk");
    region_ = std::move(*region);
    part_ = part_of(mapped_.surface, edit_.patches);
    embed();
    place_nodes();
    cut();
    return merge();
  }

 private:
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
    for (const DiskSide& side : sides) rim_.insert(rim_.end(), side.points.begin(), side.points.end() - 1);
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

  // Lengths of shortest paths along edges to the region's boundary.
  std::vector<double> depths() {
    const TriangleSurface& mesh = disk();
    std::vector<std::vector<int>> leaving(mesh.points.size());
    for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
      leaving[mesh.from(h)].push_back(mesh.to(h));
      if (mesh.opposite[h] < 0) leaving[mesh.to(h)].push_back(mesh.from(h));
    }
    std::vector<double> depth(mesh.points.size(), 1e300);
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    for (const int v : rim_) queue.push({depth[v] = 0, v});
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > depth[v]) continue;
      for (const int w : leaving[v]) {
        const double along = d + (mesh.points[w] - mesh.points[v]).norm();
        if (along < depth[w]) queue.push({depth[w] = along, w});
      }
    }
    return depth;
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

  void place_nodes() {
    Vec2 centre(0, 0);
    double shrink = 0.5;
    if (edit_.ring > 0) {
      const std::vector<double> depth = depths();
      const std::size_t tip = std::max_element(depth.begin(), depth.end()) - depth.begin();
      // The tip itself may be next to the rim in the plane: the rings keep some room.
      centre = 0.9 * uv_[tip];
      double perimeter = 0;
      for (std::size_t k = 0; k < rim_.size(); ++k) perimeter += (disk().points[rim_[k]] - disk().points[rim_[(k + 1) % rim_.size()]]).norm();
      const double side = perimeter / edit_.ring;
      // As far from the tip as a square's sides are from its middle, or half-way where that is not so deep.
      const double wanted = std::max(0.45 * depth[tip], depth[tip] - 0.6 * side);
      std::vector<double> at;
      for (std::size_t v = 0; v < depth.size(); ++v)
        if (depth[v] > 0.8 * wanted && depth[v] < 1.2 * wanted) at.push_back(gauge(uv_[v], centre));
      if (!at.empty()) {
        std::nth_element(at.begin(), at.begin() + at.size() / 2, at.end());
        shrink = std::clamp(at[at.size() / 2], 0.02, 0.9);
      }
    }
    for (int k = 0; k < edit_.inner_nodes; ++k) inner_vertex_.push_back(insert(k < edit_.ring ? Vec2(centre + shrink * (polygon_[k] - centre)) : centre));
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

  std::vector<int> merge() {
    const int n = static_cast<int>(region_.corners.size());
    PatchedSurface& whole = mapped_.surface;
    const int old_count = whole.patch_count(), removed = static_cast<int>(edit_.patches.size()), added = static_cast<int>(edit_.quads.size());
    // The new quads take the numbers of the old ones, then further ones; holes are filled with the last patches.
    std::vector<int> holes = edit_.patches;
    std::sort(holes.begin(), holes.end());
    std::vector<int> number(added), renumbered(old_count);
    std::iota(renumbered.begin(), renumbered.end(), 0);
    for (int i = 0; i < added; ++i) number[i] = i < removed ? holes[i] : old_count + i - removed;
    const int count = old_count + added - removed;
    for (int i = added, last = old_count - 1; i < removed && holes[i] < count; ++i) {
      while (std::find(holes.begin(), holes.end(), last) != holes.end()) --last;
      renumbered[last--] = holes[i];
    }

    PatchedSurface out;
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
    const std::vector<char> in_region = [&] {
      std::vector<char> in(old_count, 0);
      for (const int q : edit_.patches) in[q] = 1;
      return in;
    }();
    for (std::size_t f = 0; f < whole.mesh.faces.size(); ++f) {
      if (in_region[whole.patch[f]]) continue;
      mesh.faces.push_back(whole.mesh.faces[f]);
      mesh.source_face.push_back(whole.mesh.source_face[f]);
      out.patch.push_back(renumbered[whole.patch[f]]);
      corners.push_back(mapped_.corners[f]);
    }
    for (std::size_t f = 0; f < piece_.mesh.faces.size(); ++f) {
      const std::array<int, 3>& c = piece_.mesh.faces[f];
      mesh.faces.push_back({point[c[0]], point[c[1]], point[c[2]]});
      mesh.source_face.push_back(disk().source_face[piece_.mesh.source_face[f]]);
      out.patch.push_back(number[piece_.patch[f]]);
      corners.push_back({Vec2(0, 0), Vec2(0, 0), Vec2(0, 0)});
    }
    connect_half_edges(mesh);

    out.nodes.resize(count);
    out.neighbours.resize(count);
    out.sides.resize(count);
    for (int q = 0; q < old_count; ++q) {
      if (in_region[q]) continue;
      out.nodes[renumbered[q]] = whole.nodes[q];
      out.sides[renumbered[q]] = std::move(whole.sides[q]);
      for (int i = 0; i < 4; ++i) {
        PatchSide other = whole.neighbours[q][i];
        if (other.patch >= 0) other.patch = renumbered[other.patch];
        out.neighbours[renumbered[q]][i] = other;
      }
    }
    for (int k = 0; k < added; ++k) {
      for (int i = 0; i < 4; ++i) {
        const int a = edit_.quads[k][i], b = edit_.quads[k][(i + 1) % 4];
        out.nodes[number[k]][i] = a < n ? region_.corners[a] : whole.node_count + a - n;
        std::vector<int>& side = out.sides[number[k]][i];
        for (const int v : piece_.sides[k][i]) side.push_back(point[v]);
        if (a < n && b == (a + 1) % n) {
          const PatchSide& rim = region_.boundary[a];
          PatchSide other = whole.neighbours[rim.patch][rim.side];
          if (other.patch >= 0) {
            other.patch = renumbered[other.patch];
            out.neighbours[other.patch][other.side] = {number[k], i};
          }
          out.neighbours[number[k]][i] = other;
        } else {
          const PatchSide other = piece_.neighbours[k][i];
          out.neighbours[number[k]][i] = {number[other.patch], other.side};
        }
      }
    }
    // Nodes densely, in the order of their first use.
    std::vector<int> node(whole.node_count + edit_.inner_nodes, -1);
    for (auto& nodes : out.nodes)
      for (int& x : nodes) {
        if (node[x] < 0) node[x] = out.node_count++;
        x = node[x];
      }
    mapped_.surface = std::move(out);
    mapped_.corners = std::move(corners);
    return number;
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

std::vector<int> apply_edit(MappedSurface& mapped, const LayoutEdit& edit) { return Relayout(mapped, edit).run(); }

}  // namespace hybrid_mesh
