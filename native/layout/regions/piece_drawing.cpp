// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/piece_drawing.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/error.h"
#include "decoder/disjoint_sets.h"
#include "layout/regions/disk_drawing.h"
#include "layout/regions/ring_drawing.h"

namespace hybrid_mesh {
namespace {

// One piece of a region by itself, with numbers of its own.
struct Piece {
  RegionSurface surface;
  LayoutEdit edit;
  std::vector<int> corners;  // per corner of it: that of the region
  std::vector<int> nodes;    // per node: that of the region's edit
  std::vector<int> quads;    // per quad: that of the region's edit
  int first_rim = 0;         // corners of its first rim
};

int node_count(const PatchRegion& region, const LayoutEdit& edit) { return static_cast<int>(region.corners.size()) + edit.inner_nodes; }

Piece take_piece(const RegionSurface& whole, const PatchRegion& region, const LayoutEdit& edit, const RegionPiece& of, DisjointSets& points,
                 DisjointSets& nodes) {
  Piece out;
  for (const int r : of.rims)
    for (int k = region.rims[r]; k < region.rims[r + 1]; ++k) out.corners.push_back(k);
  out.first_rim = region.rims[of.rims.front() + 1] - region.rims[of.rims.front()];

  const int on_surface = points.find(whole.corner(out.corners.front()));
  std::vector<int> number(whole.mesh.points.size(), -1);
  for (int v = 0; v < static_cast<int>(number.size()); ++v) {
    if (points.find(v) != on_surface) continue;
    number[v] = static_cast<int>(out.surface.point.size());
    out.surface.mesh.points.push_back(whole.mesh.points[v]);
    out.surface.source.push_back(whole.source[v]);
    out.surface.point.push_back(whole.point[v]);
  }
  for (std::size_t f = 0; f < whole.mesh.faces.size(); ++f) {
    const std::array<int, 3>& face = whole.mesh.faces[f];
    if (number[face[0]] < 0) continue;
    out.surface.mesh.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
    out.surface.mesh.source_face.push_back(whole.mesh.source_face[f]);
  }
  connect_half_edges(out.surface.mesh);
  for (const int k : out.corners) {
    std::vector<int>& side = out.surface.sides.emplace_back();
    for (const int v : whole.sides[k]) side.push_back(number[v]);
  }

  const int of_edit = nodes.find(out.corners.front());
  const auto corners = static_cast<int>(region.corners.size());
  out.nodes = out.corners;
  for (int n = corners; n < node_count(region, edit); ++n)
    if (nodes.find(n) == of_edit) out.nodes.push_back(n);
  std::vector<int> local(node_count(region, edit), -1);
  for (std::size_t n = 0; n < out.nodes.size(); ++n) local[out.nodes[n]] = static_cast<int>(n);
  out.edit.inner_nodes = static_cast<int>(out.nodes.size() - out.corners.size());
  for (std::size_t q = 0; q < edit.quads.size(); ++q) {
    if (local[edit.quads[q][0]] < 0) continue;
    std::array<int, 4>& quad = out.edit.quads.emplace_back(edit.quads[q]);
    for (int& n : quad) n = local[n];
    out.quads.push_back(static_cast<int>(q));
  }
  return out;
}

PatchedSurface draw(Piece& piece) {
  if (piece.first_rim == static_cast<int>(piece.corners.size())) return draw_quads(piece.surface, piece.edit);
  return draw_ring(piece.surface, piece.edit, find_spoke(piece.edit.quads, static_cast<int>(piece.corners.size()), piece.first_rim));
}

std::array<int, 3> renumbered(std::array<int, 3> face, const std::vector<int>& point) {
  for (int& v : face) v = point[v];
  return face;
}

// Pieces put together again.
class Assembly {
 public:
  Assembly(std::size_t corners, const LayoutEdit& edit, int nodes) {
    surface_.sides.resize(corners);
    cut_.node_count = nodes;
    cut_.nodes.resize(edit.quads.size());
    cut_.neighbours.resize(edit.quads.size());
    cut_.sides.resize(edit.quads.size());
  }

  void add(Piece piece, PatchedSurface cut) {
    if (cut.patch_count() != static_cast<int>(piece.quads.size())) throw Error(ErrorCode::Internal, "a piece of a region was drawn with other quads");
    const auto first = static_cast<int>(surface_.mesh.points.size());
    const RegionSurface& of = piece.surface;
    surface_.mesh.points.insert(surface_.mesh.points.end(), of.mesh.points.begin(), of.mesh.points.end());
    surface_.source.insert(surface_.source.end(), of.source.begin(), of.source.end());
    // Points that it got while it was drawn are none of the whole.
    for (std::size_t v = 0; v < of.mesh.points.size(); ++v) surface_.point.push_back(v < of.point.size() ? of.point[v] : -1);
    for (std::size_t k = 0; k < piece.corners.size(); ++k)
      for (const int v : of.sides[k]) surface_.sides[piece.corners[k]].push_back(first + v);
    first_point_.push_back(first);
    pieces_.push_back({std::move(piece), std::move(cut)});
  }

  PatchedSurface finish(RegionSurface& surface) {
    // The points of the cut surface begin with those of the surface.
    cut_.mesh.points = surface_.mesh.points;
    for (std::size_t v = 0; v < surface_.mesh.points.size(); ++v) cut_.source.push_back({{static_cast<int>(v), -1, -1}, {1, 0, 0}});
    for (std::size_t k = 0; k < pieces_.size(); ++k) join(pieces_[k].first, pieces_[k].second, first_point_[k]);
    connect_half_edges(surface_.mesh);
    connect_half_edges(cut_.mesh);
    surface = std::move(surface_);
    return std::move(cut_);
  }

 private:
  void join(const Piece& piece, const PatchedSurface& cut, int first_point) {
    const auto first_face = static_cast<int>(surface_.mesh.faces.size());
    std::vector<int> point(cut.mesh.points.size());
    for (std::size_t v = 0; v < point.size(); ++v) {
      if (v < piece.surface.mesh.points.size()) {
        point[v] = first_point + static_cast<int>(v);
        continue;
      }
      point[v] = static_cast<int>(cut_.mesh.points.size());
      cut_.mesh.points.push_back(cut.mesh.points[v]);
      PointSource& source = cut_.source.emplace_back(cut.source[v]);
      for (int& from : source.vertices)
        if (from >= 0) from += first_point;
    }
    for (const auto& face : piece.surface.mesh.faces) surface_.mesh.faces.push_back(renumbered(face, point));
    surface_.mesh.source_face.insert(surface_.mesh.source_face.end(), piece.surface.mesh.source_face.begin(), piece.surface.mesh.source_face.end());
    for (const auto& face : cut.mesh.faces) cut_.mesh.faces.push_back(renumbered(face, point));
    for (const int f : cut.mesh.source_face) cut_.mesh.source_face.push_back(first_face + f);
    for (const int p : cut.patch) cut_.patch.push_back(piece.quads[p]);
    for (int q = 0; q < cut.patch_count(); ++q) {
      const int quad = piece.quads[q];
      for (int i = 0; i < 4; ++i) {
        const PatchSide& across = cut.neighbours[q][i];
        cut_.nodes[quad][i] = piece.nodes[cut.nodes[q][i]];
        if (across.patch >= 0) cut_.neighbours[quad][i] = {piece.quads[across.patch], across.side};
        for (const int v : cut.sides[q][i]) cut_.sides[quad][i].push_back(point[v]);
      }
    }
  }

  RegionSurface surface_;
  PatchedSurface cut_;
  std::vector<std::pair<Piece, PatchedSurface>> pieces_;
  std::vector<int> first_point_;
};

}  // namespace

bool has_drawable_pieces(const PatchRegion& region) {
  return region.pieces.size() > 1 && std::all_of(region.pieces.begin(), region.pieces.end(), [](const RegionPiece& p) {
           const int rims = static_cast<int>(p.rims.size());
           return p.open_loops == 0 && rims <= 2 && p.euler == 2 - rims;
         });
}

PatchedSurface draw_pieces(RegionSurface& surface, const PatchRegion& region, const LayoutEdit& edit) {
  DisjointSets points(surface.mesh.points.size()), nodes(node_count(region, edit));
  for (const auto& face : surface.mesh.faces)
    for (const int v : face) points.join(v, face[0]);
  for (const auto& quad : edit.quads)
    for (const int n : quad) nodes.join(n, quad[0]);

  Assembly assembly(surface.sides.size(), edit, node_count(region, edit));
  for (const RegionPiece& of : region.pieces) {
    Piece piece = take_piece(surface, region, edit, of, points, nodes);
    PatchedSurface cut = draw(piece);
    assembly.add(std::move(piece), std::move(cut));
  }
  return assembly.finish(surface);
}

}  // namespace hybrid_mesh
