// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/reader/hybrid_mesh_decoder.h"

#include <algorithm>
#include <new>
#include <string>

#include "decoder/error.h"
#include "decoder/reader/stream_coder.h"

using namespace hybrid_mesh;

struct hybrid_mesh_decoder {
  std::vector<std::uint8_t> bytes;
  int most_quads = most_stream_quads;
  std::shared_ptr<const StreamGeometry> geometry;  // once something has been decoded
  int level = -1;
  std::vector<Point3> points;
  std::string error;

  const LevelMesh* mesh() const { return level < 0 ? nullptr : &geometry->meshes[level]; }
};

namespace {

static_assert(sizeof(Point3) == 3 * sizeof(double), "points are handed out as numbers");

hybrid_mesh_status status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::CorruptStream:
      return HYBRID_MESH_CORRUPT;
    case ErrorCode::Unsupported:
      return HYBRID_MESH_UNSUPPORTED;
    case ErrorCode::InvalidInput:
      return HYBRID_MESH_INVALID;
    default:
      return HYBRID_MESH_INTERNAL;
  }
}

// Nothing is thrown through C.
template <class Body>
hybrid_mesh_status guarded(hybrid_mesh_decoder* decoder, const Body& body) {
  if (!decoder) return HYBRID_MESH_INVALID;
  try {
    decoder->error.clear();
    body();
    return HYBRID_MESH_OK;
  } catch (const Error& error) {
    decoder->error = error.what();
    return status_of(error.code());
  } catch (const std::bad_alloc&) {
    return HYBRID_MESH_OUT_OF_MEMORY;
  } catch (const std::exception& error) {
    decoder->error = error.what();
    return HYBRID_MESH_INTERNAL;
  }
}

}  // namespace

hybrid_mesh_decoder* hybrid_mesh_decoder_open(const uint8_t* bytes, size_t size) {
  auto* decoder = new (std::nothrow) hybrid_mesh_decoder;
  if (decoder && hybrid_mesh_decoder_append(decoder, bytes, size) != HYBRID_MESH_OK) {
    delete decoder;
    return nullptr;
  }
  return decoder;
}

void hybrid_mesh_decoder_close(hybrid_mesh_decoder* decoder) { delete decoder; }

hybrid_mesh_status hybrid_mesh_decoder_append(hybrid_mesh_decoder* decoder, const uint8_t* bytes, size_t size) {
  return guarded(decoder, [&] { decoder->bytes.insert(decoder->bytes.end(), bytes, bytes + size); });
}

hybrid_mesh_status hybrid_mesh_decoder_limit(hybrid_mesh_decoder* decoder, size_t most_quads) {
  return guarded(decoder, [&] { decoder->most_quads = static_cast<int>(std::min<size_t>(most_quads, most_stream_quads)); });
}

hybrid_mesh_status hybrid_mesh_decoder_decode(hybrid_mesh_decoder* decoder, size_t most_bytes, int level) {
  return guarded(decoder, [&] {
    decoder->level = -1;
    decoder->points.clear();
    if (level < -1) throw Error(ErrorCode::InvalidInput, "a level below -1");
    const std::size_t size = most_bytes > 0 ? std::min(most_bytes, decoder->bytes.size()) : decoder->bytes.size();
    const DecodedStream stream = decode_content(decoder->bytes.data(), size, decoder->geometry, decoder->most_quads);
    decoder->geometry = stream.geometry;
    const int depth = stream.geometry->depth(), last = level < 0 ? depth : std::min(level, depth);
    std::vector<Point3> points = base_points(stream.content);
    for (int j = 0; j < last; ++j) points = next_points(*stream.geometry, stream.content, j, points);
    place_points(stream.content.placement, points);
    decoder->points = std::move(points);
    decoder->level = last;
  });
}

const char* hybrid_mesh_decoder_error(const hybrid_mesh_decoder* decoder) { return decoder ? decoder->error.c_str() : "no decoder"; }

int hybrid_mesh_decoder_depth(const hybrid_mesh_decoder* decoder) { return decoder && decoder->level >= 0 ? decoder->geometry->depth() : -1; }

int hybrid_mesh_decoder_level(const hybrid_mesh_decoder* decoder) { return decoder ? decoder->level : -1; }

size_t hybrid_mesh_decoder_vertex_count(const hybrid_mesh_decoder* decoder) { return decoder && decoder->level >= 0 ? decoder->points.size() : 0; }

size_t hybrid_mesh_decoder_face_count(const hybrid_mesh_decoder* decoder) {
  return decoder && decoder->level >= 0 ? decoder->mesh()->face_count() : 0;
}

const double* hybrid_mesh_decoder_points(const hybrid_mesh_decoder* decoder) {
  return decoder && decoder->level >= 0 ? &decoder->points.data()->x : nullptr;
}

const int64_t* hybrid_mesh_decoder_offsets(const hybrid_mesh_decoder* decoder) {
  return decoder && decoder->level >= 0 ? decoder->mesh()->offsets.data() : nullptr;
}

const int32_t* hybrid_mesh_decoder_indices(const hybrid_mesh_decoder* decoder) {
  return decoder && decoder->level >= 0 ? decoder->mesh()->indices.data() : nullptr;
}
