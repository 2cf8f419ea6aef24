// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/region_uncutting.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

namespace hybrid_mesh {
namespace {

using Weights = std::array<double, 3>;  // in a root triangle

constexpr double kLeastArea = 1e-9;  // of a root triangle: what is smaller is no triangle

double area(const Weights& a, const Weights& b, const Weights& c) { return (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]); }

// The triangles of a simple polygon of which the smallest is as large as can be, by numbers of its corners; none where one would have no area.
std::vector<std::array<int, 3>> triangulated(const std::vector<Weights>& polygon) {
  const int n = static_cast<int>(polygon.size());
  std::vector<std::vector<double>> best(n, std::vector<double>(n, std::numeric_limits<double>::infinity()));
  std::vector<std::vector<int>> apex(n, std::vector<int>(n, -1));
  for (int length = 2; length < n; ++length)
    for (int i = 0; i + length < n; ++i) {
      const int k = i + length;
      best[i][k] = -1;
      for (int m = i + 1; m < k; ++m) {
        const double least = std::min({area(polygon[i], polygon[m], polygon[k]), best[i][m], best[m][k]});
        if (least > best[i][k]) best[i][k] = least, apex[i][k] = m;
      }
    }
  std::vector<std::array<int, 3>> out;
  if (n < 3 || best[0][n - 1] < kLeastArea) return out;
  std::vector<std::pair<int, int>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k - i < 2) continue;
    const int m = apex[i][k];
    out.push_back({i, m, k});
    open.push_back({i, m});
    open.push_back({m, k});
  }
  return out;
}

class Uncutting {
 public:
  Uncutting(const RegionSurface& part, GluedMaps& glued) : part_(part), mesh_(part.mesh), glued_(glued) {}

  RegionSurface run() {
    find_pieces();
    find_removable();
    std::vector<std::vector<std::array<int, 3>>> fresh(pieces_.size());
    std::vector<char> changed(pieces_.size(), 0);
    // What cannot be done without its points keeps them, and its neighbours do.
    std::vector<int> todo(pieces_.size());
    for (std::size_t i = 0; i < todo.size(); ++i) todo[i] = static_cast<int>(i);
    while (!todo.empty()) {
      std::vector<int> again;
      for (const int i : todo) {
        changed[i] = std::any_of(pieces_[i].begin(), pieces_[i].end(), [&](int f) {
          return std::any_of(mesh_.faces[f].begin(), mesh_.faces[f].end(), [&](int v) { return removable_[v]; });
        });
        if (!changed[i]) continue;
        fresh[i] = without_points(i);
        if (fresh[i].empty()) keep_points(i, again);
      }
      std::sort(again.begin(), again.end());
      again.erase(std::unique(again.begin(), again.end()), again.end());
      todo = std::move(again);
    }
    return finished(fresh, changed);
  }

 private:
  int root(int f) const { return glued_.on.face[mesh_.source_face[f]]; }
  Weights weights(int f, int corner) const {
    const std::array<float, 9>& w = glued_.on.weights[mesh_.source_face[f]];
    return {w[3 * corner], w[3 * corner + 1], w[3 * corner + 2]};
  }
  int across(int h) const { return mesh_.opposite[h] < 0 ? -1 : mesh_.opposite[h] / 3; }

  // Faces of one root triangle that hang together.
  void find_pieces() {
    piece_.assign(mesh_.faces.size(), -1);
    for (int first = 0; first < static_cast<int>(mesh_.faces.size()); ++first) {
      if (piece_[first] >= 0) continue;
      std::vector<int> faces{first};
      piece_[first] = static_cast<int>(pieces_.size());
      for (std::size_t i = 0; i < faces.size(); ++i)
        for (int h = 3 * faces[i]; h < 3 * faces[i] + 3; ++h) {
          const int g = across(h);
          if (g < 0 || piece_[g] >= 0 || root(g) != root(first)) continue;
          piece_[g] = piece_[first];
          faces.push_back(g);
        }
      pieces_.push_back(std::move(faces));
    }
  }

  // Points inside a root triangle, and inside an edge of two of them.
  void find_removable() {
    struct Around {
      std::array<int, 2> roots{-1, -1};
      bool many = false, corner = false, inside = true;  // more than two roots; a corner of one; inside all of them
    };
    std::vector<Around> around(mesh_.points.size());
    removable_.assign(mesh_.points.size(), 1);
    for (int f = 0; f < static_cast<int>(mesh_.faces.size()); ++f)
      for (int i = 0; i < 3; ++i) {
        Around& a = around[mesh_.faces[f][i]];
        const int r = root(f);
        if (a.roots[0] < 0 || a.roots[0] == r)
          a.roots[0] = r;
        else if (a.roots[1] < 0 || a.roots[1] == r)
          a.roots[1] = r;
        else
          a.many = true;
        const Weights w = weights(f, i);
        const auto zeros = std::count(w.begin(), w.end(), 0.0);
        a.corner |= zeros == 2;
        a.inside &= zeros == 0;
        if (across(3 * f + i) < 0) removable_[mesh_.faces[f][i]] = removable_[mesh_.faces[f][(i + 1) % 3]] = 0;
      }
    for (std::size_t v = 0; v < around.size(); ++v) {
      const Around& a = around[v];
      const bool one = a.roots[1] < 0;
      if (a.many || a.corner || one != a.inside) removable_[v] = 0;
    }
  }

  // The piece's boundary without removable points, as corners of faces; nothing if it has another shape than a disk's.
  std::vector<std::pair<int, int>> boundary(int piece) const {
    std::map<int, std::pair<int, int>> from;  // by the point where an edge begins: its face and corner
    for (const int f : pieces_[piece])
      for (int i = 0; i < 3; ++i) {
        const int g = across(3 * f + i);
        if ((g < 0 || piece_[g] != piece) && !from.insert({mesh_.faces[f][i], {f, i}}).second) return {};
      }
    std::vector<std::pair<int, int>> loop;
    std::size_t walked = 0;
    const int first = from.begin()->first;
    int v = first;
    do {
      const auto [f, i] = from.at(v);
      if (!removable_[v]) loop.push_back({f, i});
      v = mesh_.faces[f][(i + 1) % 3];
      ++walked;
    } while (v != first && walked <= from.size());
    if (walked != from.size()) return {};
    return loop;
  }

  // The triangles of a piece, as corners, once its removable points are gone; none if there is no way.
  std::vector<std::array<int, 3>> without_points(int piece) {
    const std::vector<std::pair<int, int>> loop = boundary(piece);
    std::vector<Weights> polygon;
    for (const auto& [f, i] : loop) polygon.push_back(weights(f, i));
    // A corner of a face is 3 * face + corner.
    std::vector<std::array<int, 3>> out;
    for (const auto& t : triangulated(polygon)) {
      std::array<int, 3> face;
      for (int i = 0; i < 3; ++i) face[i] = 3 * loop[t[i]].first + loop[t[i]].second;
      out.push_back(face);
    }
    return out;
  }

  // `again`: the pieces that have one of them, and have to be looked at once more.
  void keep_points(int piece, std::vector<int>& again) {
    for (const int f : pieces_[piece])
      for (const int v : mesh_.faces[f])
        if (removable_[v]) {
          removable_[v] = 0;
        }
    again.push_back(piece);
    for (const int f : pieces_[piece])
      for (int h = 3 * f; h < 3 * f + 3; ++h)
        if (const int g = across(h); g >= 0 && piece_[g] != piece) again.push_back(piece_[g]);
  }

  RegionSurface finished(const std::vector<std::vector<std::array<int, 3>>>& fresh, const std::vector<char>& changed) {
    RegionSurface out;
    std::vector<int> number(mesh_.points.size(), -1);
    const auto point = [&](int v) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(out.mesh.points.size());
        out.mesh.points.push_back(mesh_.points[v]);
        out.point.push_back(part_.point[v]);
        out.source.push_back(part_.source[v]);
      }
      return number[v];
    };
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!changed[i]) {
        for (const int f : pieces_[i]) {
          const auto& c = mesh_.faces[f];
          out.mesh.faces.push_back({point(c[0]), point(c[1]), point(c[2])});
          out.mesh.source_face.push_back(mesh_.source_face[f]);
        }
        continue;
      }
      for (const std::array<int, 3>& corners : fresh[i]) {
        std::array<int, 3> face, names;
        std::array<float, 9> source;
        for (int k = 0; k < 3; ++k) {
          const int f = corners[k] / 3, at = corners[k] % 3, v = mesh_.faces[f][at];
          face[k] = point(v);
          names[k] = part_.source[v].vertices[0];
          const std::array<float, 9>& whole = glued_.on.weights[mesh_.source_face[f]];
          std::copy_n(whole.begin() + 3 * at, 3, source.begin() + 3 * k);
        }
        out.mesh.faces.push_back(face);
        out.mesh.source_face.push_back(static_cast<int>(glued_.faces.size()));
        glued_.faces.push_back(names);
        glued_.on.face.push_back(root(pieces_[i].front()));
        glued_.on.weights.push_back(source);
      }
    }
    connect_half_edges(out.mesh);
    for (const std::vector<int>& side : part_.sides) {
      std::vector<int>& own = out.sides.emplace_back();
      for (const int v : side) own.push_back(number[v]);
    }
    return out;
  }

  const RegionSurface& part_;
  const TriangleSurface& mesh_;
  GluedMaps& glued_;
  std::vector<int> piece_;                // per face
  std::vector<std::vector<int>> pieces_;  // faces
  std::vector<char> removable_;           // per point
};

}  // namespace

RegionSurface uncut_region(const RegionSurface& part, GluedMaps& glued) { return Uncutting(part, glued).run(); }

}  // namespace hybrid_mesh
