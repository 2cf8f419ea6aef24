// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes off the page's thread. A message {ticket, kind, ...} gets one answer: {ticket, result}, {ticket, refused: words, corrupt: whether it may be
// that bytes are missing}, or {ticket, broken: words}, after which this worker is of no more use.
"use strict";

// Some 1 GB of memory. The program's own bound is twice that.
const MOST_QUADS = 1 << 22;

let functions = null;
const streams = new Map(); // by the page's number: {decoder, sphere, whole: of each level, the points that all bytes give}

function known(stream) {
  const found = streams.get(stream);
  if (!found) throw new StreamError(STREAM_STATUS.INVALID, "the stream is closed");
  return found;
}

// Quads that are told of, and the connectivity of one level, which is the same for all prefixes.
function census(mesh) {
  const vertices = mesh.points.length / 3, faces = mesh.offsets.length - 1;
  let quads = 0;
  for (let f = 0; f < faces; ++f) quads += mesh.offsets[f + 1] - mesh.offsets[f] === 4 ? 1 : 0;
  return { level: mesh.level, vertices, faces, quads };
}

const answers = {
  async start({ module }) {
    functions = await decoderFunctions(module);
  },
  open({ stream }) {
    const decoder = new StreamDecoder(functions);
    decoder.limit(MOST_QUADS);
    streams.set(stream, { decoder, sphere: null, whole: new Map() });
  },
  append({ stream, bytes }) {
    const { decoder, whole } = known(stream);
    decoder.append(bytes);
    whole.clear();
  },
  close({ stream }) {
    streams.get(stream)?.decoder.close();
    streams.delete(stream);
  },
  // The mesh as it is drawn.
  decode({ stream, bytes, level }) {
    const decoded = known(stream);
    const start = performance.now();
    const mesh = decoded.decoder.decode(bytes, level);
    const milliseconds = performance.now() - start;
    decoded.sphere ??= boundingSphere(mesh.points);
    const points = placedPoints(mesh.points, decoded.sphere);
    const whole = decoded.whole.get(mesh.level);
    const off = whole ? rootMeanSquare(mesh.points, whole.points) / whole.diagonal : null;
    return {
      ...census(mesh), depth: mesh.depth, bytes, milliseconds, off,
      points, triangles: triangles(points, mesh.offsets, mesh.indices), ...shading(points, mesh.offsets, mesh.indices),
    };
  },
  // The fewest bytes that give a mesh, if all do.
  first_bytes({ stream }) {
    const { decoder } = known(stream);
    let few = 0, enough = decoder.size;
    while (enough - few > 1) {
      const middle = (few + enough) >> 1;
      try {
        decoder.decode(middle, 0);
        enough = middle;
      } catch (error) {
        if (!(error instanceof StreamError)) throw error;
        few = middle;
      }
    }
    return enough;
  },
  // What there is to say of a level, and from then on how far other prefixes are off.
  survey({ stream, level }) {
    const { decoder, whole } = known(stream);
    const mesh = decoder.decode(0, level);
    whole.set(mesh.level, { points: mesh.points.slice(), diagonal: boundingSphere(mesh.points).diagonal || 1 });
    return { ...census(mesh), ...topology(mesh.points.length / 3, mesh.offsets, mesh.indices) };
  },
  object({ stream, bytes, level }) {
    const mesh = known(stream).decoder.decode(bytes, level);
    return wavefrontObject(mesh.points, mesh.offsets, mesh.indices);
  },
};

async function answer({ ticket, kind, ...data }) {
  try {
    const result = await answers[kind](data);
    const arrays = Object.values(result ?? {}).filter((value) => ArrayBuffer.isView(value));
    postMessage({ ticket, result }, arrays.map((array) => array.buffer));
  } catch (error) {
    if (error instanceof StreamError) postMessage({ ticket, refused: error.message, corrupt: error.status === STREAM_STATUS.CORRUPT });
    else postMessage({ ticket, broken: String(error.message ?? error) });
  }
}

// One after the other, the module's start included.
let last = Promise.resolve();
onmessage = ({ data }) => (last = last.then(() => answer(data)));
