// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Xin, Wang, Efficiently determining a locally exact shortest path on polyhedral surfaces, 2007 (the shortest way through a strip of faces,
// which then passes over the vertices where it bends, until no strip gives a shorter one).
#include "layout/curves/curve_tightening.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

constexpr double kStraight = 1e-7;  // radians: a curve that bends less is straight
constexpr double kRoom = 1e-3;      // of an edge, kept from fixed curves

}  // namespace

double CurveTightener::angle_around(int v) {
  angle_around_.resize(curves_.points().size(), -1);
  double& angle = angle_around_[v];
  if (angle >= 0) return angle;
  const EditMesh& mesh = curves_.mesh();
  const std::vector<Vec3>& points = curves_.points();
  angle = 0;
  int g = mesh.out[v];
  do {
    const Vec3 a = points[mesh.to(g)] - points[v], b = points[mesh.apex(g)] - points[v];
    angle += std::atan2(a.cross(b).norm(), a.dot(b));
    g = mesh.ccw(g);
  } while (g >= 0 && g != mesh.out[v]);
  return angle;
}

FaceStrip CurveTightener::strip_of(int c) {
  crossings_.clear(), half_edges_.clear();
  for (int n = curves_.curve(c).first; n >= 0; n = curves_.crossing(n).next) {
    crossings_.push_back(n);
    half_edges_.push_back(curves_.leaving(n));
  }
  FaceStrip strip(curves_.mesh(), curves_.points(), half_edges_, curves_.points()[curves_.curve(c).start], curves_.points()[curves_.curve(c).end]);
  // Room between the fixed curves on either side.
  for (std::size_t i = 0; i < crossings_.size(); ++i) {
    const std::vector<int>& list = curves_.on_edge(curves_.crossing(crossings_[i]).edge);
    if (list.size() < 2) continue;
    const auto at = std::find(list.begin(), list.end(), crossings_[i]);
    double low = 0, high = 1;
    for (auto k = list.begin(); k != at; ++k)
      if (fixed_[curves_.crossing(*k).curve]) low = std::max(low, curves_.crossing(*k).t + kRoom);
    for (auto k = at + 1; k != list.end(); ++k)
      if (fixed_[curves_.crossing(*k).curve]) high = std::min(high, curves_.crossing(*k).t - kRoom);
    if (low > high) low = high = 0.5 * (low + high);
    const bool up = curves_.mesh().from(half_edges_[i]) < curves_.mesh().to(half_edges_[i]);
    strip.narrow(static_cast<int>(i), up ? low : 1 - high, up ? high : 1 - low);
  }
  strip.find_shortest();
  return strip;
}

void CurveTightener::place(const FaceStrip& strip) {
  const std::vector<double> fractions = strip.fractions();
  for (std::size_t i = 0; i < crossings_.size(); ++i) {
    const bool up = curves_.mesh().from(half_edges_[i]) < curves_.mesh().to(half_edges_[i]);
    curves_.set_t(crossings_[i], up ? fractions[i] : 1 - fractions[i]);
  }
}

// Leads the curve over the vertices where it bends although the other side is shorter. False if there are none.
bool CurveTightener::pass_vertices(int c, const FaceStrip& strip) {
  const EditMesh& mesh = curves_.mesh();
  std::vector<char> taken(crossings_.size(), 0);
  bool any = false;
  for (std::size_t b = 0; b < strip.bends().size(); ++b) {
    const FaceStrip::Bend& bend = strip.bends()[b];
    const FaceStrip::Portal& at = strip.portals()[bend.first];
    if (bend.at != (bend.left ? at.left : at.right)) continue;  // at a fixed curve
    const int v = bend.left ? mesh.to(half_edges_[bend.first]) : mesh.from(half_edges_[bend.first]);
    if (curves_.degree(v) > 0 || mesh.is_boundary(v)) continue;
    if (!(angle_around(v) - (std::numbers::pi + strip.turn(b)) < std::numbers::pi - kStraight)) continue;
    // All crossings of edges at v in a row, with v on this side.
    const auto pivots = [&](int i) { return (bend.left ? mesh.to(half_edges_[i]) : mesh.from(half_edges_[i])) == v; };
    int first = bend.first, last = bend.first;
    while (first > 0 && pivots(first - 1)) --first;
    while (last + 1 < static_cast<int>(crossings_.size()) && pivots(last + 1)) ++last;
    bool free = true;
    for (int i = first; i <= last; ++i) free = free && !taken[i] && curves_.is_nearest(crossings_[i], v);
    if (!free) continue;
    // The other way around: its spokes, from before the first to after the last.
    const int begin = bend.left ? mesh.opposite[half_edges_[first]] : half_edges_[first];
    const int stop = bend.left ? mesh.opposite[half_edges_[last]] : half_edges_[last];
    std::vector<int> way;
    if (last - first + 1 < mesh.valence(v))
      for (int g = bend.left ? mesh.cw(begin) : mesh.ccw(begin); g != stop; g = bend.left ? mesh.cw(g) : mesh.ccw(g))
        way.push_back(bend.left ? g : mesh.opposite[g]);
    int previous = curves_.crossing(crossings_[first]).previous;
    for (const int h : way) previous = curves_.insert_nearest(c, previous, h, v);
    for (int i = first; i <= last; ++i) {
      curves_.erase(crossings_[i]);
      taken[i] = 1;
    }
    any = true;
  }
  return any;
}

bool CurveTightener::tighten(int c) {
  fixed_.resize(curves_.curve_count(), 0);
  double shortest = std::numeric_limits<double>::infinity();
  // Each pass shortens the curve; what rounding keeps in doubt ends by itself.
  for (int idle = 0; curves_.curve(c).first >= 0;) {
    const FaceStrip strip = strip_of(c);
    place(strip);
    idle = strip.length() < shortest * (1 - 1e-9) ? 0 : idle + 1;
    shortest = std::min(shortest, strip.length());
    if (idle > 20 || !pass_vertices(c, strip)) break;
    changed_ = true;
    if (!curves_.simplify(c)) return false;
  }
  return true;
}

void CurveTightener::tighten_all(const Progress& progress) {
  fixed_.resize(curves_.curve_count(), 0);
  const int count = curves_.curve_count();
  changed_ = true;
  for (int sweep = 0; sweep < 20 && changed_; ++sweep) {
    changed_ = false;
    for (int c = 0; c < count; ++c) {
      progress.check();
      if (curves_.curve(c).alive && !fixed_[c] && !tighten(c)) throw NoMap("a curve of a layout vanished when it was tightened");
    }
  }
  curves_.spread();
}

}  // namespace hybrid_mesh
