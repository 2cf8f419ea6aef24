// SPDX-License-Identifier: GPL-3.0-or-later
// Where streams come from: {name, size: in bytes, or null, pieces: an asynchronous iterable of Uint8Array}.
"use strict";

const MOST_BYTES = 1 << 28; // no stream of as many quads as are allowed is as long

async function* piecesOf(readable) {
  const reader = readable.getReader();
  try {
    for (let piece = await reader.read(); !piece.done; piece = await reader.read()) yield piece.value;
  } finally {
    reader.cancel().catch(() => {});
  }
}

function fileSource(file) {
  return { name: file.name, size: file.size, pieces: piecesOf(file.stream()) };
}

// An element that has a stream in base64.
function embeddedSource(element) {
  const text = atob(element.textContent.trim());
  const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const pieces = (async function* () {
    yield bytes;
  })();
  return { name: element.dataset.name, size: bytes.length, pieces };
}

async function addressSource(address) {
  const name = decodeURIComponent(new URL(address, document.baseURI).pathname.split("/").pop());
  let response;
  try {
    response = await fetch(address);
  } catch {
    const local = location.protocol === "file:" ? "; a page that was opened from a folder may not load files beside it: drop the stream here" : "";
    throw new Error(`${name} cannot be loaded${local}`);
  }
  if (!response.ok) throw new Error(`${name} cannot be loaded: the server says ${response.status}`);
  const length = Number(response.headers.get("content-length"));
  // Of a body that was packed for the way the length is that of the packed one.
  const size = length > 0 && !response.headers.get("content-encoding") ? length : null;
  return { name, size, pieces: piecesOf(response.body) };
}

// What the first bytes of a file that is no stream say of it; null if they may be a stream's.
function foreignWords(head) {
  const starts = (text) => [...text].every((letter, i) => i >= head.length || head[i] === letter.charCodeAt(0));
  if (head.length === 0) return "the file is empty";
  if (starts("HMw")) return null;
  if (head.length >= 5 && starts("HMESH")) return "it is a container, which is read whole: encode it as a stream first";
  return "it is not a stream of a hybrid mesh: it starts with other bytes";
}
