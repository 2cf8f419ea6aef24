// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Guskov, Khodakovsky, Schroeder, Sweldens, Hybrid Meshes: Multiresolution using Regular and Irregular Refinement, 2002, Figures 4 to 7.
#include "hierarchy/irregular_operations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

namespace hybrid_mesh {

namespace {

using Side = Repatch::Side;

constexpr int kMostQuads = 1 << 20;  // of one operation: takes 1.5 GB
constexpr int kFewestSides = 4;      // of a boundary that a ring of quads can stand on without joining two vertices twice

Side patch_side(int quad, int side) {
  Side result;
  result.kind = Side::Kind::Patch;
  result.quad = quad;
  result.side = side;
  return result;
}

Side outer_side(HalfEdge half) {
  Side result;
  result.kind = Side::Kind::Outer;
  result.half = half;
  return result;
}

// Why the nodes cannot be removed by one operation; empty if nothing speaks against it.
std::string find_node_defect(const HybridMesh& mesh, const std::vector<int>& nodes) {
  if (nodes.empty()) return "no quads were given";
  std::set<int> seen;
  for (int n : nodes) {
    if (n < 0 || n >= mesh.node_count()) return "quad " + std::to_string(n) + " does not exist";
    if (!seen.insert(n).second) return "quad " + std::to_string(n) + " was given twice";
    if (mesh.is_root(n)) return "quad " + std::to_string(n) + " is a root quad, which cannot be removed";
    if (!mesh.is_active(n)) return "quad " + std::to_string(n) + " is not there: another operation has removed it";
    if (mesh.level(n) != mesh.level(nodes[0]))
      return "the quads are of several levels (" + std::to_string(mesh.level(nodes[0])) + " and " + std::to_string(mesh.level(n)) + ")";
  }
  return "";
}

// Counts the quads around a region's corners that are not of the region. A coarser leaf counts as if it were refined.
void look_outside(const HybridMesh& mesh, DiskRegion& region) {
  const std::set<int> inside(region.nodes.begin(), region.nodes.end());
  for (std::size_t k = 0; k < region.boundary.size(); ++k) {
    const SideLink at = region.sides[k];
    const VertexId vertex = region.corners[k];
    int outside = 0;
    bool open = false;
    for (int leaf : mesh.leaves_at_corner(at.node, at.side)) {
      int ancestor = leaf, times = 0;
      while (ancestor >= 0 && mesh.level(ancestor) > region.level) ancestor = mesh.parent(ancestor);
      for (int i = 0; i < 4; ++i) {
        if (mesh.corner(leaf, i) != vertex) continue;
        ++times;
        open |= mesh.leaf_neighbours(leaf, i).empty() || mesh.leaf_neighbours(leaf, (i + 3) % 4).empty();
      }
      if (!inside.count(ancestor)) outside += times > 0 ? times : 2;  // two where the corner lies inside a side of the leaf
    }
    region.outside.push_back(outside);
    region.on_mesh_boundary.push_back(open);
  }
}

}  // namespace

DiskRegion find_disk_region(const HybridMesh& mesh, const std::vector<int>& nodes, HalfEdge start) {
  DiskRegion region;
  region.nodes = nodes;
  region.reason = find_node_defect(mesh, nodes);
  if (!region.reason.empty()) return region;
  const auto refuse = [&](const std::string& reason) {
    region.reason = reason;
    return region;
  };
  region.level = mesh.level(nodes[0]);
  std::unordered_map<HalfEdge, SideLink> sides;
  for (int n : nodes)
    for (int s = 0; s < 4; ++s) sides[mesh.half_edge(n, s)] = {n, s};

  std::set<int> reached{nodes[0]};
  for (std::vector<int> stack{nodes[0]}; !stack.empty();) {
    const int n = stack.back();
    stack.pop_back();
    for (int s = 0; s < 4; ++s) {
      const auto across = sides.find(mesh.half_edge(n, s) ^ 1);
      if (across != sides.end() && reached.insert(across->second.node).second) stack.push_back(across->second.node);
    }
  }
  if (reached.size() != nodes.size()) return refuse("the quads are not all joined by sides");

  std::map<VertexId, HalfEdge> leaving;  // along the boundary
  HalfEdge first = -1;
  for (int n : nodes)
    for (int s = 0; s < 4; ++s) {
      const HalfEdge h = mesh.half_edge(n, s);
      if (sides.count(h ^ 1)) continue;
      if (first < 0) first = h;
      if (!leaving.try_emplace(mesh.from(h), h).second) return refuse("the boundary of the quads meets a vertex twice");
    }
  if (first < 0) return refuse("the quads have no boundary");
  if (start >= 0) {
    if (!sides.count(start) || sides.count(start ^ 1)) return refuse("the side to start from is not on the boundary of the quads");
    first = start;
  }
  for (HalfEdge h = first;;) {
    region.boundary.push_back(h);
    region.sides.push_back(sides.at(h));
    region.corners.push_back(mesh.from(h));
    const auto next = leaving.find(mesh.to(h));
    if (next == leaving.end() || region.boundary.size() > leaving.size()) return refuse("the boundary of the quads is not closed");
    h = next->second;
    if (h == first) break;
  }
  if (region.boundary.size() != leaving.size()) return refuse("the quads have several boundaries");
  std::set<VertexId> vertices;
  for (int n : nodes)
    for (int i = 0; i < 4; ++i)
      if (vertices.insert(mesh.corner(n, i)).second && !leaving.count(mesh.corner(n, i))) region.inner.push_back(mesh.corner(n, i));
  const int edges = static_cast<int>(4 * nodes.size() + region.boundary.size()) / 2;
  if (static_cast<int>(vertices.size()) - edges + static_cast<int>(nodes.size()) != 1) return refuse("the quads form no disk");
  look_outside(mesh, region);
  return region;
}

OperationDraft add_cubes(const HybridMesh& mesh, const std::vector<int>& nodes, int count) {
  const DiskRegion region = find_disk_region(mesh, nodes);
  if (!region.reason.empty()) return {{}, region.reason};
  const int n = static_cast<int>(region.boundary.size());
  if (n < kFewestSides) return {{}, "the boundary of the quads has less than four sides"};
  if (count < 1) return {{}, "at least one ring of quads is needed"};
  if (count > kMostQuads / n) return {{}, "more rings of quads than one operation can have"};

  Repatch repatch;
  repatch.kind = "add_cubes";
  repatch.level = region.level;
  repatch.removed = nodes;
  repatch.boundary = region.corners;
  repatch.new_vertices = count * n + static_cast<int>(region.inner.size());
  // Ring 0 is the region's boundary.
  const auto corner = [&](int ring, int k) { return ring == 0 ? k % n : -1 - ((ring - 1) * n + k % n); };
  const auto ring_quad = [&](int ring, int k) { return ring * n + (k + n) % n; };
  std::unordered_map<HalfEdge, SideLink> top;  // sides of the copy
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (int s = 0; s < 4; ++s) top[mesh.half_edge(nodes[i], s)] = {static_cast<int>(i), s};
  for (int ring = 0; ring < count; ++ring)
    for (int k = 0; k < n; ++k) {
      const SideLink lid = top.at(region.boundary[k]);
      repatch.quads.push_back({corner(ring, k), corner(ring, k + 1), corner(ring + 1, k + 1), corner(ring + 1, k)});
      repatch.sides.push_back({ring == 0 ? outer_side(region.boundary[k]) : patch_side(ring_quad(ring - 1, k), 2),
                               patch_side(ring_quad(ring, k + 1), 3),
                               ring + 1 < count ? patch_side(ring_quad(ring + 1, k), 0) : patch_side(count * n + lid.node, lid.side),
                               patch_side(ring_quad(ring, k - 1), 1)});
    }
  std::map<VertexId, int> copy;
  for (int k = 0; k < n; ++k) copy[region.corners[k]] = corner(count, k);
  for (std::size_t i = 0; i < region.inner.size(); ++i) copy[region.inner[i]] = -1 - (count * n + static_cast<int>(i));
  std::unordered_map<HalfEdge, int> place;  // of boundary half-edges
  for (int k = 0; k < n; ++k) place[region.boundary[k]] = k;
  for (int node : nodes) {
    std::array<int, 4> quad;
    std::array<Side, 4> sides;
    for (int s = 0; s < 4; ++s) {
      const HalfEdge h = mesh.half_edge(node, s);
      quad[s] = copy.at(mesh.corner(node, s));
      const auto across = top.find(h ^ 1);
      sides[s] =
          across == top.end() ? patch_side(ring_quad(count - 1, place.at(h)), 2) : patch_side(count * n + across->second.node, across->second.side);
    }
    repatch.quads.push_back(quad);
    repatch.sides.push_back(sides);
  }
  std::vector<VertexPlace> places;
  for (int ring = 1; ring <= count; ++ring)
    for (VertexId corner : region.corners) places.push_back({{{corner, 1.0}}, static_cast<double>(ring)});
  for (VertexId inner : region.inner) places.push_back({{{inner, 1.0}}, static_cast<double>(count)});
  return {repatch, "", places};
}

OperationDraft open_boundary(const HybridMesh& mesh, const std::vector<int>& nodes) {
  const std::string reason = find_node_defect(mesh, nodes);
  if (!reason.empty()) return {{}, reason};
  Repatch repatch;
  repatch.kind = "open_boundary";
  repatch.level = mesh.level(nodes[0]);
  repatch.removed = nodes;
  return {repatch, ""};
}

OperationDraft free_layout(const HybridMesh& mesh, const std::vector<int>& nodes, const std::vector<std::array<int, 4>>& quads, HalfEdge start) {
  const DiskRegion region = find_disk_region(mesh, nodes, start);
  if (!region.reason.empty()) return {{}, region.reason};
  const int n = static_cast<int>(region.boundary.size());
  if (quads.empty()) return {{}, "a layout without quads"};
  if (quads.size() > static_cast<std::size_t>(kMostQuads)) return {{}, "more quads than one operation can have"};
  Repatch repatch;
  repatch.kind = "free_layout";
  repatch.level = region.level;
  repatch.removed = nodes;
  repatch.boundary = region.corners;
  int last = n - 1;
  std::map<std::pair<int, int>, SideLink> sides;
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      const int a = quads[q][s], b = quads[q][(s + 1) % 4];
      if (a < 0 || a >= n + 4 * static_cast<int>(quads.size())) return {{}, "quad " + std::to_string(q) + " of the layout has a corner out of range"};
      if (!sides.try_emplace({a, b}, SideLink{static_cast<int>(q), s}).second)
        return {{}, "two quads of the layout lie on the same side of the edge from corner " + std::to_string(a) + " to " + std::to_string(b)};
      last = std::max(last, a);
    }
  repatch.new_vertices = last + 1 - n;
  for (std::size_t q = 0; q < quads.size(); ++q) {
    std::array<int, 4> quad;
    std::array<Side, 4> links;
    for (int s = 0; s < 4; ++s) {
      const int a = quads[q][s], b = quads[q][(s + 1) % 4];
      quad[s] = a < n ? a : n - 1 - a;
      const auto across = sides.find({b, a});
      const bool along = a < n && b == (a + 1) % n;
      if (along && across != sides.end()) return {{}, "the layout has quads on both sides of boundary side " + std::to_string(a)};
      if (!along && across == sides.end())
        return {{}, "the layout has a hole at the edge from corner " + std::to_string(a) + " to " + std::to_string(b)};
      links[s] = along ? outer_side(region.boundary[a]) : patch_side(across->second.node, across->second.side);
    }
    repatch.quads.push_back(quad);
    repatch.sides.push_back(links);
  }
  for (int k = 0; k < n; ++k)
    if (!sides.count({k, (k + 1) % n})) return {{}, "the layout leaves boundary side " + std::to_string(k) + " without a quad"};
  return {repatch, ""};
}

// --- tubes ---------------------------------------------------------------------------------------------------------------------------------------

namespace {

// A circle of vertices that a ring of quads stands on.
struct Circle {
  std::vector<int> corners;       // in the tube's numbering
  std::vector<int> quads;         // around each corner so far
  std::vector<char> on_boundary;  // of the mesh
};

struct Tube {
  std::vector<std::array<int, 4>> quads;
  std::vector<std::vector<std::pair<int, double>>> means;  // #new vertices: of the outer circles' corners, with weights
  double cost = 0;
};

// Adds `weight` times the point that divides a circle's corners, at equal distances from each other, in the ratio `turn` : 1 - turn.
void add_point_of(const Circle& circle, double turn, double weight, std::vector<std::pair<int, double>>& mean) {
  const double at = turn * static_cast<double>(circle.corners.size());
  const auto k = static_cast<std::size_t>(at);
  const double beyond = at - static_cast<double>(k);
  mean.emplace_back(circle.corners[k % circle.corners.size()], weight * (1 - beyond));
  if (beyond > 0) mean.emplace_back(circle.corners[(k + 1) % circle.corners.size()], weight * beyond);
}

// How far a vertex of so many quads is from a regular one; more than six or fewer than three weigh more than any number of other ones.
double irregularity(int quads, bool on_boundary) {
  const int off = quads - (on_boundary ? 2 : 4);
  const bool allowed = on_boundary ? quads >= 1 && quads <= 4 : quads >= 3 && quads <= 6;
  return off * off + (allowed ? 0 : 1000.0 * off * off);
}

// The ring between a circle of m vertices and one of n <= m (m + n even), both in the direction of the first, the ring to its left: corner 0 faces
// corner 0. Every vertex of the smaller circle has an edge to the larger one; where it has t more, it stands at the tip of t quads with two sides
// each on the larger circle, whose middles have no other quad. The t are chosen by dynamic programming so that vertices are as regular as can be. The
// circles' counts of quads are raised.
Tube make_ring(Circle& large, Circle& small) {
  const int m = static_cast<int>(large.corners.size()), n = static_cast<int>(small.corners.size()), surplus = (m - n) / 2;
  Tube ring;
  if (surplus > 0) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const int most = std::min(surplus, 3);
    // best[j][u]: the first j vertices of the smaller circle with u two-sided quads among them; the next vertex faces corner j + 2 u of the larger
    // one.
    std::vector<std::vector<double>> best(n + 1, std::vector<double>(surplus + 1, kNever));
    std::vector<std::vector<int>> choice(n + 1, std::vector<int>(surplus + 1, 0));
    best[0][0] = 0;
    const auto large_cost = [&](int i, int quads) { return irregularity(large.quads[i % m] + quads, large.on_boundary[i % m]); };
    // A vertex may stand at the tip of more than three such quads only where there is no other way.
    for (int limit = most; best[n][surplus] == kNever; limit = surplus)
      for (int j = 0; j < n; ++j)
        for (int u = 0; u <= surplus; ++u) {
          if (best[j][u] == kNever) continue;
          double along = 0;
          for (int t = 0; t <= limit && u + t <= surplus; ++t) {
            const int i = j + 2 * u;
            if (t > 0) along += large_cost(i + 2 * t - 1, 1);
            along += large_cost(i + 2 * t, 2);
            const double cost = best[j][u] + along + irregularity(small.quads[j] + 2 + t, small.on_boundary[j]);
            if (cost < best[j + 1][u + t]) {
              best[j + 1][u + t] = cost;
              choice[j + 1][u + t] = t;
            }
          }
        }
    ring.cost = best[n][surplus];
    std::vector<int> tips(n);
    for (int j = n, u = surplus; j > 0; u -= choice[j][u], --j) tips[j - 1] = choice[j][u];
    for (int j = 0, i = 0; j < n; ++j) {
      for (int t = 0; t < tips[j]; ++t, i += 2) {
        ring.quads.push_back({large.corners[i], large.corners[i + 1], large.corners[(i + 2) % m], small.corners[j]});
        large.quads[i + 1] -= 1;  // two are added below
      }
      ring.quads.push_back({large.corners[i], large.corners[(i + 1) % m], small.corners[(j + 1) % n], small.corners[j]});
      ++i;
      small.quads[j] += tips[j];
    }
  } else {
    for (int j = 0; j < n; ++j) {
      ring.quads.push_back({large.corners[j], large.corners[(j + 1) % n], small.corners[(j + 1) % n], small.corners[j]});
      ring.cost += irregularity(large.quads[j] + 2, large.on_boundary[j]) + irregularity(small.quads[j] + 2, small.on_boundary[j]);
    }
  }
  for (int& quads : large.quads) quads += 2;
  for (int& quads : small.quads) quads += 2;
  return ring;
}

// A tube of `rings` rings from circle `start` to circle `end`, the latter in the direction of the first; new vertices are numbered from `first_new`.
Tube make_tube(const Circle& start, const Circle& end, int rings, int first_new) {
  Circle a = start;
  const int m = static_cast<int>(start.corners.size()), n = static_cast<int>(end.corners.size());
  Tube tube;
  for (int r = 1; r <= rings; ++r) {
    Circle next;
    if (r == rings) {
      next = end;
    } else {
      // Sizes between the two in equal ratios, even or odd as they are.
      const double along = static_cast<double>(r) / rings;
      const double wanted = m * std::pow(static_cast<double>(n) / m, along);
      const int size = n + 2 * static_cast<int>(std::lround((wanted - n) / 2));
      for (int k = 0; k < size; ++k) {
        next.corners.push_back(first_new++);
        auto& mean = tube.means.emplace_back();
        add_point_of(start, static_cast<double>(k) / size, 1 - along, mean);
        add_point_of(end, static_cast<double>(k) / size, along, mean);
      }
      next.quads.assign(size, 2);  // those of the ring to come
      next.on_boundary.assign(size, 0);
    }
    const bool narrows = a.corners.size() >= next.corners.size();
    // The ring's quads run counter-clockwise with the larger circle to their right; seen from the other end everything is mirrored.
    Tube ring = narrows ? make_ring(a, next) : make_ring(next, a);
    if (!narrows)
      for (auto& quad : ring.quads) std::swap(quad[1], quad[3]);
    tube.quads.insert(tube.quads.end(), ring.quads.begin(), ring.quads.end());
    if (r < rings)
      for (int& quads : next.quads) quads -= 2;
    tube.cost += ring.cost;
    a = next;
  }
  return tube;
}

// Pairs of vertices, one of each list, that an edge of the mesh joins on a level or where only coarser quads are.
std::set<std::pair<VertexId, VertexId>> joined_vertices(const HybridMesh& mesh, int level, const std::vector<VertexId>& a,
                                                        const std::vector<VertexId>& b) {
  const std::set<VertexId> in_a(a.begin(), a.end()), in_b(b.begin(), b.end());
  std::set<std::pair<VertexId, VertexId>> result;
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (!mesh.is_active(n) || !(mesh.level(n) == level || (mesh.level(n) < level && mesh.is_leaf(n)))) continue;
    for (int s = 0; s < 4; ++s) {
      const VertexId u = mesh.corner(n, s), v = mesh.corner(n, (s + 1) % 4);
      if (in_a.count(u) && in_b.count(v)) result.insert({u, v});
      if (in_a.count(v) && in_b.count(u)) result.insert({v, u});
    }
  }
  return result;
}

}  // namespace

OperationDraft connect(const HybridMesh& mesh, const std::vector<int>& region_a, const std::vector<int>& region_b, int turn) {
  const DiskRegion a = find_disk_region(mesh, region_a), b = find_disk_region(mesh, region_b);
  if (!a.reason.empty()) return {{}, "the first region: " + a.reason};
  if (!b.reason.empty()) return {{}, "the second region: " + b.reason};
  if (a.level != b.level) return {{}, "the regions are of different levels"};
  const int m = static_cast<int>(a.boundary.size()), n = static_cast<int>(b.boundary.size());
  if (m < kFewestSides || n < kFewestSides) return {{}, "a boundary with less than four sides"};
  if ((m + n) % 2) return {{}, "boundaries with an odd number of sides together cannot be joined by quads"};
  const std::set<int> nodes_a(region_a.begin(), region_a.end());
  for (int node : region_b)
    if (nodes_a.count(node)) return {{}, "the regions have a quad in common"};
  const std::set<VertexId> corners_a(a.corners.begin(), a.corners.end());
  for (VertexId v : b.corners)
    if (corners_a.count(v)) return {{}, "the regions touch each other"};

  // Seen from inside the tube the second boundary runs against the first: side 0 of a faces side `turn` of b.
  Circle circle_a, circle_b;
  std::map<int, HalfEdge> half_from;  // of boundary sides, by their first corner
  for (int k = 0; k < m; ++k) {
    circle_a.corners.push_back(k);
    half_from[k] = a.boundary[k];
  }
  circle_a.quads = a.outside;
  circle_a.on_boundary = a.on_mesh_boundary;
  for (int k = 0; k < n; ++k) {
    const int at = static_cast<int>(((turn % n) + n + 1 - k + n) % n);
    circle_b.corners.push_back(m + at);
    circle_b.quads.push_back(b.outside[at]);
    circle_b.on_boundary.push_back(b.on_mesh_boundary[at]);
    half_from[m + k] = b.boundary[k];
  }
  Repatch repatch;
  repatch.kind = "connect";
  repatch.level = a.level;
  repatch.removed = region_a;
  repatch.removed.insert(repatch.removed.end(), region_b.begin(), region_b.end());
  repatch.boundary = a.corners;
  repatch.boundary.insert(repatch.boundary.end(), b.corners.begin(), b.corners.end());
  const auto joined = joined_vertices(mesh, a.level, a.corners, b.corners);
  const auto joins_twice = [&](const Tube& tube) {
    for (const auto& quad : tube.quads)
      for (int s = 0; s < 4; ++s) {
        const int u = quad[s], v = quad[(s + 1) % 4];
        if (u < m && v >= m && v < m + n && joined.count({repatch.boundary[u], repatch.boundary[v]})) return true;
      }
    return false;
  };
  // Rings that narrow to a third each need no vertex of more than six quads where the ground is regular.
  const double ratio = static_cast<double>(std::max(m, n)) / std::min(m, n);
  const int most_rings = 3 + static_cast<int>(std::ceil(std::log(ratio) / std::log(2.0)));
  Tube tube;
  for (int rings = 1; rings <= most_rings; ++rings) {
    Tube next = make_tube(circle_a, circle_b, rings, m + n);
    if (joins_twice(next)) continue;
    if (tube.quads.empty() || next.cost < tube.cost - 900) tube = std::move(next);
    if (tube.cost < 900) break;
  }
  if (tube.quads.empty()) return {{}, "the tube would join vertices twice"};

  std::map<std::pair<int, int>, SideLink> sides;
  for (std::size_t q = 0; q < tube.quads.size(); ++q)
    for (int s = 0; s < 4; ++s) sides[{tube.quads[q][s], tube.quads[q][(s + 1) % 4]}] = {static_cast<int>(q), s};
  for (std::size_t q = 0; q < tube.quads.size(); ++q) {
    std::array<int, 4> quad;
    std::array<Side, 4> links;
    for (int s = 0; s < 4; ++s) {
      const int u = tube.quads[q][s], v = tube.quads[q][(s + 1) % 4];
      quad[s] = u < m + n ? u : m + n - 1 - u;
      repatch.new_vertices = std::max(repatch.new_vertices, u + 1 - m - n);
      const auto across = sides.find({v, u});
      links[s] = across != sides.end() ? patch_side(across->second.node, across->second.side) : outer_side(half_from.at(u));
    }
    repatch.quads.push_back(quad);
    repatch.sides.push_back(links);
  }
  std::vector<VertexPlace> places;
  for (const auto& mean : tube.means) {
    VertexPlace& place = places.emplace_back();
    for (const auto& [corner, weight] : mean) place.mean.emplace_back(repatch.boundary[corner], weight);
  }
  return {repatch, "", places};
}

}  // namespace hybrid_mesh
