// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "codec/rate_fit.h"
#include "codec/stream_analysis.h"
#include "decoder/forest/vertex_index.h"
#include "decoder/reader/stream_coder.h"
#include "hierarchy/flat_points.h"
#include "remesh/surface_samples.h"
#include "surface/distance.h"

namespace hybrid_mesh {

namespace {

// Samples a direction of the distances that a prefix is chosen by.
constexpr std::int64_t samples = 50000;
constexpr std::int64_t floor_samples = 200000;  // ... that a fitted mesh is judged by
// Times the distance of the mesh that is given, that of a fitted one is too far; below a fraction of the diagonal it is near whatever the other is.
constexpr double higher_floor = 1.05, no_floor = 1e-5;

// Of all levels, in the world. Throws Error{CorruptStream} where numbers do not go so far.
std::vector<std::vector<Point3>> points_of_levels(const DecodedStream& stream) {
  std::vector<std::vector<Point3>> levels{base_points(stream.content)};
  for (int j = 0; j < stream.geometry->depth(); ++j) levels.push_back(next_points(*stream.geometry, stream.content, j, levels.back()));
  for (std::vector<Point3>& points : levels) place_points(stream.content.placement, points);
  return levels;
}

// The points of a final mesh at the vertices of another that has the same ones under other names.
template <class GivenVertex>
std::vector<Vec3> points_at(const QuadMesh& given, const LevelMesh& mesh, const GivenVertex& given_vertex) {
  if (given.vertex_count() != mesh.vertex_count() || given.face_count() != mesh.face_count())
    throw Error(ErrorCode::Internal, "a stream's mesh differs from the one that was given");
  const VertexIndex find(given.vertex);
  std::vector<Vec3> points;
  points.reserve(mesh.vertex_count());
  for (const VertexId vertex : mesh.vertex) {
    const int v = find(given_vertex(vertex));
    if (v < 0) throw Error(ErrorCode::Internal, "a stream's vertex that was not given");
    if (!given.points[v].allFinite()) throw Error(ErrorCode::InvalidInput, "a position that is not finite");
    points.push_back(given.points[v]);
  }
  return points;
}

struct Fitted {
  QuadMesh mesh;
  std::shared_ptr<const PolygonSoup> surface;
};

// The final mesh, with its vertices where the fewest details are needed; nothing unless the options and the hierarchy allow it.
std::optional<Fitted> fitted(const HybridMesh& hierarchy, const StreamOptions& options, const Progress& progress) {
  if (options.fit == StreamFit::None) return std::nullopt;
  const QuadMesh mesh = hierarchy.final_mesh();
  for (const Vec3& point : mesh.points)
    if (!point.allFinite()) return std::nullopt;
  std::shared_ptr<const PolygonSoup> surface = options.surface;
  if (!surface) {
    if (!hierarchy.has_maps()) return std::nullopt;
    surface = std::make_shared<const PolygonSoup>(mapped_surface(hierarchy));
    if (surface->polygon_count() == 0 || !lies_on(mesh, *surface, progress)) return std::nullopt;
  }
  return Fitted{fit_for_rate(hierarchy, *surface, RateFitOptions(), progress), std::move(surface)};
}

// Whether the whole of a fitted mesh's stream would be farther from the surface than that of the mesh that is given.
bool raises_floor(const Fitted& fit, const QuadMesh& given, const Progress& progress) {
  const DistanceReference reference(*fit.surface);
  const auto floor = [&](const QuadMesh& mesh) { return reference.distance(to_soup(mesh), {floor_samples, 1}, progress).l2; };
  return floor(fit.mesh) > higher_floor * floor(given) + no_floor;
}

PolygonSoup final_soup(const DecodedStream& stream) {
  const LevelMesh& mesh = stream.geometry->meshes.back();
  PolygonSoup soup;
  soup.points = vectors_of(points_of_levels(stream).back());
  soup.offsets = mesh.offsets;
  soup.indices = mesh.indices;
  return soup;
}

// Infinity for a prefix without its base.
double error_of(const std::vector<std::uint8_t>& bytes, std::size_t size, const std::shared_ptr<const StreamGeometry>& geometry,
                const DistanceReference& reference, const Progress& progress) {
  std::optional<DecodedStream> stream;
  try {
    stream = decode_content(bytes.data(), size, geometry);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::CorruptStream) throw;
    return std::numeric_limits<double>::infinity();
  }
  return reference.distance(final_soup(*stream), {samples, 1}, progress).l2;
}

// By bisection, as if the error fell all along the stream, to within 1/256 of the size.
std::size_t shortest(const std::vector<std::uint8_t>& bytes, double error, const std::shared_ptr<const StreamGeometry>& geometry,
                     const DistanceReference& reference, const Progress& progress) {
  std::size_t too_short = 0, enough = bytes.size();
  for (int step = 0; enough - too_short > 1 + enough / 256; ++step) {
    progress(1 - 1.0 / (step + 1));
    // Where errors are far apart, sizes are: the mean is that of logarithms.
    const double mean = std::sqrt(static_cast<double>(std::max<std::size_t>(too_short, 64)) * static_cast<double>(enough));
    const std::size_t size = std::clamp(static_cast<std::size_t>(mean), too_short + 1, enough - 1);
    (error_of(bytes, size, geometry, reference, progress.part(1, 1)) <= error ? enough : too_short) = size;
  }
  return enough;
}

// A stream of these points of the final mesh, as long as bytes are allowed.
struct Encoded {
  std::vector<std::uint8_t> bytes;
  std::shared_ptr<const StreamGeometry> geometry;
};

Encoded encoded(const HybridMesh& hierarchy, const QuadMesh& given, const StreamOptions& options, const Progress& progress) {
  BitWriter writer;
  StreamCoder coder(writer, &hierarchy);
  const std::shared_ptr<StreamGeometry> geometry = stream_geometry(coder.refined_to_depth(coder.code_structure()));
  const std::vector<Vec3> points = points_at(given, geometry->meshes.back(), [&](VertexId vertex) { return coder.given_vertex(vertex); });
  progress(0.1);
  const StreamContent all = analyse(*geometry, points);
  progress(0.3);
  StreamContent known;
  coder.code_head(geometry->depth(), known, &all);
  coder.code_base(geometry->meshes[0], known, &all);
  const std::size_t base = stream_preamble + writer.size() + 4;
  coder.code_planes(*geometry, known, &all);
  progress(0.4);
  std::vector<std::uint8_t> bytes(stream_magic.begin(), stream_magic.end());
  bytes.push_back(stream_version);
  const std::vector<std::uint8_t> body = writer.finish();
  bytes.insert(bytes.end(), body.begin(), body.end());
  if (options.most_bytes > 0 && options.most_bytes < bytes.size()) {
    if (options.most_bytes < base)
      throw Error(ErrorCode::InvalidInput,
                  "the base alone takes about " + std::to_string(base) + " bytes, more than " + std::to_string(options.most_bytes));
    bytes.resize(options.most_bytes);
  }
  return {std::move(bytes), geometry};
}

}  // namespace

std::vector<std::uint8_t> encode_stream(const HybridMesh& hierarchy, const StreamOptions& options, const Progress& progress) {
  if (hierarchy.node_count() == 0) throw Error(ErrorCode::InvalidInput, "an empty hierarchy has no stream");
  progress.stage("fitting");
  const QuadMesh given = hierarchy.final_mesh();
  const std::optional<Fitted> fit = fitted(hierarchy, options, progress.part(0, 0.6));
  const bool both = fit && raises_floor(*fit, given, progress.part(0.6, 0.6));
  progress.stage("coding");
  std::optional<DistanceReference> reference;
  if (options.error > 0 || both) reference.emplace(options.surface ? *options.surface : to_soup(given));
  const auto made = [&](const QuadMesh& mesh, const Progress& part) {
    Encoded stream = encoded(hierarchy, mesh, options, part.part(0, 0.4));
    if (options.error > 0) stream.bytes.resize(shortest(stream.bytes, options.error, stream.geometry, *reference, part.part(0.4, 1)));
    return stream;
  };
  Encoded stream = made(fit ? fit->mesh : given, progress.part(0.6, both ? 0.8 : 1));
  if (both) {
    Encoded other = made(given, progress.part(0.8, 1));
    const auto error = [&](const Encoded& s) { return error_of(s.bytes, s.bytes.size(), s.geometry, *reference, progress.part(1, 1)); };
    const double here = error(stream), there = error(other);
    const bool enough = std::max(here, there) <= options.error;
    if (enough ? other.bytes.size() < stream.bytes.size() : there < here) stream = std::move(other);
  }
  progress(1);
  return std::move(stream.bytes);
}

HybridMesh decode_stream(const std::uint8_t* data, std::size_t size) {
  const DecodedStream stream = decode_content(data, size);
  const std::vector<std::vector<Point3>> levels = points_of_levels(stream);
  HybridMesh mesh(whole_forest(*stream.geometry));
  // What the setters of positions take of a mesh.
  QuadMesh placed;
  for (std::size_t j = 0; j < levels.size(); ++j) {
    placed.vertex = stream.geometry->meshes[j].vertex;
    placed.points = vectors_of(levels[j]);
    mesh.set_level_positions(static_cast<int>(j), placed);
  }
  mesh.set_final_positions(placed);
  return mesh;
}

}  // namespace hybrid_mesh
