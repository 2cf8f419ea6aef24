// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/region_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/error.h"
#include "decoder/disjoint_sets.h"

namespace hybrid_mesh {
namespace {

constexpr double kSame = 1e-9;  // of a loop's edge: points of both sides that are no farther apart are one

// A rim that comes to light where faces are taken out, as places on the loop that it runs along: place i + t is at t between the loop's points i and
// i + 1. Its points are in the loop's direction, the first at the loop's first point.
struct PlacedRim {
  std::vector<int> points;
  std::vector<double> places;
  bool reversed = false;  // faces run along it against the loop's direction
};

// The places of a closed line's points on a loop all of whose points it has; nothing if it does not run along the loop. Points of the loop may
// coincide: what tells them apart is the order.
std::optional<PlacedRim> place_rim(const std::vector<int>& line, const std::vector<Vec3>& points, const std::vector<Vec3>& loop) {
  constexpr double near = 1e-6;  // of the shorter edge
  const std::size_t n = loop.size(), m = line.size();
  const auto is_at = [&](int v, std::size_t i) {
    const double edge = std::min((loop[(i + 1) % n] - loop[i]).norm(), (loop[(i + n - 1) % n] - loop[i]).norm());
    return (points[v] - loop[i]).norm() <= near * edge;
  };
  for (const bool back : {false, true}) {
    const auto on_line = [&](std::size_t first, std::size_t k) { return line[back ? (first + m - k % m) % m : (first + k) % m]; };
    // Of points that are near one of the loop's the nearest is it: a cut may have put another beside it.
    const auto is_nearest = [&](std::size_t first, std::size_t k, std::size_t i) {
      const double own = (points[on_line(first, k)] - loop[i]).norm();
      return is_at(on_line(first, k), i) && own <= (points[on_line(first, k + 1)] - loop[i]).norm() &&
             own <= (points[on_line(first, k + m - 1)] - loop[i]).norm();
    };
    for (std::size_t first = 0; first < m; ++first) {
      if (!is_nearest(first, 0, 0)) continue;
      PlacedRim rim;
      rim.reversed = back;
      std::size_t i = 0;  // the last point of the loop that was passed
      bool ordered = true;
      for (std::size_t k = 0; k < m && ordered; ++k) {
        const int v = on_line(first, k);
        const bool next = k > 0 && i + 1 < n && is_nearest(first, k, i + 1);
        i += next;
        const double t = next || k == 0 ? 0 : (points[v] - loop[i]).norm() / (loop[(i + 1) % n] - loop[i]).norm();
        ordered = t < 1 && (k == 0 || static_cast<double>(i) + t > rim.places.back());
        rim.points.push_back(v);
        rim.places.push_back(static_cast<double>(i) + t);
      }
      if (ordered && i + 1 == n) return rim;
    }
  }
  return std::nullopt;
}

class Exchange {
 public:
  Exchange(const RegionSurface& part, const SurfaceSeries& series, const std::vector<int>& events, const Placement& placement, GluedMaps& glued)
      : part_(part), series_(series), events_(events), placement_(placement), glued_(glued) {}

  RegionSurface run() {
    for (std::size_t v = 0; v < part_.mesh.points.size(); ++v) {
      points_.push_back(part_.mesh.points[v]);
      whole_.push_back(part_.point[v]);
      id_.push_back(part_.source[v].vertices[0]);
    }
    take_out();
    for (const int e : events_) open(e);
    return finished();
  }

 private:
  struct Face {
    std::array<int, 3> corners;
    int source;                    // see OpenedSurface::faces
    std::array<float, 9> weights;  // there, corner by corner
  };
  using Line = std::vector<int>;

  // Keeps the faces that are no cap's or tube's of the events, and finds the lines where these bordered on them, by event and side.
  void take_out() {
    const std::set<int> opening(events_.begin(), events_.end());
    const auto event_of = [&](int f) {
      const int source = glued_.on.face[part_.mesh.source_face[f]];
      const int e = source < static_cast<int>(series_.face_event.size()) ? series_.face_event[source] : -1;
      return opening.count(e) ? e : -1;
    };
    std::map<std::pair<int, int>, std::map<int, int>> next;  // by event and side: along the lines, faces on the left
    for (int f = 0; f < static_cast<int>(part_.mesh.faces.size()); ++f) {
      if (event_of(f) >= 0) continue;
      const int glued_face = part_.mesh.source_face[f];
      faces_.push_back({part_.mesh.faces[f], glued_.on.face[glued_face], glued_.on.weights[glued_face]});
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int across = part_.mesh.opposite[h] < 0 ? -1 : part_.mesh.opposite[h] / 3;
        const int e = across < 0 ? -1 : event_of(across);
        if (e < 0) continue;
        const int side = series_.face_side[glued_.on.face[part_.mesh.source_face[across]]];
        if (!next[{e, side}].insert({part_.mesh.from(h), part_.mesh.to(h)}).second) throw NoMap("what opens touches itself");
      }
    }
    for (auto& [name, to] : next)
      while (!to.empty()) lines_[name].push_back(take_line(to));
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const auto& c = faces_[f].corners;
      for (int i = 0; i < 3; ++i) face_along_[{c[i], c[(i + 1) % 3]}] = static_cast<int>(f);
    }
  }

  void open(int e) {
    const TopologyEvent& event = series_.events[e];
    std::vector<Line>&first = lines_[{e, 0}], &second = lines_[{e, 1}];
    switch (event.kind) {
      case EventKind::Cut:
        if (first.size() != 1 || second.size() != 1) outside();
        zip(placed(first[0], positions(event.loops[0])), placed(second[0], positions(event.loops[0])));
        break;
      case EventKind::Boundary:
        if (first.size() != 1) outside();
        placed(first[0], positions(event.loops[0]));
        break;
      case EventKind::Tube:
        if (first.size() != 2) outside();
        for (int end = 0; end < 2; ++end) {
          const std::vector<Vec3> loop = positions(event.loops[end]);
          std::optional<PlacedRim> rim = place_rim(first[0], points_, loop);
          if (!rim) rim = placed(first[1], loop);
          zip(*rim, placed(bring_back(e, end), loop));
        }
        break;
    }
  }

  [[noreturn]] static void outside() { throw NoMap("what opens is not wholly inside the region"); }

  std::vector<Vec3> positions(const std::vector<int>& loop) const {
    std::vector<Vec3> out;
    for (const int v : loop) out.push_back(placement_.to_unit(series_.input.points[v]));
    return out;
  }

  PlacedRim placed(const Line& line, const std::vector<Vec3>& loop) const {
    std::optional<PlacedRim> rim = place_rim(line, points_, loop);
    if (!rim) throw NoMap("what opens does not end at its loop");
    return std::move(*rim);
  }

  // Adds the faces that a tube hides at one of its ends. Returns their boundary.
  Line bring_back(int e, int end) {
    int number = static_cast<int>(series_.closed.faces.size());
    for (int before = 0; before < e; ++before)
      for (const auto& hidden : series_.hidden[before]) number += static_cast<int>(hidden.size());
    if (end == 1) number += static_cast<int>(series_.hidden[e][0].size());
    std::map<int, int> point;
    std::map<int, int> to;
    for (const int f : series_.hidden[e][end]) {
      Face face{{}, number++, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
      for (int i = 0; i < 3; ++i) {
        const int v = series_.input.faces[f][i];
        const auto [at, fresh] = point.insert({v, static_cast<int>(points_.size())});
        if (fresh) add_point(placement_.to_unit(series_.input.points[v]));
        face.corners[i] = at->second;
      }
      for (int i = 0; i < 3; ++i) face_along_[{face.corners[i], face.corners[(i + 1) % 3]}] = static_cast<int>(faces_.size());
      faces_.push_back(face);
    }
    for (const int f : series_.hidden[e][end])
      for (int i = 0; i < 3; ++i) {
        const int a = point[series_.input.faces[f][i]], b = point[series_.input.faces[f][(i + 1) % 3]];
        if (!face_along_.count({b, a})) to[a] = b;
      }
    return take_line(to);
  }

  // Walks one line to its end and takes it out of the steps from point to point.
  static Line take_line(std::map<int, int>& to) {
    Line line;
    for (auto at = to.begin(); at != to.end();) {
      line.push_back(at->first);
      const int v = at->second;
      to.erase(at);
      at = to.find(v);
    }
    return line;
  }

  int add_point(const Vec3& p) {
    points_.push_back(p);
    whole_.push_back(-1);
    id_.push_back(-1);
    return static_cast<int>(points_.size()) - 1;
  }

  // Joins two rims along one loop, each getting the points that the other one has.
  void zip(PlacedRim a, PlacedRim b) {
    if (a.reversed == b.reversed) throw NoMap("the two sides of what opens do not fit");
    add_missing(a, b);
    add_missing(b, a);
    for (std::size_t k = 0; k < a.points.size(); ++k) joined_[b.points[k]] = a.points[k];
  }

  // Gives a rim the points of another one that it lacks.
  void add_missing(PlacedRim& rim, const PlacedRim& other) {
    PlacedRim out;
    out.reversed = rim.reversed;
    std::size_t k = 0;
    for (std::size_t i = 0; i < rim.points.size(); ++i) {
      const double from = rim.places[i], to = i + 1 < rim.places.size() ? rim.places[i + 1] : std::floor(from) + 1;
      out.points.push_back(rim.points[i]);
      out.places.push_back(from);
      while (k < other.places.size() && other.places[k] <= from + kSame) ++k;
      std::vector<int> inserted;
      std::vector<double> fractions;
      for (; k < other.places.size() && other.places[k] < to - kSame; ++k) {
        inserted.push_back(add_point(points_[other.points[k]]));
        fractions.push_back((other.places[k] - from) / (to - from));
        out.points.push_back(inserted.back());
        out.places.push_back(other.places[k]);
      }
      if (!inserted.empty()) split(rim.points[i], rim.points[(i + 1) % rim.points.size()], std::move(inserted), std::move(fractions), rim.reversed);
    }
    rim = std::move(out);
  }

  // Splits the face along an edge by points of the edge.
  void split(int a, int b, std::vector<int> inserted, std::vector<double> fractions, bool reversed) {
    if (reversed) {
      std::swap(a, b);
      std::reverse(inserted.begin(), inserted.end());
      std::reverse(fractions.begin(), fractions.end());
      for (double& t : fractions) t = 1 - t;
    }
    const auto at = face_along_.find({a, b});
    if (at == face_along_.end()) throw Error(ErrorCode::Internal, "no face runs along the rim of what opens");
    const int first = at->second;
    const Face face = faces_[first];
    int i = 0;
    while (face.corners[i] != a) ++i;
    const int c = face.corners[(i + 2) % 3];
    const auto weights_of = [&](int corner) {
      return std::array{face.weights[3 * corner], face.weights[3 * corner + 1], face.weights[3 * corner + 2]};
    };
    const auto wa = weights_of(i), wb = weights_of((i + 1) % 3), wc = weights_of((i + 2) % 3);
    inserted.push_back(b);
    fractions.push_back(1);
    int from = a;
    auto from_weights = wa;
    for (std::size_t k = 0; k < inserted.size(); ++k) {
      std::array<float, 3> to_weights;
      for (int j = 0; j < 3; ++j) to_weights[j] = static_cast<float>((1 - fractions[k]) * wa[j] + fractions[k] * wb[j]);
      Face piece{{from, inserted[k], c}, face.source, {}};
      for (int j = 0; j < 3; ++j) piece.weights[j] = from_weights[j], piece.weights[3 + j] = to_weights[j], piece.weights[6 + j] = wc[j];
      const int number = k == 0 ? first : static_cast<int>(faces_.size());
      if (k == 0)
        faces_[first] = piece;
      else
        faces_.push_back(piece);
      for (int j = 0; j < 3; ++j) face_along_[{piece.corners[j], piece.corners[(j + 1) % 3]}] = number;
      from = inserted[k];
      from_weights = to_weights;
    }
  }

  RegionSurface finished() {
    RegionSurface out;
    std::vector<int> number(points_.size(), -1);
    int next_id = static_cast<int>(glued_.mapped.surface.mesh.points.size());
    const auto point = [&](int v) {
      if (const auto joined = joined_.find(v); joined != joined_.end()) v = joined->second;
      if (number[v] < 0) {
        number[v] = static_cast<int>(out.mesh.points.size());
        out.mesh.points.push_back(points_[v]);
        out.point.push_back(whole_[v]);
        if (id_[v] < 0) id_[v] = next_id++;
        out.source.push_back({{id_[v], -1, -1}, {1, 0, 0}});
      }
      return number[v];
    };
    for (const Face& face : faces_) {
      std::array<int, 3> corners;
      for (int i = 0; i < 3; ++i) corners[i] = point(face.corners[i]);
      out.mesh.faces.push_back(corners);
      out.mesh.source_face.push_back(static_cast<int>(glued_.faces.size()));
      glued_.faces.push_back({out.source[corners[0]].vertices[0], out.source[corners[1]].vertices[0], out.source[corners[2]].vertices[0]});
      glued_.on.face.push_back(face.source);
      glued_.on.weights.push_back(face.weights);
    }
    try {
      connect_half_edges(out.mesh);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::InvalidInput) throw;
      throw NoMap(std::string("what opens makes no surface: ") + e.what());
    }
    std::vector<char> on_boundary(out.mesh.points.size(), 0);
    for (int h = 0; h < static_cast<int>(out.mesh.opposite.size()); ++h)
      if (out.mesh.opposite[h] < 0 && std::exchange(on_boundary[out.mesh.from(h)], 1)) throw NoMap("what opens touches the region's boundary");
    for (const std::vector<int>& side : part_.sides) {
      std::vector<int>& own = out.sides.emplace_back();
      for (const int v : side) {
        if (number[v] < 0) outside();
        own.push_back(number[v]);
      }
    }
    return out;
  }

  const RegionSurface& part_;
  const SurfaceSeries& series_;
  const std::vector<int>& events_;
  const Placement& placement_;
  GluedMaps& glued_;
  std::vector<Vec3> points_;
  std::vector<int> whole_, id_;  // per point: of the whole; among the points that the glued faces name
  std::vector<Face> faces_;
  std::map<std::pair<int, int>, int> face_along_;  // by the ends of an edge that it runs along
  std::map<std::pair<int, int>, std::vector<Line>> lines_;
  std::map<int, int> joined_;  // a point is another one now
};

}  // namespace

RegionSurface exchanged(const RegionSurface& part, const SurfaceSeries& series, const std::vector<int>& events, const Placement& placement,
                        GluedMaps& glued) {
  return Exchange(part, series, events, placement, glued).run();
}

std::vector<RegionPiece> pieces_of(const RegionSurface& surface, const PatchRegion& region) {
  const TriangleSurface& mesh = surface.mesh;
  DisjointSets joined(mesh.points.size());
  for (const auto& f : mesh.faces)
    for (int i = 1; i < 3; ++i) joined.join(f[i], f[0]);
  std::map<int, RegionPiece> pieces;  // by the point that stands for it
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const auto [at, fresh] = pieces.insert({joined.find(static_cast<int>(v)), {}});
    if (fresh) at->second.euler = 0;
    ++at->second.euler;
  }
  std::vector<int> next(mesh.points.size(), -1);
  for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
    RegionPiece& piece = pieces[joined.find(mesh.from(h))];
    if (h % 3 == 0) ++piece.euler;
    if (mesh.opposite[h] < h) --piece.euler;  // each edge once
    if (mesh.opposite[h] < 0) next[mesh.from(h)] = mesh.to(h);
  }
  const auto walk = [&](int v) {
    while (next[v] >= 0) v = std::exchange(next[v], -1);
  };
  for (int r = 0; r < region.rim_count(); ++r) {
    const int v = surface.corner(region.rims[r]);
    pieces[joined.find(v)].rims.push_back(r);
    walk(v);
  }
  for (std::size_t v = 0; v < next.size(); ++v) {
    if (next[v] < 0) continue;
    ++pieces[joined.find(static_cast<int>(v))].open_loops;
    walk(static_cast<int>(v));
  }
  std::vector<RegionPiece> out;
  for (auto& [point, piece] : pieces) out.push_back(std::move(piece));
  return out;
}

}  // namespace hybrid_mesh
