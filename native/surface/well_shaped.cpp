// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Rivara, Hitschfeld, Simpson, Terminal-edges Delaunay (small-angle based) algorithm for the quality triangulation problem, 2001 (which
// edge is split); Ruppert, A Delaunay refinement algorithm for quality 2-dimensional mesh generation, 1995 (edges that are encroached upon; splits
// near corners).
#include "surface/well_shaped.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

#include "surface/guarded_mesh.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

class Shaping {
 public:
  Shaping(const TriangleSurface& input, const WellShapedOptions& options, const Progress& progress)
      : options_(options),
        progress_(progress),
        sizes_(input.sizes.get()),
        mesh_(input, {options.tolerance, options.sharp_angle}),
        least_angle_(radians(options.least_angle)),
        stamp_(input.faces.size(), 0) {
    mesh_.release(std::vector<char>(input.faces.size(), 1));
    std::vector<char> released = needle_regions(mesh_, options.needles);
    for (std::size_t f = 0; f < options.held.size(); ++f) released[f] = released[f] && !options.held[f];
    mesh_.release(std::move(released));
  }

  void run() {
    flip_bad();
    collapse_bad();
    refine();
  }

  const GuardedMesh& mesh() const { return mesh_; }
  bool changed() const { return changed_; }

 private:
  struct Candidate {
    double key;
    int face;
    int stamp;
    bool operator<(const Candidate& o) const { return key != o.key ? key < o.key : face > o.face; }
  };

  bool alive(int f) const { return mesh_.mesh().alive[f]; }
  bool is_thin(int f) const { return mesh_.is_released(f) && mesh_.smallest_angle(f) < least_angle_; }
  void touch(int f) {
    stamp_.resize(mesh_.face_count(), 0);
    ++stamp_[f];
    changed_ = true;
  }

  // Flips what edges on the stack and then those around them become better by. Faces that were changed go into `touched_`.
  void flip_around(std::vector<int>& edges, bool only_thin) {
    while (!edges.empty()) {
      const int h = edges.back(), o = mesh_.mesh().opposite[h];
      edges.pop_back();
      if (o < 0 || !alive(h / 3) || (only_thin && !is_thin(h / 3) && !is_thin(o / 3)) || !mesh_.flip(h)) continue;
      for (const int g : {h, o}) {
        touch(g / 3);
        touched_.push_back(g / 3);
        edges.push_back(EditMesh::next(g));
        edges.push_back(EditMesh::prev(g));
      }
    }
  }

  void flip_bad() {
    progress_.check();
    std::vector<int> edges;
    for (int f = 0; f < mesh_.face_count(); ++f) {
      if (!is_thin(f)) continue;
      edges = {3 * f, 3 * f + 1, 3 * f + 2};
      flip_around(edges, true);
    }
    touched_.clear();
  }

  // Collapses the short edges of bad triangles, the shortest first.
  void collapse_bad() {
    std::priority_queue<Candidate> heap;
    const auto push = [&](int f) {
      if (!is_thin(f)) return;
      const double length = mesh_.length(mesh_.shortest(f));
      if (length < options_.collapsible) heap.push({-length, f, stamp_[f]});
    };
    for (int f = 0; f < mesh_.face_count(); ++f)
      if (alive(f)) push(f);
    std::vector<int> edges;
    for (std::int64_t steps = 0; !heap.empty(); ++steps) {
      if (steps % 1024 == 0) progress_.check();
      const Candidate best = heap.top();
      heap.pop();
      if (!alive(best.face) || stamp_[best.face] != best.stamp) continue;
      const int h = mesh_.shortest(best.face), o = mesh_.mesh().opposite[h];
      const int a = mesh_.mesh().from(h), b = mesh_.mesh().to(h);
      const int kept = mesh_.collapse(h, least_angle_) ? b : o >= 0 && mesh_.collapse(o, least_angle_) ? a : -1;
      if (kept < 0) continue;
      touched_.clear();
      edges.clear();
      for (int g = mesh_.mesh().out[kept];;) {
        touch(g / 3);
        touched_.push_back(g / 3);
        edges.push_back(g);
        edges.push_back(EditMesh::next(g));
        g = mesh_.mesh().ccw(g);
        if (g < 0 || g == mesh_.mesh().out[kept]) break;
      }
      flip_around(edges, true);
      for (const int f : touched_) push(f);
    }
  }

  bool is_too_long(int h) const {
    const double length = mesh_.length(h);
    if (!sizes_) return length > options_.longest_edge;
    const Vec3 middle = 0.5 * (mesh_.point(mesh_.mesh().from(h)) + mesh_.point(mesh_.mesh().to(h)));
    return length * sizes_->fineness(middle) > options_.longest_edge;
  }

  // --- refinement ----------------------------------------------------------------------------------------------------------------
  bool is_bad(int f) const {
    if (is_too_long(mesh_.longest(f))) return true;
    if (!mesh_.is_released(f)) return false;
    const int corner = mesh_.smallest_corner(f);
    const double angle = mesh_.corner_angle(corner);
    if (angle >= least_angle_) return false;
    const int sides[2] = {corner, EditMesh::prev(corner)};
    const bool held[2] = {mesh_.is_held(sides[0]), mesh_.is_held(sides[1])};
    if (held[0] && held[1]) return false;  // an angle that the input has: no splits would make it larger
    for (int i = 0; i < 2; ++i)
      if (held[i] && !mesh_.is_curve(sides[i])) return angle < radians(options_.least_bent_angle);
    return true;
  }

  // The edge whose split is to mend the face: the longest of the faces around that are ever larger, or a held edge beside it, near which its middle
  // would lie.
  int edge_to_split(int f) const {
    int h = mesh_.longest(f);
    for (;;) {
      const int o = mesh_.mesh().opposite[h];
      if (o < 0 || mesh_.is_held(h)) return h;
      const int g = mesh_.longest(o / 3);
      if (!(mesh_.length(g) > (1 + 1e-12) * mesh_.length(h))) break;
      h = g;
    }
    const Vec3 middle = 0.5 * (mesh_.point(mesh_.mesh().from(h)) + mesh_.point(mesh_.mesh().to(h)));
    int best = h;
    double most = 0;
    for (const int side : {h, mesh_.mesh().opposite[h]})
      for (const int g : {EditMesh::next(side), EditMesh::prev(side)}) {
        const Vec3 a = mesh_.point(mesh_.mesh().from(g)) - middle, b = mesh_.point(mesh_.mesh().to(g)) - middle;
        const double into = -a.dot(b) / (a.norm() * b.norm());
        if (into > most && mesh_.length(g) > 2 * options_.shortest_edge && mesh_.is_held(g)) most = into, best = g;
      }
    return best;
  }

  // Do held edges meet at from(h), of which h is one, at less than the angle of a small corner?
  bool is_small_corner(int h) const {
    const EditMesh& m = mesh_.mesh();
    const double least = radians(options_.small_corner);
    double angle = 0;
    for (int g = h; angle < least;) {
      angle += mesh_.corner_angle(g);
      g = m.ccw(g);
      if (g < 0) break;
      if (g == h || angle >= least) break;
      if (mesh_.is_curve(g)) return true;
    }
    angle = 0;
    for (int g = h; angle < least;) {
      g = m.cw(g);
      if (g < 0 || g == h) break;
      angle += mesh_.corner_angle(g);
      if (angle < least && mesh_.is_curve(g)) return true;
    }
    return false;
  }

  // Curves that leave a small corner are split at powers of two, so that no split of one asks for a split of the other.
  double fraction_of(int h) const {
    if (!mesh_.is_curve(h)) return 0.5;
    const int o = mesh_.mesh().opposite[h];
    const bool at_from = is_small_corner(h), at_to = o >= 0 && is_small_corner(o);
    if (at_from == at_to) return 0.5;
    const double length = mesh_.length(h);
    double shell = std::exp2(std::floor(std::log2(length / 1.5)));  // between a third and two thirds
    if (shell < length / 3) shell *= 2;
    return at_from ? shell / length : 1 - shell / length;
  }

  void refine() {
    std::priority_queue<Candidate> heap;
    const auto push = [&](int f) {
      if (is_bad(f)) heap.push({mesh_.length(mesh_.longest(f)), f, stamp_[f]});
    };
    for (int f = 0; f < mesh_.face_count(); ++f)
      if (alive(f)) push(f);
    std::vector<int> edges;
    for (std::int64_t steps = 0; !heap.empty() && mesh_.mesh().vertex_count < options_.most_points; ++steps) {
      if (steps % 1024 == 0) progress_.check();
      const Candidate best = heap.top();
      heap.pop();
      if (stamp_[best.face] != best.stamp) continue;
      const int h = edge_to_split(best.face);
      if (mesh_.length(h) < 2 * options_.shortest_edge) continue;
      const int m = mesh_.split(h, fraction_of(h));
      touched_.clear();
      edges.clear();
      for (int g = mesh_.mesh().out[m];;) {
        touch(g / 3);
        touched_.push_back(g / 3);
        edges.push_back(g);
        edges.push_back(EditMesh::next(g));
        g = mesh_.mesh().ccw(g);
        if (g < 0 || g == mesh_.mesh().out[m]) break;
      }
      flip_around(edges, false);
      if (stamp_[best.face] == best.stamp) touched_.push_back(best.face);
      for (const int f : touched_) push(f);
    }
  }

  const WellShapedOptions& options_;
  const Progress& progress_;
  const SizeField* sizes_;
  GuardedMesh mesh_;
  double least_angle_;
  std::vector<int> stamp_;    // per face: its changes
  std::vector<int> touched_;  // faces that the last operation changed, some repeatedly
  bool changed_ = false;
};

}  // namespace

WellShaped make_well_shaped(const TriangleSurface& input, const WellShapedOptions& options, const Progress& progress) {
  Shaping shaping(input, options, progress);
  shaping.run();
  WellShaped result;
  result.mesh = shaping.mesh().packed(result.place);
  result.unchanged = !shaping.changed();
  result.query = shaping.mesh().query_of_input();
  return result;
}

}  // namespace hybrid_mesh
