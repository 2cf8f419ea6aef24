// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/curve_cleaning.h"

#include <algorithm>
#include <tuple>

#include "base/tolerances.h"
#include "layout/curves/surface_paths.h"
#include "layout/drawn/patch_layout.h"

namespace hybrid_mesh {
namespace {

class CurveCleaning {
 public:
  CurveCleaning(const TriangleSurface& surface, SurfaceCurves& curves, const CleaningOptions& options)
      : surface_(surface),
        curves_(curves),
        options_(options),
        is_kept_(curves.points().size(), 0),
        is_junction_(is_kept_),
        moved_(is_kept_.size(), 0) {
    for (const int v : options.boundary_nodes) is_kept_[v] = 1;
    for (const int v : options.junctions) is_junction_[v] = 1;
  }

  void run(const Progress& progress) {
    curves_.spread();
    do {
      while (slide_boundary_nodes() || contract_short_curves()) progress.check();
    } while (remove_slips());
    // What is left of crossings and of the places where closed strokes begin.
    for (int v = 0; v < static_cast<int>(curves_.points().size()); ++v) {
      if (curves_.degree(v) != 2 || curves_.mesh().is_boundary(v)) continue;
      const auto ends = curves_.ends_at(v);
      if (curves_.curve(ends[0].curve).stroke == curves_.curve(ends[1].curve).stroke) curves_.dissolve(v);
    }
    curves_.spread();
  }

 private:
  // Nodes are moved onto others of the same rank or a higher one: inside, on the boundary, and those that stay where they are.
  int rank(int v) const {
    if (!curves_.mesh().is_boundary(v)) return 0;
    return is_kept_[v] ? 2 : 1;
  }

  void contract(int c, int v) {
    const int to = curves_.curve(c).start == v ? curves_.curve(c).end : curves_.curve(c).start;
    moved_[to] = std::max(moved_[to], moved_[v] + curves_.length(c));
    curves_.contract(c, v);
  }

  bool is_small_loop(int c) const {
    const std::vector<Vec3> line = curves_.polyline(c);
    return std::all_of(line.begin(), line.end(), [&](const Vec3& p) { return (p - line[0]).norm() < options_.snap; });
  }

  // Do two curves lie side by side?
  bool is_narrow(int c, int d) const {
    const auto beside = [&](const std::vector<Vec3>& points, const std::vector<Vec3>& line) {
      return std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
        for (std::size_t i = 1; i < line.size(); ++i) {
          const double t = nearest_on_segment(p, line[i - 1], line[i]);
          if ((p - line[i - 1] - t * (line[i] - line[i - 1])).norm() < 0.5 * options_.snap) return true;
        }
        return false;
      });
    };
    const std::vector<Vec3> a = curves_.polyline(c), b = curves_.polyline(d);
    return beside(a, b) && beside(b, a);
  }

  bool contract_short_curves() {
    bool any = false;
    std::vector<std::pair<double, int>> shortest;
    for (int c = 0; c < curves_.curve_count(); ++c)
      if (curves_.curve(c).alive && curves_.curve(c).start != curves_.curve(c).end)
        if (const double length = curves_.length(c); length < options_.snap) shortest.push_back({length, c});
    std::sort(shortest.begin(), shortest.end());
    for (const auto& [length, c] : shortest) {
      const SurfaceCurves::Curve curve = curves_.curve(c);
      if (!curve.alive || curve.start == curve.end || curves_.length(c) > length * 1.5 + tolerance::same_place) continue;
      const auto weight = [&](int x) { return std::tuple(rank(x), curves_.degree(x), -x); };
      const int v = weight(curve.start) < weight(curve.end) ? curve.start : curve.end;
      if (rank(v) > 0 || moved_[v] + length > 2 * options_.snap) continue;
      contract(c, v);
      any = true;
    }
    return any;
  }

  // A node where two strokes cross and nothing else happens.
  bool is_crossing(int v) const { return curves_.degree(v) == 4 && !is_junction_[v] && !curves_.mesh().is_boundary(v); }
  int other_end(int c, int v) const { return curves_.curve(c).start == v ? curves_.curve(c).end : curves_.curve(c).start; }

  // Small loops with nothing inside go. So do two curves side by side with nothing in between, from a node to where their strokes cross once more:
  // the crossing goes to the node.
  bool remove_slips() {
    std::vector<int> number;  // of the layout's curves
    std::vector<char> slips(curves_.curve_count(), 0);
    bool any = false;
    for (int c = 0; c < curves_.curve_count(); ++c) {
      if (!curves_.curve(c).alive) continue;
      number.push_back(c);
      const int a = curves_.curve(c).start, b = curves_.curve(c).end;
      slips[c] = a == b ? is_small_loop(c) : is_crossing(a) != is_crossing(b) && curves_.length(c) < 5 * options_.snap;
      any = any || slips[c];
    }
    if (!any) return false;
    any = false;
    const PatchLayout layout = make_patch_layout(surface_, curves_, options_.boundary_nodes);
    for (const PatchLayout::Face& face : layout.faces) {
      if (!face.is_disk() || face.side_count() > 2) continue;
      std::array<int, 2> sides{-1, -1};
      bool usable = true;
      for (int i = 0; i < face.side_count(); ++i) {
        const int k = face.cycles[0][i].curve;
        usable = usable && k < static_cast<int>(number.size()) && slips[number[k]] && curves_.curve(number[k]).alive;
        if (usable) sides[i] = number[k];
      }
      const auto [c, d] = sides;
      if (!usable || c == d) continue;
      if (d < 0) {
        curves_.remove(c);
        any = true;
        continue;
      }
      const int v = is_crossing(curves_.curve(c).start) ? curves_.curve(c).start : curves_.curve(c).end, w = other_end(c, v);
      if (v == w || !is_crossing(v) || other_end(d, v) != w || !is_narrow(c, d)) continue;
      contract(c, v);
      if (curves_.curve(d).alive) curves_.remove(d);
      any = true;
    }
    return any;
  }

  // Nodes of the boundary that are too near to the next one. True if one was moved.
  bool slide_boundary_nodes() {
    const EditMesh& mesh = curves_.mesh();
    const auto is_node = [&](int v) { return rank(v) == 2 || curves_.degree(v) > 0; };
    std::vector<int> nodes;
    for (int v = 0; v < static_cast<int>(curves_.points().size()); ++v)
      if (mesh.is_boundary(v) && is_node(v)) nodes.push_back(v);
    bool any = false;
    for (const int v : nodes) {
      if (!is_node(v)) continue;
      double length = 0;
      int w = v;
      do {
        const int next = mesh.to(mesh.out[w]);
        length += (curves_.points()[next] - curves_.points()[w]).norm();
        w = next;
      } while (w != v && length < options_.snap && !is_node(w));
      if (w == v || length >= options_.snap) continue;
      const auto weight = [&](int x) { return std::tuple(rank(x), curves_.degree(x), -x); };
      const bool forward = weight(v) < weight(w);
      const int from = forward ? v : w, to = forward ? w : v;
      if (rank(from) == 2 || moved_[from] + length > 2 * options_.snap) continue;
      curves_.slide(from, to, forward);
      moved_[to] = std::max(moved_[to], moved_[from] + length);
      any = true;
    }
    return any;
  }

  const TriangleSurface& surface_;
  SurfaceCurves& curves_;
  const CleaningOptions& options_;
  std::vector<char> is_kept_, is_junction_;  // per vertex
  std::vector<double> moved_;                // per vertex: how far ends were moved to it
};

}  // namespace

void clean_curves(const TriangleSurface& surface, SurfaceCurves& curves, const CleaningOptions& options, const Progress& progress) {
  CurveCleaning(surface, curves, options).run(progress);
}

}  // namespace hybrid_mesh
