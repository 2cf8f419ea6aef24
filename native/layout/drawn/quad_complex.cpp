// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/quad_complex.h"

#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "decoder/disjoint_sets.h"

namespace hybrid_mesh {
namespace {

// `next`: per point on the boundary the one that follows, else -1; `boundary_sides`: how many sides of each face are on the boundary.
template <class Faces>
MeshComponents find_components(int points, const Faces& faces, const std::vector<int>& next, int sides, const std::vector<int>& boundary_sides) {
  DisjointSets joined(points);
  for (const auto& f : faces)
    for (const int v : f) joined.join(v, f[0]);
  // Twice points - edges + faces: a side is half an edge, one on the boundary a whole one.
  std::map<int, std::array<int, 2>> found;
  for (int v = 0; v < points; ++v) found[joined.find(v)][0] += 2;
  for (std::size_t f = 0; f < faces.size(); ++f) found[joined.find(faces[f][0])][0] += 2 - sides - boundary_sides[f];
  std::vector<char> seen(points, 0);
  for (int v = 0; v < points; ++v) {
    if (next[v] < 0 || seen[v]) continue;
    ++found[joined.find(v)][1];
    for (int w = v; !seen[w]; w = next[w]) seen[w] = 1;
  }
  MeshComponents out;
  std::map<int, int> number;
  for (const auto& [v, t] : found) {
    number[v] = static_cast<int>(out.topology.size());
    out.topology.push_back({t[0] / 2, t[1]});
  }
  for (int v = 0; v < points; ++v) out.of.push_back(number[joined.find(v)]);
  return out;
}

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

bool is_finite(const Vec3& p) { return std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z()); }

}  // namespace

MeshComponents components_of(const TriangleSurface& surface) {
  std::vector<int> next(surface.points.size(), -1), boundary(surface.faces.size(), 0);
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h)
    if (surface.opposite[h] < 0) next[surface.from(h)] = surface.to(h), ++boundary[h / 3];
  return find_components(static_cast<int>(surface.points.size()), surface.faces, next, 3, boundary);
}

QuadComplex::QuadComplex(const LayoutOutline& outline) : outline_(outline), neighbours_(outline.neighbours) {
  check_numbers();
  if (neighbours_.empty()) find_neighbours();
  check_neighbours();
  edge_at_.resize(quads(), {-1, -1, -1, -1});
  for (int q = 0; q < quads(); ++q)
    for (int i = 0; i < 4; ++i) {
      const PatchSide other = neighbours_[q][i];
      if (other.patch < 0 || edge_at_[q][i] >= 0) continue;
      edge_at_[q][i] = edge_at_[other.patch][other.side] = edges();
      edges_.push_back({node(q, i), node(q, i + 1), {q, i}, neighbours_[q][i]});
    }
  order_nodes();
}

MeshComponents QuadComplex::components() const {
  std::vector<int> boundary(quads(), 0);
  for (int q = 0; q < quads(); ++q)
    for (const PatchSide& s : neighbours_[q]) boundary[q] += s.patch < 0;
  return find_components(nodes(), outline_.quads, next_on_boundary_, 4, boundary);
}

void QuadComplex::check_numbers() const {
  for (const auto& quad : outline_.quads)
    for (const int n : quad)
      if (n < 0 || n >= nodes()) refuse("a quad has the node " + std::to_string(n) + ", which does not exist");
  for (int n = 0; n < nodes(); ++n)
    if (!is_finite(outline_.nodes[n])) refuse("node " + std::to_string(n) + " has a coordinate that is not finite");
  if (!outline_.neighbours.empty() && outline_.neighbours.size() != outline_.quads.size()) refuse("there must be neighbours for every quad, or none");
  if (!outline_.sides.empty() && outline_.sides.size() != outline_.quads.size()) refuse("there must be lines for the sides of every quad, or none");
  for (const auto& lines : outline_.sides)
    for (const std::vector<Vec3>& line : lines)
      for (const Vec3& p : line)
        if (!is_finite(p)) refuse("the line of a side has a coordinate that is not finite");
}

void QuadComplex::find_neighbours() {
  neighbours_.assign(quads(), {});
  std::map<std::pair<int, int>, PatchSide> sides;
  for (int q = 0; q < quads(); ++q)
    for (int i = 0; i < 4; ++i) {
      const int a = node(q, i), b = node(q, i + 1);
      if (!sides.insert({{a, b}, {q, i}}).second)
        refuse("two quads run from node " + std::to_string(a) + " to node " + std::to_string(b) + ": their neighbours must be given");
    }
  for (const auto& [ends, side] : sides)
    if (const auto at = sides.find({ends.second, ends.first}); at != sides.end()) neighbours_[side.patch][side.side] = at->second;
}

void QuadComplex::check_neighbours() const {
  for (int q = 0; q < quads(); ++q)
    for (int i = 0; i < 4; ++i) {
      const PatchSide other = neighbours_[q][i];
      if (other.patch < 0) continue;
      const bool exists = other.patch < quads() && other.side >= 0 && other.side < 4 && !(other.patch == q && other.side == i);
      const PatchSide back = exists ? neighbours_[other.patch][other.side] : PatchSide();
      if (back.patch != q || back.side != i || node(q, i) != node(other.patch, other.side + 1) || node(q, i + 1) != node(other.patch, other.side))
        refuse("side " + std::to_string(i) + " of quad " + std::to_string(q) + " and the side across do not match");
    }
}

void QuadComplex::order_nodes() {
  around_.resize(nodes());
  next_on_boundary_.assign(nodes(), -1);
  std::vector<int> corners(nodes(), 0);
  std::vector<PatchSide> first(nodes());
  for (int q = 0; q < quads(); ++q)
    for (int i = 0; i < 4; ++i) {
      const int n = node(q, i);
      ++corners[n];
      if (neighbours_[q][i].patch < 0) {
        if (next_on_boundary_[n] >= 0) refuse("the boundary of the quads touches itself at node " + std::to_string(n));
        next_on_boundary_[n] = node(q, i + 1);
        first[n] = {q, i};
      } else if (first[n].patch < 0) {
        first[n] = {q, i};
      }
    }
  for (int n = 0; n < nodes(); ++n) {
    if (corners[n] == 0) refuse("node " + std::to_string(n) + " is in no quad");
    // From quad to quad across the side that ends at the node: its other half begins there.
    PatchSide s = first[n];
    do {
      --corners[n];
      if (const int e = edge_at_[s.patch][s.side]; e >= 0) around_[n].push_back({e, is_left(s.patch, s.side)});
      s = neighbours_[s.patch][(s.side + 3) % 4];
    } while (s.patch >= 0 && !(s.patch == first[n].patch && s.side == first[n].side) && corners[n] > 0);
    if (corners[n] != 0) refuse("the quads at node " + std::to_string(n) + " do not surround it once");
  }
}

}  // namespace hybrid_mesh
