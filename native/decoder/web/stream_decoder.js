// SPDX-License-Identifier: GPL-3.0-or-later
// The decoder (../reader/hybrid_mesh_decoder.h) for JavaScript, of hybrid_mesh_decoder.wasm and nothing else.
"use strict";

const STREAM_STATUS = { CORRUPT: 1, UNSUPPORTED: 2, INVALID: 3, OUT_OF_MEMORY: 4, INTERNAL: 5 };

// What the decoder refuses, in its own words. Whatever else is thrown leaves a module that is not to be used again.
class StreamError extends Error {
  constructor(status, message) {
    super(message || (status === STREAM_STATUS.OUT_OF_MEMORY ? "there is not enough memory" : "the decoder has failed"));
    this.status = status;
  }
}

// `module`: a WebAssembly.Module. Its functions, ready to be called.
async function decoderFunctions(module) {
  const instance = await WebAssembly.instantiate(module, {
    env: { emscripten_notify_memory_growth() {} },
    wasi_snapshot_preview1: {
      proc_exit(code) {
        throw new Error(`the decoder has stopped with code ${code}`);
      },
    },
  });
  instance.exports._initialize();
  return instance.exports;
}

// One stream, as far as it has been appended.
class StreamDecoder {
  constructor(functions) {
    this.functions = functions;
    this.size = 0;
    this.handle = functions.hybrid_mesh_decoder_open(0, 0);
    if (!this.handle) throw new StreamError(STREAM_STATUS.OUT_OF_MEMORY);
  }

  close() {
    this.functions.hybrid_mesh_decoder_close(this.handle);
    this.handle = 0;
  }

  limit(mostQuads) {
    this.check(this.functions.hybrid_mesh_decoder_limit(this.handle, mostQuads));
  }

  append(bytes) {
    const place = this.functions.malloc(bytes.length);
    if (!place) throw new StreamError(STREAM_STATUS.OUT_OF_MEMORY);
    new Uint8Array(this.functions.memory.buffer, place, bytes.length).set(bytes);
    const status = this.functions.hybrid_mesh_decoder_append(this.handle, place, bytes.length);
    this.functions.free(place);
    this.check(status);
    this.size += bytes.length;
  }

  // The arrays are views of the module's memory: copy them before anything else is called.
  decode(mostBytes, level) {
    const f = this.functions;
    this.check(f.hybrid_mesh_decoder_decode(this.handle, mostBytes, level));
    const memory = f.memory.buffer;
    const vertices = f.hybrid_mesh_decoder_vertex_count(this.handle);
    const faces = f.hybrid_mesh_decoder_face_count(this.handle);
    // Offsets are of 64 bits in C; no mesh has so many corners that the lower half would not do.
    const wide = new Int32Array(memory, f.hybrid_mesh_decoder_offsets(this.handle), 2 * (faces + 1));
    const offsets = new Int32Array(faces + 1);
    for (let i = 0; i <= faces; ++i) offsets[i] = wide[2 * i];
    return {
      depth: f.hybrid_mesh_decoder_depth(this.handle),
      level: f.hybrid_mesh_decoder_level(this.handle),
      points: new Float64Array(memory, f.hybrid_mesh_decoder_points(this.handle), 3 * vertices),
      offsets,
      indices: new Int32Array(memory, f.hybrid_mesh_decoder_indices(this.handle), offsets[faces]),
    };
  }

  check(status) {
    if (status !== 0) throw new StreamError(status, this.words());
  }

  words() {
    const memory = new Uint8Array(this.functions.memory.buffer);
    const start = this.functions.hybrid_mesh_decoder_error(this.handle);
    return new TextDecoder().decode(memory.subarray(start, memory.indexOf(0, start)));
  }
}
