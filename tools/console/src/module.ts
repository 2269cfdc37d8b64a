// SPDX-License-Identifier: Apache-2.0
// The firmware as a module (boards/browser): its exports, and how it is loaded.

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  capstan_buffer(): number;
  capstan_buffer_size(): number;
  capstan_start(size: number): number;
  capstan_receive(size: number): number;
  capstan_tick(cycles: number): number;
  capstan_take(): number;
  capstan_greet(): void;
  capstan_peer_left(): void;
  capstan_tables(): number;
}

/** It needs nothing but a way to end. What else it asks for does not exist: no file (-44) and no stream (52). */
function importsOf(module: WebAssembly.Module): WebAssembly.Imports {
  const imports: Record<string, Record<string, (status: number) => number>> = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    (imports[from] ??= {})[name] =
      name === 'proc_exit'
        ? (status) => {
            throw new Error(`the firmware ended with ${status}`);
          }
        : () => (from === 'env' ? -44 : 52);
  }
  return imports;
}

export class FirmwareModule {
  private constructor(private readonly wasm: Exports) {}

  static async load(bytes: Uint8Array): Promise<FirmwareModule> {
    const module = await WebAssembly.compile(bytes as BufferSource);
    const instance = await WebAssembly.instantiate(module, importsOf(module));
    const wasm = instance.exports as unknown as Exports;
    wasm._initialize();
    return new FirmwareModule(wasm);
  }

  /** Starts anew; a sentence if the scenario is none. */
  start(scenario: string): string {
    const result = this.wasm.capstan_start(this.put(new TextEncoder().encode(scenario)));
    return result < 0 ? this.text(-result) : '';
  }
  /** Returns how many of the bytes found room. */
  receive(bytes: Uint8Array): number {
    return this.wasm.capstan_receive(this.put(bytes));
  }
  /** Lets time go on; returns what the board said. Throws a sentence if the plant diverged. */
  tick(cycles: number): Uint8Array {
    const waiting = this.wasm.capstan_tick(cycles);
    if (waiting < 0) {
      throw new Error(this.text(-waiting));
    }
    const said = new Uint8Array(waiting);
    for (let at = 0; at < waiting; ) {
      const size = this.wasm.capstan_take();
      said.set(this.buffer(size), at);
      at += size;
    }
    return said;
  }
  print_banner(): void {
    this.wasm.capstan_greet();
  }
  peerLeft(): void {
    this.wasm.capstan_peer_left();
  }
  tables(): string {
    return this.text(this.wasm.capstan_tables());
  }

  private buffer(size: number): Uint8Array {
    return new Uint8Array(this.wasm.memory.buffer, this.wasm.capstan_buffer(), size);
  }
  private put(bytes: Uint8Array): number {
    const part = bytes.subarray(0, this.wasm.capstan_buffer_size());
    this.buffer(part.length).set(part);
    return part.length;
  }
  private text(size: number): string {
    return new TextDecoder().decode(this.buffer(size).slice());
  }
}
