// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "base/context.h"
#include "parameterization/patched_surface.h"
#include "surface/edit_mesh.h"

namespace hybrid_mesh {

// A surface split along curves, which are chains of its edges.
struct CutMesh {
  TriangleSurface mesh;                  // source_face: face of the surface
  std::vector<PointSource> source;       // per point
  std::vector<int> curve;                // per half-edge: the curve along it, -1: none
  std::vector<std::vector<int>> chains;  // per curve: its points from start to end; empty for one that was removed
};

// Curves on a triangle surface. Every curve begins and ends at a vertex and is otherwise an ordered list of crossings of edges; each edge has the
// ordered list of the crossings on it. So whether two curves cross is a matter of order alone: within a face, they do if their ends on its sides
// alternate. Vertices are put in where curves are to begin, end or meet.
//
// Invariants: a curve crosses no edge of the boundary; it never leaves a face by the side it came in by, nor beside the vertex that it begins or ends
// at; one without crossings is an inner edge, which no other curve crosses or is (after resolve_crossings).
class SurfaceCurves {
 public:
  // Edges are oriented from their smaller to their larger vertex: t in (0, 1) runs that way, and next_left says whether the curve goes on to the left
  // of the edge.
  struct Crossing {
    int curve = -1, previous = -1, next = -1;
    int edge = -1;
    double t = 0.5;
    bool next_left = false;
  };
  struct Curve {
    int start = -1, end = -1;   // vertices
    int first = -1, last = -1;  // crossings, -1: none
    int along = -1;             // the edge that it is
    int stroke = -1;            // whatever the caller numbers it by
    bool alive = true;
  };
  // One end of a curve at a vertex: it leaves along the half-edge `spoke`, or through the face on the left of that.
  struct End {
    int curve = -1;
    bool at_start = true;
    int spoke = -1;
    bool along = false;
    friend bool operator==(const End&, const End&) = default;
  };
  // Leaves the face of `half_edge` across it, at the fraction t of it.
  struct Step {
    int half_edge;
    double t;
  };

  // A part of a face's side between two crossings: `from` and `to` are fractions of the half-edge, `below` the crossing that it follows in the edge's
  // list (-1: none).
  struct Gap {
    int half_edge, rank, below;  // rank: its number on the edge, from the smaller vertex on
    double from, to;
    int cell;
  };
  // A part of a corner of a face, counter-clockwise after `rank` curve ends there; the corner is where the half-edge `spoke` starts.
  struct CornerGap {
    int spoke, rank;
    int cell;
  };
  // The parts into which curves divide a face. Sides that are curves or boundary have no gaps.
  struct FaceCells {
    std::vector<Gap> gaps;
    std::vector<CornerGap> corners;
  };

  // `points`: where the surface's points are taken to lie. Sources are combinations of the surface's points.
  SurfaceCurves(const TriangleSurface& surface, std::vector<Vec3> points);

  const EditMesh& mesh() const { return mesh_; }
  const std::vector<Vec3>& points() const { return points_; }
  const PointSource& source(int v) const { return source_[v]; }
  std::vector<std::array<int, 3>> faces() const;
  int face_count() const { return static_cast<int>(mesh_.alive.size()); }
  int half_edge(int edge) const { return half_edge_[edge]; }
  int low(int edge) const { return std::min(mesh_.from(half_edge_[edge]), mesh_.to(half_edge_[edge])); }
  int high(int edge) const { return std::max(mesh_.from(half_edge_[edge]), mesh_.to(half_edge_[edge])); }

  int curve_count() const { return static_cast<int>(curves_.size()); }
  const Curve& curve(int c) const { return curves_[c]; }
  const Crossing& crossing(int n) const { return crossings_[n]; }
  const std::vector<int>& on_edge(int edge) const { return on_edge_[edge]; }  // from the smaller vertex to the larger
  int along(int edge) const { return along_[edge]; }                          // the curve that this edge is, -1: none
  int degree(int v) const { return degree_[v]; }                              // curve ends
  Vec3 position(int n) const;
  double length(int c) const;
  std::vector<Vec3> polyline(int c) const;
  // The ends of curves at a vertex, counter-clockwise; at the boundary from the clockwise-most on.
  std::vector<End> ends_at(int v) const;
  void find_cells(int f, FaceCells& cells) const;

  // --- growth ------------------------------------------------------------------------------------------------------------------
  // New vertices; curves are led past them on the side where they are. Weights of the face's corners in (0, 1); t from the half-edge's start.
  int split_face(int f, const std::array<double, 3>& weights) { return split_face(f, weights, {}); }
  int split_edge(int h, double t) { return split_edge(h, t, -1); }
  // Puts a vertex on a curve's crossing, which ends it there and begins a new one.
  int split_curve(int n);

  // --- curves ------------------------------------------------------------------------------------------------------------------
  // Adds a curve that may cross others and itself. Steps beside its ends and there and back are left out. Returns -1 if nothing is left, or if what
  // is left is an edge that is a curve already.
  int add(int start, int end, const std::vector<Step>& steps, int stroke);
  // Adds a curve through gaps. Returns -1 if nothing is left of it.
  int add(int start, int end, const std::vector<Gap>& gaps, int stroke);
  // Does a curve cross no other, nor itself?
  bool is_clear(int c) const;
  // Puts a vertex wherever two curves cross.
  void resolve_crossings(const Progress& progress);
  void remove(int c);
  // Moves all other curve ends at inner vertex v, an end of curve c, along c to its other end, side by side in their order, and removes c.
  // Curves that vanish by that, or coincide with another, are removed.
  void contract(int c, int v);
  // The same for a boundary vertex along the boundary: to the vertex that the boundary (which has the surface on its left) leads to, or backward. No
  // other curve ends in between.
  void slide(int v, int to, bool forward);
  // Joins the two curves that end at an inner vertex to one. False if they are not two, or one and the same.
  bool dissolve(int v);

  // --- for what moves curves ---------------------------------------------------------------------------------------------------
  // Crosses half-edge h, leaving its face, right after crossing `previous` of the curve (-1: at its start); in the edge's list right after crossing
  // `below` (-1: first).
  int insert(int c, int previous, int h, int below, double t);
  int insert_nearest(int c, int previous, int h, int v);  // nearest to vertex v, an end of h
  void erase(int n);
  bool is_nearest(int n, int v) const {
    return v == low(crossings_[n].edge) ? on_edge_[crossings_[n].edge].front() == n : on_edge_[crossings_[n].edge].back() == n;
  }
  void set_t(int n, double t) { crossings_[n].t = t; }
  // Takes out what the invariants forbid. False if the curve has nothing left, is an edge of the boundary, or coincides with another: then it is
  // removed.
  bool simplify(int c);
  // The half-edge by which a crossing's curve leaves a face, with the face on its left.
  int leaving(int n) const;
  // Makes the crossings of every edge lie apart in their order, moved as little as that takes.
  void spread();

  // --- results -----------------------------------------------------------------------------------------------------------------
  // Splits the surface along all curves.
  CutMesh cut() const;
  // An empty string, or what is wrong with the lists, or that curves cross.
  const char* find_defect() const;

 private:
  // A corner of a face, or a crossing on the side that follows that corner.
  struct Station {
    int corner = -1, crossing = -1;
    std::array<double, 3> weights{0, 0, 0};
  };
  // A curve's way through a face, between two stations.
  struct Chord {
    int curve = -1;
    int from = -1, to = -1;                    // in the curve's direction
    int from_crossing = -1, to_crossing = -1;  // -1: the curve's end
  };
  struct FacePolygon {
    std::vector<Station> stations;
    std::vector<Chord> chords;
  };

  static constexpr double kLeastGap = 1e-3;  // between neighbouring crossings of an edge, and its ends, as a fraction of it
  static double inside(double t);            // at least so far from the ends

  FacePolygon polygon(int f) const;
  static bool alternate(const Chord& a, const Chord& b);
  int split_face(int f, const std::array<double, 3>& weights, const std::vector<int>& through);
  int split_edge(int h, double t, int through);
  int add_vertex(const std::array<int, 3>& of, const std::array<double, 3>& weights);
  int add_face(int like);
  int add_edge(int h);
  void put(int h, int origin, int edge, int opposite);
  int new_crossing();
  void link_after(int c, int previous, int n);
  void unlink(int n);
  int split_between(int c, int p, int q, int x);
  bool set_along(int c);
  void clear_along(int c);
  void reverse(int c);
  void open_end(const End& end);
  void extend(const End& end, const End& guide, bool before);
  void spread(int edge);
  void simplify_all(std::vector<int> curves);

  EditMesh mesh_;
  std::vector<Vec3> points_;
  std::vector<PointSource> source_;
  std::vector<int> source_face_;
  std::vector<int> half_edge_;  // per edge: one of its half-edges
  std::vector<Crossing> crossings_;
  std::vector<int> free_;
  std::vector<Curve> curves_;
  std::vector<std::vector<int>> on_edge_;  // per edge
  std::vector<int> along_;                 // per edge
  std::vector<int> degree_;                // per vertex
};

}  // namespace hybrid_mesh
