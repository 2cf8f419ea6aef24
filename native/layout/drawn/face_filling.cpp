// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/face_filling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "base/found.h"
#include "layout/regions/disk_drawing.h"

namespace hybrid_mesh {
namespace {

constexpr double kRightAngle = 0.5 * std::numbers::pi;
constexpr double kUndecided = 0.3;            // quads: an angle so far from a whole number of right angles may be rounded up or down
constexpr int kMostTrials = 24;               // of other roundings in a face
constexpr int kIrregular = 2, kUnsound = 20;  // in quads: what a node that is not regular costs, and one with a quad too few or too many
constexpr int kMostRounds = 6;                // in which nodes with too few or too many quads are put right

// A face that is to be filled, and its corners.
struct Polygon {
  int face = -1;
  std::vector<int> nodes;
  std::vector<double> angle;  // of the face on the surface
  std::vector<int> wishes;    // quads
  DiskLayout filling;

  int size() const { return static_cast<int>(nodes.size()); }
  std::vector<int> quads_at() const {
    std::vector<int> count(nodes.size(), 0);
    for (const auto& quad : filling.quads)
      for (const int c : quad)
        if (c < size()) ++count[c];
    return count;
  }
};

class FaceFiller {
 public:
  FaceFiller(const PatchLayout& layout, const FaceFillingOptions& options, const Progress& progress)
      : layout_(layout), progress_(progress), joined_(options.joined) {
    const int nodes = static_cast<int>(layout.nodes.size());
    least_.assign(nodes, 3);
    most_.assign(nodes, 6);
    fixed_.assign(nodes, 0);
    for (const PatchLayout::Curve& c : layout.curves) {
      joined_.insert({{c.from, c.to}, {c.to, c.from}});
      if (c.boundary)
        for (const int n : {c.from, c.to}) least_[n] = 1, most_[n] = 4;
    }
    for (std::size_t n = 0; n < options.quads_at.size(); ++n)
      if (options.quads_at[n] > 0) least_[n] = most_[n] = options.quads_at[n];
    for (int f = 0; f < static_cast<int>(layout.faces.size()); ++f) add_face(f);
    find_angles();
  }

  std::vector<DiskLayout> run() {
    wish();
    for (Polygon& p : polygons_) fill(p);
    for (Polygon& p : polygons_) simplify(p);
    std::vector<Polygon> best = polygons_;
    int least = defects();
    for (int round = 0; round < kMostRounds && least > 0 && put_right(); ++round)
      if (const int now = defects(); now < least) least = now, best = polygons_;
    std::vector<DiskLayout> out(layout_.faces.size());
    for (std::size_t f = 0; f < out.size(); ++f)
      if (is_quad(layout_.faces[f])) out[f].quads.push_back({0, 1, 2, 3});
    for (Polygon& p : best) out[p.face] = std::move(p.filling);
    return out;
  }

 private:
  static bool is_quad(const PatchLayout::Face& face) { return face.is_disk() && face.side_count() == 4; }

  void add_face(int f) {
    const PatchLayout::Face& face = layout_.faces[f];
    std::vector<int> nodes;
    for (const auto& cycle : face.cycles)
      for (const PatchLayout::Side& s : cycle) nodes.push_back(layout_.start(s));
    std::vector<int> sorted = nodes;
    std::sort(sorted.begin(), sorted.end());
    const bool touches_itself = std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
    if (face.is_disk() && !touches_itself && face.side_count() >= 6 && face.side_count() % 2 == 0) {
      polygons_.push_back({f, nodes, std::vector<double>(nodes.size(), 0), {}, {}});
    } else {
      for (const int n : nodes) ++fixed_[n];
    }
  }

  void find_angles() {
    std::vector<int> polygon_of(layout_.faces.size(), -1), node_of(layout_.mesh.points.size(), -1);
    for (std::size_t k = 0; k < polygons_.size(); ++k) polygon_of[polygons_[k].face] = static_cast<int>(k);
    for (std::size_t n = 0; n < layout_.nodes.size(); ++n) node_of[layout_.nodes[n]] = static_cast<int>(n);
    const TriangleSurface& mesh = layout_.mesh;
    for (int h = 0; h < static_cast<int>(mesh.opposite.size()); ++h) {
      const int n = node_of[mesh.from(h)], k = polygon_of[layout_.face[h / 3]];
      if (n < 0 || k < 0) continue;
      const auto at = std::find(polygons_[k].nodes.begin(), polygons_[k].nodes.end(), n);
      if (at == polygons_[k].nodes.end()) continue;
      const Vec3& p = mesh.points[mesh.from(h)];
      const Vec3 a = mesh.points[mesh.to(h)] - p, b = mesh.points[mesh.from(TriangleSurface::previous(h))] - p;
      polygons_[k].angle[at - polygons_[k].nodes.begin()] += std::atan2(a.cross(b).norm(), a.dot(b));
    }
  }

  struct Corner {
    Polygon* polygon;
    int k;
    int quads;                                                 // wished or there
    double room() const { return polygon->angle[k] / quads; }  // of each of the quads
  };
  std::vector<std::vector<Corner>> corners(bool filled) {
    std::vector<std::vector<Corner>> at(layout_.nodes.size());
    for (Polygon& p : polygons_) {
      const std::vector<int> quads = filled ? p.quads_at() : p.wishes;
      for (int k = 0; k < p.size(); ++k) at[p.nodes[k]].push_back({&p, k, quads[k]});
    }
    return at;
  }
  int total(int node, const std::vector<Corner>& corners) const {
    int sum = fixed_[node];
    for (const Corner& c : corners) sum += c.quads;
    return sum;
  }
  // Where one more quad finds most room, or one fewer makes it. Nothing where no corner can give one up.
  static Corner* most_fitting(std::vector<Corner>& corners, int by) {
    Corner* best = nullptr;
    for (Corner& c : corners) {
      if (c.quads + by < 1) continue;
      if (!best || (by > 0 ? c.room() > best->room() : c.room() < best->room())) best = &c;
    }
    return best;
  }

  // About a quad for each right angle, and at each node as many as it may have.
  void wish() {
    for (Polygon& p : polygons_)
      for (const double angle : p.angle) p.wishes.push_back(angle < 1.5 * kRightAngle ? 1 : angle < 2.5 * kRightAngle ? 2 : 3);
    std::vector<std::vector<Corner>> at = corners(false);
    for (std::size_t n = 0; n < at.size(); ++n)
      for (int sum = total(static_cast<int>(n), at[n]); sum < least_[n] || sum > most_[n];) {
        const int by = sum < least_[n] ? 1 : -1;
        Corner* corner = most_fitting(at[n], by);
        if (!corner) break;
        corner->polygon->wishes[corner->k] = corner->quads += by;
        sum += by;
      }
  }

  // The pairs of its nodes that a filling joins across the polygon.
  static std::vector<std::pair<int, int>> chords(const Polygon& p) {
    std::vector<std::pair<int, int>> found;
    for (const auto& quad : p.filling.quads)
      for (int i = 0; i < 4; ++i) {
        const int a = quad[i], b = quad[(i + 1) % 4];
        if (a < p.size() && b < p.size() && b != (a + 1) % p.size()) found.push_back({p.nodes[a], p.nodes[b]});
      }
    return found;
  }

  void fill(Polygon& p) {
    if (!p.filling.quads.empty())
      for (const auto& chord : chords(p)) joined_.erase(chord);
    p.filling = fill_disk(p.wishes, progress_);
    std::vector<std::pair<int, int>> across = chords(p);
    if (std::any_of(across.begin(), across.end(), [&](const auto& chord) { return joined_.count(chord) > 0; })) {
      p.filling = fill_disk_with_ring(p.size(), progress_);
      across.clear();
    }
    joined_.insert(across.begin(), across.end());
  }

  // What a filling is worth avoiding: quads, irregular nodes inside and at its corners, where others have so many quads, and nodes with too few or
  // too many quads.
  int cost(const Polygon& p, const std::vector<int>& of_others) const {
    std::vector<int> around(p.size() + p.filling.inner_nodes, 0);
    for (const auto& quad : p.filling.quads)
      for (const int c : quad) ++around[c];
    int sum = static_cast<int>(p.filling.quads.size());
    for (int c = 0; c < static_cast<int>(around.size()); ++c) {
      if (c >= p.size()) {
        sum += kIrregular * (around[c] != 4);
        continue;
      }
      const int n = p.nodes[c], quads = of_others[c] + around[c];
      const int regular = least_[n] == most_[n] ? least_[n] : least_[n] == 1 ? 2 : 4;
      sum += kIrregular * (quads != regular) + kUnsound * std::max({0, least_[n] - quads, quads - most_[n]});
    }
    return sum;
  }

  // An angle about halfway between two numbers of quads may have either: that which is filled more simply.
  void simplify(Polygon& p) {
    const std::vector<std::vector<Corner>> at = corners(true);
    const std::vector<int> own = p.quads_at();
    std::vector<int> of_others;
    for (int k = 0; k < p.size(); ++k) of_others.push_back(total(p.nodes[k], at[p.nodes[k]]) - own[k]);
    int trials = 0, least = cost(p, of_others);
    for (int k = 0; k < p.size() && trials < kMostTrials; ++k) {
      const double more = p.angle[k] / kRightAngle - p.wishes[k];
      if (std::abs(more) < kUndecided || (more < 0 && p.wishes[k] == 1)) continue;
      ++trials;
      Polygon other = p;
      other.wishes[k] += more > 0 ? 1 : -1;
      fill(other);
      const int now = cost(other, of_others);
      if (now < least) {
        least = now;
        p = std::move(other);
      } else {
        for (const auto& chord : chords(other)) joined_.erase(chord);
        for (const auto& chord : chords(p)) joined_.insert(chord);
      }
    }
  }

  // How many quads too few or too many there are at nodes.
  int defects() {
    const std::vector<std::vector<Corner>> at = corners(true);
    int count = 0;
    for (std::size_t n = 0; n < at.size(); ++n) {
      const int sum = total(static_cast<int>(n), at[n]);
      if (!at[n].empty()) count += std::max({0, least_[n] - sum, sum - most_[n]});
    }
    return count;
  }

  // Where wishes could not be kept, nodes may have too few quads or too many: then others are wished there. True if there was anything to change.
  bool put_right() {
    std::vector<std::vector<Corner>> at = corners(true);
    std::set<Polygon*> changed;
    for (std::size_t n = 0; n < at.size(); ++n) {
      const int sum = total(static_cast<int>(n), at[n]);
      if (sum >= least_[n] && sum <= most_[n]) continue;
      const int by = sum < least_[n] ? 1 : -1;
      Corner* corner = most_fitting(at[n], by);
      if (!corner) continue;
      const int wished = std::clamp(corner->quads + by, 1, 5);
      if (corner->polygon->wishes[corner->k] == wished) continue;
      corner->polygon->wishes[corner->k] = wished;
      changed.insert(corner->polygon);
    }
    for (Polygon& p : polygons_)
      if (changed.count(&p)) fill(p);
    return !changed.empty();
  }

  const PatchLayout& layout_;
  const Progress& progress_;
  std::set<std::pair<int, int>> joined_;
  std::vector<int> least_, most_;  // quads at each node
  std::vector<int> fixed_;         // quads at each node in faces that are not filled
  std::vector<Polygon> polygons_;
};

// Puts the quads of all faces together.
class FaceCutter {
 public:
  explicit FaceCutter(const PatchLayout& layout) : layout_(layout) {
    out_.mesh.points = layout.mesh.points;
    out_.source = layout.source;
    out_.node_count = static_cast<int>(layout.nodes.size());
    beside_.resize(2 * layout.curves.size());
  }

  void add(int f, const DiskLayout& filling) {
    const std::vector<PatchLayout::Side>& cycle = layout_.faces[f].cycles.front();
    const int n = static_cast<int>(cycle.size()), first = out_.patch_count(), first_node = out_.node_count;
    out_.node_count += filling.inner_nodes;
    std::map<std::pair<int, int>, PatchSide> sides;
    for (std::size_t q = 0; q < filling.quads.size(); ++q) {
      std::array<int, 4>& nodes = out_.nodes.emplace_back();
      for (int i = 0; i < 4; ++i) {
        const int a = filling.quads[q][i], b = filling.quads[q][(i + 1) % 4];
        nodes[i] = a < n ? layout_.start(cycle[a]) : first_node + a - n;
        sides[{a, b}] = {first + static_cast<int>(q), i};
        if (a < n && b == (a + 1) % n) beside_[slot(cycle[a], true)] = {first + static_cast<int>(q), i};
      }
    }
    out_.neighbours.resize(out_.nodes.size());
    for (const auto& [ends, side] : sides)
      if (const auto other = sides.find({ends.second, ends.first}); other != sides.end()) out_.neighbours[side.patch][side.side] = other->second;
    if (n == 4)
      take(f, cycle);
    else
      cut(f, filling);
  }

  PatchedSurface finish() {
    for (std::size_t f = 0; f < layout_.faces.size(); ++f)
      for (const PatchLayout::Side& s : layout_.faces[f].cycles.front()) {
        const PatchSide own = beside_[slot(s, true)];
        out_.neighbours[own.patch][own.side] = beside_[slot(s, false)];
      }
    connect_half_edges(out_.mesh);
    return std::move(out_);
  }

 private:
  // Of what lies on the left of a side, or across it.
  static std::size_t slot(const PatchLayout::Side& s, bool left) { return 2 * s.curve + (s.forward == left ? 1 : 0); }

  void take(int f, const std::vector<PatchLayout::Side>& cycle) {
    for (std::size_t t = 0; t < layout_.mesh.faces.size(); ++t) {
      if (layout_.face[t] != f) continue;
      out_.mesh.faces.push_back(layout_.mesh.faces[t]);
      out_.mesh.source_face.push_back(layout_.mesh.source_face[t]);
      out_.patch.push_back(static_cast<int>(out_.sides.size()));
    }
    auto& sides = out_.sides.emplace_back();
    for (int i = 0; i < 4; ++i) sides[i] = layout_.points(cycle[i]);
  }

  void cut(int f, const DiskLayout& filling) {
    LayoutFacePart part = cut_out(layout_, f);
    RegionSurface disk{std::move(part.mesh), {}, part.point, std::move(part.sides)};
    for (const int v : part.point) disk.source.push_back(layout_.source[v]);
    LayoutEdit edit;
    edit.quads = filling.quads;
    edit.inner_nodes = filling.inner_nodes;
    const PatchedSurface piece = draw_quads(disk, edit);
    const int first = static_cast<int>(out_.sides.size());
    std::vector<int> point = part.point;
    for (std::size_t v = point.size(); v < piece.mesh.points.size(); ++v) {
      point.push_back(static_cast<int>(out_.mesh.points.size()));
      out_.mesh.points.push_back(piece.mesh.points[v]);
      out_.source.push_back(traced(piece.source[v], disk.source));
    }
    for (std::size_t t = 0; t < piece.mesh.faces.size(); ++t) {
      const std::array<int, 3>& c = piece.mesh.faces[t];
      out_.mesh.faces.push_back({point[c[0]], point[c[1]], point[c[2]]});
      out_.mesh.source_face.push_back(disk.mesh.source_face[piece.mesh.source_face[t]]);
      out_.patch.push_back(first + piece.patch[t]);
    }
    for (const auto& of : piece.sides) {
      auto& sides = out_.sides.emplace_back();
      for (int i = 0; i < 4; ++i)
        for (const int v : of[i]) sides[i].push_back(point[v]);
    }
  }

  const PatchLayout& layout_;
  PatchedSurface out_;
  std::vector<PatchSide> beside_;
};

}  // namespace

std::vector<DiskLayout> find_fillings(const PatchLayout& layout, const FaceFillingOptions& options, const Progress& progress) {
  return FaceFiller(layout, options, progress).run();
}

PatchedSurface fill_faces(DrawnLayout& drawn, const FaceFillingOptions& options, const Progress& progress) {
  if (!drawn.problems.empty()) return {};
  const PatchLayout& layout = drawn.layout;
  if (layout.is_quads()) return to_patched_surface(layout);
  const std::vector<DiskLayout> fillings = find_fillings(layout, options, progress);
  FaceCutter cutter(layout);
  for (int f = 0; f < static_cast<int>(layout.faces.size()); ++f) {
    const auto filled = found([&] { cutter.add(f, fillings[f]); });
    if (!filled) {
      LayoutProblem problem{LayoutProblem::Kind::ManySides,
                            "a face of " + std::to_string(layout.faces[f].side_count()) + " sides cannot be filled with quads (" + filled.reason +
                                "): curves across it must divide it",
                            {}};
      problem.face = f;
      for (const PatchLayout::Side& s : layout.faces[f].cycles.front())
        for (const int v : layout.points(s)) problem.where.push_back(layout.mesh.points[v]);
      drawn.problems.push_back(std::move(problem));
      return {};
    }
  }
  return cutter.finish();
}

}  // namespace hybrid_mesh
