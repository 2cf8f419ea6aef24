// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/corner_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hybrid_mesh {
namespace {

// Where some vertices are, to come back to.
class KeptMap {
 public:
  KeptMap(const ChartMesh& charts, const std::vector<int>& vertices) {
    for (const int v : vertices) kept_.push_back({v, charts.uv[v], charts.kind[v]});
  }
  void restore(ChartMesh& charts) const {
    for (const Vertex& v : kept_) charts.uv[v.vertex] = v.uv, charts.kind[v.vertex] = v.kind;
  }

 private:
  struct Vertex {
    int vertex;
    Complex uv;
    ChartMesh::Kind kind;
  };
  std::vector<Vertex> kept_;
};

constexpr int kRings = 3;       // around a move, where the map may give
constexpr int kMostOthers = 3;  // corners in the way that move on
constexpr int kPatience = 8;    // sweeps to unfold a move that is only tried
constexpr double kLeastGain = 1e-4;
constexpr double kThin = 1e-9;  // determinant below which an energy is a rounding error

}  // namespace

// Features' corners stay where they are.
bool CornerMotion::is_corner(int v) const {
  if (c_.kind[v] != ChartMesh::Kind::Pinned || !c_.mesh.is_boundary(v) || (!c_.held.empty() && c_.held[v])) return false;
  bool on_feature = false;
  c_.for_star(v, [&](int h, const Complex&, const Complex&) { on_feature |= c_.is_sharp(h); });
  return !on_feature;
}

std::vector<int> CornerMotion::all() const {
  std::vector<int> corners;
  for (int v = 0; v < static_cast<int>(c_.points.size()); ++v)
    if (c_.mesh.vertex_alive(v) && is_corner(v)) corners.push_back(v);
  return corners;
}

std::vector<int> CornerMotion::near(int v) const {
  std::vector<int> corners, region{v};
  c_.mesh.grow(region, 2);
  for (const int w : region)
    if (is_corner(w)) corners.push_back(w);
  return corners;
}

int CornerMotion::last_half_edge(int v) const {
  int h = c_.mesh.out[v];
  while (c_.mesh.ccw(h) >= 0) h = c_.mesh.ccw(h);
  return h;
}

int CornerMotion::next(int v, bool forward) const { return forward ? c_.mesh.to(c_.mesh.out[v]) : c_.mesh.apex(last_half_edge(v)); }

int CornerMotion::move(int corner, bool forward, int sweeps, int others) {
  if (!c_.held.empty() && c_.held[corner]) return -1;
  const int first = c_.mesh.out[corner], last = last_half_edge(corner);
  const int leaves = forward ? EditMesh::next(first) : EditMesh::prev(last), u = c_.mesh.origin[leaves];
  if (!c_.movable(u) && (others == kMostOthers || move(u, forward, sweeps, others + 1) < 0)) return -1;
  std::vector<int> region{corner, u};
  c_.mesh.grow(region, kRings);
  const KeptMap kept(c_, region);
  const Complex place = c_.uv[corner],
                behind = forward ? c_.corner[last].back(c_.at(EditMesh::prev(last))) : c_.corner[first].back(c_.at(EditMesh::next(first)));
  c_.uv[u] = c_.corner[leaves].back(c_.at(forward ? first : last));
  c_.kind[u] = ChartMesh::Kind::Pinned;
  const bool along_u = std::abs((behind - place).real()) > std::abs((behind - place).imag());
  c_.uv[corner] = along_u ? Complex(0.5 * (place + behind).real(), place.imag()) : Complex(place.real(), 0.5 * (place + behind).imag());
  c_.kind[corner] = along_u ? ChartMesh::Kind::SlideU : ChartMesh::Kind::SlideV;
  region = {corner, u};
  for (int rings = 0; rings < kRings; ++rings) {
    c_.mesh.grow(region, 1);
    if (stars_.unfold(region, sweeps)) return u;
  }
  kept.restore(c_);
  return -1;
}

std::vector<int> CornerMotion::move_downhill(const std::vector<int>& corners, const std::vector<char>& allowed) {
  std::vector<int> moved;
  for (const int corner : corners) {
    int at = step_downhill(corner, true, allowed);
    if (at < 0) at = step_downhill(corner, false, allowed);
    if (at >= 0) moved.push_back(at);
  }
  return moved;
}

int CornerMotion::step_downhill(int corner, bool forward, const std::vector<char>& allowed) {
  const int u = next(corner, forward);
  if (!c_.movable(u) || !(allowed.empty() || allowed[u])) return -1;
  std::vector<int> region{corner, u};
  c_.mesh.grow(region, kRings);
  const auto relaxed_energy = [&] {
    for (int sweep = 0; sweep < 5; ++sweep)
      for (const int w : region)
        if (c_.movable(w)) stars_.relax(w, false);
    return energy_around(region);
  };
  const double before = relaxed_energy();
  const KeptMap kept(c_, region);
  if (move(corner, forward, kPatience) == u && relaxed_energy() < before * (1 - kLeastGain)) return u;
  kept.restore(c_);
  return -1;
}

// Of the triangles with a vertex in the region; infinite where one is too thin in the map.
double CornerMotion::energy_around(const std::vector<int>& region) const {
  std::vector<int> faces;
  for (const int v : region) {
    int h = c_.mesh.out[v];
    do {
      faces.push_back(h / 3);
      h = c_.mesh.ccw(h);
    } while (h >= 0 && h != c_.mesh.out[v]);
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  double sum = 0;
  for (const int f : faces) sum += c_.determinant(f) > kThin ? stars_.face_energy(f) : std::numeric_limits<double>::infinity();
  return sum;
}

}  // namespace hybrid_mesh
