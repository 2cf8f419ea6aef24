// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Zorin, Schroeder, Sweldens, Interactive multiresolution mesh editing, 1997.
#include "wavelets/level_editing.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/tolerances.h"
#include "decoder/forest/vertex_index.h"
#include "decoder/transform/level_prediction.h"
#include "hierarchy/flat_points.h"
#include "wavelets/region_motion.h"
#include "wavelets/star_motion.h"
#include "wavelets/wavelet_step.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

template <class Body>
void for_each_vertex(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) body(v);
  });
}

// A mesh of the hierarchy before, in its points, and after.
struct MovedMesh {
  QuadMesh mesh;
  std::vector<Vec3> after;

  explicit MovedMesh(QuadMesh given) : mesh(std::move(given)), after(mesh.points) {}
  bool any_moved() const { return mesh.points != after; }
  // As the setters of positions take them.
  QuadMesh only_moved() const {
    QuadMesh result;
    for (std::size_t v = 0; v < after.size(); ++v)
      if (mesh.points[v] != after[v]) {
        result.vertex.push_back(mesh.vertex[v]);
        result.points.push_back(after[v]);
      }
    return result;
  }
};

bool has_operations(const HybridMesh& hierarchy, int level) {
  for (int o = 0; o < hierarchy.operation_count(); ++o)
    if (hierarchy.operation(o).enabled && hierarchy.operation(o).repatch.level == level) return true;
  return false;
}

std::vector<char> differences(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double least) {
  std::vector<char> result(a.size());
  for (std::size_t v = 0; v < a.size(); ++v) result[v] = least > 0 ? (a[v] - b[v]).norm() > least : a[v] != b[v];
  return result;
}

double diagonal_of(const std::vector<Vec3>& points) {
  Eigen::AlignedBox<double, 3> box;
  for (const Vec3& point : points) box.extend(point);
  return box.diagonal().norm();
}

// Carries the differences of a mesh's points from others, `base`, to where these are after.
void carry(MovedMesh& moved, const std::vector<Vec3>& base, const std::vector<Vec3>& base_after, double least) {
  const VertexStars stars(moved.mesh);
  const std::vector<char> changed = differences(base, base_after, least);
  for_each_vertex(base.size(), [&](std::size_t v) {
    if (!stars.any(changed, static_cast<int>(v))) return;
    moved.after[v] = base_after[v] + stars.motion(static_cast<int>(v), base, base_after)(moved.mesh.points[v] - base[v]);
  });
}

// The vertices of `inner` that `outer` has, too, go where they go there, the others follow.
MovedMesh joined(QuadMesh inner, const MovedMesh& outer) {
  MovedMesh result(std::move(inner));
  const VertexIndex find(outer.mesh.vertex);
  std::vector<int> place(result.after.size());
  for (std::size_t v = 0; v < place.size(); ++v) {
    place[v] = find(result.mesh.vertex[v]);
    if (place[v] >= 0 && outer.mesh.points[place[v]] != outer.after[place[v]]) result.after[v] = outer.after[place[v]];
  }
  move_regions(result.mesh, place, outer.mesh, outer.after, result.after);
  return result;
}

// Carries an edit from level to level.
class Editing {
 public:
  explicit Editing(const HybridMesh& hierarchy) : given_(hierarchy), result_(hierarchy) {}

  // N^j, with what the operations of its level have to do with it.
  MovedMesh start(const LevelEdit& edit) {
    MovedMesh moved(given_.level_mesh(edit.level, edit.kind));
    moved.after = edit.points;
    keep(edit.level, moved);
    if (edit.kind == LevelKind::M) return operated(edit.level, std::move(moved));
    undo_operations(edit.level, moved);
    return moved;
  }

  // N^j from N^{j-1}.
  MovedMesh finer(const MovedMesh& coarse, int level) {
    MovedMesh moved(given_.level_mesh(level, LevelKind::M));
    const LevelPrediction prediction(given_, coarse.mesh, moved.mesh, level, BoundaryRule::EdgesOnly);
    const auto predicted = [&](const std::vector<Vec3>& from) {
      std::vector<Point3> points(prediction.count());
      prediction.regular(flat_points(from).data(), points.data());
      prediction.close(points.data());
      return vectors_of(points);
    };
    carry(moved, predicted(coarse.mesh.points), predicted(coarse.after), 0);
    keep(level, moved);
    return operated(level, std::move(moved));
  }

  // N^{j-1} from N^j.
  MovedMesh coarser(const MovedMesh& fine, int level) {
    const WaveletStep step(given_, level);
    MovedMesh moved(step.coarse());
    const std::vector<Vec3> base = step.analyse(fine.mesh.points).coarse;
    carry(moved, base, step.analyse(fine.after).coarse, tolerance::same_place * diagonal_of(fine.mesh.points));
    keep(level - 1, moved);
    undo_operations(level - 1, moved);
    return moved;
  }

  void finish(const MovedMesh& finest) {
    MovedMesh moved(given_.final_mesh());
    const VertexIndex find(finest.mesh.vertex);
    std::vector<Vec3> base = moved.mesh.points, base_after = base;
    for (std::size_t v = 0; v < base.size(); ++v)
      if (const int place = find(moved.mesh.vertex[v]); place >= 0) base[v] = finest.mesh.points[place], base_after[v] = finest.after[place];
    carry(moved, base, base_after, 0);
    const QuadMesh kept = moved.only_moved();
    if (kept.vertex_count() > 0) result_.set_final_positions(kept);
  }

  HybridMesh result() && { return std::move(result_); }

 private:
  void keep(int level, const MovedMesh& moved) {
    const QuadMesh kept = moved.only_moved();
    if (kept.vertex_count() > 0) result_.set_level_positions(level, kept);
  }
  // N^j from M^j.
  MovedMesh operated(int level, MovedMesh before) {
    if (!has_operations(given_, level)) return before;
    MovedMesh moved = joined(given_.level_mesh(level), before);
    keep(level, moved);
    return moved;
  }
  // M^j from N^j.
  void undo_operations(int level, const MovedMesh& after) {
    if (has_operations(given_, level)) keep(level, joined(given_.level_mesh(level, LevelKind::M), after));
  }

  const HybridMesh& given_;
  HybridMesh result_;
};

}  // namespace

HybridMesh edited(const HybridMesh& hierarchy, const LevelEdit& edit, const Progress& progress) {
  const int depth = hierarchy.depth();
  if (edit.level < 0 || edit.level > depth)
    refuse("there is no level " + std::to_string(edit.level) + ": the hierarchy has levels 0 to " + std::to_string(depth));
  const std::size_t count = hierarchy.level_mesh(edit.level, edit.kind).vertex_count();
  if (edit.points.size() != count) refuse(std::to_string(edit.points.size()) + " points for a level that has " + std::to_string(count));
  for (std::size_t v = 0; v < count; ++v)
    if (!edit.points[v].allFinite()) refuse("point " + std::to_string(v) + " is not finite");
  Editing editing(hierarchy);
  const MovedMesh start = editing.start(edit);
  MovedMesh moved = start;
  for (int level = edit.level + 1; level <= depth && moved.any_moved(); ++level) {
    // A level takes four times as long as the one before it.
    progress(std::ldexp(1.0, 2 * (level - 1 - depth)));
    moved = editing.finer(moved, level);
  }
  if (moved.any_moved()) editing.finish(moved);
  moved = start;
  for (int level = edit.level; level > 0 && edit.coarser == CoarserLevels::Follow && moved.any_moved(); --level) {
    progress.check();
    moved = editing.coarser(moved, level);
  }
  progress(1);
  return std::move(editing).result();
}

}  // namespace hybrid_mesh
