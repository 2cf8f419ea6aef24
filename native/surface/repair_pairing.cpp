// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <deque>
#include <numeric>
#include <tuple>

#include "decoder/disjoint_sets.h"
#include "surface/edge_groups.h"
#include "surface/repair_stages.h"

namespace hybrid_mesh {

namespace {

// Sets of faces with known relative orientation.
class OrientationSets {
 public:
  explicit OrientationSets(int count) : parent_(count), turned_(count, 0) { std::iota(parent_.begin(), parent_.end(), 0); }

  // The set of a face, and whether the face is turned against the set's representative.
  std::pair<int, bool> find(int face) {
    int root = face;
    bool turned = false;
    while (parent_[root] != root) turned ^= turned_[root] != 0, root = parent_[root];
    bool rest = turned;
    while (parent_[face] != root && face != root) {  // compress the path
      const int up = parent_[face];
      const bool step = turned_[face] != 0;
      parent_[face] = root;
      turned_[face] = rest;
      rest ^= step;
      face = up;
    }
    return {root, turned};
  }
  // Whether the two may be glued so that one is turned against the other as said: not if they are known to be otherwise.
  bool compatible(int f, int g, bool turned) {
    const auto [rf, tf] = find(f);
    const auto [rg, tg] = find(g);
    return rf != rg || (tf ^ tg) == turned;
  }
  bool same(int f, int g) { return find(f).first == find(g).first; }
  void join(int f, int g, bool turned) {
    const auto [rf, tf] = find(f);
    const auto [rg, tg] = find(g);
    if (rf == rg) return;
    const int low = std::min(rf, rg), high = std::max(rf, rg);
    parent_[high] = low;
    turned_[high] = tf ^ tg ^ turned;
  }

 private:
  std::vector<int> parent_;
  std::vector<char> turned_;
};

class EdgePairing {
 public:
  EdgePairing(RepairMesh& mesh, const EdgeGroups& edges) : mesh_(mesh), edges_(edges), sets_(static_cast<int>(mesh.faces.size())) {}

  // The number of edges of more than two faces.
  int pair() {
    std::vector<int> crowded;
    edge_of_.assign(mesh_.half_edge_count(), -1);
    for (int e = 0; e < edges_.count(); ++e) {
      if (edges_.size(e) == 2) {
        glue(edges_.of(e)[0], edges_.of(e)[1]);
      } else if (edges_.size(e) > 2) {
        crowded.push_back(e);
        for (int i = 0; i < edges_.size(e); ++i) edge_of_[edges_.of(e)[i]] = e;
      }
    }
    // An edge at which fans end that begin at it has a pairing that suggests itself. From such edges on, pairs follow along chains of
    // crowded edges, as a pair closes fans at the next edge too.
    std::deque<int> ready;
    for (const int e : crowded)
      if (closes_fan(e)) ready.push_back(e);
    done_.assign(edges_.count(), 0);
    for (std::size_t next = 0; next < crowded.size() || !ready.empty();) {
      const bool follow = !ready.empty();
      const int e = follow ? ready.front() : crowded[next];
      follow ? ready.pop_front() : void(++next);
      if (done_[e]) continue;
      done_[e] = 1;
      pair_crowded(e, ready);
    }
    return static_cast<int>(crowded.size());
  }

 private:
  struct Candidate {
    int fans;  // closed by the pair
    bool one_sheet, opposite;
    double folding;  // cosine between the faces seen from the edge: -1 flat, 1 folded
    int h, g;
    bool operator<(const Candidate& c) const {
      return std::tuple(-fans, !one_sheet, !opposite, folding, h, g) < std::tuple(-c.fans, !c.one_sheet, !c.opposite, c.folding, c.h, c.g);
    }
  };
  // More faces at one edge than this are paired in parts; no scan has so many, but a hostile file may.
  static constexpr int most_at_once = 64;

  void glue(int h, int g) {
    mesh_.glue(h, g);
    sets_.join(h / 3, g / 3, mesh_.same_direction(h, g));
  }

  // The boundary half-edge at which the fan around `vertex` ends that begins at the boundary half-edge h.
  int fan_end(int h, int vertex) const {
    for (int steps = 0; steps < 256; ++steps) {
      const int f = h / 3;
      int other = -1;
      for (int g = 3 * f; g < 3 * f + 3; ++g)
        if (g != h && (mesh_.from(g) == vertex || mesh_.to(g) == vertex)) other = g;
      if (mesh_.mate[other] < 0) return other;
      h = mesh_.mate[other];
    }
    return -1;
  }

  bool closes_fan(int e) const {
    for (int i = 0; i < edges_.size(e); ++i) {
      const int h = edges_.of(e)[i];
      for (const int end : {fan_end(h, mesh_.from(h)), fan_end(h, mesh_.to(h))})
        if (end >= 0 && edge_of_[end] == e) return true;
    }
    return false;
  }

  Vec3 away(int h) const {
    const Vec3 &a = mesh_.position(mesh_.from(h)), &b = mesh_.position(mesh_.to(h)), &c = mesh_.position(mesh_.apex(h));
    const Vec3 along = (b - a).normalized();
    const Vec3 out = (c - a) - (c - a).dot(along) * along;
    return out.norm() > 0 ? out.normalized() : Vec3::Zero();
  }

  void pair_crowded(int e, std::deque<int>& ready) {
    const int* half_edges = edges_.of(e);
    const int count = edges_.size(e);
    std::vector<std::array<int, 2>> ends(count);
    for (int i = 0; i < count; ++i) {
      const int a = std::min(mesh_.from(half_edges[i]), mesh_.to(half_edges[i])), b = std::max(mesh_.from(half_edges[i]), mesh_.to(half_edges[i]));
      ends[i] = {fan_end(half_edges[i], a), fan_end(half_edges[i], b)};
      for (const int end : ends[i])
        if (end >= 0 && edge_of_[end] >= 0 && !done_[edge_of_[end]]) ready.push_back(edge_of_[end]);
    }
    for (int begin = 0; begin < count; begin += most_at_once) {
      const int end = std::min(begin + most_at_once, count);
      std::vector<Candidate> candidates;
      for (int i = begin; i < end; ++i)
        for (int j = i + 1; j < end; ++j) {
          const int h = half_edges[i], g = half_edges[j];
          const int fans = (ends[i][0] == g) + (ends[i][1] == g);
          candidates.push_back({fans, sets_.same(h / 3, g / 3), !mesh_.same_direction(h, g), away(h).dot(away(g)), h, g});
        }
      std::sort(candidates.begin(), candidates.end());
      for (const Candidate& c : candidates)
        if (mesh_.mate[c.h] < 0 && mesh_.mate[c.g] < 0 && sets_.compatible(c.h / 3, c.g / 3, mesh_.same_direction(c.h, c.g))) glue(c.h, c.g);
    }
  }

  RepairMesh& mesh_;
  const EdgeGroups& edges_;
  OrientationSets sets_;
  std::vector<int> edge_of_;  // of the half-edges at crowded edges
  std::vector<char> done_;
};

// Vertices around which the faces, joined by all their edges, fall into several parts.
std::int64_t count_pinched(const RepairMesh& mesh, const EdgeGroups& edges) {
  DisjointSets corners(mesh.half_edge_count());  // named by the half-edge that leaves them
  const auto corner = [&](int h, int vertex) { return mesh.from(h) == vertex ? h : TriangleSurface::next(h); };
  for (int e = 0; e < edges.count(); ++e) {
    const int h = edges.of(e)[0];
    for (int i = 1; i < edges.size(e); ++i)
      for (const int vertex : {mesh.from(h), mesh.to(h)}) corners.join(corner(edges.of(e)[i], vertex), corner(h, vertex));
  }
  std::vector<int> fans(mesh.origin.size(), 0);
  for (int c = 0; c < mesh.half_edge_count(); ++c)
    if (corners.is_representative(c)) ++fans[mesh.from(c)];
  return std::count_if(fans.begin(), fans.end(), [](int n) { return n > 1; });
}

}  // namespace

void pair_half_edges(RepairMesh& mesh, RepairReport& report) {
  mesh.mate.assign(3 * mesh.faces.size(), -1);
  const EdgeGroups edges = group_edges(
      static_cast<int>(mesh.origin.size()), mesh.half_edge_count(), [&](int h) { return mesh.from(h); }, [&](int h) { return mesh.to(h); });
  report.nonmanifold_vertices = count_pinched(mesh, edges);
  report.nonmanifold_edges = EdgePairing(mesh, edges).pair();
}

}  // namespace hybrid_mesh
