// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Botsch, Kobbelt, A remeshing approach to multiresolution modeling, 2004 (splits, collapses, flips and relaxation in turn).
#include "topology/cap_shaping.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surface/edit_mesh.h"

namespace hybrid_mesh {
namespace {

constexpr int rounds = 6;
constexpr double split_above = 1.4, collapse_below = 0.65;  // by the wanted length
// The wanted length grows by this part of the distance from the rim.
constexpr double gradation = 0.2;

class CapShaper {
 public:
  CapShaper(const std::vector<Vec3>& rim, const RimPatch& cap);
  RimPatch shape();

 private:
  bool on_rim(int v) const { return v < rim_; }
  double length(int h) const { return (at_[mesh_.from(h)] - at_[mesh_.to(h)]).norm(); }
  double wanted(int h) const { return (size_[mesh_.from(h)] + size_[mesh_.to(h)]) / 2; }
  bool inner_edge(int h) const { return mesh_.face_alive(h / 3) && mesh_.opposite[h] >= 0; }
  int half_edges() const { return static_cast<int>(mesh_.origin.size()); }
  double roundness(int a, int b, int c) const;
  void renew_sizes();
  void split_long();
  void collapse_short();
  bool collapse_spares_shape(int h) const;
  bool flip_bad();
  void relax();
  double worst_around(int v) const;
  Vec3 normal_around(int v) const;
  void mend();

  int rim_;
  EditMesh mesh_;
  std::vector<Vec3> at_;
  std::vector<double> size_;  // per point: the length wanted of its edges
};

TriangleSurface disk_of(const std::vector<Vec3>& rim, const RimPatch& cap) {
  TriangleSurface disk;
  disk.points = rim;
  disk.points.insert(disk.points.end(), cap.points.begin(), cap.points.end());
  disk.faces = cap.faces;
  connect_half_edges(disk);
  return disk;
}

CapShaper::CapShaper(const std::vector<Vec3>& rim, const RimPatch& cap) : rim_(static_cast<int>(rim.size())) {
  const TriangleSurface disk = disk_of(rim, cap);
  mesh_ = EditMesh(disk);
  at_ = disk.points;
}

// Grows with the smallest angle: minus its cosine.
double CapShaper::roundness(int a, int b, int c) const {
  const Vec3 u = at_[b] - at_[a], v = at_[c] - at_[b], w = at_[a] - at_[c];
  const double x = u.norm(), y = v.norm(), z = w.norm();
  const double none = -1;
  if (!(x > 0 && y > 0 && z > 0)) return none;
  return std::min({u.dot(w) / (x * z), v.dot(u) / (y * x), w.dot(v) / (z * y)});
}

void CapShaper::renew_sizes() {
  size_.assign(at_.size(), std::numeric_limits<double>::infinity());
  for (int i = 0; i < rim_; ++i) {
    // Not each edge's own length: the triangles beside a short edge among long ones are as large as those beside the long ones.
    double sum = 0;
    const int reach = std::min(3, (rim_ - 1) / 2);
    for (int k = -reach; k < reach; ++k) sum += (at_[(i + k + rim_) % rim_] - at_[(i + k + 1 + rim_) % rim_]).norm();
    size_[i] = reach > 0 ? sum / (2 * reach) : 0;
  }
  // A few sweeps in both directions reach all points: the mesh is a disk of few rings.
  for (bool changed = true; changed;) {
    changed = false;
    for (int h = 0; h < half_edges(); ++h) {
      if (!mesh_.face_alive(h / 3)) continue;
      for (const auto& [a, b] : {std::pair(mesh_.from(h), mesh_.to(h)), std::pair(mesh_.to(h), mesh_.from(h))}) {
        const double reached = size_[a] + gradation * length(h);
        if (!on_rim(b) && reached < size_[b] * (1 - 1e-9)) {
          size_[b] = reached;
          changed = true;
        }
      }
    }
  }
}

void CapShaper::split_long() {
  std::vector<std::pair<double, int>> edges;
  for (int h = 0; h < half_edges(); ++h)
    if (inner_edge(h) && h < mesh_.opposite[h] && length(h) > split_above * wanted(h)) edges.emplace_back(-length(h) / wanted(h), h);
  std::sort(edges.begin(), edges.end());
  for (const auto& [excess, h] : edges) {
    // Splits around may have made another edge of it.
    if (!(length(h) > split_above * wanted(h))) continue;
    const Vec3 middle = (at_[mesh_.from(h)] + at_[mesh_.to(h)]) / 2;
    const double size = wanted(h);
    mesh_.split(h);
    at_.push_back(middle);
    size_.push_back(size);
  }
}

void CapShaper::collapse_short() {
  std::vector<std::pair<double, int>> edges;
  for (int h = 0; h < half_edges(); ++h)
    if (inner_edge(h) && !on_rim(mesh_.from(h)) && length(h) < collapse_below * wanted(h)) edges.emplace_back(length(h) / wanted(h), h);
  std::sort(edges.begin(), edges.end());
  for (const auto& [excess, h] : edges) {
    if (!inner_edge(h) || on_rim(mesh_.from(h)) || !(length(h) < collapse_below * wanted(h))) continue;
    if (mesh_.vertex_count - rim_ > 1 && mesh_.can_collapse(h) && collapse_spares_shape(h)) mesh_.collapse(h);
  }
}

// No edge across the cap between points of the rim, and no face turned over or made a sliver.
bool CapShaper::collapse_spares_shape(int h) const {
  const int v = mesh_.from(h), u = mesh_.to(h);
  bool spared = true;
  if (on_rim(u)) mesh_.for_ring(v, [&](int w) { spared = spared && (w == u || !on_rim(w)); });
  double before = std::numeric_limits<double>::infinity(), after = before;
  int g = mesh_.out[v];
  do {
    const int a = mesh_.to(g), b = mesh_.apex(g);
    before = std::min(before, roundness(v, a, b));
    if (a != u && b != u) {
      after = std::min(after, roundness(u, a, b));
      const Vec3 old_normal = (at_[a] - at_[v]).cross(at_[b] - at_[v]), normal = (at_[a] - at_[u]).cross(at_[b] - at_[u]);
      spared = spared && normal.dot(old_normal) > 0;
    }
    g = mesh_.ccw(g);
  } while (g != mesh_.out[v]);
  constexpr double sliver = -0.955;  // 17 degrees
  return spared && after > std::min(before, sliver);
}

// Flips edges where the smallest angle beside them grows.
bool CapShaper::flip_bad() {
  bool any = false;
  for (int h = 0; h < half_edges(); ++h) {
    if (!inner_edge(h)) continue;
    const int a = mesh_.from(h), b = mesh_.to(h), c = mesh_.apex(h), d = mesh_.apex(mesh_.opposite[h]);
    if (on_rim(c) && on_rim(d)) continue;
    const double now = std::min(roundness(a, b, c), roundness(b, a, d));
    const double then = std::min(roundness(a, d, c), roundness(d, b, c));
    if (!(then > now + 1e-6)) continue;
    // Both new faces look the way that the old ones do.
    const Vec3 sum = (at_[b] - at_[a]).cross(at_[c] - at_[a]) + (at_[a] - at_[b]).cross(at_[d] - at_[b]);
    const Vec3 one = (at_[d] - at_[a]).cross(at_[c] - at_[a]), two = (at_[b] - at_[d]).cross(at_[c] - at_[d]);
    if (one.dot(sum) <= 0 || two.dot(sum) <= 0 || !mesh_.can_flip(h)) continue;
    mesh_.flip(h);
    any = true;
  }
  return any;
}

void CapShaper::relax() {
  constexpr int sweeps = 4;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const std::vector<Vec3> old = at_;
    for (int v = rim_; v < static_cast<int>(at_.size()); ++v) {
      if (!mesh_.vertex_alive(v)) continue;
      Vec3 sum = Vec3::Zero();
      double weight = 0;
      mesh_.for_ring(v, [&](int w) {
        // An edge that is longer than wanted pulls more.
        const double pull = (old[w] - old[v]).norm() / (size_[v] + size_[w]);
        sum += pull * old[w];
        weight += pull;
      });
      if (weight > 0) at_[v] = sum / weight;
    }
  }
}

double CapShaper::worst_around(int v) const {
  double worst = 1;
  int h = mesh_.out[v];
  do {
    worst = std::min(worst, roundness(v, mesh_.to(h), mesh_.apex(h)));
    h = mesh_.ccw(h);
  } while (h >= 0 && h != mesh_.out[v]);
  return worst;
}

// Moves inner points only where the worst triangle around gets better, towards the middle of those around.
void CapShaper::mend() {
  for (int v = rim_; v < static_cast<int>(at_.size()); ++v) {
    if (!mesh_.vertex_alive(v)) continue;
    Vec3 middle = Vec3::Zero();
    int count = 0;
    mesh_.for_ring(v, [&](int w) {
      middle += at_[w];
      ++count;
    });
    middle /= count;
    for (const double step : {1.0, 0.5, 0.25}) {
      const double before = worst_around(v);
      const Vec3 old = at_[v], old_normal = normal_around(v);
      at_[v] = old + step * (middle - old);
      if (worst_around(v) > before && normal_around(v).dot(old_normal) > 0) break;
      at_[v] = old;
    }
  }
}

Vec3 CapShaper::normal_around(int v) const {
  Vec3 sum = Vec3::Zero();
  int h = mesh_.out[v];
  do {
    sum += (at_[mesh_.to(h)] - at_[v]).cross(at_[mesh_.apex(h)] - at_[v]);
    h = mesh_.ccw(h);
  } while (h >= 0 && h != mesh_.out[v]);
  return sum;
}

RimPatch CapShaper::shape() {
  for (int round = 0; round < rounds; ++round) {
    renew_sizes();
    split_long();
    collapse_short();
    for (int sweep = 0; sweep < 4 && flip_bad(); ++sweep) continue;
    relax();
  }
  renew_sizes();
  for (int round = 0; round < 4; ++round) {
    collapse_short();
    for (int sweep = 0; sweep < 4 && flip_bad(); ++sweep) continue;
    mend();
  }
  RimPatch cap;
  std::vector<int> number(at_.size(), -1);
  for (int v = 0; v < static_cast<int>(at_.size()); ++v) {
    if (on_rim(v)) number[v] = v;
    if (on_rim(v) || !mesh_.vertex_alive(v)) continue;
    number[v] = rim_ + static_cast<int>(cap.points.size());
    cap.points.push_back(at_[v]);
  }
  for (int f = 0; f < half_edges() / 3; ++f)
    if (mesh_.face_alive(f)) cap.faces.push_back({number[mesh_.origin[3 * f]], number[mesh_.origin[3 * f + 1]], number[mesh_.origin[3 * f + 2]]});
  return cap;
}

}  // namespace

RimPatch shaped_cap(const std::vector<Vec3>& rim, const RimPatch& cap) { return CapShaper(rim, cap).shape(); }

}  // namespace hybrid_mesh
