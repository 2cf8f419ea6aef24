// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "codec/rate_fit.h"
#include "codec/stream_body.h"
#include "hierarchy/vertex_index.h"
#include "remesh/surface_samples.h"
#include "surface/distance.h"

namespace hybrid_mesh {

namespace {

constexpr std::array<std::uint8_t, 3> magic = {'H', 'M', 'w'};
constexpr std::uint8_t version = 1;
constexpr std::size_t preamble = magic.size() + 1;

// Samples a direction of the distances that a prefix is chosen by.
constexpr std::int64_t samples = 50000;
constexpr std::int64_t floor_samples = 200000;  // ... that a fitted mesh is judged by
// Times the distance of the mesh that is given, that of a fitted one is too far; below a fraction of the diagonal it is near whatever the other is.
constexpr double higher_floor = 1.05, no_floor = 1e-5;

[[noreturn]] void corrupt(const std::string& what) { throw Error(ErrorCode::CorruptStream, "not a valid hierarchy stream: " + what); }

struct Decoded {
  std::shared_ptr<const StreamGeometry> geometry;
  StreamContent content;
};

// `geometry`: of the same stream, if another prefix has been decoded already.
Decoded decoded(const std::uint8_t* data, std::size_t size, std::shared_ptr<const StreamGeometry> geometry) {
  if (size < preamble || !is_stream(data, size)) corrupt("it starts with other bytes");
  if (data[magic.size()] == 0) corrupt("a version that never was");
  if (data[magic.size()] > version)
    throw Error(ErrorCode::Unsupported, "a hierarchy stream of version " + std::to_string(data[magic.size()]) + ", newer than this program");
  BitReader reader(data + preamble, size - preamble);
  StreamCoder coder(reader);
  StreamContent content;
  try {
    HybridMesh mesh = coder.code_structure();
    const int depth = mesh.depth();
    coder.code_head(depth, content, nullptr);
    if (!geometry) {
      const std::shared_ptr<StreamGeometry> made = stream_geometry(std::move(mesh));
      add_layouts(*made, content.remainders);
      geometry = made;
    }
    coder.code_base(*geometry, content, nullptr);
  } catch (const StreamEnd&) {
    corrupt("it ends before its base does");
  }
  try {
    coder.code_planes(*geometry, content, nullptr);
  } catch (const StreamEnd&) {
  }
  return {std::move(geometry), std::move(content)};
}

// The points of a final mesh at the vertices of another that has the same ones under other names.
template <class GivenVertex>
std::vector<Vec3> points_at(const QuadMesh& given, const QuadMesh& mesh, const GivenVertex& given_vertex) {
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

PolygonSoup final_soup(const Decoded& stream) {
  QuadMesh mesh = stream.geometry->mesh.final_mesh();
  mesh.points = synthesise(*stream.geometry, stream.content).back();
  for (Vec3& point : mesh.points) point = stream.content.placement.outward(point);
  return to_soup(mesh);
}

// Infinity for a prefix without its base.
double error_of(const std::vector<std::uint8_t>& bytes, std::size_t size, const std::shared_ptr<const StreamGeometry>& geometry,
                const DistanceReference& reference, const Progress& progress) {
  std::optional<Decoded> stream;
  try {
    stream = decoded(bytes.data(), size, geometry);
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
  const std::shared_ptr<StreamGeometry> geometry = stream_geometry(coder.code_structure());
  const QuadMesh mesh = geometry->mesh.final_mesh();
  const std::vector<Vec3> points = points_at(given, mesh, [&](VertexId vertex) { return coder.given_vertex(vertex); });
  progress(0.1);
  const StreamContent all = analyse(*geometry, points);
  progress(0.3);
  StreamContent known;
  coder.code_head(static_cast<int>(geometry->steps.size()), known, &all);
  coder.code_base(*geometry, known, &all);
  const std::size_t base = preamble + writer.size() + 4;
  coder.code_planes(*geometry, known, &all);
  progress(0.4);
  std::vector<std::uint8_t> bytes(magic.begin(), magic.end());
  bytes.push_back(version);
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

bool is_stream(const std::uint8_t* data, std::size_t size) { return size >= magic.size() && std::equal(magic.begin(), magic.end(), data); }

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
  const Decoded stream = decoded(data, size, nullptr);
  HybridMesh mesh = stream.geometry->mesh;
  const std::vector<WaveletStep>& steps = stream.geometry->steps;
  std::vector<std::vector<Vec3>> levels = synthesise(*stream.geometry, stream.content);
  // What the setters of positions take of a mesh.
  QuadMesh placed;
  for (std::size_t j = 0; j < levels.size(); ++j) {
    placed.vertex = j > 0 ? steps[j - 1].fine().vertex : mesh.level_mesh(0).vertex;
    placed.points = std::move(levels[j]);
    for (Vec3& point : placed.points) {
      point = stream.content.placement.outward(point);
      if (!point.allFinite()) corrupt("a vertex farther away than numbers go");
    }
    mesh.set_level_positions(static_cast<int>(j), placed);
  }
  mesh.set_final_positions(placed);
  return mesh;
}

}  // namespace hybrid_mesh
