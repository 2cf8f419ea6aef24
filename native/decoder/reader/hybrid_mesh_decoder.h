/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Reads hybrid mesh streams (../FORMAT.md), from C or from whatever calls C. To build it: every .cpp below this header's folder and its sister
 * folders, as C++20, and nothing else: g++ -std=c++20 -O3 -ffp-contract=off. Contraction of floating-point operations must be off; then points are
 * the same bits on every machine.
 *
 * All prefixes of a stream that have its base whole are meshes of the same connectivity. A decoder that has decoded one decodes others of the same
 * stream without making the connectivity anew. A decoder is used by one thread at a time; different ones are independent. */
#ifndef HYBRID_MESH_DECODER_H
#define HYBRID_MESH_DECODER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct hybrid_mesh_decoder hybrid_mesh_decoder;

/* NOLINTBEGIN(readability-identifier-naming): names as C has them. */
typedef enum hybrid_mesh_status {
  HYBRID_MESH_OK = 0,
  HYBRID_MESH_CORRUPT = 1,     /* not a stream, or one that ends before its base does, or of more quads than are allowed */
  HYBRID_MESH_UNSUPPORTED = 2, /* a stream of a later version */
  HYBRID_MESH_INVALID = 3,     /* an argument out of range, or nothing decoded yet */
  HYBRID_MESH_OUT_OF_MEMORY = 4,
  HYBRID_MESH_INTERNAL = 5 /* a defect of the decoder */
} hybrid_mesh_status;
/* NOLINTEND(readability-identifier-naming) */

/* A decoder of a stream, or of its first bytes, which are copied. NULL: out of memory. */
hybrid_mesh_decoder* hybrid_mesh_decoder_open(const uint8_t* bytes, size_t size);
/* Frees it and all that it has returned. NULL is allowed. */
void hybrid_mesh_decoder_close(hybrid_mesh_decoder* decoder);

/* Appends further bytes of the stream. */
hybrid_mesh_status hybrid_mesh_decoder_append(hybrid_mesh_decoder* decoder, const uint8_t* bytes, size_t size);
/* Refuses hierarchies of more quads, those of all levels counted together. Memory is a few hundred bytes for each. At first 2^23, more than which no
 * stream has. */
hybrid_mesh_status hybrid_mesh_decoder_limit(hybrid_mesh_decoder* decoder, size_t most_quads);

/* Decodes a mesh from the first `most_bytes` bytes that the decoder has (0: all). `level`: 0 is the base; -1, or one above the depth: the finest.
 * What was decoded before is gone, also where this fails. */
hybrid_mesh_status hybrid_mesh_decoder_decode(hybrid_mesh_decoder* decoder, size_t most_bytes, int level);
/* What went wrong last, in words, or "". Valid until the next call. */
const char* hybrid_mesh_decoder_error(const hybrid_mesh_decoder* decoder);

/* Of the mesh that was decoded; 0, -1 or NULL if there is none. Arrays are valid until the next call that decodes, appends or closes. */
int hybrid_mesh_decoder_depth(const hybrid_mesh_decoder* decoder); /* highest level of the hierarchy */
int hybrid_mesh_decoder_level(const hybrid_mesh_decoder* decoder); /* of the mesh */
size_t hybrid_mesh_decoder_vertex_count(const hybrid_mesh_decoder* decoder);
size_t hybrid_mesh_decoder_face_count(const hybrid_mesh_decoder* decoder);
const double* hybrid_mesh_decoder_points(const hybrid_mesh_decoder* decoder);   /* #V x 3 */
const int64_t* hybrid_mesh_decoder_offsets(const hybrid_mesh_decoder* decoder); /* #F + 1: face f has corners offsets[f] ... offsets[f + 1] - 1 */
const int32_t* hybrid_mesh_decoder_indices(
    const hybrid_mesh_decoder* decoder); /* of the corners' vertices, counter-clockwise; four a face as a rule */

#ifdef __cplusplus
}
#endif

#endif
