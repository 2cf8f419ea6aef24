// SPDX-License-Identifier: GPL-3.0-or-later
// The page's side of decoder_worker.js.
"use strict";

const MOST_SECONDS = 60; // for one answer; then a stream is taken for one that never ends

class Refused extends Error {} // the stream is not one; the decoder goes on
class Broken extends Error {} // the decoder is gone, with all of its streams

class DecoderClient {
  // `program`: text of the worker; `module`: WebAssembly.Module. `restarted` is called when there is a fresh worker that has no streams.
  constructor(program, module, restarted) {
    this.address = URL.createObjectURL(new Blob([program], { type: "text/javascript" }));
    this.module = module;
    this.restarted = restarted;
    this.tickets = 0;
    this.start();
  }

  start() {
    this.waiting = new Map();
    this.worker = new Worker(this.address);
    this.worker.onmessage = ({ data }) => this.settle(data);
    this.worker.onerror = (event) => this.abandon(event.message);
    this.ask("start", { module: this.module }).catch(() => {});
  }

  ask(kind, data) {
    const ticket = ++this.tickets;
    return new Promise((resolve, reject) => {
      const clock = setTimeout(() => this.abandon(`it takes more than ${MOST_SECONDS} seconds`), MOST_SECONDS * 1000);
      this.waiting.set(ticket, { resolve, reject, clock });
      this.worker.postMessage({ ticket, kind, ...data });
    });
  }

  settle({ ticket, result, refused, corrupt, broken }) {
    if (broken !== undefined) {
      this.abandon(broken);
      return;
    }
    const { resolve, reject, clock } = this.waiting.get(ticket);
    this.waiting.delete(ticket);
    clearTimeout(clock);
    if (refused === undefined) resolve(result);
    else reject(Object.assign(new Refused(refused), { corrupt }));
  }

  // A fresh worker in the place of this one; whatever was asked is refused.
  abandon(words) {
    this.worker.terminate();
    const waiting = this.waiting;
    this.start();
    this.restarted();
    for (const { reject, clock } of waiting.values()) {
      clearTimeout(clock);
      reject(new Broken(words));
    }
  }
}
