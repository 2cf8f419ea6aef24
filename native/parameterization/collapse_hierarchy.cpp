// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/collapse_hierarchy.h"

#include <algorithm>
#include <utility>

#include "parameterization/cone_motion.h"
#include "parameterization/relaxation_sweeps.h"

namespace hybrid_mesh {

CollapseHierarchy::CollapseHierarchy(ChartMesh& charts, const GlobalMapOptions& options, const std::vector<char>& allowed, GlobalMapReport& report)
    : c_(charts),
      options_(options),
      allowed_(allowed),
      report_(report),
      density_{options.theta},
      stars_(charts, density_),
      corners_(charts, density_) {}

// Collapses down to `target` vertices in passes over independent stars.
void CollapseHierarchy::collapse(int target) {
  struct Candidate {
    double cost;
    int vertex;
  };
  std::vector<Candidate> order;
  std::vector<char> locked(c_.points.size(), 0);
  std::vector<int> ring;
  while (c_.mesh.vertex_count > target) {
    order.clear();
    for (int v = 0; v < static_cast<int>(c_.points.size()); ++v) {
      locked[v] = 0;
      if (!c_.mesh.vertex_alive(v) || !c_.movable(v)) continue;
      double shortest = 1e300;
      int h = c_.mesh.out[v];
      do {
        shortest = std::min(shortest, c_.squared_length(v, c_.mesh.to(h)));
        h = c_.mesh.ccw(h);
      } while (h >= 0 && h != c_.mesh.out[v]);
      order.push_back({shortest, v});
    }
    std::sort(order.begin(), order.end(),
              [](const Candidate& a, const Candidate& b) { return a.cost != b.cost ? a.cost < b.cost : a.vertex < b.vertex; });
    // Only the shorter half: a pass over independent stars must not reach for long edges while short ones are locked.
    order.resize((order.size() + 1) / 2);
    const std::size_t before = log_.size();
    for (const Candidate& candidate : order) {
      const int v = candidate.vertex;
      if (locked[v]) continue;
      std::vector<std::pair<double, int>> halves;
      int h = c_.mesh.out[v];
      do {
        if (!c_.slides_inside(v) || c_.is_sharp(h)) halves.push_back({c_.squared_length(v, c_.mesh.to(h)), h});
        if (c_.mesh.is_boundary(v)) break;
        h = c_.mesh.ccw(h);
      } while (h >= 0 && h != c_.mesh.out[v]);
      std::sort(halves.begin(), halves.end());
      for (std::size_t i = 0; i < std::min(collapses_.ways, halves.size()); ++i) {
        const int half = halves[i].second;
        if (!c_.can_collapse(half) || !c_.collapse_keeps_map(half, collapses_.determinant, collapses_.shape)) continue;
        c_.mesh.ring(v, ring);
        for (const int w : ring) locked[w] = 1;
        c_.collapse(half);
        log_.push_back(half);
        break;
      }
      if (c_.mesh.vertex_count <= target) break;
    }
    if (log_.size() - before < collapses_.least_gone * c_.mesh.vertex_count + 1) {
      if (log_.size() > before) levels_.push_back(log_.size());
      break;
    }
    levels_.push_back(log_.size());
  }
}

void CollapseHierarchy::resume(std::vector<int> log) {
  log_ = std::move(log);
  // A sweep whenever the mesh has grown by a fifth.
  double vertices = c_.mesh.vertex_count;
  const double all = vertices + static_cast<double>(log_.size());
  while (vertices < all) {
    levels_.push_back(static_cast<std::size_t>(all - vertices));
    vertices *= 1.2;
  }
  std::reverse(levels_.begin(), levels_.end());
}

void CollapseHierarchy::refine(const Progress& progress) {
  int swept = c_.mesh.vertex_count;
  for (std::size_t level = levels_.size(); level-- > 0;) {
    const std::size_t begin = level > 0 ? levels_[level - 1] : 0;
    while (log_.size() > begin) {
      if (log_.size() % 4096 == 0) progress.check();
      undo_last();
    }
    if (c_.mesh.vertex_count > placement_.growth * swept || level == 0) {
      relax_in_sweeps(c_, density_, options_.sweeps, progress);
      swept = c_.mesh.vertex_count;
      const int rounds = std::clamp(options_.cone_rounds - 1, 0, 2);
      for (int round = 0; round < rounds; ++round) report_.cone_moves += move_cones(c_, density_, allowed_);
    }
    progress(1 - static_cast<double>(level) / levels_.size());
  }
}

void CollapseHierarchy::undo_last() {
  const int h = log_.back(), v = c_.mesh.from(h);
  log_.pop_back();
  const bool placed = c_.undo_collapse(h) || undo_past_cone(h);
  if (!placed) {
    const bool corner_near = options_.corners_move && !corners_.near(v).empty();
    const std::vector<Complex> before = corner_near ? c_.uv : std::vector<Complex>();
    if (!undo_with_rounder_ring(h) && !(corner_near && undo_past_corners(h, before))) {
      ++report_.unplaced;
      untangle(v);
    }
  }
  make_room(v);
}

// The vertex would come back into a fan of a full turn or more, for which a cone has room: the cone has to give way.
bool CollapseHierarchy::undo_past_cone(int h) {
  const int kept = c_.mesh.to(h);
  for (int tries = 0; tries < placement_.cone_tries && c_.kind[kept] == ChartMesh::Kind::Cone; ++tries) {
    c_.collapse(h);
    const bool evicted = evict_cone(c_, density_, kept) >= 0;
    if (c_.undo_collapse(h)) return true;
    if (!evicted) return false;
  }
  return false;
}

// Where its ring has no kernel, the ring is given the chance to become rounder first. False, too, where the map unfolded with the vertex in a place
// that is not its star's kernel.
bool CollapseHierarchy::undo_with_rounder_ring(int h) {
  const int v = c_.mesh.from(h), kept = c_.mesh.to(h);
  for (int tries = 0; tries < placement_.ring_tries && !unfolds_around(v, placement_.rings, placement_.patience); ++tries) {
    c_.collapse(h);
    std::vector<int> region{kept};
    c_.mesh.grow(region, placement_.rings + tries);
    for (int sweep = 0; sweep < placement_.ring_sweeps; ++sweep)
      for (const int w : region)
        if (c_.movable(w)) stars_.relax(w, true);
    if (c_.undo_collapse(h)) return true;
  }
  return false;
}

// Moves corners of the boundary near it. `before`: positions with which the map is unfolded once the vertex is gone.
bool CollapseHierarchy::undo_past_corners(int h, std::vector<Complex> before) {
  const int v = c_.mesh.from(h), kept = c_.mesh.to(h);
  const auto take_back = [&] {
    c_.collapse(h);
    c_.uv = before;
  };
  take_back();
  const bool placed = corners_.move_near(kept, [&](int) {
    before = c_.uv;
    if (c_.undo_collapse(h) || unfolds_around(v, placement_.rings, placement_.patience)) return true;
    take_back();
    return false;
  });
  return placed || c_.undo_collapse(h);
}

// Relaxes a vertex that has just come back, and where its triangles are squeezed its neighbours with it: the next ones to come back there would be
// squeezed more and more.
void CollapseHierarchy::make_room(int v) {
  std::vector<int> ring;
  for (int tries = 0; tries < placement_.room_tries; ++tries) {
    stars_.relax(v, tries > 0);
    double least = 1e300;
    int h = c_.mesh.out[v];
    do {
      least = std::min(least, c_.determinant(h / 3));
      h = c_.mesh.ccw(h);
    } while (h >= 0 && h != c_.mesh.out[v]);
    if (least > placement_.room) return;
    c_.mesh.ring(v, ring);
    for (const int w : ring)
      if (c_.movable(w)) stars_.relax(w, true);
  }
}

// The star of v has no kernel: its neighbours are moved until it has one.
bool CollapseHierarchy::unfolds_around(int v, int rings, int sweeps) {
  std::vector<int> region{v};
  c_.mesh.grow(region, rings);
  return stars_.unfold(region, sweeps);
}

void CollapseHierarchy::untangle(int v) {
  for (int rings = placement_.rings; rings <= placement_.most_rings; ++rings)
    if (unfolds_around(v, rings, rings < placement_.patient_rings ? placement_.patience : placement_.long_patience)) return;
  throw NoMap("the map could not be carried to a finer mesh");
}

}  // namespace hybrid_mesh
