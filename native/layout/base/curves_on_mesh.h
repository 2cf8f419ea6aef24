// SPDX-License-Identifier: GPL-3.0-or-later
// The curves of a layout on a mesh, as curve_network.h has them followed and cut.
#pragma once

#include <algorithm>
#include <vector>

#include "layout/base/quad_layout.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// Where a curve crosses an edge of the mesh. Edges are oriented from their smaller to their larger vertex: t in (0, 1) runs that way, and
// next_left says whether the curve goes on to the left of it.
struct Crossing {
  int curve = -1, previous = -1, next = -1;
  int edge = -1, low = -1, high = -1;
  double t = 0.5;
  bool next_left = false;
};

class CurveNetwork {
 public:
  CurveNetwork(const TriangleSurface& surface, EditMesh& mesh, const MeshFeatures& features, const QuadLayout& layout)
      : surface_(surface),
        points_(surface.points),
        mesh_(mesh),
        features_(features),
        layout_(layout),
        on_edge_(mesh.edge_count),
        along_edge_(mesh.edge_count, -1) {
    first_.assign(layout.curves.size(), -1);
    last_.assign(layout.curves.size(), -1);
    for (std::size_t c = 0; c < layout.curves.size(); ++c)
      if (layout.curves[c].edge >= 0 && !is_feature(static_cast<int>(c))) along_edge_[layout.curves[c].edge] = static_cast<int>(c);
  }

  // Lays the curves on straight segments in the plane, where the mesh's vertices lie at `uv`.
  void draw(const std::vector<Vec2>& uv);

  void undo(const MeshEdit& edit) {
    if (edit.kind == MeshEdit::Kind::Collapse)
      undo_collapse(edit.half_edge);
    else
      undo_flip(edit.half_edge);
  }

  PatchedSurface cut();

 private:
  // Does the layout's curve run along a feature? Such a curve has no crossings: it is followed once the mesh is the fine one again.
  bool is_feature(int c) const { return !features_.empty() && layout_.curves[c].edge >= 0 && features_.curves()[layout_.curves[c].edge] >= 0; }
  struct Station {
    int corner = -1;    // index in the ring, or -1
    int crossing = -1;  // or a crossing on the ring's edge
    double angle = 0, radius = 0;
  };
  struct Chord {
    int curve;
    int from, to;                    // stations, in the curve's direction
    int from_crossing, to_crossing;  // -1: the curve's end
    int low = 0, span = 0;           // the arc that the new vertex does not see: stations low .. low + span
    bool forward = true;             // the arc runs from `from` to `to`
  };

  // --- links of the curves ---------------------------------------------------------------------------------------------------
  void erase_from_curve(int n) {
    const Crossing& x = crossings_[n];
    (x.previous >= 0 ? crossings_[x.previous].next : first_[x.curve]) = x.next;
    (x.next >= 0 ? crossings_[x.next].previous : last_[x.curve]) = x.previous;
    crossings_[n].curve = -1;
    free_.push_back(n);
  }
  bool is_linked(int n) const { return crossings_[n].curve >= 0; }
  void erase(int n) {
    std::vector<int>& list = on_edge_[crossings_[n].edge];
    list.erase(std::find(list.begin(), list.end(), n));
    erase_from_curve(n);
  }
  int new_crossing() {
    if (!free_.empty()) {
      const int n = free_.back();
      free_.pop_back();
      crossings_[n] = Crossing();
      return n;
    }
    crossings_.emplace_back();
    return static_cast<int>(crossings_.size()) - 1;
  }
  // Inserts crossing n after `previous` (-1: at the start).
  void link_after(int curve, int previous, int n) {
    const int next = previous >= 0 ? crossings_[previous].next : first_[curve];
    crossings_[n].previous = previous;
    crossings_[n].next = next;
    (previous >= 0 ? crossings_[previous].next : first_[curve]) = n;
    (next >= 0 ? crossings_[next].previous : last_[curve]) = n;
  }
  // Shortens the curve at the link that follows `p` (-1: its start) as long as it leaves and re-enters an edge, runs beside a corner or along an
  // edge.
  void simplify(int curve, int p) {
    for (;;) {
      const int q = p >= 0 ? crossings_[p].next : first_[curve];
      const int start = layout_.curves[curve].start, end = layout_.curves[curve].end;
      if (p < 0 && q < 0) {
        int h = mesh_.find(start, end);
        if (h < 0) h = mesh_.find(end, start);
        if (h < 0) throw NoMap("a base curve without crossings joins vertices that are not adjacent");
        along_edge_[mesh_.edge[h]] = curve;
        return;
      }
      const auto touches = [&](int n, int v) { return crossings_[n].low == v || crossings_[n].high == v; };
      if (p < 0 && touches(q, start)) {
        erase(q);
      } else if (p >= 0 && q < 0 && touches(p, end)) {
        const int before = crossings_[p].previous;
        erase(p);
        p = before;
      } else if (p >= 0 && q >= 0 && crossings_[p].edge == crossings_[q].edge) {
        const int before = crossings_[p].previous;
        erase(q);
        erase(p);
        p = before;
      } else {
        return;
      }
    }
  }

  // Takes all curves off an edge that is about to vanish; curves left without crossings go to `bare_`.
  void clear_edge(int e) {
    for (const int n : on_edge_[e]) {
      const int c = crossings_[n].curve;
      erase_from_curve(n);
      if (first_[c] < 0) bare_.push_back(c);
    }
    on_edge_[e].clear();
    if (along_edge_[e] >= 0) {
      bare_.push_back(along_edge_[e]);
      along_edge_[e] = -1;
    }
  }

  // The chords of a polygon whose boundary edges are the half-edges `sides_` (interior on the left), with `ring_` their starts; open: the last ring
  // vertex has no side.
  void collect(bool closed) {
    stations_.clear();
    chords_.clear();
    corner_station_.assign(ring_.size(), -1);
    if (station_of_.size() < crossings_.size()) station_of_.resize(crossings_.size() + 64, -1);
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      corner_station_[i] = static_cast<int>(stations_.size());
      stations_.push_back({static_cast<int>(i), -1, 0, 0});
      if (!closed && i + 1 == ring_.size()) break;
      const std::vector<int>& list = on_edge_[mesh_.edge[sides_[i]]];
      const bool up = mesh_.from(sides_[i]) < mesh_.to(sides_[i]);
      for (std::size_t k = 0; k < list.size(); ++k) {
        const int n = up ? list[k] : list[list.size() - 1 - k];
        station_of_[n] = static_cast<int>(stations_.size());
        stations_.push_back({-1, n, 0, 0});
      }
    }
    const auto corner_of = [&](int v) {
      for (std::size_t i = 0; i < ring_.size(); ++i)
        if (ring_[i] == v) return corner_station_[i];
      throw NoMap("a base curve ends outside the star that it runs through");
    };
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const bool up = mesh_.from(sides_[i]) < mesh_.to(sides_[i]);
      for (const int n : on_edge_[mesh_.edge[sides_[i]]]) {
        const Crossing& x = crossings_[n];
        const QuadLayout::Curve& curve = layout_.curves[x.curve];
        if (x.next_left == up) {
          const int to = x.next >= 0 ? station_of_[x.next] : corner_of(curve.end);
          chords_.push_back({x.curve, station_of_[n], to, n, x.next});
        } else if (x.previous < 0) {
          chords_.push_back({x.curve, corner_of(curve.start), station_of_[n], -1, n});
        }
      }
    }
    for (const int c : bare_)
      if (first_[c] < 0) chords_.push_back({c, corner_of(layout_.curves[c].start), corner_of(layout_.curves[c].end), -1, -1});
    bare_.clear();
  }

  Vec3 position(const Crossing& x) const { return points_[x.low] + x.t * (points_[x.high] - points_[x.low]); }

  int place(const Chord& chord, int previous, int edge, int a, int b, double t_from_a, bool next_left_of_ab) {
    const int n = new_crossing();
    Crossing& x = crossings_[n];
    x.curve = chord.curve;
    x.edge = edge;
    x.low = std::min(a, b);
    x.high = std::max(a, b);
    x.t = a < b ? t_from_a : 1 - t_from_a;
    x.next_left = (a < b) == next_left_of_ab;
    link_after(chord.curve, previous, n);
    return n;
  }

  // Parameters along an edge must be strictly increasing: kept where they are, spread evenly where not.
  static void spread(std::vector<double>& t) {
    bool good = true;
    double last = 0;
    for (const double x : t) {
      if (!(x > last + 1e-4)) good = false;
      last = x;
    }
    if (good && last < 1 - 1e-4) return;
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = (i + 1.0) / (t.size() + 1.0);
  }

  // Shortens at both ends of every chord; links between new crossings need it never.
  void simplify_chords() {
    for (const Chord& c : chords_) {
      if (c.from_crossing < 0 || is_linked(c.from_crossing)) simplify(c.curve, c.from_crossing);
      if (first_[c.curve] < 0) continue;
      if (c.to_crossing < 0)
        simplify(c.curve, last_[c.curve]);
      else if (is_linked(c.to_crossing))
        simplify(c.curve, crossings_[c.to_crossing].previous);
    }
  }

  void undo_collapse(int h);
  void put_back(int first, int last, bool closed, int kept);
  void undo_flip(int h);
  std::vector<int> follow_feature(int c, const std::vector<char>& is_node);
  void insert_vertex(int v, bool closed);

  static int split_boundary_edge(PatchedSurface& out, int h);

  const TriangleSurface& surface_;
  const std::vector<Vec3>& points_;
  EditMesh& mesh_;
  const MeshFeatures& features_;
  const QuadLayout& layout_;
  std::vector<Crossing> crossings_;
  std::vector<int> free_;
  std::vector<std::vector<int>> on_edge_;  // per edge name: its crossings from the smaller vertex to the larger
  std::vector<int> along_edge_;            // per edge name: the curve that is this edge
  std::vector<int> first_, last_;          // per curve: crossings, -1: none
  std::vector<int> bare_, ring_, sides_, spokes_, corner_station_, station_of_;
  std::vector<Station> stations_;
  std::vector<Chord> chords_;
  std::vector<std::pair<int, int>> split_boundary_chain_;  // quad and first of the two sides that share a boundary edge of the mesh
};

}  // namespace hybrid_mesh
