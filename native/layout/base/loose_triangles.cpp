// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/loose_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

namespace hybrid_mesh {
namespace {

class LooseTriangles {
 public:
  LooseTriangles(EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures& features, std::vector<int> mate, std::vector<MeshEdit>& log)
      : mesh_(mesh), points_(points), features_(features), mate_(std::move(mate)), log_(log) {}

  bool run(const std::vector<int>& faces) {
    if (std::none_of(faces.begin(), faces.end(), [&](int f) { return mate_[f] != f && !has_mate(f); })) return false;
    const std::size_t before = log_.size();
    for (const int f : faces)
      if (!has_mate(f)) mate_[f] = f;
    for (const bool may_fold : {false, true}) {
      may_fold_ = may_fold;
      for (const int f : faces)
        if (is_loose(f)) find_mate(f);
    }
    return log_.size() > before;
  }

 private:
  // A way through two inner edges, by their names, which stay: into a pair and out of it. Into a loose triangle: `out` is -1.
  struct Step {
    int in = -1, out = -1;
    bool operator<(const Step& o) const { return std::pair(in, out) < std::pair(o.in, o.out); }
  };

  bool is_loose(int f) const { return mate_[f] == f; }
  bool has_mate(int f) const {  // of its piece
    for (int h = 3 * f; h < 3 * f + 3; ++h)
      if (!features_.on(mesh_, h) && mesh_.opposite[h] >= 0 && mesh_.opposite[h] / 3 == mate_[f]) return true;
    return false;
  }
  template <class Visit>
  void for_neighbours(int f, const Visit& visit) const {
    for (int h = 3 * f; h < 3 * f + 3; ++h)
      if (!features_.on(mesh_, h) && mesh_.opposite[h] >= 0) visit(mesh_.opposite[h] / 3, mesh_.edge[h]);
  }

  // Brings a loose triangle to the nearest other one of its piece, pair by pair. No step is tried twice, or it might go in circles.
  void find_mate(int f) {
    std::set<Step> tried;
    for (Step step = first_step(f, tried); step.in >= 0; step = first_step(f, tried)) {
      int next = -1;
      for_neighbours(f, [&](int g, int edge) {
        if (edge == step.in) next = g;
      });
      if (step.out < 0) {
        mate_[f] = next, mate_[next] = f;
        return;
      }
      tried.insert(step);
      if (const int moved = pass(f, next, step.out); moved >= 0) f = moved;
    }
  }

  // Of the shortest way to another loose triangle, breadth first; none: `in` is -1.
  Step first_step(int start, const std::set<Step>& tried) const {
    std::map<int, Step> seen{{start, {}}};  // per face: how its way begins
    std::vector<int> queue{start};
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const int f = queue[i];
      const Step begun = seen[f];
      Step found;
      for_neighbours(f, [&](int g, int edge) {
        if (found.in >= 0 || seen.count(g)) return;
        Step step = begun;
        if (f == start)
          step.in = edge;
        else if (begun.out < 0)
          step.out = edge;
        if (tried.count(step)) return;
        if (is_loose(g)) {
          found = step;
          return;
        }
        for (const int h : {g, mate_[g]}) {
          seen[h] = step;
          queue.push_back(h);
        }
      });
      if (found.in >= 0) return found;
    }
    return {};
  }

  // Makes a pair of two of three triangles, a loose one and those of the pair beside it, so that the third has the edge `out`. Returns the third, -1
  // if no flips of the two edges between them do that.
  int pass(int loose, int f, int out) {
    const std::array<int, 3> three{loose, f, mate_[f]};
    const int moved = flipped_until_apart(three, out, 2);
    if (moved < 0) return -1;
    mate_[moved] = moved;
    std::array<int, 2> pair{};
    std::copy_if(three.begin(), three.end(), pair.begin(), [&](int g) { return g != moved; });
    mate_[pair[0]] = pair[1], mate_[pair[1]] = pair[0];
    return moved;
  }

  int flipped_until_apart(const std::array<int, 3>& three, int out, int flips) {
    const auto is_inner = [&](int h) {
      return !features_.on(mesh_, h) && mesh_.opposite[h] >= 0 && std::find(three.begin(), three.end(), mesh_.opposite[h] / 3) != three.end();
    };
    for (const int f : three) {
      int inner = 0;
      bool has_out = false;
      for (int h = 3 * f; h < 3 * f + 3; ++h) inner += is_inner(h), has_out |= mesh_.edge[h] == out;
      if (has_out && inner == 1) return f;
    }
    if (flips == 0) return -1;
    for (const int f : three)
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        if (!is_inner(h) || mesh_.opposite[h] < h || !features_.can_flip(mesh_, h) || !mesh_.can_flip(h) || (!may_fold_ && folds(mesh_, points_, h)))
          continue;
        mesh_.flip(h);
        log_.push_back({MeshEdit::Kind::Flip, h});
        if (const int moved = flipped_until_apart(three, out, flips - 1); moved >= 0) return moved;
        mesh_.undo_flip(h);
        log_.pop_back();
      }
    return -1;
  }

  EditMesh& mesh_;
  const std::vector<Vec3>& points_;
  const MeshFeatures& features_;
  std::vector<int> mate_;
  std::vector<MeshEdit>& log_;
  bool may_fold_ = false;  // in the last resort: on the surface curves stay apart, wherever the mesh's triangles lie
};

}  // namespace

bool pair_loose_triangles(EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures& features, const std::vector<int>& faces,
                          std::vector<int> mate, std::vector<MeshEdit>& log) {
  return LooseTriangles(mesh, points, features, std::move(mate), log).run(faces);
}

bool folds(const EditMesh& mesh, const std::vector<Vec3>& points, int h) {
  const Vec3 &a = points[mesh.from(h)], &b = points[mesh.to(h)], &c = points[mesh.apex(h)], &d = points[mesh.apex(mesh.opposite[h])];
  const Vec3 normal = (b - a).cross(c - a) + (a - b).cross(d - b);
  return !((a - c).cross(d - c).dot(normal) > 0) || !((b - d).cross(c - d).dot(normal) > 0);
}

}  // namespace hybrid_mesh
