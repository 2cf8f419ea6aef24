// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/base_domain.h"

#include <algorithm>

#include "layout/base/curve_network.h"
#include "layout/base/decimation.h"
#include "layout/base/quad_layout.h"

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
  CoarseSurface(const TriangleSurface& surface, const EditMesh& decimated, const std::vector<MeshEdit>& log, double vertices, CutSurface& out)
      : surface_(surface), log_(log), out_(out), vertex_(surface.points.size(), -1), face_(surface.faces.size(), -1) {
    EditMesh& mesh = out.collapsed;
    mesh = decimated;
    const auto is_flip = [](const MeshEdit& e) { return e.kind == MeshEdit::Kind::Flip; };
    const std::size_t first_flip = std::find_if(log.begin(), log.end(), is_flip) - log.begin();
    kept_ = log.size();
    while (kept_ > 0 && (mesh.vertex_count < vertices || kept_ > first_flip)) undo(mesh, log[--kept_]);
    for (std::size_t i = 0; i < kept_; ++i) out.log.push_back(log[i].half_edge);
    compact();
  }

  void cut(const EditMesh& decimated, QuadLayout layout, const Progress& progress) {
    EditMesh mesh(out_.coarse);
    std::vector<MeshEdit> log;
    for (std::size_t i = kept_; i < log_.size(); ++i) {
      log.push_back({log_[i].kind, translated(log_[i].half_edge)});
      redo(mesh, log.back());
    }
    for (int& v : layout.node_vertex)
      if (v >= 0) v = vertex_[v];
    std::vector<int> renamed(decimated.edge_count, -1);
    for (int h = 0; h < static_cast<int>(decimated.edge.size()); ++h)
      if (decimated.face_alive(h / 3)) renamed[decimated.edge[h]] = mesh.edge[translated(h)];
    for (QuadLayout::Curve& c : layout.curves) c = {vertex_[c.start], vertex_[c.end], renamed[c.edge]};
    out_.patches = cut_along_layout(out_.coarse, mesh, log, layout, progress);
  }

 private:
  int translated(int half_edge) const { return 3 * face_[half_edge / 3] + half_edge % 3; }

  void compact() {
    const EditMesh& mesh = out_.collapsed;
    TriangleSurface& coarse = out_.coarse;
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
  const std::vector<MeshEdit>& log_;
  CutSurface& out_;
  std::vector<int> vertex_, face_;  // of the surface: the coarse one's, or -1
  std::size_t kept_ = 0;
};

}  // namespace

BaseDomain::BaseDomain(const TriangleSurface& surface, const BaseDomainOptions& options, const Progress& progress)
    : surface_(surface), decimated_(surface) {
  DecimationOptions decimation;
  // Room for the clean-up of the quads, which merges some of them.
  decimation.target_faces = std::max({4, 5 * options.least, static_cast<int>(2.6 * options.size)});
  decimation.seed = options.seed;
  std::vector<VertexQuadric> quadrics = decimate(decimated_, surface.points, decimation, log_, progress.part(0, 0.8));
  QuadLayoutOptions layout_options;
  layout_options.size = options.size;
  layout_options.boundary_side = options.boundary_side;
  layout_options.least = options.least;
  layout_options.seed = options.seed;
  layout_ = make_quad_layout(decimated_, surface.points, std::move(quadrics), layout_options, log_, progress.part(0.8, 1));
}

int BaseDomain::boundary_sides() const {
  int sides = 0;
  for (const QuadLayout::Quad& q : layout_.quads)
    for (const QuadLayout::Side& side : q.sides) sides += side.curve < 0;
  return sides;
}

CutSurface BaseDomain::cut(double vertices_a_quad, const Progress& progress) const {
  CutSurface out;
  CoarseSurface(surface_, decimated_, log_, vertices_a_quad * quads(), out).cut(decimated_, layout_, progress);
  return out;
}

}  // namespace hybrid_mesh
