// SPDX-License-Identifier: GPL-3.0-or-later
// The page: which stream is there, what is wanted of it (bytes, level), what is shown, and the controls of all that.
"use strict";

const PLAY_SECONDS = 9; // from the fewest bytes to all

class Viewer {
  constructor() {
    this.stream = null;
    this.wanted = { bytes: 0, level: -1 };
    this.shown = null;
    this.loads = 0;
    this.decoding = null;
    this.sources = [];
    this.readOut = new ReadOut();
    this.camera = new OrbitCamera(element("canvas"), () => this.renderer?.redraw());
    try {
      this.renderer = new SurfaceRenderer(element("canvas"), this.camera);
      const code = Uint8Array.from(atob(element("decoder").textContent.trim()), (letter) => letter.charCodeAt(0));
      if (!WebAssembly.validate(code)) throw new Error("this browser is too old: it has no exceptions in WebAssembly");
      this.client = new DecoderClient(element("worker").textContent, new WebAssembly.Module(code), () => this.stream?.restore());
    } catch (error) {
      this.say(`Nothing can be shown: ${error.message}`);
      return;
    }
    this.connect();
    this.offer();
  }

  say(line) {
    this.readOut.say(line);
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
      await stream.load(opened, (mesh) => (load === this.loads || this.stream === stream) && this.replace(stream, mesh));
    } catch (error) {
      const words = error.message.replace("not a valid hierarchy stream: ", "not a stream that can be shown: ");
      if (load === this.loads) this.say(error instanceof Refused || error instanceof Broken ? `${name}: ${words}` : words);
    }
    if (this.stream === stream) {
      await this.settle(stream);
    } else {
      stream.close();
      if (load === this.loads) element("streams").value = this.stream?.name ?? "";
    }
  }

  // Shows a mesh of a stream that comes in. Returns true: more of it is welcome.
  replace(stream, mesh) {
    if (this.stream !== stream) {
      this.stream?.close();
      this.stream = stream;
      this.shown = null;
      this.camera.reset();
      this.readOut.introduce(stream, this.sources.length > 1 && this.sources.some(({ name }) => name === stream.name));
      this.enable(false);
    }
    this.wanted = { bytes: stream.size, level: mesh.depth };
    this.show(mesh);
    return true;
  }

  // Once there is no more to come of it.
  async settle(stream) {
    try {
      stream.firstBytes = await stream.ask("first_bytes");
      if (this.stream !== stream) return;
      this.enable(true);
      this.tell();
      await this.survey(stream);
    } catch (error) {
      if (this.stream === stream) this.say(`${stream.name}: ${error.message}`);
    }
  }

  // While a stream comes in, what is shown is what has come.
  enable(whole) {
    for (const id of ["bytes", "level", "play", "save"]) element(id).disabled = !whole;
  }

  // The figures of all levels, one after the other, between which what is wanted is decoded.
  async survey(stream) {
    for (let level = this.shown.depth; level >= 0; --level) {
      await this.decoding;
      if (this.stream !== stream) return;
      const known = await stream.ask("survey", { level });
      if (this.stream !== stream) return;
      stream.levels[level] = known;
      this.tell();
    }
    this.refresh();
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
        this.wanted = { bytes: this.shown.bytes, level: this.shown.level }; // which has been decoded once
      }
    }
  }

  show(mesh) {
    const continues = this.shown?.level === mesh.level && this.shown.points.length === mesh.points.length && this.shown.triangles.length === mesh.triangles.length;
    this.shown = mesh;
    this.renderer.setLook({ free: this.readOut.freePart() });
    try {
      this.renderer.show(mesh, continues);
    } catch (error) {
      this.say(error.message);
    }
    this.tell();
  }

  tell() {
    if (this.shown) this.readOut.tell(this.stream, this.shown, this.wanted);
  }

  stop() {
    this.playing = false;
    this.readOut.setPlaying(false);
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
    this.readOut.setPlaying(true);
    for (let before = performance.now(); this.playing && this.stream === stream && part < 1; ) {
      await this.want({ bytes: stream.bytesAt(part) });
      const now = await new Promise(requestAnimationFrame);
      // Where decoding is slow, it takes longer, so that no prefix is far from the last one.
      part = Math.min(1, part + Math.min(250, Math.max(0, now - before)) / 1000 / PLAY_SECONDS);
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
      this.readOut.showLegend(PALETTES[value]);
    });
    element("levels").tBodies[0].onclick = ({ target }) => {
      const row = target.closest("tr");
      if (row && !element("level").disabled) this.want({ level: row.sectionRowIndex });
    };
    addEventListener("resize", () => this.shown && this.renderer.setLook({ free: this.readOut.freePart() }));
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
      for (const button of element(id).children) button.setAttribute("aria-pressed", button === target);
      chosen(target.value);
    };
  }
}

const viewer = new Viewer();
