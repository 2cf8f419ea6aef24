// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/base_domain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/found.h"
#include "layout/base/curve_network.h"
#include "layout/base/decimation.h"
#include "layout/base/quad_layout.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

void undo(EditMesh& mesh, const MeshEdit& edit) {
  if (edit.kind == MeshEdit::Kind::Collapse)
    mesh.undo_collapse(edit.half_edge);
  else
    mesh.undo_flip(edit.half_edge);
}

void redo(EditMesh& mesh, const MeshEdit& edit) {
  if (edit.kind == MeshEdit::Kind::Collapse)
    mesh.collapse(edit.half_edge);
  else
    mesh.flip(edit.half_edge);
}

// The layout on the coarse surface: the log's later part is replayed on a copy of the mesh that starts there.
class CoarseSurface {
 public:
  // Undoes `log` until `vertices` vertices are alive and nothing but collapses is left.
  CoarseSurface(const TriangleSurface& surface, EditMesh decimated, const MeshFeatures& features, const std::vector<MeshEdit>& log, double vertices,
                CutSurface& out)
      : surface_(surface), features_(features), log_(log), out_(out), vertex_(surface.points.size(), -1), face_(surface.faces.size(), -1) {
    EditMesh& mesh = out.collapsed;
    mesh = std::move(decimated);
    for (int h = 0; h < static_cast<int>(mesh.edge.size()); ++h)
      if (mesh.face_alive(h / 3)) coarsest_.push_back({mesh.edge[h], h});
    const auto is_flip = [](const MeshEdit& e) { return e.kind == MeshEdit::Kind::Flip; };
    const std::size_t first_flip = std::find_if(log.begin(), log.end(), is_flip) - log.begin();
    kept_ = log.size();
    while (kept_ > 0 && (mesh.vertex_count < vertices || kept_ > first_flip)) undo(mesh, log[--kept_]);
    for (std::size_t i = 0; i < kept_; ++i) out.log.push_back(log[i].half_edge);
    compact();
  }

  void cut(QuadLayout layout, const Progress& progress) {
    EditMesh mesh(out_.coarse);
    const MeshFeatures features(out_.coarse, coarse_features(), mesh);
    std::vector<MeshEdit> log;
    for (std::size_t i = kept_; i < log_.size(); ++i) {
      log.push_back({log_[i].kind, translated(log_[i].half_edge)});
      redo(mesh, log.back());
    }
    for (int& v : layout.node_vertex)
      if (v >= 0) v = vertex_[v];
    std::vector<int> renamed(out_.collapsed.edge_count, -1);
    for (const auto& [name, half_edge] : coarsest_) renamed[name] = mesh.edge[translated(half_edge)];
    for (QuadLayout::Curve& c : layout.curves) c = {vertex_[c.start], vertex_[c.end], renamed[c.edge]};
    out_.patches = cut_along_layout(out_.coarse, mesh, features, log, layout, progress);
    out_.sharp = features_.marks();
  }

 private:
  int translated(int half_edge) const { return 3 * face_[half_edge / 3] + half_edge % 3; }

  FeatureGraph coarse_features() const {
    FeatureGraph graph;
    if (features_.empty()) return graph;
    graph.edges.assign(3 * out_.coarse.faces.size(), 0);
    for (int h = 0; h < static_cast<int>(out_.collapsed.edge.size()); ++h)
      if (face_[h / 3] >= 0) graph.edges[translated(h)] = features_.on(out_.collapsed, h);
    for (const int v : out_.vertex) graph.corners.push_back(features_.is_corner(v));
    return graph;
  }

  void compact() {
    const EditMesh& mesh = out_.collapsed;
    TriangleSurface& coarse = out_.coarse;
    coarse.sizes = surface_.sizes;
    for (int v = 0; v < static_cast<int>(vertex_.size()); ++v)
      if (mesh.vertex_alive(v)) {
        vertex_[v] = static_cast<int>(coarse.points.size());
        out_.vertex.push_back(v);
        coarse.points.push_back(surface_.points[v]);
      }
    for (int f = 0; f < static_cast<int>(face_.size()); ++f)
      if (mesh.face_alive(f)) {
        face_[f] = static_cast<int>(coarse.faces.size());
        coarse.source_face.push_back(f);
        coarse.faces.push_back({vertex_[mesh.origin[3 * f]], vertex_[mesh.origin[3 * f + 1]], vertex_[mesh.origin[3 * f + 2]]});
      }
    connect_half_edges(coarse);
  }

  const TriangleSurface& surface_;
  const MeshFeatures& features_;
  const std::vector<MeshEdit>& log_;
  CutSurface& out_;
  std::vector<int> vertex_, face_;             // of the surface: the coarse one's, or -1
  std::vector<std::pair<int, int>> coarsest_;  // names of the edges of the decimated mesh, and their half-edges
  std::size_t kept_ = 0;
};

}  // namespace

std::vector<char> points_on_mirror(const TriangleSurface& surface, const Vec3& normal) {
  std::vector<char> on(surface.points.size(), 0);
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
    const int a = surface.from(h), b = surface.to(h);
    if (surface.opposite[h] < 0 && is_in_mirror(surface.points[a], normal) && is_in_mirror(surface.points[b], normal)) on[a] = on[b] = 1;
  }
  return on;
}

BaseDomain::BaseDomain(const TriangleSurface& surface, const FeatureGraph& features, const BaseDomainOptions& options, const Progress& progress)
    : surface_(surface) {
  if (!features.empty()) {
    const EditMesh mesh(surface);
    FeatureGraph graph = with_boundary(surface, features, FeatureOptions().corner_angle);
    curves_ = MeshFeatures(surface, graph, mesh);
    for (std::size_t h = 0; h < graph.edges.size(); ++h) graph.edges[h] = features.edges[h] && surface.opposite[h] >= 0;
    features_ = MeshFeatures(surface, graph, mesh);
  }
  if (options.mirror) on_mirror_ = points_on_mirror(surface, *options.mirror);
  // Times the size, how many faces quads are chosen from: room for their clean-up, which merges some of them. Between features, whose vertices stay,
  // more of them make better corners, but not where there is no room for as many.
  const std::vector<double> ways = features.empty() ? std::vector<double>{2.6} : std::vector<double>{5, 3.9, 3.1};
  Found<Decimated> best;
  const auto excess = [&](const Decimated& d) { return std::max(0.0, static_cast<double>(d.layout.quads.size()) - options.size); };
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const double share = 1.0 / static_cast<double>(ways.size()), begin = share * static_cast<double>(k);
    Found<Decimated> made = found([&] { return decimated(ways[k] * options.size, options, progress.part(begin, begin + share)); });
    if (!made && best) continue;
    if (!best || std::pair(excess(*made), made->layout.lacking) < std::pair(excess(*best), best->layout.lacking)) best = std::move(made);
    if (best && excess(*best) == 0 && best->layout.lacking == 0) break;
  }
  if (!best) throw NoMap(best.reason);
  decimated_ = std::move(*best);
}

BaseDomain::Decimated BaseDomain::decimated(double faces, const BaseDomainOptions& options, const Progress& progress) const {
  Decimated made{EditMesh(surface_), {}, {}};
  DecimationOptions decimation;
  decimation.target_faces = std::max({4, 5 * options.least, static_cast<int>(faces)});
  decimation.fineness = fineness_at_points(surface_);
  decimation.curve_edge = std::sqrt(measured_area(surface_) / std::max(1.0, options.size));
  decimation.seed = options.seed;
  decimation.features = &curves_;
  decimation.on_mirror = on_mirror_;
  std::vector<VertexQuadric> quadrics = decimate(made.mesh, surface_.points, decimation, made.log, progress.part(0, 0.8));
  QuadLayoutOptions layout_options;
  layout_options.size = options.size;
  layout_options.boundary_side = options.boundary_side;
  layout_options.least = options.least;
  layout_options.seed = options.seed;
  layout_options.features = &curves_;
  layout_options.fineness = decimation.fineness;
  layout_options.on_mirror = on_mirror_;
  made.layout = make_quad_layout(made.mesh, surface_.points, std::move(quadrics), layout_options, made.log, progress.part(0.8, 1));
  return made;
}

int BaseDomain::boundary_sides() const {
  const QuadLayout& layout = decimated_.layout;
  // A node between the two ends of a boundary edge is where they are.
  const auto is_on_mirror = [&](const QuadLayout::Quad& q, int i) {
    const int v = layout.node_vertex[q.nodes[i]];
    return v >= 0 ? on_mirror_[v] != 0 : on_mirror_[layout.node_vertex[q.nodes[(i + 1) % 4]]] && on_mirror_[layout.node_vertex[q.nodes[(i + 3) % 4]]];
  };
  int sides = 0;
  for (const QuadLayout::Quad& q : layout.quads)
    for (int i = 0; i < 4; ++i)
      if (q.sides[i].curve < 0 && (on_mirror_.empty() || !is_on_mirror(q, i) || !is_on_mirror(q, (i + 1) % 4))) ++sides;
  return sides;
}

EditMesh BaseDomain::take_mesh() {
  if (walks_.empty()) {
    const EditMesh& mesh = decimated_.mesh;
    for (int v = 0; v < static_cast<int>(mesh.out.size()); ++v)
      if (mesh.vertex_alive(v)) walks_.push_back({v, mesh.out[v]});
    return std::move(decimated_.mesh);
  }
  EditMesh mesh(surface_);
  for (const MeshEdit& edit : decimated_.log) redo(mesh, edit);
  for (const auto& [v, h] : walks_) mesh.out[v] = h;
  return mesh;
}

CutSurface BaseDomain::cut(double vertices_a_quad, const Progress& progress) {
  CutSurface out;
  CoarseSurface(surface_, take_mesh(), features_, decimated_.log, vertices_a_quad * quads(), out).cut(decimated_.layout, progress);
  return out;
}

}  // namespace hybrid_mesh
