// SPDX-License-Identifier: Apache-2.0
// A board on a serial line, by the browser's WebSerial. The line itself cannot tell the board that the page has gone.
import type { Link, LinkEvents } from './link';

const kBaud = 115200;

/** What is used of WebSerial (wicg.github.io/serial); TypeScript does not know it yet. */
export interface SerialPort {
  open(options: { baudRate: number }): Promise<void>;
  close(): Promise<void>;
  readonly readable: ReadableStream<Uint8Array> | null;
  readonly writable: WritableStream<Uint8Array> | null;
}
interface Serial {
  requestPort(): Promise<SerialPort>;
}

export function serialOfBrowser(): Serial | undefined {
  return (navigator as unknown as { serial?: Serial }).serial;
}

function sentence(problem: unknown): string {
  return problem instanceof Error ? problem.message : String(problem);
}

export class SerialLink implements Link {
  readonly name = 'serial line';
  readonly simulated = false;
  readonly everyMs = 10; // what fits 115200 baud
  private events: LinkEvents | undefined;
  private closing = false;

  private constructor(
    private readonly port: SerialPort,
    private readonly reader: ReadableStreamDefaultReader<Uint8Array>,
    private readonly writer: WritableStreamDefaultWriter<Uint8Array>,
  ) {}

  /** Throws a sentence if the port does not open. */
  static async open(port: SerialPort): Promise<SerialLink> {
    try {
      await port.open({ baudRate: kBaud });
    } catch (problem) {
      throw new Error(`the port does not open (${sentence(problem)}); see that no other program has it`);
    }
    if (port.readable === null || port.writable === null) {
      throw new Error('the port opens but carries nothing; take it out, put it in and connect again');
    }
    return new SerialLink(port, port.readable.getReader(), port.writable.getWriter());
  }

  /** Begins to hand on what comes. */
  listen(events: LinkEvents): void {
    this.events = events;
    void this.read();
  }
  send(bytes: Uint8Array): void {
    this.writer.write(bytes).catch((problem: unknown) => this.lost(sentence(problem)));
  }
  /** There is nothing that this line could say beyond the DISARM that was sent. */
  leave(): void {}
  /** What was sent goes out first. */
  async close(): Promise<void> {
    this.closing = true;
    await this.writer.close().catch(() => undefined);
    await this.reader.cancel().catch(() => undefined);
    this.reader.releaseLock();
    await this.port.close().catch(() => undefined);
  }

  private async read(): Promise<void> {
    try {
      for (;;) {
        const { value, done } = await this.reader.read();
        if (done) {
          this.lost('it ended');
          return;
        }
        this.events?.bytes(value);
      }
    } catch (problem) {
      this.lost(sentence(problem));
    }
  }
  private lost(why: string): void {
    if (!this.closing) {
      this.closing = true;
      this.events?.lost(`the serial line is gone (${why}); check the cable and connect again`);
      void this.close();
    }
  }
}
