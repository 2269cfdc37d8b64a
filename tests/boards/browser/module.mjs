// SPDX-License-Identifier: Apache-2.0
// Loads a module of the browser build in Node.
import { readFileSync } from 'node:fs';

/** A module that needs nothing but a way to end. What else it asks for does not exist: no file (-44) and no stream (52). */
export function load(path) {
  const module = new WebAssembly.Module(readFileSync(path));
  const imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    imports[from] ??= {};
    imports[from][name] = name === 'proc_exit' ? (status) => { throw new Error(`the module ended with ${status}`); } : () => (from === 'env' ? -44 : 52);
  }
  const exports = new WebAssembly.Instance(module, imports).exports;
  exports._initialize();
  return exports;
}

/** The board with its console as text: run() gives a line time until its answer is complete. */
export class Board {
  constructor(path) {
    this.wasm = load(path);
    this.text = '';
    this.decoder = new TextDecoder('latin1');
  }
  buffer(size) { return new Uint8Array(this.wasm.memory.buffer, this.wasm.capstan_buffer(), size); }
  put(text) {
    const bytes = new TextEncoder().encode(text);
    this.buffer(bytes.length).set(bytes);
    return bytes.length;
  }
  said(size) { return this.decoder.decode(this.buffer(size).slice()); }
  start(scenario = '') {
    const result = this.wasm.capstan_start(this.put(scenario));
    return result < 0 ? this.said(-result) : '';
  }
  tables() { return this.said(this.wasm.capstan_tables()).trim().split('\n').map((line) => line.split('\t')); }
  tick(cycles) {
    let waiting = this.wasm.capstan_tick(cycles);
    if (waiting < 0) throw new Error(this.said(-waiting));
    while (waiting > 0) {
      const size = this.wasm.capstan_take();
      this.text += this.said(size);
      waiting -= size;
    }
  }
  /** Sends a line; returns what is answered, its last line `ok` or `error ...`. */
  ask(line, patience = 20000) {
    this.text = '';
    let rest = `${line}\n`;
    for (let cycle = 0; cycle < patience; ++cycle) {
      rest = rest.slice(this.wasm.capstan_receive(this.put(rest)));
      this.tick(1);
      const text = this.text.replace(/\0[^\0]*\0/g, '');  // without frames
      if (/(^|\n)(ok|error [^\r\n]*)\r?\n$/.test(text)) return text.trim();
    }
    throw new Error(`no answer to '${line}' within ${patience} ms, but: ${this.text}`);
  }
  state() { return /^state (\w+) fault (\w+)/m.exec(this.ask('status')).slice(1, 3).join(' '); }
}
