// SPDX-License-Identifier: GPL-3.0-or-later
// Draws one mesh in WebGL 2. Nothing but numbers of vertices is drawn: the mesh is in textures, from which the shader takes what it needs, so that
// corners share their vertices and faces have figures of their own.
"use strict";

const TABLE_WIDTH = 4096;
const BLEND_MILLISECONDS = 160; // from one prefix of a stream to the next
const UNITS = ["points", "normals", "pointsBefore", "normalsBefore", "faceRows", "sizes", "triangles"];

const VERTEX_SHADER = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D points, normals, pointsBefore, normalsBefore, faceRows, sizes;
uniform usampler2D triangles;
uniform mat4 view, projection;
uniform float blend;
uniform bool smoothly;
out vec3 place, normal;
out vec3 corner;
flat out uint edges;
flat out vec2 figures;
ivec2 cell(uint i) { return ivec2(i % ${TABLE_WIDTH}u, i / ${TABLE_WIDTH}u); }
void main() {
  uint k = uint(gl_VertexID) % 3u;
  uvec4 row = texelFetch(triangles, cell(uint(gl_VertexID) / 3u), 0);
  ivec2 at = cell(row[k]), face = cell(row.w >> 3u);
  vec3 point = mix(texelFetch(pointsBefore, at, 0).xyz, texelFetch(points, at, 0).xyz, blend);
  vec4 figure = texelFetch(faceRows, face, 0);
  vec3 around = mix(texelFetch(normalsBefore, at, 0).xyz, texelFetch(normals, at, 0).xyz, blend);
  normal = mat3(view) * (smoothly ? around : figure.xyz);
  vec4 seen = view * vec4(point, 1.0);
  place = seen.xyz;
  corner = vec3(k == 0u, k == 1u, k == 2u);
  edges = row.w & 7u;
  figures = vec2(figure.w, texelFetch(sizes, face, 0).x);
  gl_Position = projection * seen;
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
precision highp int;
in vec3 place, normal;
in vec3 corner;
flat in uint edges;
flat in vec2 figures;
uniform int figure;       // -1: none
uniform vec4 stops[5];    // (red, green, blue, value)
uniform float lineWidth;  // in pixels; 0: no lines
out vec4 color;
vec3 palette(float value) {
  if (value < -8.0) return vec3(0.22);  // no figure
  vec3 shown = stops[0].rgb;
  for (int i = 1; i < 5; ++i) shown = mix(shown, stops[i].rgb, clamp((value - stops[i - 1].w) / (stops[i].w - stops[i - 1].w), 0.0, 1.0));
  return shown;
}
void main() {
  vec3 n = normalize(normal), eye = normalize(-place);
  bool inside = !gl_FrontFacing;
  if (inside) n = -n;
  vec3 albedo = figure < 0 ? vec3(0.56, 0.57, 0.60) : palette(figures[figure]);
  if (inside) albedo = figure < 0 ? vec3(0.40, 0.20, 0.13) : albedo * 0.55;
  const vec3 key = normalize(vec3(-0.45, 0.65, 0.62)), fill = normalize(vec3(0.85, 0.05, 0.4)), rim = normalize(vec3(0.35, 0.6, -0.8));
  vec3 sky = mix(vec3(0.040, 0.034, 0.034), vec3(0.145, 0.165, 0.205), 0.5 + 0.5 * n.y);
  vec3 light = sky + vec3(1.05, 0.98, 0.88) * max(dot(n, key), 0.0) + vec3(0.14, 0.19, 0.27) * max(dot(n, fill), 0.0);
  float grazing = pow(1.0 - max(dot(n, eye), 0.0), 4.0);
  vec3 lit = albedo * light;
  lit += vec3(0.30, 0.38, 0.50) * grazing * (0.25 + max(dot(n, rim), 0.0)) * (figure < 0 ? 1.0 : 0.35);
  lit += vec3(0.10) * pow(max(dot(n, normalize(key + eye)), 0.0), 40.0) * (figure < 0 ? 1.0 : 0.4);
  // Lines: how many pixels it is to the side opposite to each corner. Where quads are a few pixels wide, lines would be all that is seen.
  if (lineWidth > 0.0) {
    vec3 slope = sqrt(dFdx(corner) * dFdx(corner) + dFdy(corner) * dFdy(corner));
    vec3 away = corner / max(slope, 1e-9);
    if ((edges & 1u) == 0u) away.z = 1e9;
    if ((edges & 2u) == 0u) away.x = 1e9;
    if ((edges & 4u) == 0u) away.y = 1e9;
    float nearest = min(min(away.x, away.y), away.z);
    float widest = max(max(slope.x, slope.y), slope.z);
    float room = smoothstep(1.5, 8.0, 1.0 / (widest * lineWidth));
    float ink = (1.0 - smoothstep(lineWidth * 0.5 - 0.5, lineWidth * 0.5 + 0.5, nearest)) * 0.85 * room;
    lit = mix(lit, vec3(0.008, 0.012, 0.022), ink);
  }
  lit = lit / (1.0 + 0.12 * lit);
  color = vec4(pow(lit, vec3(1.0 / 2.2)), 1.0);
}`;

function shaderProgram(gl) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    const logs = gl.getAttachedShaders(program).map((shader) => gl.getShaderInfoLog(shader));
    throw new Error(`the picture cannot be drawn: ${[...logs, gl.getProgramInfoLog(program)].filter(Boolean).join(" ")}`);
  }
  return program;
}

// Rows of numbers as a texture, TABLE_WIDTH of them side by side.
class Table {
  constructor(gl, inner, outer, kind, width) {
    // Asked for once: the answer may wait for all that is being drawn.
    const mostLines = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    Object.assign(this, { gl, inner, outer, kind, width, mostLines, lines: 0, texture: gl.createTexture() });
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  }

  fill(rows) {
    const { gl } = this;
    const count = rows.length / this.width, whole = Math.floor(count / TABLE_WIDTH), rest = count % TABLE_WIDTH;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    const lines = Math.max(1, whole + (rest > 0 ? 1 : 0));
    if (lines > this.mostLines) throw new Error("the mesh is too large for this device's graphics");
    if (lines !== this.lines) gl.texImage2D(gl.TEXTURE_2D, 0, this.inner, TABLE_WIDTH, lines, 0, this.outer, this.kind, null);
    this.lines = lines;
    if (whole > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, TABLE_WIDTH, whole, this.outer, this.kind, rows);
    if (rest > 0) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, whole, rest, 1, this.outer, this.kind, rows, whole * TABLE_WIDTH * this.width);
  }
}

class SurfaceRenderer {
  constructor(canvas, camera) {
    this.canvas = canvas;
    this.camera = camera;
    this.look = { lines: true, smoothly: true, palette: null, free: null };
    this.mesh = null;
    this.gl = canvas.getContext("webgl2", { antialias: true });
    if (!this.gl) throw new Error("this browser has no WebGL 2");
    this.prepare();
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.prepare();
      if (this.mesh) this.show(this.mesh, false);
    });
    new ResizeObserver(() => this.redraw()).observe(canvas);
  }

  prepare() {
    const { gl } = this;
    this.program = shaderProgram(gl);
    gl.useProgram(this.program);
    gl.bindVertexArray(gl.createVertexArray());
    gl.enable(gl.DEPTH_TEST);
    const vectors = () => new Table(gl, gl.RGB32F, gl.RGB, gl.FLOAT, 3);
    this.tables = {
      points: vectors(), normals: vectors(), pointsBefore: vectors(), normalsBefore: vectors(),
      faceRows: new Table(gl, gl.RGBA32F, gl.RGBA, gl.FLOAT, 4), sizes: new Table(gl, gl.R32F, gl.RED, gl.FLOAT, 1),
      triangles: new Table(gl, gl.RGBA32UI, gl.RGBA_INTEGER, gl.UNSIGNED_INT, 4),
    };
    this.places = {};
    for (const name of [...UNITS, "view", "projection", "blend", "smoothly", "figure", "stops", "lineWidth"])
      this.places[name] = gl.getUniformLocation(this.program, name);
    UNITS.forEach((name, unit) => gl.uniform1i(this.places[name], unit));
  }

  // `continues`: from another prefix of the same level, whose vertices move to their new places.
  show(mesh, continues) {
    const { tables } = this;
    if (continues) {
      [tables.points, tables.pointsBefore] = [tables.pointsBefore, tables.points];
      [tables.normals, tables.normalsBefore] = [tables.normalsBefore, tables.normals];
    }
    for (const name of ["points", "normals", "faceRows", "sizes", "triangles"]) tables[name].fill(mesh[name]);
    this.mesh = mesh;
    this.blendStart = continues ? performance.now() : -Infinity;
    this.redraw();
  }

  setLook(changes) {
    Object.assign(this.look, changes);
    this.redraw();
  }

  redraw() {
    this.frame ??= requestAnimationFrame((now) => {
      this.frame = null;
      this.draw(now);
    });
  }

  draw(now) {
    const { gl, canvas, places, look } = this;
    const density = window.devicePixelRatio || 1;
    const width = Math.round(canvas.clientWidth * density), height = Math.round(canvas.clientHeight * density);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0); // the page's own background
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.mesh || gl.isContextLost()) return;
    const passed = Math.max(0, now - this.blendStart) / BLEND_MILLISECONDS;
    const settled = passed >= 1;
    UNITS.forEach((name, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, this.tables[settled ? name.replace("Before", "") : name].texture);
    });
    gl.uniformMatrix4fv(places.view, false, this.camera.view());
    gl.uniformMatrix4fv(places.projection, false, this.camera.projection(look.free ?? { left: 0, right: canvas.clientWidth, top: 0, bottom: canvas.clientHeight }));
    gl.uniform1f(places.blend, settled ? 1 : passed * (2 - passed));
    gl.uniform1i(places.smoothly, look.smoothly ? 1 : 0);
    gl.uniform1f(places.lineWidth, look.lines ? 1.15 * density : 0);
    gl.uniform1i(places.figure, { shape: 0, size: 1 }[look.palette] ?? -1);
    gl.uniform4fv(places.stops, (PALETTES[look.palette] ?? PALETTES.size).stops.flatMap(([value, ...rgb]) => [...rgb, value]));
    gl.drawArrays(gl.TRIANGLES, 0, (3 * this.mesh.triangles.length) / 4);
    if (!settled) this.redraw();
  }
}
