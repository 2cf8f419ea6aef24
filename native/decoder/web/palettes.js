// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of figures on faces: stops (value, linear red, green, blue), as the legend and the renderer show them.
"use strict";

const PALETTES = {
  shape: {
    words: "Scaled Jacobian: 1 for a square, 0 and less for an inverted quad; grey is no quad",
    ticks: [[0, "0"], [0.25, "¼"], [0.5, "½"], [0.75, "¾"], [1, "1"]],
    stops: [[0, 0.55, 0.02, 0.03], [0.35, 0.93, 0.3, 0.05], [0.65, 0.95, 0.72, 0.25], [0.85, 0.42, 0.68, 0.5], [1, 0.1, 0.44, 0.55]],
  },
  // The colours that stretch has in Blender.
  size: {
    words: "Length of edges beside the mean quad's: blue is dense, red stretched",
    ticks: [[-2, "¼"], [-1, "½"], [0, "1"], [1, "2"], [2, "4"]],
    stops: [[-2, 0.03, 0.08, 0.45], [-1, 0.1, 0.42, 0.75], [0, 0.8, 0.8, 0.78], [1, 0.95, 0.5, 0.08], [2, 0.65, 0.03, 0.03]],
  },
};

// As a CSS gradient from left to right, its steps where the renderer has them: it blends linear light, and CSS does not.
function paletteGradient({ stops }) {
  const first = stops[0][0], last = stops[stops.length - 1][0];
  const shown = (x) => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
  const colors = [];
  for (let step = 0; step <= 32; ++step) {
    const value = first + ((last - first) * step) / 32;
    const after = Math.max(1, stops.findIndex((stop) => stop[0] >= value));
    const [a, b] = [stops[after - 1], stops[after]];
    const blend = (value - a[0]) / (b[0] - a[0]);
    colors.push(`rgb(${[1, 2, 3].map((i) => shown(a[i] + blend * (b[i] - a[i])))})`);
  }
  return `linear-gradient(to right, ${colors})`;
}
