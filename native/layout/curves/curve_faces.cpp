// SPDX-License-Identifier: GPL-3.0-or-later
// What curves make of the faces that they run through: chords, the parts between them, and the surface split along them.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "layout/curves/face_splitting.h"
#include "layout/curves/surface_curves.h"

namespace hybrid_mesh {

SurfaceCurves::FacePolygon SurfaceCurves::polygon(int f) const {
  FacePolygon out;
  std::array<int, 3> corner_station{};
  std::vector<std::pair<int, int>> of_crossing;
  for (int i = 0; i < 3; ++i) {
    const int s = 3 * f + i;
    Station corner;
    corner.corner = i;
    corner.weights[i] = 1;
    corner_station[i] = static_cast<int>(out.stations.size());
    out.stations.push_back(corner);
    const std::vector<int>& list = on_edge_[mesh_.edge[s]];
    const bool up = mesh_.from(s) < mesh_.to(s);
    for (std::size_t k = 0; k < list.size(); ++k) {
      Station x;
      x.crossing = up ? list[k] : list[list.size() - 1 - k];
      const double t = up ? crossings_[x.crossing].t : 1 - crossings_[x.crossing].t;
      x.weights[i] = 1 - t;
      x.weights[(i + 1) % 3] = t;
      of_crossing.push_back({x.crossing, static_cast<int>(out.stations.size())});
      out.stations.push_back(x);
    }
  }
  if (of_crossing.empty()) return out;
  std::sort(of_crossing.begin(), of_crossing.end());
  const auto station = [&](int n) { return std::lower_bound(of_crossing.begin(), of_crossing.end(), std::pair(n, 0))->second; };
  const auto corner_of = [&](int v) {
    for (int i = 0; i < 3; ++i)
      if (mesh_.from(3 * f + i) == v) return corner_station[i];
    throw Error(ErrorCode::Internal, "a curve ends outside the face that it runs through");
  };
  for (const auto& [n, at] : of_crossing) {
    const Crossing& x = crossings_[n];
    int side = 3 * f;
    while (mesh_.edge[side] != x.edge) ++side;
    const bool up = mesh_.from(side) < mesh_.to(side);
    if (x.next_left == up)
      out.chords.push_back({x.curve, at, x.next >= 0 ? station(x.next) : corner_of(curves_[x.curve].end), n, x.next});
    else if (x.previous < 0)
      out.chords.push_back({x.curve, corner_of(curves_[x.curve].start), at, -1, n});
  }
  return out;
}

void SurfaceCurves::find_cells(int f, FaceCells& out) const {
  out.gaps.clear(), out.corners.clear();
  bool empty = true;
  for (int h = 3 * f; h < 3 * f + 3; ++h) empty = empty && on_edge_[mesh_.edge[h]].empty();
  if (empty) {
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      if (mesh_.opposite[h] >= 0 && along_[mesh_.edge[h]] < 0) out.gaps.push_back({h, 0, -1, 0, 1, 0});
      out.corners.push_back({h, 0, 0});
    }
    return;
  }
  const FacePolygon poly = polygon(f);
  // A cell is told by the sides of the chords on which it lies.
  std::vector<std::vector<char>> sides;
  const auto cell = [&](std::vector<char> of) {
    const auto at = std::find(sides.begin(), sides.end(), of);
    if (at != sides.end()) return static_cast<int>(at - sides.begin());
    sides.push_back(std::move(of));
    return static_cast<int>(sides.size()) - 1;
  };
  const int count = static_cast<int>(poly.stations.size());
  std::vector<char> of(poly.chords.size());
  int side = 0;
  for (int s = 0; s < count; ++s) {
    const Station &here = poly.stations[s], &next = poly.stations[(s + 1) % count];
    if (here.corner >= 0) {
      side = here.corner;
      // The chords that end here, counter-clockwise: by how far on their other ends are.
      std::vector<std::pair<int, int>> ends;
      for (std::size_t k = 0; k < poly.chords.size(); ++k) {
        const Chord& c = poly.chords[k];
        if (c.from == s || c.to == s) ends.push_back({((c.from == s ? c.to : c.from) - s + count) % count, static_cast<int>(k)});
      }
      std::sort(ends.begin(), ends.end());
      for (std::size_t k = 0; k < of.size(); ++k) {
        const auto [low, high] = std::minmax(poly.chords[k].from, poly.chords[k].to);
        of[k] = s > low && s < high;
      }
      for (int rank = 0; rank <= static_cast<int>(ends.size()); ++rank) {
        for (int k = 0; k < static_cast<int>(ends.size()); ++k) {
          const Chord& c = poly.chords[ends[k].second];
          of[ends[k].second] = (k >= rank) == (std::min(c.from, c.to) == s);
        }
        out.corners.push_back({3 * f + side, rank, cell(of)});
      }
    }
    const int h = 3 * f + side, e = mesh_.edge[h];
    if (mesh_.opposite[h] < 0 || along_[e] >= 0) continue;
    for (std::size_t k = 0; k < of.size(); ++k) {
      const auto [low, high] = std::minmax(poly.chords[k].from, poly.chords[k].to);
      of[k] = s >= low && s < high;
    }
    const bool up = mesh_.from(h) < mesh_.to(h);
    const int crossing = up ? here.crossing : next.crossing;
    int rank = 0;
    if (crossing >= 0) rank = static_cast<int>(std::find(on_edge_[e].begin(), on_edge_[e].end(), crossing) - on_edge_[e].begin()) + 1;
    out.gaps.push_back(
        {h, rank, crossing, here.corner >= 0 ? 0 : here.weights[(side + 1) % 3], next.corner >= 0 ? 1 : next.weights[(side + 1) % 3], cell(of)});
  }
}

bool SurfaceCurves::alternate(const Chord& a, const Chord& b) {
  const int low = std::min(a.from, a.to), high = std::max(a.from, a.to);
  if (b.from == low || b.from == high || b.to == low || b.to == high) return false;
  return (b.from > low && b.from < high) != (b.to > low && b.to < high);
}

bool SurfaceCurves::is_clear(int c) const {
  if (curves_[c].along >= 0) return on_edge_[curves_[c].along].empty();
  const auto is_clear_in = [&](int f) {
    const FacePolygon poly = polygon(f);
    for (const Chord& a : poly.chords)
      for (const Chord& b : poly.chords)
        if (a.curve == c && alternate(a, b)) return false;
    return true;
  };
  for (int n = curves_[c].first; n >= 0; n = crossings_[n].next)
    if (!is_clear_in(leaving(n) / 3)) return false;
  return is_clear_in(mesh_.opposite[leaving(curves_[c].last)] / 3);
}

CutMesh SurfaceCurves::cut() const {
  CutMesh out;
  out.mesh.points = points_;
  out.source = source_;
  out.chains.resize(curves_.size());
  std::vector<int> point_of(crossings_.size(), -1);
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    if (!curves_[c].alive) continue;
    out.chains[c].push_back(curves_[c].start);
    for (int n = curves_[c].first; n >= 0; n = crossings_[n].next) {
      const Crossing& x = crossings_[n];
      point_of[n] = static_cast<int>(out.mesh.points.size());
      out.chains[c].push_back(point_of[n]);
      out.mesh.points.push_back(position(n));
      out.source.push_back(combine({&source_[low(x.edge)], &source_[high(x.edge)], nullptr}, {1 - x.t, x.t, 0}));
    }
    out.chains[c].push_back(curves_[c].end);
  }
  const std::array<Vec2, 3> reference{Vec2(0, 0), Vec2(1, 0), Vec2(0.5, std::sqrt(0.75))};
  for (int f = 0; f < face_count(); ++f) {
    const FacePolygon poly = polygon(f);
    std::vector<PieceCorner> corners;
    int side = 0;
    for (const Station& s : poly.stations) {
      if (s.corner >= 0) side = s.corner;
      PieceCorner c{};
      c.point = s.corner >= 0 ? mesh_.from(3 * f + s.corner) : point_of[s.crossing];
      // A side with crossings is not a curve itself.
      c.mark = s.corner >= 0 ? along_[mesh_.edge[3 * f + side]] : -1;
      c.sides = s.corner >= 0 ? (1 << side) | (1 << ((side + 2) % 3)) : 1 << side;
      c.at = s.weights[0] * reference[0] + s.weights[1] * reference[1] + s.weights[2] * reference[2];
      corners.push_back(c);
    }
    const auto emit = [&](const PieceCorner& a, const PieceCorner& b, const PieceCorner& c, int ab, int bc, int ca) {
      out.mesh.faces.push_back({a.point, b.point, c.point});
      out.mesh.source_face.push_back(source_face_[f]);
      out.curve.insert(out.curve.end(), {ab, bc, ca});
    };
    std::vector<FaceChord> chords;
    for (const Chord& c : poly.chords) chords.push_back({std::min(c.from, c.to), std::max(c.from, c.to), c.curve});
    split_along_chords(corners, chords, emit);
  }
  connect_half_edges(out.mesh);
  return out;
}

const char* SurfaceCurves::find_defect() const {
  std::vector<char> listed(crossings_.size(), 0);
  for (int e = 0; e < mesh_.edge_count; ++e) {
    if (mesh_.edge[half_edge_[e]] != e) return "an edge without a half-edge";
    if (!on_edge_[e].empty() && mesh_.opposite[half_edge_[e]] < 0) return "a curve crosses the boundary";
    if (!on_edge_[e].empty() && along_[e] >= 0) return "a curve crosses another that is an edge";
    double last = 0;
    for (const int n : on_edge_[e]) {
      if (crossings_[n].edge != e || crossings_[n].curve < 0 || listed[n]) return "a crossing is listed on another edge than its own, or twice";
      if (!(crossings_[n].t > last && crossings_[n].t < 1)) return "the crossings of an edge are out of order";
      last = crossings_[n].t;
      listed[n] = 1;
    }
  }
  std::vector<int> degree(points_.size(), 0);
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    const Curve& curve = curves_[c];
    if (!curve.alive) continue;
    ++degree[curve.start], ++degree[curve.end];
    if ((curve.first < 0) != (curve.along >= 0)) return "a curve without crossings is no edge";
    if (curve.along >= 0) {
      if (along_[curve.along] != static_cast<int>(c)) return "a curve's edge does not know it";
      if (std::minmax(curve.start, curve.end) != std::minmax(low(curve.along), high(curve.along))) return "a curve is an edge between other vertices";
      continue;
    }
    int previous = -1;
    for (int n = curve.first; n >= 0; n = crossings_[n].next) {
      const Crossing& x = crossings_[n];
      if (x.curve != static_cast<int>(c) || x.previous != previous || !listed[n]) return "a curve's crossings are not linked";
      const int face = leaving(n) / 3;
      if (previous < 0 ? mesh_.apex(leaving(n)) != curve.start : mesh_.opposite[leaving(previous)] / 3 != face)
        return "a curve goes from one face to another without crossing";
      if (previous >= 0 && crossings_[previous].edge == x.edge) return "a curve leaves a face where it came in";
      previous = n;
    }
    if (previous != curve.last || mesh_.apex(mesh_.opposite[leaving(previous)]) != curve.end) return "a curve does not reach its end";
  }
  if (degree != degree_) return "a vertex with another number of curve ends than it says";
  for (int f = 0; f < face_count(); ++f) {
    const FacePolygon poly = polygon(f);
    for (std::size_t i = 0; i < poly.chords.size(); ++i)
      for (std::size_t j = i + 1; j < poly.chords.size(); ++j)
        if (alternate(poly.chords[i], poly.chords[j])) return "two curves cross";
  }
  return "";
}

}  // namespace hybrid_mesh
