// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/region_layout.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/error.h"
#include "layout/base/curve_network.h"
#include "layout/base/decimation.h"
#include "layout/base/quad_layout.h"
#include "layout/regions/disk_drawing.h"
#include "layout/regions/region_pattern.h"

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

namespace {

// Whether sides join all of some patches, given in order.
bool are_joined(const PatchedSurface& surface, const std::vector<int>& patches) {
  std::vector<char> reached(patches.size(), 0);
  std::vector<int> stack{patches.front()};
  std::size_t count = reached[0] = 1;
  while (!stack.empty()) {
    const int q = stack.back();
    stack.pop_back();
    for (const PatchSide& s : surface.neighbours[q]) {
      const auto at = std::lower_bound(patches.begin(), patches.end(), s.patch);
      if (at == patches.end() || *at != s.patch || reached[at - patches.begin()]) continue;
      reached[at - patches.begin()] = 1;
      stack.push_back(s.patch);
      ++count;
    }
  }
  return count == patches.size();
}

}  // namespace

std::optional<PatchRegion> make_region(const PatchedSurface& surface, const std::vector<int>& patches, PatchSide start) {
  std::vector<int> sorted = patches;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return std::nullopt;
  const auto inside = [&](int q) { return std::binary_search(sorted.begin(), sorted.end(), q); };
  const auto on_rim = [&](const PatchSide& s) { return !inside(surface.neighbours[s.patch][s.side].patch); };
  int rim = 0;
  for (const int q : patches)
    for (int i = 0; i < 4; ++i) {
      if (!on_rim({q, i})) continue;
      ++rim;
      if (start.patch < 0) start = {q, i};
    }
  if (rim == 0 || !inside(start.patch) || !on_rim(start)) return std::nullopt;
  // A torus beside the disk changes neither the rim nor the count below.
  if (!are_joined(surface, sorted)) return std::nullopt;
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

LayoutEdit tower_edit(const PatchedSurface& surface, const PatchRegion& region, int rings) {
  const int n = static_cast<int>(region.corners.size());
  LayoutEdit edit;
  edit.patches = region.patches;
  edit.start = region.boundary[0];
  edit.rings = rings;
  edit.inner_nodes = n * rings + static_cast<int>(region.inner_nodes.size());
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < n; ++k) edit.quads.push_back({n * r + k, n * r + (k + 1) % n, n * (r + 1) + (k + 1) % n, n * (r + 1) + k});
  const auto place = [](const std::vector<int>& nodes, int node) {
    return static_cast<int>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
  };
  for (const int q : region.patches) {
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) {
      const int corner = place(region.corners, surface.nodes[q][i]);
      quad[i] = n * rings + (corner < n ? corner : n + place(region.inner_nodes, surface.nodes[q][i]));
    }
    edit.quads.push_back(quad);
  }
  return edit;
}

std::optional<int> irregular_growth(const PatchedSurface& surface, const PatchRegion& region, const LayoutEdit& edit, const std::vector<int>& valence,
                                    const std::vector<char>& on_boundary) {
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
  const std::vector<double> depth = edge_distances(part.surface.mesh, rim);
  const double side = loop_length(part.surface.mesh, rim) / static_cast<double>(region.corners.size());
  return static_cast<int>(std::lround(*std::max_element(depth.begin(), depth.end()) / std::max(side, 1e-300)));
}

namespace {

// One application of an edit.
class Relayout {
 public:
  Relayout(MappedSurface& mapped, const LayoutEdit& edit) : mapped_(mapped), edit_(edit) {}

  LayoutChange run() {
    take_region();
    std::vector<std::vector<int>> sides;
    for (const PatchSide& side : region_.boundary) sides.push_back(part_.surface.sides[local_patch(side.patch)][side.side]);
    piece_ = draw_quads(part_.surface, sides, edit_);
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

  int local_patch(int q) const { return static_cast<int>(std::find(edit_.patches.begin(), edit_.patches.end(), q) - edit_.patches.begin()); }

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
      out.source.push_back(traced(piece_.source[v], part_.surface.source));
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
      mesh.source_face.push_back(part_.surface.mesh.source_face[piece_.mesh.source_face[f]]);
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
};

}  // namespace

LayoutChange apply_edit(MappedSurface& mapped, const LayoutEdit& edit) { return Relayout(mapped, edit).run(); }

LayoutChange apply_edit(MappedSurface& mapped, DrawnEdit drawn) { return Relayout(mapped, drawn.edit).run(std::move(drawn.piece)); }

namespace {

std::optional<DrawnEdit> decimated_edit(const PatchedSurface& surface, const PatchRegion& region, double quads, double slack, std::uint64_t seed,
                                        const Progress& progress) {
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

std::optional<DrawnEdit> even_edit(const PatchedSurface& surface, const PatchRegion& region, double quads, std::uint64_t seed,
                                   const Progress& progress) {
  // Whether the triangles beside a boundary that must stay find pairs is a matter of luck, and more of them have more of it.
  for (const double slack : {2.6, 3.1, 3.6, 4.1})
    for (const std::uint64_t other : {0, 1})
      if (std::optional<DrawnEdit> edit = decimated_edit(surface, region, quads, slack, 2 * seed + other, progress)) return edit;
  return std::nullopt;
}

}  // namespace hybrid_mesh
