// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Garland, Heckbert, Surface simplification using quadric error metrics, 1997 (the error measure).
#include "layout/base/decimation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "decoder/disjoint_sets.h"
#include "layout/base/closed_components.h"
#include "layout/base/curve_classes.h"
#include "layout/base/jitter.h"
#include "layout/base/loose_triangles.h"
#include "layout/base/vertex_star.h"
#include "surface/size_field.h"

namespace hybrid_mesh {
namespace {

// Of a closed component: enough for its quads to be paired and cleaned up.
constexpr int kLeastClosedFaces = 4 * kLeastClosedQuads;
// ... and where curves bound its quads, which are not cleaned up: those of a cube.
constexpr int kLeastFacesBetweenCurves = 2 * kLeastClosedQuads;

// The cheapest collapse that takes a vertex away; half_edge -1: there is none.
struct Candidate {
  double cost = std::numeric_limits<double>::infinity();
  int vertex = -1, half_edge = -1;
  std::uint32_t stamp = 0;
};
// The heap's order: the cheapest on top. Costs may tie, vertices do not.
bool is_dearer(const Candidate& a, const Candidate& b) { return a.cost != b.cost ? a.cost > b.cost : a.vertex > b.vertex; }

constexpr double kMuchLonger = 1.65;    // times the edges that curves are to have, from where on their length decides
constexpr int kLeastOnMirror = 3;       // triangles at its vertices
constexpr int kLeastOfClosedCurve = 4;  // edges: with fewer the quads beside it have straight corners
constexpr int kLeastOfLoop = 3;         // of a curve from a corner to itself: with fewer it is none in a simplicial mesh

// When so many times the faces asked for are left, the base takes shape.
constexpr double kShapingFaces = 12;
// From so many faces on the order of collapses is kept exact, so that the base does not depend on how the queue works; before that single collapses
// of a fine surface matter little, and exactness would take two thirds of the time.
constexpr int kExactFaces = 120000;

class Decimation {
 public:
  Decimation(EditMesh& mesh, const std::vector<Vec3>& points, const DecimationOptions& options, std::vector<MeshEdit>& log)
      : mesh_(mesh), points_(points), options_(options), log_(log), quadrics_(points.size()), components_(closed_components(mesh)) {
    valences_.assign(points.size(), 0);
    if (options.fixed.empty()) find_loops();
    if (!features().empty()) count_curve_edges();
    queued_.assign(points.size(), Queued::No);
    stamps_.assign(points.size(), 0);
    for (std::size_t f = 0; f < mesh.alive.size(); ++f)
      if (mesh.alive[f]) add_face(mesh, points, static_cast<int>(f), quadrics_);
    for (std::size_t v = 0; v < points.size(); ++v)
      if (mesh.vertex_alive(static_cast<int>(v))) {
        valences_[v] = mesh.valence(static_cast<int>(v));
        loose_ += is_loose(static_cast<int>(v));
      }
  }

  void run(const Progress& progress) {
    const int initial = mesh_.face_count;
    int next_refill = static_cast<int>(0.7 * std::min<double>(initial, kShapingFaces * options_.target_faces));
    refill();
    int steps = 0;
    while (mesh_.face_count > options_.target_faces || loose_ > 0) {
      if (heap_.empty() && !loop_.empty() && !shaping_) begin_shaping();
      if (heap_.empty()) break;
      if (++steps % 512 == 0)
        progress(std::clamp((std::log(initial) - std::log(mesh_.face_count)) / std::max(1e-9, std::log(initial) - std::log(options_.target_faces)),
                            0.0, 1.0));
      const Candidate best = pop();
      if (best.half_edge < 0 || (mesh_.face_count <= options_.target_faces && !is_loose(best.vertex))) continue;
      collapse(best.half_edge);
      if (mesh_.face_count <= next_refill) {
        next_refill = static_cast<int>(0.7 * mesh_.face_count);
        begin_shaping();
      }
    }
    if (!features().empty()) balance_curves();
    dress_mirror();
    progress(1);
  }

  std::vector<VertexQuadric> take_quadrics() { return std::move(quadrics_); }

 private:
  const MeshFeatures& features() const {
    static const MeshFeatures none;
    return options_.features ? *options_.features : none;
  }

  // Boundary loops and feature curves that meet have one number.
  void find_loops() {
    loop_ = mesh_.boundary_loops();
    if (!features().empty()) {
      DisjointSets sets(points_.size());
      for (int h = 0; h < static_cast<int>(mesh_.origin.size()); ++h)
        if (mesh_.alive[h / 3] && (mesh_.opposite[h] < 0 || features().on(mesh_, h))) sets.join(mesh_.from(h), mesh_.to(h));
      for (int v = 0; v < static_cast<int>(points_.size()); ++v) loop_[v] = loop_[v] >= 0 || features().is_on_curve(v) ? sets.find(v) : -1;
    }
    if (std::all_of(loop_.begin(), loop_.end(), [](int loop) { return loop < 0; })) loop_.clear();
  }

  void count_curve_edges() {
    curve_edges_.assign(features().curve_count(), 0);
    least_edges_.assign(features().curve_count(), kLeastOfClosedCurve);
    std::vector<int> end(features().curve_count(), -1);
    for (int h = 0; h < static_cast<int>(mesh_.origin.size()); ++h)
      if (mesh_.alive[h / 3] && (mesh_.opposite[h] < 0 || mesh_.opposite[h] > h) && features().on(mesh_, h)) {
        const int curve = features().curves()[mesh_.edge[h]];
        ++curve_edges_[curve];
        for (const int v : {mesh_.from(h), mesh_.to(h)})
          if (features().is_corner(v)) {
            least_edges_[curve] = end[curve] < 0 || (end[curve] == v && least_edges_[curve] > 1) ? kLeastOfLoop : 1;
            end[curve] = v;
          }
      }
  }

  // Opposite sides get the same number of edges, curves edges of the length that they are to have, and pieces between curves an even number of
  // triangles. How short a curve can be depends on the others: of two that have both ends in common and nothing between them one has two edges. Where
  // some cannot be as short as is wanted, all is taken back, and the numbers are chosen anew.
  void balance_curves() {
    constexpr int tries = 8;
    std::vector<int> least = least_edges_;
    for (int f = 0; f < static_cast<int>(mesh_.alive.size()); ++f)
      if (mesh_.alive[f]) live_.push_back(f);
    const State before{log_.size(), valences_, quadrics_, curve_edges_, components_.faces, loose_};
    for (int k = 1;; ++k) {
      CurveClasses classes = curve_classes(mesh_, points_, features(), options_.fineness);
      std::vector<int> wanted = least;
      for (const std::vector<int>& curves : classes.curves) {
        int fewest = std::numeric_limits<int>::max();
        for (const int c : curves) fewest = std::min(fewest, classes.edges[c]);
        for (const int c : curves) wanted[c] = std::max(wanted[c], fewest);
      }
      shorten_to(classes, wanted);
      classes = curve_classes(mesh_, points_, features(), options_.fineness);
      wanted = wanted_edges(classes, least);
      const std::vector<int> edges = shorten_to(classes, wanted);
      if (edges == wanted || k == tries) return;
      for (std::size_t c = 0; c < edges.size(); ++c)
        if (edges[c] > wanted[c]) least[c] = edges[c];
      restore(before);
    }
  }
  std::vector<int> shorten_to(const CurveClasses& classes, const std::vector<int>& wanted) {
    std::vector<int> edges = classes.edges;  // in the end as many as there are then
    for (bool any = true; any;) {            // what keeps one from being shorter may go with another
      any = false;
      for (const std::vector<int>& curves : classes.curves)
        for (const int c : curves)
          for (; edges[c] > wanted[c] && shorten(c); --edges[c]) any = true;
    }
    return edges;
  }
  // How many edges each curve is to have.
  std::vector<int> wanted_edges(const CurveClasses& classes, const std::vector<int>& least) const {
    std::vector<int> wanted(classes.edges.size());
    for (const std::vector<int>& curves : classes.curves) {
      int low = 1, high = std::numeric_limits<int>::max();
      double length = 0;
      for (const int c : curves) {
        low = std::max(low, least[c]), high = std::min(high, classes.edges[c]);
        length += classes.length[c] / static_cast<double>(curves.size());
      }
      const int even = std::clamp(static_cast<int>(std::lround(length / options_.curve_edge)), std::min(low, high), high);
      for (const int c : curves) wanted[c] = std::max(even, std::min(least[c], classes.edges[c]));
    }
    classes.make_even(wanted, least);
    return wanted;
  }

  // All that collapses and flips change, but the order of those to come.
  struct State {
    std::size_t log;
    std::vector<int> valences;
    std::vector<VertexQuadric> quadrics;
    std::vector<int> curve_edges, component_faces;
    int loose;
  };
  void restore(const State& state) {
    for (; log_.size() > state.log; log_.pop_back())
      log_.back().kind == MeshEdit::Kind::Collapse ? mesh_.undo_collapse(log_.back().half_edge) : mesh_.undo_flip(log_.back().half_edge);
    valences_ = state.valences, quadrics_ = state.quadrics, curve_edges_ = state.curve_edges;
    components_.faces = state.component_faces;
    loose_ = state.loose;
  }
  // Calls visit(h) for the half-edges of a curve.
  template <class Visit>
  void for_curve(int curve, const Visit& visit) const {
    for (const int f : live_)
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (mesh_.alive[f] && features().on(mesh_, h) && features().curves()[mesh_.edge[h]] == curve) visit(h);
  }
  // Takes the cheapest vertex away from a curve.
  bool shorten(int curve) {
    int best = cheapest_on(curve);
    if (best < 0 && flip_beside(curve)) best = cheapest_on(curve);
    return best >= 0 && apply(best, kLeastFacesBetweenCurves);
  }
  // The half-edge along which that vertex goes, -1: none can.
  int cheapest_on(int curve) {
    double least = std::numeric_limits<double>::infinity();
    int best = -1;
    for_curve(curve, [&](int h) {
      if (!features().can_collapse(mesh_, h) || !mesh_.can_collapse(h) || makes_bridge(h, star_.around)) return;
      star_.gather(mesh_, points_, mesh_.from(h));
      for (std::size_t i = 0; i < star_.spokes.size(); ++i)
        if (star_.spokes[i].half_edge == h) {
          const double cost = full_cost(least_cost(mesh_.from(h), star_, i), mesh_.from(h), star_, i) * (features().keeps_room(mesh_, h) ? 1 : 1e3);
          if (cost < least) least = cost, best = h;
        }
    });
    return best;
  }
  // A vertex does not go along the edge of a triangle of which another edge is on a curve, too: that one would be merged with the third. Flips the
  // third edges of such triangles.
  bool flip_beside(int curve) {
    bool any = false;
    for_curve(curve, [&](int h) {
      const int next = EditMesh::next(h), previous = EditMesh::prev(h);
      if (features().on(mesh_, next) == features().on(mesh_, previous)) return;
      const int third = features().on(mesh_, next) ? previous : next;
      if (mesh_.opposite[third] < 0 || !features().can_flip(mesh_, third) || !mesh_.can_flip(third) || folds(mesh_, points_, third)) return;
      flip(third);
      any = true;
    });
    return any;
  }

  // Does the collapse keep the curves, and to each a vertex more than it needs? That one can go where the triangles beside it are to be paired.
  bool keeps_curves(int h) const {
    if (features().empty()) return true;
    if (!features().can_collapse(mesh_, h) || !features().keeps_room(mesh_, h)) return false;
    if (!features().is_on_curve(mesh_.from(h))) return true;
    const int curve = features().curves()[mesh_.edge[h]];
    return curve_edges_[curve] > least_edges_[curve] + 1;
  }

  // The part of a collapse's cost that the rest only multiplies, by no less than 1: the distance to the surface and the longest edge.
  double least_cost(int v, const VertexStar& star, std::size_t spoke) const {
    const Vec3& target = star.spokes[spoke].at;
    double longest = 0;
    star.for_kept_faces(spoke, [&](const VertexStar::Face&, const Vec3& a, const Vec3& b) {
      longest = std::max({longest, (target - a).squaredNorm(), (target - b).squaredNorm()});
    });
    const VertexQuadric &mine = quadrics_[v], &other = quadrics_[star.spokes[spoke].end];
    const double cost = (mine.planes(target) + other.planes(target)) / std::max(mine.area + other.area, 1e-300) + options_.evenness * longest;
    const double finer = fineness_on_edge(options_.fineness, v, star.spokes[spoke].end);
    return cost * finer * finer;
  }

  // How long the edge of a curve gets that loses a star's vertex along a spoke. Edges much longer than those beside them lie far off a bent curve,
  // and the quads between them fold.
  double curve_edge_without(const VertexStar& star, std::size_t spoke) const {
    for (const VertexStar::Spoke& other : star.spokes)
      if (other.end != star.spokes[spoke].end && (other.half_edge < 0 || features().on(mesh_, other.half_edge)))
        return (other.at - star.spokes[spoke].at).norm() * fineness_on_edge(options_.fineness, other.end, star.spokes[spoke].end);
    return 0;
  }

  // Times the shape of the new triangles, how far they turn, valences, and the evenness of curves.
  double full_cost(double error, int v, const VertexStar& star, std::size_t spoke) const {
    const int h = star.spokes[spoke].half_edge, u = star.spokes[spoke].end, o = mesh_.opposite[h];
    const Vec3& target = star.spokes[spoke].at;
    double worst_shape = 1, worst_turn = 1;
    star.for_kept_faces(spoke, [&](const VertexStar::Face& face, const Vec3& a, const Vec3& b) {
      const Vec3 ab = b - a, au = target - a, bu = target - b;
      const Vec3 fresh = au.cross(bu);
      const double area2 = fresh.norm();
      const double sum = ab.squaredNorm() + au.squaredNorm() + bu.squaredNorm();
      worst_shape = std::min(worst_shape, sum > 0 ? 2 * std::sqrt(3.0) * area2 / sum : 0.0);
      const double scale = area2 * face.area2;
      if (scale > 0) worst_turn = std::min(worst_turn, fresh.dot(face.normal) / scale);
    });
    error *= 1 + 0.3 * (1 / std::max(worst_shape, 0.01) - 1);
    error *= 1 + 20 * std::max(0.0, 0.3 - worst_turn);
    const auto misfit = [&](int w, int valence) {
      const int regular = mesh_.is_boundary(w) ? 4 : 6;
      const double high = std::max(0, valence - regular), low = std::max(0, regular - 1 - valence);
      return high * high + low * low;
    };
    const int apex = mesh_.apex(h);
    double valence = misfit(u, valences_[u] + valences_[v] - (mesh_.is_boundary(v) ? 3 : 4)) + misfit(apex, valences_[apex] - 1);
    if (o >= 0) valence += misfit(mesh_.apex(o), valences_[mesh_.apex(o)] - 1);
    error *= 1 + 0.15 * valence;
    if (!features().empty() && features().on(mesh_, h))
      error *= 1 + std::pow(curve_edge_without(star, spoke) / (kMuchLonger * options_.curve_edge), 6);
    return error * (1 + 1e-3 * jitter(options_.seed, v));
  }

  // The cheapest collapse of v that the topology allows.
  Candidate cheapest(int v, VertexStar& star) const {
    Candidate best;
    best.vertex = v;
    if ((!options_.fixed.empty() && options_.fixed[v]) || features().is_corner(v)) return best;
    star.gather(mesh_, points_, v);
    // A boundary vertex moves along its outgoing boundary edge.
    const std::size_t ways = mesh_.is_boundary(v) ? 1 : star.spokes.size();
    star.bounds.clear();
    for (std::size_t i = 0; i < ways; ++i) star.bounds.push_back({least_cost(v, star, i), static_cast<int>(i)});
    std::sort(star.bounds.begin(), star.bounds.end());
    for (const auto& [bound, i] : star.bounds) {
      if (bound > best.cost) break;
      const int h = star.spokes[i].half_edge;
      if (!keeps_curves(h)) continue;
      const double cost = full_cost(bound, v, star, i);
      // The topological test is dearer than the cost.
      if (!(cost < best.cost || (cost == best.cost && h < best.half_edge)) || !mesh_.can_collapse(h) || makes_chord(h, star.around) ||
          makes_bridge(h, star.around) || bares_mirror(h))
        continue;
      best.cost = cost;
      best.half_edge = h;
    }
    return best;
  }

  // On a boundary that is to be left with the fixed vertices only.
  bool is_loose(int v) const { return !options_.fixed.empty() && !options_.fixed[v] && mesh_.is_boundary(v); }

  // Would an inner edge join two vertices of one boundary loop? A map of the surface at this stage could give a triangle between it and the boundary
  // no area, where a straight side of the base runs along it. What only decides on the base, while that takes shape, may have such edges.
  bool makes_chord(int h, std::vector<int>& around) const {
    const int v = mesh_.from(h), u = mesh_.to(h), o = mesh_.opposite[h];
    if (loop_.empty() || shaping_ || loop_[u] < 0 || loop_[v] >= 0) return false;
    mesh_.ring(v, around);
    return std::any_of(around.begin(), around.end(),
                       [&](int w) { return loop_[w] == loop_[u] && w != u && w != mesh_.apex(h) && (o < 0 || w != mesh_.apex(o)); });
  }

  bool is_on_mirror(int v) const { return !options_.on_mirror.empty() && options_.on_mirror[v]; }
  // Would an edge join two vertices of the mirror that is not on it?
  bool makes_bridge(int h, std::vector<int>& around) const {
    const int v = mesh_.from(h), u = mesh_.to(h), o = mesh_.opposite[h];
    if (is_on_mirror(v) || !is_on_mirror(u)) return false;
    mesh_.ring(v, around);
    return std::any_of(around.begin(), around.end(),
                       [&](int w) { return is_on_mirror(w) && w != u && w != mesh_.apex(h) && (o < 0 || w != mesh_.apex(o)); });
  }

  bool is_inside_mirror(int v) const { return is_on_mirror(v) && !features().is_corner(v); }
  // Would a vertex of the mirror get so few triangles that they might become one quad, which would have two sides in common with its mirror image?
  // Only where the base takes shape: a cut leaves many of them.
  bool is_bare(int v, int triangles) const { return is_inside_mirror(v) && triangles < kLeastOnMirror; }
  bool bares_mirror(int h) const {
    if (options_.on_mirror.empty() || mesh_.face_count > kShapingFaces * options_.target_faces) return false;
    const int v = mesh_.from(h), u = mesh_.to(h), o = mesh_.opposite[h], apex = mesh_.apex(h);
    if (is_bare(apex, valences_[apex] - 2)) return true;
    if (o >= 0) return is_bare(mesh_.apex(o), valences_[mesh_.apex(o)] - 2);
    return is_bare(u, valences_[u] + valences_[v] - 4);
  }
  // Gives a third triangle to vertices of the mirror that have fewer, or takes them away.
  void dress_mirror() {
    for (int v = 0; v < static_cast<int>(options_.on_mirror.size()); ++v) {
      if (!mesh_.vertex_alive(v) || !is_bare(v, valences_[v] - 1) || dress(v)) continue;
      const int h = mesh_.out[v];
      if (mesh_.can_collapse(h) && keeps_curves(h) && !bares_mirror(h)) apply(h);
    }
  }
  bool dress(int v) {
    for (int h = mesh_.out[v]; h >= 0; h = mesh_.ccw(h)) {
      const int g = EditMesh::next(h), o = mesh_.opposite[g];  // across from v
      if (o < 0 || !features().can_flip(mesh_, g) || !mesh_.can_flip(g) || is_on_mirror(mesh_.apex(o))) continue;
      if (is_bare(mesh_.from(g), valences_[mesh_.from(g)] - 2) || is_bare(mesh_.to(g), valences_[mesh_.to(g)] - 2)) continue;
      flip(g);
      if (!is_bare(v, valences_[v] - 1)) return true;
      h = mesh_.out[v];
    }
    return false;
  }

  // What changes around a vertex makes its cost in the heap a stale one, which is found out only when it comes to the top: of the seven vertices
  // around a collapse most change again before that, and costs seldom fall. Where the base takes shape costs are kept exact.
  enum class Queued : char { No, Fresh, Stale };
  bool keeps_exact() const { return mesh_.face_count <= kExactFaces; }

  void push(Candidate candidate) {
    const int v = candidate.vertex;
    candidate.stamp = ++stamps_[v];
    queued_[v] = candidate.half_edge < 0 ? Queued::No : Queued::Fresh;
    if (candidate.half_edge < 0) return;
    heap_.push_back(candidate);
    std::push_heap(heap_.begin(), heap_.end(), is_dearer);
  }

  // The cheapest collapse, or none if another one has to be looked at first.
  Candidate pop() {
    std::pop_heap(heap_.begin(), heap_.end(), is_dearer);
    Candidate top = heap_.back();
    heap_.pop_back();
    if (!mesh_.vertex_alive(top.vertex) || top.stamp != stamps_[top.vertex]) return {};
    if (std::exchange(queued_[top.vertex], Queued::No) == Queued::Fresh) return top;
    top = cheapest(top.vertex, star_);
    if (top.half_edge < 0 || heap_.empty() || !is_dearer(top, heap_.front())) return top;
    push(top);
    return {};
  }

  void refill() {
    std::vector<int> vertices;
    for (std::size_t v = 0; v < points_.size(); ++v) {
      queued_[v] = Queued::No;
      if (mesh_.vertex_alive(static_cast<int>(v))) vertices.push_back(static_cast<int>(v));
    }
    heap_.resize(vertices.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices.size(), 1024), [&](const tbb::blocked_range<std::size_t>& range) {
      VertexStar star;
      for (std::size_t i = range.begin(); i < range.end(); ++i) heap_[i] = cheapest(vertices[i], star);
    });
    std::erase_if(heap_, [](const Candidate& c) { return c.half_edge < 0; });
    for (Candidate& c : heap_) {
      queued_[c.vertex] = Queued::Fresh;
      c.stamp = stamps_[c.vertex];
    }
    std::make_heap(heap_.begin(), heap_.end(), is_dearer);
  }

  // All costs anew: from here on those that are stale would decide on the base.
  void begin_shaping() {
    shaping_ = true;
    refill();
  }

  void touch(int v) {
    if (queued_[v] == Queued::No || keeps_exact())
      push(cheapest(v, star_));
    else
      queued_[v] = Queued::Stale;
  }

  void collapse(int h) {
    if (mesh_.can_collapse(h) && keeps_curves(h) && !makes_chord(h, star_.around) && !makes_bridge(h, star_.around) && !bares_mirror(h)) apply(h);
  }
  // Returns whether the mesh has changed: closed components keep so many faces.
  bool apply(int h, int least_faces = kLeastClosedFaces) {
    const int v = mesh_.from(h), u = mesh_.to(h), o = mesh_.opposite[h];
    if (const int c = components_.of[v]; c >= 0) {
      if (components_.faces[c] - 2 < least_faces) return false;
      components_.faces[c] -= 2;
    }
    if (features().is_on_curve(v)) --curve_edges_[features().curves()[mesh_.edge[h]]];
    valences_[u] += valences_[v] - (mesh_.is_boundary(v) ? 3 : 4);
    --valences_[mesh_.apex(h)];
    if (o >= 0) --valences_[mesh_.apex(o)];
    quadrics_[u].planes += quadrics_[v].planes;
    quadrics_[u].area += quadrics_[v].area;
    loose_ -= is_loose(v);
    mesh_.collapse(h);
    log_.push_back({MeshEdit::Kind::Collapse, h});
    mesh_.ring(u, ring_);
    touch(u);
    for (const int w : ring_) touch(w);
    return true;
  }

  void flip(int h) {
    --valences_[mesh_.from(h)], --valences_[mesh_.to(h)];
    ++valences_[mesh_.apex(h)], ++valences_[mesh_.apex(mesh_.opposite[h])];
    mesh_.flip(h);
    log_.push_back({MeshEdit::Kind::Flip, h});
  }

  EditMesh& mesh_;
  const std::vector<Vec3>& points_;
  const DecimationOptions& options_;
  std::vector<MeshEdit>& log_;
  std::vector<VertexQuadric> quadrics_;
  ClosedComponents components_;
  std::vector<int> valences_;
  std::vector<Queued> queued_;
  std::vector<std::uint32_t> stamps_;  // of the last candidate, by vertex: earlier ones in the heap count for nothing
  std::vector<Candidate> heap_;
  VertexStar star_;
  std::vector<int> ring_;
  std::vector<int> live_;                       // faces that were alive when curves began to be balanced
  std::vector<int> curve_edges_, least_edges_;  // per feature curve: how many edges it has, and has to keep
  std::vector<int> loop_;  // per vertex its boundary loop, or -1; empty: there are none, or only the fixed vertices of them will be left
  bool shaping_ = false;
  int loose_ = 0;
};

}  // namespace

std::vector<VertexQuadric> decimate(EditMesh& mesh, const std::vector<Vec3>& points, const DecimationOptions& options, std::vector<MeshEdit>& log,
                                    const Progress& progress) {
  Decimation decimation(mesh, points, options, log);
  decimation.run(progress);
  return decimation.take_quadrics();
}

}  // namespace hybrid_mesh
