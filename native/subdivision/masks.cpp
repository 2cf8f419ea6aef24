// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Catmull, Clark, Recursively generated B-spline surfaces on arbitrary topological meshes, 1978; DeRose, Kass, Truong, Subdivision surfaces
// in character animation, 1998 (semi-sharp creases); Biermann, Levin, Zorin, Piecewise smooth subdivision surfaces with normal control, 2000
// (tangents at creases), all as OpenSubdiv has them.
#include "subdivision/masks.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>
#include <memory>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

// What the factory below is told of a mesh.
struct FannedTopology {
  const QuadTopology& topology;
  const VertexFans& fans;
};

}  // namespace
}  // namespace hybrid_mesh

// NOLINTBEGIN(readability-identifier-naming): what OpenSubdiv calls has OpenSubdiv's names.
namespace OpenSubdiv::OPENSUBDIV_VERSION::Far {

using hybrid_mesh::FannedTopology;

// All relations are given, down to the place of a vertex in each of its faces and edges: what OpenSubdiv would find out by comparing names would
// be wrong where a face or an edge has the same vertex twice.
template <>
bool TopologyRefinerFactory<FannedTopology>::resizeComponentTopology(TopologyRefiner& refiner, const FannedTopology& mesh) {
  const auto& [topology, fans] = mesh;
  setNumBaseVertices(refiner, topology.vertex_count);
  setNumBaseFaces(refiner, topology.face_count());
  setNumBaseEdges(refiner, topology.edge_count());
  for (int f = 0; f < topology.face_count(); ++f) setNumBaseFaceVertices(refiner, f, 4);
  for (int e = 0; e < topology.edge_count(); ++e) setNumBaseEdgeFaces(refiner, e, topology.is_boundary(e) ? 1 : 2);
  for (int v = 0; v < topology.vertex_count; ++v) setNumBaseVertexFaces(refiner, v, fans.face_count(v));
  for (int v = 0; v < topology.vertex_count; ++v) setNumBaseVertexEdges(refiner, v, fans.spoke_count(v));
  return true;
}

template <>
bool TopologyRefinerFactory<FannedTopology>::assignComponentTopology(TopologyRefiner& refiner, const FannedTopology& mesh) {
  const auto& [topology, fans] = mesh;
  for (int f = 0; f < topology.face_count(); ++f) {
    IndexArray vertices = getBaseFaceVertices(refiner, f), edges = getBaseFaceEdges(refiner, f);
    for (int i = 0; i < 4; ++i) {
      vertices[i] = topology.corners[f][i];
      edges[i] = topology.half[f][i] >> 1;
    }
  }
  for (int e = 0; e < topology.edge_count(); ++e) {
    IndexArray vertices = getBaseEdgeVertices(refiner, e), faces = getBaseEdgeFaces(refiner, e);
    LocalIndexArray place = getBaseEdgeFaceLocalIndices(refiner, e);
    for (int i = 0; i < 2; ++i) vertices[i] = topology.ends[e][i];
    int count = 0;
    for (const int side : topology.sides[e]) {
      if (side < 0) continue;
      faces[count] = side / 4;
      place[count++] = static_cast<LocalIndex>(side % 4);
    }
  }
  for (int v = 0; v < topology.vertex_count; ++v) {
    IndexArray faces = getBaseVertexFaces(refiner, v), edges = getBaseVertexEdges(refiner, v);
    LocalIndexArray in_face = getBaseVertexFaceLocalIndices(refiner, v), in_edge = getBaseVertexEdgeLocalIndices(refiner, v);
    for (int i = 0; i < fans.face_count(v); ++i) {
      faces[i] = fans.corner(v, i) / 4;
      in_face[i] = static_cast<LocalIndex>(fans.corner(v, i) % 4);
    }
    for (int i = 0; i < fans.spoke_count(v); ++i) {
      edges[i] = fans.spoke(v, i) >> 1;
      in_edge[i] = static_cast<LocalIndex>(fans.spoke(v, i) & 1);
    }
  }
  return true;
}

template <>
bool TopologyRefinerFactory<FannedTopology>::assignComponentTags(TopologyRefiner& refiner, const FannedTopology& mesh) {
  const auto& topology = mesh.topology;
  for (int e = 0; e < topology.edge_count(); ++e)
    if (topology.edge_sharpness[e] > 0) setBaseEdgeSharpness(refiner, e, topology.edge_sharpness[e]);
  for (int v = 0; v < topology.vertex_count; ++v)
    if (topology.vertex_sharpness[v] > 0) setBaseVertexSharpness(refiner, v, topology.vertex_sharpness[v]);
  return true;
}

template <>
bool TopologyRefinerFactory<FannedTopology>::assignFaceVaryingTopology(TopologyRefiner&, const FannedTopology&) {
  return true;
}

template <>
void TopologyRefinerFactory<FannedTopology>::reportInvalidTopology(TopologyError, const char*, const FannedTopology&) {}

}  // namespace OpenSubdiv::OPENSUBDIV_VERSION::Far

namespace hybrid_mesh {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// A point as OpenSubdiv sums it up.
struct Sum {
  Vec3 value = Vec3::Zero();
  void Clear() { value.setZero(); }
  void AddWithWeight(const Sum& other, double weight) { value += weight * other.value; }
  void AddWithWeight(const Vec3& point, double weight) { value += weight * point; }
};

// NOLINTEND(readability-identifier-naming)

std::unique_ptr<Far::TopologyRefiner> make_refiner(const QuadTopology& topology, const VertexFans& fans) {
  using Factory = Far::TopologyRefinerFactory<FannedTopology>;
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(topology.boundary == BoundaryRule::EdgesOnly ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                                                                   : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create({topology, fans}, Factory::Options(Sdc::SCHEME_CATMARK, options)));
  if (!refiner) throw Error(ErrorCode::Unsupported, "a mesh that OpenSubdiv does not take: a vertex has too many quads");
  return refiner;
}

std::vector<Vec3> values(const std::vector<Sum>& sums) {
  std::vector<Vec3> result;
  result.reserve(sums.size());
  for (const Sum& sum : sums) result.push_back(sum.value);
  return result;
}

// What the vertices, edges and faces of a mesh become one level finer.
template <class Summed, class Result, class Source>
Result refined_values(const QuadTopology& topology, const VertexFans& fans, const Source& source) {
  const auto refiner = make_refiner(topology, fans);
  refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(1));
  std::vector<Summed> refined(refiner->GetLevel(1).GetNumVertices());
  Far::PrimvarRefinerReal<double>(*refiner).Interpolate(1, source, refined);
  Result result;
  const Far::TopologyLevel& level = refiner->GetLevel(0);
  result.vertices.reserve(topology.vertex_count);
  result.edges.reserve(topology.edge_count());
  result.faces.reserve(topology.face_count());
  for (int v = 0; v < topology.vertex_count; ++v) result.vertices.push_back(std::move(refined[level.GetVertexChildVertex(v)].value));
  for (int e = 0; e < topology.edge_count(); ++e) result.edges.push_back(std::move(refined[level.GetEdgeChildVertex(e)].value));
  for (int f = 0; f < topology.face_count(); ++f) result.faces.push_back(std::move(refined[level.GetFaceChildVertex(f)].value));
  return result;
}

}  // namespace

float refined_sharpness(float sharpness) { return Sdc::Crease().SubdivideUniformSharpness(sharpness); }

RefinedPoints refine_points(const QuadTopology& topology, const VertexFans& fans, const std::vector<Vec3>& points) {
  return refined_values<Sum, RefinedPoints>(topology, fans, points.data());
}

LimitPoints limit_points(const QuadTopology& topology, const VertexFans& fans, const std::vector<Vec3>& points) {
  const auto refiner = make_refiner(topology, fans);
  std::vector<Sum> limit(topology.vertex_count), tangent(topology.vertex_count), cross_tangent(topology.vertex_count);
  const Vec3* source = points.data();
  Far::PrimvarRefinerReal<double>(*refiner).Limit(source, limit, tangent, cross_tangent);
  return {values(limit), values(tangent), values(cross_tangent)};
}

}  // namespace hybrid_mesh
