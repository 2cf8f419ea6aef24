// SPDX-License-Identifier: GPL-3.0-or-later
// What is drawn and told of a polygon mesh: #V x 3 points, #F + 1 offsets into the corners' indices.
"use strict";

// The middle of the bounding box, and how far from it the farthest point is; never 0.
function boundingSphere(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; ++i) {
    const axis = i % 3;
    if (points[i] < low[axis]) low[axis] = points[i];
    if (points[i] > high[axis]) high[axis] = points[i];
  }
  const center = low.map((x, axis) => x / 2 + high[axis] / 2);
  let radius = 0;
  for (let i = 0; i < points.length; i += 3)
    radius = Math.max(radius, Math.hypot(points[i] - center[0], points[i + 1] - center[1], points[i + 2] - center[2]));
  const diagonal = Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  return { center, radius: radius > 0 ? radius : 1, diagonal };
}

// In single precision, with the sphere as the unit sphere.
function placedPoints(points, sphere) {
  const placed = new Float32Array(points.length);
  for (let i = 0; i < points.length; ++i) placed[i] = (points[i] - sphere.center[i % 3]) / sphere.radius;
  return placed;
}

// Rows (a, b, c, 8 face + edges): bit i of `edges` is set where the side after corner i is an edge of the mesh and no diagonal. Quads are cut along
// the shorter diagonal.
function triangles(points, offsets, indices) {
  const faces = offsets.length - 1;
  const rows = new Uint32Array(4 * (indices.length - 2 * faces));
  let at = 0;
  const put = (a, b, c, face, edges) => {
    rows[at++] = a;
    rows[at++] = b;
    rows[at++] = c;
    rows[at++] = 8 * face + edges;
  };
  const squared = (i, j) => {
    const x = points[3 * i] - points[3 * j], y = points[3 * i + 1] - points[3 * j + 1], z = points[3 * i + 2] - points[3 * j + 2];
    return x * x + y * y + z * z;
  };
  for (let f = 0; f < faces; ++f) {
    const start = offsets[f], count = offsets[f + 1] - start;
    const turned = count === 4 && squared(indices[start + 1], indices[start + 3]) < squared(indices[start], indices[start + 2]) ? 1 : 0;
    const corner = (k) => indices[start + ((k + turned) % count)];
    for (let k = 1; k + 1 < count; ++k) put(corner(0), corner(k), corner(k + 1), f, (k === 1 ? 1 : 0) | 2 | (k + 2 === count ? 4 : 0));
  }
  return rows;
}

const NO_FIGURE = -9;

// A quad's scaled Jacobian: the least over its corners of the volume that its two edges and the quad's unit normal span, of edges of length 1. Other
// faces have none: where a corner lies on a straight side it would be 0.
function scaledJacobian(p, indices, start, count, normal) {
  if (count !== 4) return NO_FIGURE;
  const length = Math.hypot(normal[0], normal[1], normal[2]);
  let least = 1;
  for (let k = 0; k < count; ++k) {
    const o = 3 * indices[start + k], n = 3 * indices[start + ((k + 1) % count)], b = 3 * indices[start + ((k + count - 1) % count)];
    const ux = p[n] - p[o], uy = p[n + 1] - p[o + 1], uz = p[n + 2] - p[o + 2];
    const vx = p[b] - p[o], vy = p[b + 1] - p[o + 1], vz = p[b + 2] - p[o + 2];
    const scale = Math.hypot(ux, uy, uz) * Math.hypot(vx, vy, vz) * length;
    const volume = (uy * vz - uz * vy) * normal[0] + (uz * vx - ux * vz) * normal[1] + (ux * vy - uy * vx) * normal[2];
    least = Math.min(least, scale > 0 ? volume / scale : 0);
  }
  return least;
}

// Of each face (unit normal, scaled Jacobian), of each vertex the unit normal, by area, and of each face the binary logarithm of how long its edges are
// beside those of the mean face, by area.
function shading(points, offsets, indices) {
  const faces = offsets.length - 1;
  const faceRows = new Float32Array(4 * faces), sizes = new Float32Array(faces), normals = new Float32Array(points.length);
  const normal = [0, 0, 0];
  let total = 0;
  for (let f = 0; f < faces; ++f) {
    const start = offsets[f], count = offsets[f + 1] - start;
    const o = 3 * indices[start];
    normal.fill(0);
    for (let k = 1; k + 1 < count; ++k) {
      const a = 3 * indices[start + k], b = 3 * indices[start + k + 1];
      const ux = points[a] - points[o], uy = points[a + 1] - points[o + 1], uz = points[a + 2] - points[o + 2];
      const vx = points[b] - points[o], vy = points[b + 1] - points[o + 1], vz = points[b + 2] - points[o + 2];
      normal[0] += uy * vz - uz * vy;
      normal[1] += uz * vx - ux * vz;
      normal[2] += ux * vy - uy * vx;
    }
    for (let k = start; k < start + count; ++k) for (let axis = 0; axis < 3; ++axis) normals[3 * indices[k] + axis] += normal[axis];
    const area = Math.hypot(normal[0], normal[1], normal[2]) / 2;
    for (let axis = 0; axis < 3; ++axis) faceRows[4 * f + axis] = area > 0 ? normal[axis] / (2 * area) : 0;
    faceRows[4 * f + 3] = scaledJacobian(points, indices, start, count, normal);
    sizes[f] = area;
    total += area;
  }
  for (let f = 0; f < faces; ++f) sizes[f] = sizes[f] > 0 ? Math.log2((sizes[f] * faces) / total) / 2 : 0;
  for (let v = 0; v < normals.length; v += 3) {
    const length = Math.hypot(normals[v], normals[v + 1], normals[v + 2]);
    if (length > 0) for (let axis = 0; axis < 3; ++axis) normals[v + axis] /= length;
  }
  return { faceRows, sizes, normals };
}

// Sets of numbers 0 ... count - 1, of which two can be joined.
class DisjointSets {
  constructor(count) {
    this.parents = new Int32Array(count);
    for (let i = 0; i < count; ++i) this.parents[i] = i;
  }
  find(i) {
    while (this.parents[i] !== i) i = this.parents[i] = this.parents[this.parents[i]];
    return i;
  }
  join(i, j) {
    this.parents[this.find(i)] = this.find(j);
  }
}

// Components, boundary loops, and the genus of all components together, of an oriented manifold without loose vertices.
function topology(vertices, offsets, indices) {
  const faces = offsets.length - 1, corners = indices.length;
  const keys = new Float64Array(corners);
  const parts = new DisjointSets(vertices);
  for (let f = 0; f < faces; ++f)
    for (let start = offsets[f], end = offsets[f + 1], c = start; c < end; ++c) {
      const a = indices[c], b = indices[c + 1 < end ? c + 1 : start];
      keys[c] = a < b ? a * vertices + b : b * vertices + a;
      parts.join(a, b);
    }
  keys.sort();
  const rims = new DisjointSets(vertices), onRim = new Uint8Array(vertices);
  let edges = 0;
  for (let i = 0; i < corners; ++edges) {
    let next = i + 1;
    while (next < corners && keys[next] === keys[i]) ++next;
    if (next === i + 1) {
      const b = keys[i] % vertices, a = (keys[i] - b) / vertices;
      rims.join(a, b);
      onRim[a] = onRim[b] = 1;
    }
    i = next;
  }
  let components = 0, boundaries = 0;
  for (let v = 0; v < vertices; ++v) {
    components += parts.find(v) === v ? 1 : 0;
    boundaries += onRim[v] && rims.find(v) === v ? 1 : 0;
  }
  return { components, boundaries, genus: components - (boundaries + vertices - edges + faces) / 2 };
}

// The root mean square of how far vertices are apart.
function rootMeanSquare(points, others) {
  let sum = 0;
  for (let i = 0; i < points.length; ++i) sum += (points[i] - others[i]) ** 2;
  return Math.sqrt((3 * sum) / points.length);
}

// As text; its numbers are the points, bit for bit.
function wavefrontObject(points, offsets, indices) {
  const exact = (x) => (Object.is(x, -0) ? "-0" : String(x));
  const lines = [];
  for (let i = 0; i < points.length; i += 3) lines.push(`v ${exact(points[i])} ${exact(points[i + 1])} ${exact(points[i + 2])}\n`);
  for (let f = 0; f + 1 < offsets.length; ++f) lines.push(`f ${Array.from(indices.subarray(offsets[f], offsets[f + 1]), (i) => i + 1).join(" ")}\n`);
  return lines.join("");
}
