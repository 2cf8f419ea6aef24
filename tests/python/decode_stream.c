/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a program needs to do to read a stream: decode_stream FILE BYTES LEVEL writes a mesh as raw numbers, or what is wrong.
 * Counts of vertices, faces and corners (uint64), points (double), offsets (int64), indices (int32). */
#include <stdio.h>
#include <stdlib.h>

#include "decoder/reader/hybrid_mesh_decoder.h"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  FILE* file = fopen(argv[1], "rb");
  if (!file) return 2;
  /* In two pieces, as if the second one came later. */
  uint8_t piece[1000];
  size_t size = fread(piece, 1, sizeof piece, file);
  hybrid_mesh_decoder* decoder = hybrid_mesh_decoder_open(piece, size);
  if (!decoder) return 2;
  hybrid_mesh_decoder_decode(decoder, 0, -1);
  while ((size = fread(piece, 1, sizeof piece, file)) > 0)
    if (hybrid_mesh_decoder_append(decoder, piece, size) != HYBRID_MESH_OK) return 2;
  fclose(file);
  const hybrid_mesh_status status = hybrid_mesh_decoder_decode(decoder, strtoul(argv[2], NULL, 10), atoi(argv[3]));
  if (status != HYBRID_MESH_OK) {
    fprintf(stderr, "%s\n", hybrid_mesh_decoder_error(decoder));
    hybrid_mesh_decoder_close(decoder);
    return 10 + (int)status;
  }
  const int64_t* offsets = hybrid_mesh_decoder_offsets(decoder);
  const uint64_t vertices = hybrid_mesh_decoder_vertex_count(decoder), faces = hybrid_mesh_decoder_face_count(decoder), corners = (uint64_t)offsets[faces];
  const uint64_t counts[3] = {vertices, faces, corners};
  fwrite(counts, sizeof *counts, 3, stdout);
  fwrite(hybrid_mesh_decoder_points(decoder), sizeof(double), 3 * vertices, stdout);
  fwrite(offsets, sizeof *offsets, faces + 1, stdout);
  fwrite(hybrid_mesh_decoder_indices(decoder), sizeof(int32_t), corners, stdout);
  hybrid_mesh_decoder_close(decoder);
  return 0;
}
