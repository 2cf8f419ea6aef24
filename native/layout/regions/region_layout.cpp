// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/region_layout.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "base/found.h"
#include "layout/base/curve_network.h"
#include "layout/base/decimation.h"
#include "layout/base/quad_layout.h"
#include "layout/regions/disk_drawing.h"
#include "layout/regions/region_pattern.h"
#include "surface/size_field.h"

namespace hybrid_mesh {

int tower_height(const RegionSurface& surface) {
  const std::vector<int> rim = surface.rim();
  const std::vector<double> depth = edge_distances(surface.mesh, rim);
  const double side = loop_length(surface.mesh, rim) / static_cast<double>(surface.sides.size());
  return static_cast<int>(std::lround(*std::max_element(depth.begin(), depth.end()) / std::max(side, 1e-300)));
}

namespace {

// One application of an edit.
class Relayout {
 public:
  Relayout(MappedSurface& mapped, const LayoutEdit& edit) : mapped_(mapped), edit_(edit) {}

  LayoutChange run() {
    take_region();
    if (!region_.is_disk()) throw NoMap("quads are drawn without lines in a disk alone");
    piece_ = draw_quads(part_, edit_);
    return merge();
  }

  LayoutChange run(PatchedSurface piece) {
    take_region();
    piece_ = std::move(piece);
    return merge();
  }

  LayoutChange run(PatchedSurface piece, RegionSurface surface) {
    part_ = std::move(surface);
    piece_ = std::move(piece);
    const LayoutChange change = merge();
    drop_unused_points();
    return change;
  }

 private:
  void take_region() {
    std::optional<PatchRegion> region = make_region(mapped_.surface, edit_.patches, edit_.starts, FreeLoops::Open);
    if (!region) throw Error(ErrorCode::Internal, "there is no such region to be laid out anew");
    region_ = std::move(*region);
    part_ = surface_of(mapped_.surface, region_);
  }

  LayoutChange merge() {
    PatchedSurface& whole = mapped_.surface;
    PatchedSurface out;
    out.nodes = whole.nodes;
    out.neighbours = whole.neighbours;
    out.node_count = whole.node_count;
    LayoutChange change = change_layout(out, edit_);
    TriangleSurface& mesh = out.mesh;
    mesh.sizes = whole.mesh.sizes;
    mesh.points = std::move(whole.mesh.points);
    out.source = std::move(whole.source);
    std::vector<int> point(piece_.mesh.points.size());
    for (std::size_t v = 0; v < point.size(); ++v) {
      if (v < part_.point.size() && part_.point[v] >= 0) {
        point[v] = part_.point[v];
        continue;
      }
      point[v] = static_cast<int>(mesh.points.size());
      mesh.points.push_back(piece_.mesh.points[v]);
      out.source.push_back(traced(piece_.source[v], part_.source));
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
      mesh.source_face.push_back(part_.mesh.source_face[piece_.mesh.source_face[f]]);
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

  // Those inside what the region's surface was before.
  void drop_unused_points() {
    PatchedSurface& whole = mapped_.surface;
    std::vector<int> number(whole.mesh.points.size(), -1);
    for (const auto& face : whole.mesh.faces)
      for (const int v : face) number[v] = 0;
    int count = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] < 0) continue;
      number[v] = count;
      whole.mesh.points[count] = whole.mesh.points[v];
      whole.source[count++] = whole.source[v];
    }
    whole.mesh.points.resize(count);
    whole.source.resize(count);
    for (auto& face : whole.mesh.faces)
      for (int& v : face) v = number[v];
    for (auto& sides : whole.sides)
      for (std::vector<int>& side : sides)
        for (int& v : side) v = number[v];
  }

  MappedSurface& mapped_;
  const LayoutEdit& edit_;
  PatchRegion region_;
  RegionSurface part_;
  PatchedSurface piece_;
};

}  // namespace

LayoutChange apply_edit(MappedSurface& mapped, const LayoutEdit& edit) { return Relayout(mapped, edit).run(); }

LayoutChange apply_edit(MappedSurface& mapped, DrawnEdit drawn) { return Relayout(mapped, drawn.edit).run(std::move(drawn.piece)); }

LayoutChange apply_edit(MappedSurface& mapped, DrawnEdit drawn, RegionSurface surface) {
  return Relayout(mapped, drawn.edit).run(std::move(drawn.piece), std::move(surface));
}

namespace {

std::optional<DrawnEdit> decimated_edit(const QuadGraph& graph, const PatchRegion& region, const RegionSurface& surface, double quads, double slack,
                                        std::uint64_t seed, const Progress& progress) {
  const TriangleSurface& disk = surface.mesh;
  const int n = static_cast<int>(region.corners.size());
  const std::vector<int> wanted = regular_quads(graph, region);
  std::vector<int> corner_of(disk.points.size(), -1);
  DecimationOptions decimation;
  decimation.seed = seed;
  decimation.fixed.assign(disk.points.size(), 0);
  QuadLayoutOptions options;
  options.size = quads;
  options.seed = seed;
  options.boundary_quads.assign(disk.points.size(), 2);
  for (int k = 0; k < n; ++k) {
    const int v = surface.corner(k);
    corner_of[v] = k;
    decimation.fixed[v] = 1;
    options.boundary_quads[v] = wanted[k];
  }
  // With more triangles than the quads need, pairs are found more easily beside a boundary that must stay.
  decimation.target_faces = std::max(n - 2, static_cast<int>(slack * quads));
  decimation.fineness = options.fineness = fineness_at_points(disk);
  EditMesh mesh(disk);
  std::vector<MeshEdit> log;
  std::vector<VertexQuadric> quadrics = decimate(mesh, disk.points, decimation, log, progress);
  for (std::size_t v = 0; v < corner_of.size(); ++v)
    if (mesh.vertex_alive(static_cast<int>(v)) && mesh.is_boundary(static_cast<int>(v)) && corner_of[v] < 0) return std::nullopt;
  Found<QuadLayout> quad_layout = found([&] { return make_quad_layout(mesh, disk.points, std::move(quadrics), options, log, progress); });
  if (!quad_layout) return std::nullopt;
  const QuadLayout& layout = *quad_layout;
  DrawnEdit out;
  out.edit = edit_of(region);
  std::vector<int> number(layout.node_vertex.size());
  for (std::size_t k = 0; k < number.size(); ++k) {
    const int corner = corner_of[layout.node_vertex[k]];
    number[k] = corner >= 0 ? corner : n + out.edit.inner_nodes++;
  }
  // No two nodes may be joined twice, not even by a side within the region and one outside.
  std::set<std::pair<int, int>> joined = joined_outside(graph, region);
  for (const QuadLayout::Quad& quad : layout.quads) {
    std::array<int, 4> nodes;
    for (int i = 0; i < 4; ++i) nodes[i] = number[quad.nodes[i]];
    for (int i = 0; i < 4; ++i)
      if (nodes[i] == nodes[(i + 2) % 4] || !joined.insert({nodes[i], nodes[(i + 1) % 4]}).second) return std::nullopt;
    out.edit.quads.push_back(nodes);
  }
  out.piece = cut_along_layout(disk, mesh, MeshFeatures(), log, layout, progress);
  return out;
}

}  // namespace

std::optional<DrawnEdit> even_edit(const QuadGraph& graph, const PatchRegion& region, const RegionSurface& surface, double quads, std::uint64_t seed,
                                   const Progress& progress) {
  // Whether the triangles beside a boundary that must stay find pairs is a matter of luck, and more of them have more of it.
  for (const double slack : {2.6, 3.1, 3.6, 4.1})
    for (const std::uint64_t other : {0, 1})
      if (std::optional<DrawnEdit> edit = decimated_edit(graph, region, surface, quads, slack, 2 * seed + other, progress)) return edit;
  return std::nullopt;
}

}  // namespace hybrid_mesh
