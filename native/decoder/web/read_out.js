// SPDX-License-Identifier: GPL-3.0-or-later
// What the page says of what is shown: figures, the levels' table, the sliders' places, the legend.
"use strict";

const element = (id) => document.getElementById(id);
const number = new Intl.NumberFormat("en").format;

function bytesText(bytes) {
  if (bytes < 1000) return `${bytes} B`;
  return bytes < 1e6 ? `${(bytes / 1000).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(2)} MB`;
}

class ReadOut {
  constructor() {
    this.listed = ""; // what the table of levels is of
  }

  say(line) {
    element("message").hidden = !line;
    element("message").firstElementChild.textContent = line;
  }

  // A stream takes the place of what was shown. `listed`: its name is in the list of streams.
  introduce(stream, listed) {
    for (const id of ["panel", "timeline"]) element(id).hidden = false;
    element("welcome").hidden = true;
    element("name").hidden = listed;
    element("name").textContent = stream.name;
    document.title = `${stream.name} · Hybrid Mesh`;
  }

  // What panel and timeline leave free of the picture.
  freePart() {
    const { width, height } = element("canvas").getBoundingClientRect();
    const panel = element("panel").getBoundingClientRect(), timeline = element("timeline").getBoundingClientRect();
    const beside = panel.left > width / 2;
    return { left: 0, right: beside ? panel.left : width, top: 56, bottom: beside ? timeline.top : panel.top };
  }

  // `mesh` of `stream` is shown, and `wanted` may be others of its bytes and levels.
  tell(stream, mesh, wanted) {
    const put = (id, text) => (element(id).textContent = text);
    const others = mesh.faces - mesh.quads, finest = stream.levels[mesh.depth];
    put("vertices", number(mesh.vertices));
    put("faces-name", others ? "Quads · other faces" : "Quads");
    put("faces", others ? `${number(mesh.quads)} · ${number(others)}` : number(mesh.quads));
    put("off", mesh.off === null ? "…" : mesh.off === 0 ? "0" : `${(100 * mesh.off).toPrecision(2)} %`);
    put("rate", finest ? ((8 * mesh.bytes) / finest.vertices).toFixed(2) : "…");
    put("time", `${mesh.milliseconds.toFixed(mesh.milliseconds < 10 ? 1 : 0)} ms`);
    put("bytes-shown", `${bytesText(wanted.bytes)} of ${bytesText(stream.size)}`);
    put("level-shown", `${wanted.level} of ${mesh.depth}`);
    element("level").max = mesh.depth;
    this.slide("bytes", 1000 * stream.partAt(wanted.bytes), 1000);
    this.slide("level", wanted.level, mesh.depth);
    this.list(stream, mesh.depth, wanted.level);
  }

  // A slider that is held stays where it is: several places stand for the same bytes of a short stream.
  slide(id, value, most) {
    if (!element(id).matches(":active, :focus-visible")) element(id).value = value;
    element(id).style.setProperty("--part", `${(100 * value) / (most || 1)}%`);
  }

  list(stream, depth, chosen) {
    const rows = element("levels").tBodies[0];
    const content = `${stream.number}/${depth}/${stream.levels.filter(Boolean).length}`;
    if (this.listed !== content) {
      this.listed = content;
      rows.replaceChildren();
      for (let level = 0; level <= depth; ++level) this.addLevel(rows.insertRow(), level, stream.levels[level], stream.levels[level - 1]);
    }
    [...rows.rows].forEach((row, level) => row.setAttribute("aria-selected", level === chosen));
  }

  addLevel(row, level, known, coarser) {
    row.insertCell().textContent = level;
    for (const figure of ["faces", "components", "genus", "boundaries"]) {
      const cell = row.insertCell();
      cell.textContent = known ? number(known[figure]) : "…";
      // What opens on this level.
      if (figure !== "faces" && known && coarser && known[figure] !== coarser[figure]) cell.className = "opened";
    }
  }

  setPlaying(playing) {
    element("play").classList.toggle("playing", playing);
    element("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  }

  showLegend(palette) {
    element("legend").hidden = !palette;
    if (!palette) return;
    const [ramp, ticks, words] = element("legend").children;
    const first = palette.ticks[0][0], last = palette.ticks[palette.ticks.length - 1][0];
    ramp.style.background = paletteGradient(palette);
    ticks.replaceChildren();
    for (const [value, text] of palette.ticks) {
      const tick = ticks.appendChild(document.createElement("span"));
      tick.textContent = text;
      tick.style.left = `${(100 * (value - first)) / (last - first)}%`;
    }
    words.textContent = palette.words;
  }
}
