// SPDX-License-Identifier: GPL-3.0-or-later
// The page: what is wanted (bytes, level), what is shown, and the controls of both.
"use strict";

const PLAY_SECONDS = 9;
const element = (id) => document.getElementById(id);
const number = new Intl.NumberFormat("en").format;

function bytesText(bytes) {
  if (bytes < 1000) return `${bytes} B`;
  return bytes < 1e6 ? `${(bytes / 1000).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(2)} MB`;
}

class Viewer {
  constructor() {
    this.stream = null;
    this.wanted = { bytes: 0, level: -1 };
    this.shown = null;
    this.loads = 0;
    this.decoding = null;
    this.sources = [];
    this.camera = new OrbitCamera(element("canvas"), () => this.renderer?.redraw());
    try {
      this.renderer = new SurfaceRenderer(element("canvas"), this.camera);
      const code = Uint8Array.from(atob(element("decoder").textContent.trim()), (letter) => letter.charCodeAt(0));
      if (!WebAssembly.validate(code)) throw new Error("this browser is too old: it has no exceptions in WebAssembly");
      this.client = new DecoderClient(element("worker").textContent, new WebAssembly.Module(code));
    } catch (error) {
      this.say(`Nothing can be shown: ${error.message}`);
      return;
    }
    this.connect();
    this.offer();
  }

  say(line) {
    element("message").hidden = !line;
    element("message").firstElementChild.textContent = line;
  }

  // Streams in the page, and those that its address names: viewer.html?stream=a.hmesh&stream=b.hmesh.
  offer() {
    for (const embedded of document.querySelectorAll("script[data-name]")) this.sources.push({ name: embedded.dataset.name, open: () => embeddedSource(embedded) });
    const addresses = new URLSearchParams(location.search).getAll("stream");
    for (const address of addresses) this.sources.push({ name: address.split("/").pop(), open: () => addressSource(address) });
    element("streams").replaceChildren(...this.sources.map(({ name }) => new Option(name)));
    element("streams").hidden = this.sources.length < 2;
    const first = addresses.length ? this.sources.length - addresses.length : 0;
    if (this.sources.length) this.choose(first);
  }

  choose(index) {
    element("streams").selectedIndex = index;
    return this.open(this.sources[index].name, this.sources[index].open);
  }

  // The stream that is shown stays until the first mesh of this one is there, and for good if there is none.
  async open(name, source) {
    const load = ++this.loads;
    const stream = new LoadedStream(this.client, name);
    this.stop();
    this.say("");
    try {
      const opened = await source();
      await stream.load(opened, (mesh) => load === this.loads && this.replace(stream, mesh, opened.size));
    } catch (error) {
      const words = error instanceof Refused ? error.message.replace("not a valid hierarchy stream: ", "not a stream that can be shown: ") : error.message;
      if (load === this.loads) this.say(error instanceof Refused || error instanceof Broken ? `${name}: ${words}` : words);
      if (stream !== this.stream) stream.close();
      if (error instanceof Broken) await this.recover();
    }
    if (load !== this.loads) return;
    if (this.stream === stream) this.survey(stream);
    else element("streams").value = this.stream?.name ?? "";
  }

  async recover() {
    if (this.stream) await this.stream.restore();
  }

  // Shows a mesh of a stream that comes in. Returns true: more of it is welcome.
  replace(stream, mesh, total) {
    if (this.stream !== stream) {
      this.stream?.close();
      this.stream = stream;
      this.shown = null;
      this.camera.reset();
      for (const id of ["panel", "timeline"]) element(id).hidden = false;
      element("welcome").hidden = true;
      element("name").hidden = this.sources.some(({ name }) => name === stream.name) && this.sources.length > 1;
      element("name").textContent = stream.name;
      document.title = `${stream.name} · Hybrid Mesh`;
    }
    const whole = !total || total === stream.size;
    for (const id of ["bytes", "play", "save"]) element(id).disabled = !whole;
    this.wanted = { bytes: stream.size, level: mesh.depth };
    this.show(mesh);
    return true;
  }

  // The figures of all levels, one after the other, between which what is wanted is decoded.
  async survey(stream) {
    try {
      for (let level = this.shown.depth; level >= 0; --level) {
        await this.decoding;
        if (this.stream !== stream) return;
        stream.levels[level] = await stream.ask("survey", { level });
        this.listLevels();
      }
      this.refresh();
    } catch (error) {
      if (this.stream === stream) this.say(`${stream.name}: ${error.message}`);
      if (error instanceof Broken) await this.recover();
    }
  }

  want(changes) {
    Object.assign(this.wanted, changes);
    this.tell();
    return this.refresh();
  }

  // Until what is shown is what is wanted. What was wanted while a mesh was decoded is left out, but for the last.
  refresh() {
    this.decoding ??= this.decodeWanted().finally(() => (this.decoding = null));
    return this.decoding;
  }

  async decodeWanted() {
    for (let asked = null; this.stream && asked !== JSON.stringify(this.wanted); ) {
      asked = JSON.stringify(this.wanted);
      const stream = this.stream;
      try {
        const mesh = await stream.ask("decode", this.wanted);
        if (stream === this.stream) this.show(mesh);
      } catch (error) {
        if (stream !== this.stream) continue;
        this.say(`${stream.name}: ${error.message}`);
        if (error instanceof Broken) await this.recover();
        this.wanted = { bytes: this.shown.bytes, level: this.shown.level }; // which has been decoded once
      }
    }
  }

  show(mesh) {
    const continues = this.shown?.level === mesh.level && this.shown.points.length === mesh.points.length && this.shown.triangles.length === mesh.triangles.length;
    this.shown = mesh;
    this.frame();
    try {
      this.renderer.show(mesh, continues);
    } catch (error) {
      this.say(error.message);
    }
    this.tell();
  }

  // The surface is shown in what panel and timeline leave free.
  frame() {
    const { width, height } = element("canvas").getBoundingClientRect();
    const panel = element("panel").getBoundingClientRect(), timeline = element("timeline").getBoundingClientRect();
    const beside = panel.left > width / 2;
    this.renderer.setLook({ free: { left: 0, right: beside ? panel.left : width, top: 56, bottom: beside ? timeline.top : panel.top } });
  }

  // The figures and the sliders.
  tell() {
    const { shown: mesh, stream, wanted } = this;
    if (!mesh) return;
    const put = (id, text) => (element(id).textContent = text);
    put("vertices", number(mesh.vertices));
    put("faces-name", mesh.quads === mesh.faces ? "Quads" : "Quads · other faces");
    put("faces", mesh.quads === mesh.faces ? number(mesh.faces) : `${number(mesh.quads)} · ${number(mesh.faces - mesh.quads)}`);
    put("off", mesh.off === null ? "…" : mesh.off === 0 ? "0" : `${(100 * mesh.off).toPrecision(2)} %`);
    const finest = stream.levels[mesh.depth];
    put("rate", finest ? ((8 * mesh.bytes) / finest.vertices).toFixed(2) : "…");
    put("time", `${mesh.milliseconds.toFixed(mesh.milliseconds < 10 ? 1 : 0)} ms`);
    put("bytes-shown", `${bytesText(wanted.bytes)} of ${bytesText(stream.size)}`);
    put("level-shown", `${wanted.level} of ${mesh.depth}`);
    const place = (id, value, most) => {
      if (document.activeElement !== element(id) || this.playing) element(id).value = value;
      element(id).style.setProperty("--part", `${(100 * value) / (most || 1)}%`);
    };
    place("bytes", 1000 * stream.partAt(wanted.bytes), 1000);
    element("level").max = mesh.depth;
    place("level", wanted.level, mesh.depth);
    if (element("levels").tBodies[0].dataset.of !== `${stream.number}/${mesh.depth}`) this.listLevels();
    for (const row of element("levels").tBodies[0].rows) row.ariaSelected = String(Number(row.dataset.level) === wanted.level);
    Object.assign(document.body.dataset, { stream: stream.name, bytes: mesh.bytes, level: mesh.level });
  }

  listLevels() {
    const { stream, shown, wanted } = this;
    const body = element("levels").tBodies[0];
    body.dataset.of = `${stream.number}/${shown.depth}`;
    body.replaceChildren();
    for (let level = 0; level <= shown.depth; ++level) {
      const known = stream.levels[level], coarser = stream.levels[level - 1];
      const row = body.insertRow();
      row.dataset.level = level;
      row.ariaSelected = String(level === wanted.level);
      row.onclick = () => this.want({ level });
      row.insertCell().textContent = level;
      for (const figure of ["faces", "components", "genus", "boundaries"]) {
        const cell = row.insertCell();
        cell.textContent = known ? number(known[figure]) : "…";
        // What opens on this level.
        if (figure !== "faces" && known && coarser && known[figure] !== coarser[figure]) cell.className = "opened";
      }
    }
  }

  stop() {
    this.playing = false;
    element("play").classList.remove("playing");
    element("play").ariaLabel = "Play";
  }

  async play() {
    if (this.playing) {
      this.stop();
      return;
    }
    const stream = this.stream;
    let part = stream.partAt(this.wanted.bytes);
    if (part > 0.999) part = 0;
    this.playing = true;
    element("play").classList.add("playing");
    element("play").ariaLabel = "Pause";
    for (let before = performance.now(); this.playing && this.stream === stream && part < 1; ) {
      await this.want({ bytes: stream.bytesAt(part) });
      const now = await new Promise(requestAnimationFrame);
      part = Math.min(1, part + Math.max(0, now - before) / 1000 / PLAY_SECONDS);
      before = now;
    }
    if (this.playing && this.stream === stream) {
      this.stop();
      await this.want({ bytes: stream.size });
    }
  }

  // The mesh that is wanted, as text.
  object() {
    return this.stream.ask("object", this.wanted);
  }

  async save() {
    try {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([await this.object()], { type: "model/obj" }));
      link.download = `${this.stream.name.replace(/\.hmesh$/i, "")}.${this.wanted.bytes}.N${this.wanted.level}.obj`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    } catch (error) {
      this.say(`The mesh cannot be saved: ${error.message}`);
      if (error instanceof Broken) await this.recover();
    }
  }

  connect() {
    const openFile = (file) => file && this.open(file.name, () => fileSource(file));
    element("file").onchange = ({ target }) => {
      openFile(target.files[0]);
      target.value = "";
    };
    element("streams").onchange = ({ target }) => this.choose(target.selectedIndex);
    element("message").lastElementChild.onclick = () => this.say("");
    element("play").onclick = () => this.play();
    element("save").onclick = () => this.save();
    element("bytes").oninput = ({ target }) => {
      this.stop();
      this.want({ bytes: this.stream.bytesAt(target.value / 1000) });
    };
    element("level").oninput = ({ target }) => this.want({ level: Number(target.value) });
    element("lines").onchange = ({ target }) => this.renderer.setLook({ lines: target.checked });
    this.choice("shading", (value) => this.renderer.setLook({ smoothly: value === "smooth" }));
    this.choice("up", (value) => this.camera.setUp(value));
    this.choice("palette", (value) => {
      this.renderer.setLook({ palette: value || null });
      this.showLegend(PALETTES[value]);
    });
    addEventListener("resize", () => this.shown && this.frame());
    addEventListener("dragover", (event) => {
      event.preventDefault();
      document.body.classList.add("dropping");
    });
    addEventListener("dragleave", (event) => event.relatedTarget ?? document.body.classList.remove("dropping"));
    addEventListener("drop", (event) => {
      event.preventDefault();
      document.body.classList.remove("dropping");
      openFile(event.dataTransfer.files[0]);
    });
  }

  // Buttons of which one is pressed.
  choice(id, chosen) {
    element(id).onclick = ({ target }) => {
      if (target.tagName !== "BUTTON") return;
      for (const button of element(id).children) button.ariaPressed = String(button === target);
      chosen(target.value);
    };
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

const viewer = new Viewer();
