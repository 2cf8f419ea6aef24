// SPDX-License-Identifier: GPL-3.0-or-later
// Where the vertices of a mesh lie on the limit surface. Most have a mask of OpenSubdiv's. It has none for vertices at semi-sharp features, which are
// refined, with nothing but the quads around them, until the sharpness is gone; for those where a sharp crease ends, and for those of valence 2.
#include "subdivision/limit_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "subdivision/fan.h"
#include "subdivision/masks.h"
#include "subdivision/mesh_topology.h"

namespace hybrid_mesh {

namespace {

bool is_semi_sharp(float sharpness) { return sharpness > 0 && sharpness < infinite_sharpness; }

bool is_semi_sharp(const Fan& fan) {
  return is_semi_sharp(fan.vertex_sharpness) ||
         std::any_of(fan.edge_sharpness.begin(), fan.edge_sharpness.end(), [](float sharpness) { return is_semi_sharp(sharpness); });
}

// Spokes of creases and boundaries, in order.
std::vector<int> sharp_spokes(const Fan& fan) {
  std::vector<int> result;
  for (int i = 0; i < fan.spoke_count(); ++i)
    if (fan.edge_sharpness[i] > 0) result.push_back(i);
  return result;
}

// That of the polygon around the fan's vertex.
Vec3 area_normal(const Fan& fan) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < fan.face_count; ++i) sum += (fan.opposites[i] - fan.centre).cross(fan.ends[fan.next(i)] - fan.ends[i]);
  return sum.normalized();
}

// The mean over the quads, each with the normal of its corner.
Vec3 corner_normal(const Fan& fan) {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < fan.face_count; ++i) sum += (fan.ends[i] - fan.centre).cross(fan.ends[fan.next(i)] - fan.centre).normalized();
  return sum.normalized();
}

// Where tangents span no plane, up to rounding, the normal of the polygon around the vertex takes their place. `size` is the length of the longest
// spoke.
template <class MakeFan>
Vec3 tangent_normal(const VertexLimit& limit, double size, const MakeFan& fan) {
  const Vec3 normal = limit.tangent.cross(limit.cross_tangent);
  return normal.norm() > 1e-10 * size * size ? normal.normalized() : area_normal(fan());
}

Vec3 tangent_normal(const VertexLimit& limit, const Fan& fan) {
  double size = 0;
  for (const Vec3& end : fan.ends) size = std::max(size, (end - fan.centre).norm());
  return tangent_normal(limit, size, [&]() -> const Fan& { return fan; });
}

class LimitEvaluation {
 public:
  LimitEvaluation(const QuadTopology& topology, const std::vector<Vec3>& points) : topology_(topology), fans_(topology), points_(points) {}

  LimitSurface run() {
    LimitPoints limit = limit_points(topology_, fans_, points_);
    result_.points = std::move(limit.points);
    result_.normals.resize(result_.points.size());
    for (int v = 0; v < topology_.vertex_count; ++v) {
      if (!fans_.is_open(v) && fans_.face_count(v) == 1)
        throw Error(ErrorCode::Unsupported,
                    "vertex " + std::to_string(v) + " of the mesh is an interior vertex of valence 1, where subdivision has no limit");
      if (is_special(v))
        special_.push_back(v);
      else
        result_.normals[v] =
            tangent_normal({result_.points[v], limit.tangents[v], limit.cross_tangents[v]}, longest_spoke(v), [&] { return fan(v); });
    }
    if (!special_.empty()) evaluate_special();
    return std::move(result_);
  }

 private:
  Fan fan(int v) const { return fan_of(topology_, fans_, v, points_); }

  double longest_spoke(int v) const {
    double longest = 0;
    for (int i = 0; i < fans_.spoke_count(v); ++i) longest = std::max(longest, (points_[topology_.to(fans_.spoke(v, i))] - points_[v]).norm());
    return longest;
  }

  bool is_special(int v) const {
    if (topology_.vertex_sharpness[v] > 0 || (!fans_.is_open(v) && fans_.face_count(v) == 2)) return true;
    for (int i = 0; i < fans_.spoke_count(v); ++i) {
      const int edge = fans_.spoke(v, i) >> 1;
      if (!topology_.is_boundary(edge) && topology_.edge_sharpness[edge] > 0) return true;
    }
    return false;
  }

  void evaluate_special() {
    std::vector<Fan> fans;
    for (const int v : special_) fans.push_back(fan(v));
    refine_semi_sharp(fans);
    const std::vector<VertexLimit> limits = limits_of(fans, topology_.boundary);
    for (std::size_t i = 0; i < fans.size(); ++i) evaluate(special_[i], fans[i], limits[i]);
    // The sides of creases.
    const std::vector<VertexLimit> side_limits = limits_of(sides_, BoundaryRule::EdgesOnly);
    for (std::size_t i = 0; i < sides_.size(); ++i) result_.normals[side_vertex_[i]] += tangent_normal(side_limits[i], sides_[i]);
    for (const int v : side_vertex_) result_.normals[v].normalize();
  }

  void refine_semi_sharp(std::vector<Fan>& fans) const {
    while (true) {
      std::vector<Fan*> left;
      for (Fan& fan : fans)
        if (is_semi_sharp(fan)) left.push_back(&fan);
      if (left.empty()) return;
      refine(left, topology_.boundary);
    }
  }

  void evaluate(int v, const Fan& fan, const VertexLimit& limit) {
    const std::vector<int> sharp = sharp_spokes(fan);
    const bool stays =
        fan.vertex_sharpness > 0 || sharp.size() > 2 || (fan.open && fan.face_count == 1 && topology_.boundary == BoundaryRule::EdgesAndCorners);
    result_.points[v] = limit.point;
    if (stays) {
      result_.normals[v] = corner_normal(fan);
    } else if (sharp.size() == 2) {
      result_.normals[v] = Vec3::Zero();
      const int first = sharp[1] - sharp[0];
      add_side(v, part_of(fan, sharp[0], first));
      if (!fan.open) add_side(v, part_of(fan, sharp[1], fan.face_count - first));
    } else if (sharp.size() == 1 || fan.face_count == 2) {
      const Fan turned = sharp.empty() ? fan : turned_to(fan, sharp[0]);
      const VertexLimit by_matrix = limit_by_matrix(turned);
      result_.points[v] = by_matrix.point;
      result_.normals[v] = tangent_normal(by_matrix, fan);
    } else {
      result_.normals[v] = tangent_normal(limit, fan);
    }
  }

  void add_side(int v, Fan side) {
    sides_.push_back(std::move(side));
    side_vertex_.push_back(v);
  }

  // The same closed fan with another spoke first.
  static Fan turned_to(const Fan& fan, int spoke) {
    Fan turned = fan;
    std::rotate(turned.edge_sharpness.begin(), turned.edge_sharpness.begin() + spoke, turned.edge_sharpness.end());
    std::rotate(turned.ends.begin(), turned.ends.begin() + spoke, turned.ends.end());
    std::rotate(turned.opposites.begin(), turned.opposites.begin() + spoke, turned.opposites.end());
    return turned;
  }

  const QuadTopology& topology_;
  const VertexFans fans_;
  const std::vector<Vec3>& points_;
  std::vector<int> special_;      // vertices
  std::vector<Fan> sides_;        // of creases
  std::vector<int> side_vertex_;  // and their vertices
  LimitSurface result_;
};

}  // namespace

LimitSurface limit_surface(const HybridMesh& hierarchy, const QuadMesh& mesh, const CatmullClarkRules& rules) {
  if (mesh.points.size() != mesh.vertex.size()) throw Error(ErrorCode::InvalidInput, "positions and vertices of the mesh differ in number");
  MeshTopology topology(hierarchy, mesh);
  apply_rules(rules, mesh, topology);
  return LimitEvaluation(topology.quads, mesh.points).run();
}

}  // namespace hybrid_mesh
