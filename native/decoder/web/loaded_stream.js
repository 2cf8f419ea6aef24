// SPDX-License-Identifier: GPL-3.0-or-later
// A stream that the decoder has, whole or as much of it as has come.
"use strict";

const MILLISECONDS_BETWEEN_PREFIXES = 120; // that are shown while a stream comes in

class LoadedStream {
  static number = 0;

  constructor(client, name) {
    this.client = client;
    this.name = name;
    this.number = ++LoadedStream.number;
    this.pieces = []; // for a decoder that has to start again
    this.size = 0;
    this.firstBytes = 1; // the fewest that give a mesh, once that is known
    this.levels = []; // what is known of each, see `survey` of the worker
  }

  async ask(kind, data) {
    await this.restoring;
    return this.client.ask(kind, { stream: this.number, ...data });
  }

  async append(piece) {
    await this.ask("append", { bytes: piece });
    this.pieces.push(piece);
    this.size += piece.length;
  }

  // In a fresh decoder. If even that fails, whatever is asked next says so.
  restore() {
    const stream = this.number;
    const all = [this.client.ask("open", { stream }), ...this.pieces.map((bytes) => this.client.ask("append", { stream, bytes }))];
    this.restoring = Promise.allSettled(all);
  }

  close() {
    this.ask("close").catch(() => {});
  }

  // Takes in all of a source. `show(mesh)` is called with every prefix that is decoded on the way, the last one being all; what it returns that is false
  // ends the loading.
  async load(source, show) {
    await this.ask("open");
    const head = [];
    let last = 0;
    for await (const piece of source.pieces) {
      head.push(...piece.subarray(0, 8 - Math.min(8, head.length)));
      const foreign = foreignWords(head);
      if (foreign) throw new Refused(foreign);
      if (this.size + piece.length > MOST_BYTES) throw new Refused("it is longer than any stream that can be shown");
      await this.append(piece);
      if (source.size === this.size || performance.now() - last < MILLISECONDS_BETWEEN_PREFIXES) continue;
      try {
        if (show(await this.ask("decode", { bytes: this.size, level: -1 })) === false) return;
      } catch (error) {
        if (!error.corrupt) throw error; // else the base may be whole with the next piece
      }
      last = performance.now();
    }
    const foreign = foreignWords(head);
    if (foreign) throw new Refused(foreign);
    show(await this.ask("decode", { bytes: this.size, level: -1 }));
  }

  // From the size of the base to all, evenly on a logarithmic scale: most of a surface is in its first bytes.
  bytesAt(part) {
    return Math.round(this.firstBytes * (this.size / this.firstBytes) ** part);
  }

  partAt(bytes) {
    return this.size > this.firstBytes ? Math.log(bytes / this.firstBytes) / Math.log(this.size / this.firstBytes) : 1;
  }
}
