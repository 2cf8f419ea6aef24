// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Tarini, Pietroni, Cignoni, Panozzo, Puppo, Practical quad mesh simplification, 2010; Daniels, Silva, Cohen, Localized
// quadrilateral coarsening, 2009 (the local operations).
#include "layout/base/quad_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "layout/base/closed_components.h"
#include "layout/base/loose_triangles.h"
#include "layout/base/quad_pairs.h"
#include "layout/base/triangle_pairing.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

constexpr double kLacking = 100;      // what it costs that a node on a feature gets a straight corner: more than any distance or shape
constexpr double kAlone = 10;         // what it costs that a triangle stays alone on the boundary ...
constexpr double kStraight = 100;     // ... and where the boundary is one of the curves, along which the corner that it gets is straight
constexpr double kSplitMirror = 500;  // what it costs that a triangle has no mate but its mirror image

class QuadCoarsening : private QuadPairs {
 public:
  QuadCoarsening(EditMesh& mesh, const std::vector<Vec3>& points, std::vector<VertexQuadric> quadrics, const QuadLayoutOptions& options,
                 std::vector<MeshEdit>& log)
      : QuadPairs(mesh, points, options.features, options.boundary_quads, options.on_mirror),
        quadrics_(std::move(quadrics)),
        options_(options),
        log_(log),
        components_(closed_components(mesh)),
        finished_(components_.faces.size(), 0) {}

  QuadLayout run(const Progress& progress) {
    list_live();
    pair_within_features();
    collapse_splits();
    double area = 0;
    for (const int v : vertices_) area += quadrics_[v].area * finer(v) * finer(v);
    side_ = std::sqrt(area / std::max(1.0, options_.size));
    clean_sparing_small_components();
    for (int rounds = 1; size() > options_.size && collapse_cheapest(); ++rounds) progress(0.9 * (1 - std::exp(-0.01 * rounds)));
    if (quad_count() > options_.least) {
      const State before = state();
      clean();
      if (quad_count() < options_.least || !small_components().empty()) restore(before);
    }
    progress(1);
    return layout_of(faces_, vertices_);
  }

 private:
  struct DiagonalCollapse {
    double cost = 1e300;
    int from = -1, to = -1, face = -1;
    bool operator<(const DiagonalCollapse& o) const { return std::tie(cost, face, from) < std::tie(o.cost, o.face, o.from); }
  };
  // Of a face, until something changes near it.
  struct Known {
    bool rests = false;     // no side of it is worth rotating
    bool is_stale = false;  // its ways to collapse, which are in the queue, may be others by now
    std::vector<DiagonalCollapse> ways;
  };
  struct State {
    std::size_t log = 0;
    std::vector<int> faces, mate, split;  // of the live faces
    std::vector<int> vertices;
    std::vector<VertexQuadric> quadrics;  // of the live vertices
  };
  State state() const {
    State s{log_.size(), faces_, {}, {}, vertices_, {}};
    for (const int f : faces_) s.mate.push_back(mate_[f]), s.split.push_back(split_[f]);
    for (const int v : vertices_) s.quadrics.push_back(quadrics_[v]);
    return s;
  }
  void restore(const State& state) {
    for (; log_.size() > state.log; log_.pop_back()) {
      if (log_.back().kind == MeshEdit::Kind::Collapse)
        mesh_.undo_collapse(log_.back().half_edge);
      else
        mesh_.undo_flip(log_.back().half_edge);
    }
    faces_ = state.faces;
    vertices_ = state.vertices;
    for (std::size_t i = 0; i < faces_.size(); ++i) mate_[faces_[i]] = state.mate[i], split_[faces_[i]] = state.split[i];
    for (const int f : faces_) forget_face(f);
    std::fill(may_be_doublet_.begin(), may_be_doublet_.end(), 1);
    for (std::size_t i = 0; i < vertices_.size(); ++i) quadrics_[vertices_[i]] = state.quadrics[i];
  }

  // The mesh is that of the whole surface, and hardly any of it is alive: sweeps go over lists. They hold all that is alive, in order; drop_dead()
  // follows every collapse.
  void list_live() {
    for (int f = 0; f < static_cast<int>(mesh_.alive.size()); ++f)
      if (mesh_.alive[f]) faces_.push_back(f);
    for (int v = 0; v < static_cast<int>(points_.size()); ++v)
      if (mesh_.vertex_alive(v)) vertices_.push_back(v);
  }
  void drop_dead() {
    std::erase_if(faces_, [&](int f) { return !mesh_.alive[f]; });
    std::erase_if(vertices_, [&](int v) { return !mesh_.vertex_alive(v); });
  }

  // --- counts -----------------------------------------------------------------------------------------------------------
  int quad_count() const {
    int faces = 0;
    for (const int f : faces_) faces += is_pair(f) ? 1 : 2;
    return faces / 2;
  }
  // Of a closed component.
  int quads_of(int component) const {
    int faces = 0;
    for (const int f : faces_)
      if (components_.of[mesh_.origin[3 * f]] == component) faces += is_pair(f) ? 1 : 2;
    return faces / 2;
  }
  // Closed ones with fewer quads than a cube.
  std::vector<int> small_components() const {
    std::vector<int> small;
    for (int c = 0; c < static_cast<int>(components_.faces.size()); ++c)
      if (quads_of(c) < kLeastClosedQuads) small.push_back(c);
    return small;
  }
  double size() const {
    int sides = 0;
    for (const int f : faces_)
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (mesh_.opposite[h] < 0 && !(is_on_mirror(mesh_.from(h)) && is_on_mirror(mesh_.to(h)))) sides += split_[f] == h ? 2 : 1;
    return quad_count() + options_.boundary_side * sides;
  }
  void pair_within_features() {
    // What stays collapsed leaves other pairs to choose from.
    constexpr int tries = 6;
    for (int k = 0; k < tries; ++k) {
      pair();
      if (pair_loose_triangles(mesh_, points_, features_, faces_, mate_, log_)) pair();
      if (!collapse_pairs_across()) return;
    }
    throw NoMap("the triangles between sharp edges cannot be paired");
  }

  // A triangle alone gets a node between the two ends of its boundary edge, which is a quad's alone, with a straight angle: the triangle goes
  // instead, with that edge.
  void collapse_splits() {
    for (const int f : std::vector<int>(faces_)) {
      if (!mesh_.alive[f] || is_pair(f)) continue;
      const int h = split_[f];
      if (can_collapse_on_feature(h)) collapse(h);
    }
    drop_dead();
  }

  void pair() {
    std::vector<int> index(mesh_.alive.size(), -1);
    for (std::size_t i = 0; i < faces_.size(); ++i) index[faces_[i]] = static_cast<int>(i);
    std::vector<PairCandidate> candidates;
    std::vector<int> halves;
    for (const int f : faces_)
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int o = mesh_.opposite[h];
        if (o >= 0 && o < h) continue;
        if (o < 0) {
          if (!options_.boundary_quads.empty()) continue;
          const bool is_mirror = is_on_mirror(mesh_.from(h)) && is_on_mirror(mesh_.to(h));
          candidates.push_back({index[f], -1, is_mirror ? -kSplitMirror : features_.on(mesh_, h) ? -kStraight : -kAlone});
        } else {
          double b = badness({mesh_.from(h), mesh_.apex(o), mesh_.to(h), mesh_.apex(h)});
          b = features_.on(mesh_, h) ? cost_across(h) : b + diagonal_energy(h) + diagonal_energy(o);
          candidates.push_back({index[f], index[o / 3], -b});
        }
        halves.push_back(h);
      }
    const std::vector<int> choice = pair_triangles(static_cast<int>(faces_.size()), candidates);
    mate_.assign(mesh_.alive.size(), -1);
    split_.assign(mesh_.alive.size(), -1);
    slot_.assign(mesh_.alive.size(), -1);
    for (std::size_t i = 0; i < faces_.size(); ++i) slot_[faces_[i]] = static_cast<int>(i);
    known_.assign(faces_.size(), {});
    queue_.clear(), stale_.clear();
    for (const int f : faces_) forget_face(f);
    may_be_doublet_.assign(points_.size(), 1);
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const PairCandidate& c = candidates[choice[i]];
      const int f = faces_[i];
      if (c.b < 0) {
        mate_[f] = f;
        split_[f] = halves[choice[i]];
      } else {
        mate_[f] = faces_[c.a] == f ? faces_[c.b] : faces_[c.a];
      }
    }
  }

  // Triangles on both sides of a feature make no quad. Where the number of triangles between features leaves no other way for some, these are taken
  // away together, with the edge between them.
  // Returns whether there are some left.
  bool collapse_pairs_across() {
    bool stuck = false;
    for (const int f : std::vector<int>(faces_)) {
      if (!mesh_.alive[f] || !is_pair(f) || !features_.on(mesh_, diagonal(f))) continue;
      const int h = diagonal(f), o = mesh_.opposite[h];
      const bool forth = can_collapse_on_feature(h), back = can_collapse_on_feature(o);
      if (!forth && !back)
        stuck = true;
      else
        collapse(!back || (forth && features_.keeps_room(mesh_, h)) ? h : o);
    }
    drop_dead();
    return stuck;
  }

  // --- local operations ------------------------------------------------------------------------------------------------------
  bool flip(int h) {
    if (!mesh_.can_flip(h)) return false;
    const std::array<int, 4> corners{mesh_.from(h), mesh_.to(h), mesh_.apex(h), mesh_.apex(mesh_.opposite[h])};
    mesh_.flip(h);
    log_.push_back({MeshEdit::Kind::Flip, h});
    for (const int v : corners) forget(v);
    return true;
  }
  // Makes the diagonal of f's quad touch vertex v.
  bool diagonal_at(int f, int v) {
    const int d = diagonal(f);
    if (mesh_.from(d) == v || mesh_.to(d) == v) return true;
    return flip(d);
  }
  void collapse(int h) {
    const int v = mesh_.from(h), u = mesh_.to(h);
    quadrics_[u].planes += quadrics_[v].planes;
    quadrics_[u].area += quadrics_[v].area;
    forget_face(h / 3);
    if (mesh_.opposite[h] >= 0) forget_face(mesh_.opposite[h] / 3);
    mesh_.collapse(h);
    log_.push_back({MeshEdit::Kind::Collapse, h});
    mesh_.ring(u, ring_);
    forget(u);
    for (const int w : std::vector<int>(ring_)) forget(w);
  }

  double finer(int v) const { return options_.fineness.empty() ? 1.0 : options_.fineness[v]; }

  Known& known(int f) { return known_[slot_[f]]; }
  void forget_face(int f) {
    Known& k = known(f);
    k.rests = false;
    if (!std::exchange(k.is_stale, true)) stale_.push_back(f);
  }
  // What is known of the quads around a vertex, and of those that touch them, holds no longer.
  void forget(int v) {
    may_be_doublet_[v] = 1;
    for_faces_at(v, [&](int f) {
      for (const int g : {f, mate_[f]}) {
        if (!mesh_.alive[g]) continue;
        for (int i = 0; i < 3; ++i) for_faces_at(mesh_.origin[3 * g + i], [&](int near) { forget_face(near), forget_face(mate_[near]); });
      }
    });
  }

  // Does a vertex keep one of the mirror from having a quad alone?
  bool keeps_from_straight(int v) {
    if (options_.on_mirror.empty()) return false;
    mesh_.ring(v, ring_);
    return std::any_of(ring_.begin(), ring_.end(), [&](int w) { return is_inside_mirror(w) && excess(w) <= 0 && !is_diagonal(mesh_.find(v, w)); });
  }
  // An interior vertex between two quads only: the quads become one.
  bool remove_doublet(int v) {
    may_be_doublet_[v] = !mesh_.is_boundary(v) && !features_.is_on_curve(v) && excess(v) == -2;
    if (!may_be_doublet_[v] || keeps_from_straight(v) || (has_bodies() && is_finished(components_.of[v]))) return false;
    std::vector<int> faces;
    int h = mesh_.out[v];
    do {
      if (!is_pair(h / 3)) return false;
      faces.push_back(h / 3);
      faces.push_back(mate_[h / 3]);
      h = mesh_.ccw(h);
    } while (h != mesh_.out[v]);
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    if (faces.size() != 4) return false;
    h = mesh_.out[v];
    do {
      if (mesh_.can_collapse(h)) {
        collapse(h);
        std::vector<int> left;
        for (const int f : faces)
          if (mesh_.alive[f]) left.push_back(f);
        mate_[left[0]] = left[1];
        mate_[left[1]] = left[0];
        for (const int f : left)
          for (int i = 0; i < 3; ++i) forget(mesh_.origin[3 * f + i]);
        return true;
      }
      h = mesh_.ccw(h);
    } while (h != mesh_.out[v]);
    return false;
  }

  struct Rotation {
    int half_edge = -1;
    bool left = false;  // the new edge joins the corner after the edge's end to the one after its start (seen from each quad)
    double gain = 0;
  };

  Rotation best_rotation(int g) const {
    Rotation best;
    const int o = mesh_.opposite[g];
    if (o < 0 || features_.on(mesh_, g) || is_diagonal(g) || !is_pair(g / 3) || !is_pair(o / 3)) return best;
    if (mate_[g / 3] == o / 3 || g / 3 == mate_[o / 3]) return best;
    const Corners q1 = corners(g), q2 = corners(o);
    const int a = q1.v[0], d = q1.v[1], e = q1.v[2], f = q1.v[3], b = q2.v[2], c = q2.v[3];
    const std::set<int> distinct{a, b, c, d, e, f};
    if (distinct.size() != 6) return best;
    const auto gained = [&](int h, int change) { return sector_energy(h, 0) - sector_energy(h, change); };
    const double shape = badness(q1.v) + badness(q2.v);
    const double lost = gained(g, -1) + gained(o, -1);
    const auto consider = [&](bool left, int x, int y, const std::array<int, 4>& n1, const std::array<int, 4>& n2) {
      const double valence = lost + gained(half_at(g / 3, x), 1) + gained(half_at(o / 3, y), 1);
      const double change = shape - badness(n1) - badness(n2);
      const double gain = valence + 1.5 * change;
      if (is_on_mirror(x) && is_on_mirror(y)) return;
      if (gain > best.gain + 1e-9) best = {g, left, gain};
    };
    consider(true, e, b, {e, f, a, b}, {b, c, d, e});
    consider(false, f, c, {f, a, b, c}, {c, d, e, f});
    return best;
  }

  bool rotate(const Rotation& r) {
    const int g = r.half_edge, o = mesh_.opposite[g];
    const int f1 = g / 3, f2 = o / 3;
    // The rotated edge is flipped between two triangles; first the diagonals are turned so that those have the new edge's ends as apexes.
    const int a = mesh_.from(g), d = mesh_.to(g);
    if (!diagonal_at(f1, r.left ? a : d) || !diagonal_at(f2, r.left ? d : a)) return false;
    int h = mesh_.find(a, d);
    if (h < 0 || !mesh_.can_flip(h)) return false;
    const int x = h / 3, y = mesh_.opposite[h] / 3;
    const int xm = mate_[x], ym = mate_[y];
    if (!flip(h)) return false;
    if (!r.left) {
      mate_[x] = ym, mate_[ym] = x;
      mate_[y] = xm, mate_[xm] = y;
    }
    for (const int f : {x, y, xm, ym})
      for (int i = 0; i < 3; ++i) forget(mesh_.origin[3 * f + i]);
    return true;
  }

  // Merges `from` into `to`, opposite corners of face f's quad.
  double diagonal_cost(int face, int from, int to, int x, int y) const {
    if (mesh_.is_boundary(from) || features_.is_on_curve(from)) return 1e300;
    const Vec3& target = points_[to];
    const double area = quadrics_[from].area + quadrics_[to].area;
    double error = (quadrics_[from].planes(target) + quadrics_[to].planes(target)) / std::max(area, 1e-300);
    // Shape of the quads around `from` once it has moved.
    double worst = 0, total = 0, longest = 0;
    int count = 0;
    int h = mesh_.out[from];
    do {
      if (!is_diagonal(h)) {
        std::array<int, 4> q = corners(h).v;
        if (!is_pair(h / 3)) return 1e300;
        if (const int w = mesh_.to(h); is_on_mirror(to) && is_on_mirror(w) && w != x && w != y) return 1e300;
        if (std::find(q.begin(), q.end(), to) == q.end()) {
          const double before = badness(q);
          std::replace(q.begin(), q.end(), from, to);
          const double after = badness(q);
          worst = std::max(worst, after);
          total += after - before;
          ++count;
          longest = std::max({longest, (points_[q[1]] - points_[q[0]]).squaredNorm(), (points_[q[3]] - points_[q[0]]).squaredNorm()});
        }
      }
      h = mesh_.ccw(h);
    } while (h != mesh_.out[from]);
    // Quads of `from` that `to` takes over, beside the regular number.
    const int added = excess(from) + (mesh_.is_boundary(to) && !features_.is_on_curve(to) ? 1 : 2);
    if (!features_.is_on_curve(to) && excess(to) + added > 3) return 1e300;
    // The last resort.
    double lacking = 0;
    for (const int v : {x, y}) lacking += (features_.is_on_curve(v) || is_inside_mirror(v)) && lacks_quads(half_at(face, v), 1);
    const auto change = [&](int v, int by) { return sector_energy(half_at(face, v), by) - sector_energy(half_at(face, v), 0); };
    const double valence = change(to, added) + change(x, -1) + change(y, -1) - valence_energy(excess(from));
    const double side = side_ / fineness_on_edge(options_.fineness, from, to), scale = side * side;
    return error / scale + 0.02 * longest / scale + 0.05 * std::max(0.0, total) + 0.03 * std::max(0.0, worst - 2) + 0.03 * valence +
           kLacking * lacking;
  }

  // Brings the ways to collapse quads near which something has changed up to date.
  void refresh_queue() {
    for (const int f : stale_) {
      Known& k = known(f);
      for (const DiagonalCollapse& c : k.ways) queue_.erase(c);
      k.ways.clear();
      k.is_stale = false;
      if (!mesh_.alive[f] || !is_pair(f) || mate_[f] < f) continue;
      const int d = diagonal(f);
      const int x = mesh_.from(d), y = mesh_.to(d), p = mesh_.apex(d), q = mesh_.apex(mesh_.opposite[d]);
      for (const DiagonalCollapse& c : {DiagonalCollapse{diagonal_cost(f, x, y, p, q), x, y, f},
                                        {diagonal_cost(f, y, x, p, q), y, x, f},
                                        {diagonal_cost(f, p, q, x, y), p, q, f},
                                        {diagonal_cost(f, q, p, x, y), q, p, f}})
        if (c.cost < 1e299) k.ways.push_back(c);
      queue_.insert(k.ways.begin(), k.ways.end());
    }
    stale_.clear();
  }

  // Collapses the cheapest diagonal that leaves enough quads, and cleans up.
  bool collapse_cheapest() {
    refresh_queue();
    for (const DiagonalCollapse& c : queue_) {
      const int component = components_.of[c.from];
      if (is_finished(component)) continue;
      // Few quads may clean each other away.
      constexpr int some = 8;
      const bool last_ones = quad_count() < 2 * options_.least + some,
                 last_of_component = component >= 0 && quads_of(component) < 2 * kLeastClosedQuads + some;
      const State before = last_ones || last_of_component ? state() : State{};
      if (!diagonal_at(c.face, c.from)) continue;
      const int h = mesh_.find(c.from, c.to);
      if (h < 0 || !mesh_.can_collapse(h)) continue;
      collapse(h);
      drop_dead();
      clean();
      const bool too_few = last_ones && quad_count() < options_.least;
      const bool component_is_done = last_of_component && quads_of(component) < kLeastClosedQuads;
      if (!too_few && !component_is_done) return true;
      restore(before);
      if (too_few) return false;
      finished_[component] = 1;
    }
    return false;
  }

  bool has_bodies() const { return components_.faces.size() > 1; }
  bool is_finished(int component) const { return component >= 0 && finished_[component]; }

  // The triangles of a small closed body may pair to quads that clean each other away. Of a lone one another base is tried then, with other
  // near-ties.
  void clean_sparing_small_components() {
    const State before = state();
    clean();
    const std::vector<int> small = has_bodies() ? small_components() : std::vector<int>();
    for (const int c : small) finished_[c] = 1;
    if (small.empty()) return;
    restore(before);
    clean();
  }

  // Removes doublets and rotates edges where that gains, until nothing changes.
  void clean() {
    for (int sweep = 0; sweep < 50; ++sweep) {
      bool changed = false;
      for (const int v : vertices_)
        if (may_be_doublet_[v] && mesh_.vertex_alive(v)) changed |= remove_doublet(v);
      drop_dead();
      for (const int f : faces_) {
        if (known(f).rests) continue;
        bool rests = true;
        for (int h = 3 * f; h < 3 * f + 3; ++h) {
          if (mesh_.opposite[h] < h) continue;
          const Rotation r = best_rotation(h);
          if (r.half_edge < 0 || r.gain <= 0.05) continue;
          rests = false;
          if (rotate(r)) changed = true;
        }
        known(f).rests = rests;
      }
      if (!changed) return;
    }
  }

  std::vector<VertexQuadric> quadrics_;
  const QuadLayoutOptions& options_;
  std::vector<MeshEdit>& log_;
  ClosedComponents components_;        // as the mesh was first
  std::vector<char> finished_;         // per closed component: it has no quad to give away, and keeps its doublets
  std::vector<int> faces_, vertices_;  // that are alive, see list_live()
  std::vector<int> slot_;              // per face that was there when they were paired: its place in known_
  std::vector<Known> known_;
  std::set<DiagonalCollapse> queue_;  // of all quads but those of stale faces
  std::vector<char> may_be_doublet_;  // per vertex: it is one, or something has changed at it
  std::vector<int> stale_, ring_;
  double side_ = 1;
};

}  // namespace

QuadLayout make_quad_layout(EditMesh& mesh, const std::vector<Vec3>& points, std::vector<VertexQuadric> quadrics, const QuadLayoutOptions& options,
                            std::vector<MeshEdit>& log, const Progress& progress) {
  return QuadCoarsening(mesh, points, std::move(quadrics), options, log).run(progress);
}

}  // namespace hybrid_mesh
