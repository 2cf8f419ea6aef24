// SPDX-License-Identifier: GPL-3.0-or-later
// A view of the unit sphere, turned, shifted and zoomed by mouse, touch, wheel and keys. Matrices are columns first.
"use strict";

const FIELD_OF_VIEW = 0.5; // radians, of the shorter side of what is free of the canvas

function product(a, b) {
  const c = new Float32Array(16);
  for (let column = 0; column < 4; ++column)
    for (let row = 0; row < 4; ++row) for (let k = 0; k < 4; ++k) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

class OrbitCamera {
  // `changed` is called after every change.
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.changed = changed;
    this.up = "z"; // as in Blender
    this.pointers = new Map();
    this.reset();
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => this.pointers.delete(event.pointerId));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("dblclick", () => this.reset());
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  reset() {
    this.yaw = 0.55;
    this.pitch = 0.25;
    this.zoom = 1;
    this.shift = [0, 0]; // of the view, in radii of the sphere
    this.changed();
  }

  setUp(axis) {
    this.up = axis;
    this.changed();
  }

  press(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = { x: event.clientX, y: event.clientY };
    const dx = now.x - before.x, dy = now.y - before.y;
    if (this.pointers.size === 1) {
      if (event.shiftKey || event.buttons & 6) this.pan(dx, dy);
      else this.turn(dx * 0.008, dy * 0.008);
    } else if (this.pointers.size === 2) {
      const [other] = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, point]) => point);
      const apart = (point) => Math.max(1, Math.hypot(point.x - other.x, point.y - other.y));
      this.pan(dx / 2, dy / 2);
      this.scale(apart(now) / apart(before));
    }
    this.pointers.set(event.pointerId, now);
  }

  wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    this.scale(Math.exp(-event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0015)));
  }

  turn(yaw, pitch) {
    this.yaw -= yaw;
    this.pitch = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.pitch + pitch));
    this.changed();
  }

  pan(dx, dy) {
    const pixel = (2 * Math.tan(FIELD_OF_VIEW / 2) * this.distance()) / this.shorter;
    this.shift = [this.shift[0] + dx * pixel, this.shift[1] - dy * pixel];
    this.changed();
  }

  scale(factor) {
    this.zoom = Math.min(60, Math.max(0.25, this.zoom * factor));
    this.changed();
  }

  // From the eye to the sphere's centre.
  distance() {
    return 1 / Math.sin(FIELD_OF_VIEW / 2) / this.zoom;
  }

  view() {
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const right = [cy, 0, -sy], upward = [-sy * sp, cp, -cy * sp], toEye = [sy * cp, sp, cy * cp];
    // Of a surface whose z is up, x stays and (x, y, z) is looked at as (x, z, -y).
    const turned = (row) => (this.up === "z" ? [row[0], -row[2], row[1]] : row);
    const [r, u, e] = [right, upward, toEye].map(turned);
    return new Float32Array([
      r[0], u[0], e[0], 0, r[1], u[1], e[1], 0, r[2], u[2], e[2], 0, this.shift[0], this.shift[1], -this.distance(), 1,
    ]);
  }

  // `free`: the part of the canvas, in its pixels, in which the sphere is to be seen.
  projection(free) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.shorter = Math.min(free.right - free.left, free.bottom - free.top);
    const scale = this.shorter / Math.tan(FIELD_OF_VIEW / 2);
    const offset = [(free.left + free.right) / width - 1, 1 - (free.top + free.bottom) / height];
    const far = this.distance() + 2.2, near = Math.max(this.distance() - 2.2, far / 2000);
    return new Float32Array([
      scale / width, 0, 0, 0, 0, scale / height, 0, 0, -offset[0], -offset[1], -(far + near) / (far - near), -1,
      0, 0, (-2 * far * near) / (far - near), 0,
    ]);
  }
}
