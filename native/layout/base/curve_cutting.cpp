// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "layout/base/curves_on_mesh.h"
#include "layout/curves/face_splitting.h"

namespace hybrid_mesh {

PatchedSurface CurveNetwork::cut() {
  PatchedSurface out;
  std::vector<char> is_node(points_.size(), 0);
  for (const int v : layout_.node_vertex)
    if (v >= 0) is_node[v] = 1;
  std::vector<std::vector<int>> chains(layout_.curves.size());
  for (std::size_t c = 0; c < chains.size(); ++c)
    if (is_feature(static_cast<int>(c))) chains[c] = follow_feature(static_cast<int>(c), is_node);
  TriangleSurface& fine = out.mesh;
  fine.points = points_;
  fine.sizes = surface_.sizes;
  for (std::size_t v = 0; v < points_.size(); ++v) out.source.push_back({{static_cast<int>(v), -1, -1}, {1, 0, 0}});
  std::vector<int> point_of(crossings_.size(), -1);
  for (std::size_t c = 0; c < first_.size(); ++c)
    for (int n = first_[c]; n >= 0; n = crossings_[n].next) {
      point_of[n] = static_cast<int>(fine.points.size());
      fine.points.push_back(position(crossings_[n]));
      out.source.push_back({{crossings_[n].low, crossings_[n].high, -1}, {1 - crossings_[n].t, crossings_[n].t, 0}});
    }
  const Vec2 reference[3] = {Vec2(0, 0), Vec2(1, 0), Vec2(0.5, std::sqrt(0.75))};
  std::vector<int> marks;  // per half-edge of the result: the curve along it, -1 none
  for (int f = 0; f < static_cast<int>(surface_.faces.size()); ++f) {
    ring_.clear(), sides_.clear();
    for (int i = 0; i < 3; ++i) {
      ring_.push_back(mesh_.from(3 * f + i));
      sides_.push_back(3 * f + i);
    }
    collect(true);
    // Where each station lies in the reference triangle, and on which of its sides.
    std::vector<PieceCorner> polygon;
    int corner = 0;
    for (const Station& s : stations_) {
      PieceCorner c{};
      std::array<double, 3> w{0, 0, 0};
      if (s.corner >= 0) {
        corner = s.corner;
        c.point = ring_[corner];
        w[corner] = 1;
        c.sides = (1 << corner) | (1 << ((corner + 2) % 3));
        c.mark = along_edge_[mesh_.edge[sides_[corner]]];
      } else {
        const Crossing& x = crossings_[s.crossing];
        c.point = point_of[s.crossing];
        const double t = ring_[corner] == x.low ? x.t : 1 - x.t;
        w[corner] = 1 - t;
        w[(corner + 1) % 3] = t;
        c.sides = 1 << corner;
        c.mark = -1;
      }
      c.at = w[0] * reference[0] + w[1] * reference[1] + w[2] * reference[2];
      polygon.push_back(c);
    }
    const auto emit = [&](const PieceCorner& a, const PieceCorner& b, const PieceCorner& c, int ab, int bc, int ca) {
      fine.faces.push_back({a.point, b.point, c.point});
      fine.source_face.push_back(f);
      marks.insert(marks.end(), {ab, bc, ca});
    };
    std::vector<FaceChord> cuts;
    for (const Chord& c : chords_) cuts.push_back({std::min(c.from, c.to), std::max(c.from, c.to), c.curve});
    split_along_chords(polygon, cuts, emit);
  }
  connect_half_edges(fine);

  // Patches: flood fill between the curves; each curve knows the quad on its left and right.
  const int quads = static_cast<int>(layout_.quads.size());
  std::vector<std::array<PatchSide, 2>> beside(layout_.curves.size());  // [0]: left of the curve
  for (int q = 0; q < quads; ++q)
    for (int i = 0; i < 4; ++i) {
      const QuadLayout::Side& s = layout_.quads[q].sides[i];
      if (s.curve >= 0) beside[s.curve][s.forward ? 0 : 1] = {q, i};
    }
  // A half-edge along a curve runs with it if it leads from an earlier to a later point.
  std::vector<int> rank(fine.points.size(), 0);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    if (is_feature(static_cast<int>(c))) {
      for (std::size_t k = 1; k + 1 < chains[c].size(); ++k) rank[chains[c][k]] = static_cast<int>(k);
      continue;
    }
    chains[c].push_back(layout_.curves[c].start);
    for (int n = first_[c]; n >= 0; n = crossings_[n].next) {
      rank[point_of[n]] = static_cast<int>(chains[c].size());
      chains[c].push_back(point_of[n]);
    }
    chains[c].push_back(layout_.curves[c].end);
  }
  const auto rank_on = [&](int c, int point) {
    if (point == layout_.curves[c].start) return -1;
    if (point == layout_.curves[c].end) return static_cast<int>(chains[c].size());
    return rank[point];
  };
  std::vector<std::array<std::vector<int>, 4>> sides(quads);
  // Boundary sides: from a node's vertex along the boundary to the next node.
  std::vector<int> boundary_from(fine.points.size(), -1);
  for (int h = 0; h < static_cast<int>(fine.opposite.size()); ++h)
    if (fine.opposite[h] < 0) boundary_from[fine.from(h)] = h;
  std::vector<std::pair<int, int>> seeds;  // face, quad: for quads that are reached by no curve
  for (int q = 0; q < quads; ++q) {
    const QuadLayout::Quad& quad = layout_.quads[q];
    for (int i = 0; i < 4; ++i) {
      if (quad.sides[i].curve >= 0) {
        sides[q][i] = chains[quad.sides[i].curve];
        if (!quad.sides[i].forward) std::reverse(sides[q][i].begin(), sides[q][i].end());
        continue;
      }
      if (layout_.node_vertex[quad.nodes[i]] < 0) continue;  // the second half of a split boundary edge, done with the first
      std::vector<int> chain{layout_.node_vertex[quad.nodes[i]]};
      seeds.push_back({boundary_from[chain[0]] / 3, q});
      do {
        chain.push_back(fine.to(boundary_from[chain.back()]));
      } while (!is_node[chain.back()]);
      const int next = (i + 1) % 4;
      if (layout_.node_vertex[quad.nodes[next]] >= 0) {
        sides[q][i] = chain;
      } else {
        split_boundary_chain_.push_back({q, i});
        sides[q][i] = chain;
      }
    }
  }
  out.patch.assign(fine.faces.size(), -1);
  std::vector<int> stack;
  const auto seed = [&](int face, int q) {
    if (out.patch[face] >= 0 && out.patch[face] != q) throw NoMap("two base quads claim one patch");
    if (out.patch[face] == q) return;
    out.patch[face] = q;
    stack.push_back(face);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int o = fine.opposite[h];
        if (o < 0 || marks[h] >= 0) continue;
        if (out.patch[o / 3] < 0) {
          out.patch[o / 3] = q;
          stack.push_back(o / 3);
        } else if (out.patch[o / 3] != q) {
          throw NoMap("two base quads claim one patch");
        }
      }
    }
  };
  for (int h = 0; h < static_cast<int>(fine.opposite.size()); ++h) {
    const int c = marks[h];
    if (c < 0) continue;
    const bool with = rank_on(c, fine.from(h)) < rank_on(c, fine.to(h));
    const PatchSide side = beside[c][with ? 0 : 1];
    if (side.patch < 0) throw NoMap("a base curve borders no quad");
    seed(h / 3, side.patch);
  }
  for (const auto& [face, q] : seeds) seed(face, q);
  for (const int p : out.patch)
    if (p < 0) throw NoMap("a part of the surface belongs to no base quad");

  // Nodes inside boundary edges: the boundary point nearest to the middle; an edge without inner points is split.
  for (const auto& [q, i] : split_boundary_chain_) {
    std::vector<int> chain = sides[q][i];
    if (chain.size() == 2) {
      chain.insert(chain.begin() + 1, split_boundary_edge(out, boundary_from[chain[0]]));
    }
    double length = 0;
    std::vector<double> at{0};
    for (std::size_t k = 1; k < chain.size(); ++k) at.push_back(length += (fine.points[chain[k]] - fine.points[chain[k - 1]]).norm());
    std::size_t best = 1;
    for (std::size_t k = 1; k + 1 < chain.size(); ++k)
      if (std::abs(at[k] - length / 2) < std::abs(at[best] - length / 2)) best = k;
    sides[q][i].assign(chain.begin(), chain.begin() + best + 1);
    sides[q][(i + 1) % 4].assign(chain.begin() + best, chain.end());
  }
  if (!split_boundary_chain_.empty()) connect_half_edges(fine);

  out.nodes.resize(quads);
  out.neighbours.resize(quads);
  out.sides = std::move(sides);
  out.node_count = static_cast<int>(layout_.node_vertex.size());
  if (!features_.empty()) out.sharp.resize(quads);
  for (std::size_t v = 0; v < points_.size() && !features_.empty(); ++v) out.sharp_corner.push_back(features_.is_corner(static_cast<int>(v)));
  for (int q = 0; q < quads; ++q) {
    out.nodes[q] = layout_.quads[q].nodes;
    for (int i = 0; i < 4; ++i) {
      const QuadLayout::Side& s = layout_.quads[q].sides[i];
      if (s.curve >= 0) out.neighbours[q][i] = beside[s.curve][s.forward ? 1 : 0];
      if (s.curve >= 0 && is_feature(s.curve)) out.sharp[q][i] = 1;
    }
  }
  return out;
}

// Splits the face at boundary half-edge h by a point in the edge's middle and returns that point; adjacency is left to the caller.
int CurveNetwork::split_boundary_edge(PatchedSurface& out, int h) {
  TriangleSurface& fine = out.mesh;
  const int f = h / 3, i = h % 3, j = (i + 1) % 3;
  const int a = fine.faces[f][i], b = fine.faces[f][j];
  const int m = static_cast<int>(fine.points.size());
  fine.points.push_back(0.5 * (fine.points[a] + fine.points[b]));
  const PointSource middle = middle_of(out.source[a], out.source[b]);
  out.source.push_back(middle);
  std::array<int, 3> second = fine.faces[f];
  fine.faces[f][j] = m;
  second[i] = m;
  fine.faces.push_back(second);
  fine.source_face.push_back(fine.source_face[f]);
  out.patch.push_back(out.patch[f]);
  return m;
}

}  // namespace hybrid_mesh
