// SPDX-License-Identifier: Apache-2.0
// Takes what a board sends apart: text, and the binary frames of firmware/telemetry/telemetry_frames.hpp.

const kVersion = 1;
const kSchemaTag = 0x4d;
const kDataTag = 0x54;
const kHeaderBytes = 4;
const kMostWireBytes = 324;

export interface Schema {
  everyMs: number;
  columns: string[];
}
export interface FrameSink {
  text(text: string): void;
  schema(schema: Schema): void;
  /** `tick` is in ms since the board's start. */
  sample(tick: number, values: number[]): void;
}

/** CRC-16/CCITT-FALSE: polynomial 0x1021, begins with 0xFFFF. */
export function crc16(bytes: Uint8Array): number {
  let crc = 0xffff;
  for (const byte of bytes) {
    crc ^= byte << 8;
    for (let bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000) !== 0 ? ((crc << 1) ^ 0x1021) & 0xffff : (crc << 1) & 0xffff;
    }
  }
  return crc;
}

/** What was stuffed, or nothing if these bytes were not. */
export function cobsDecode(bytes: Uint8Array): Uint8Array | undefined {
  const out: number[] = [];
  for (let at = 0; at < bytes.length; ) {
    const code = bytes[at++]!;
    if (code === 0 || at + code - 1 > bytes.length) {
      return undefined;
    }
    for (let i = 1; i < code; ++i) {
      out.push(bytes[at++]!);
    }
    if (code < 0xff && at < bytes.length) {
      out.push(0);
    }
  }
  return Uint8Array.from(out);
}

/** A frame that was damaged on its way is dropped and counted, and the next one is read again. */
export class FrameSplitter {
  damaged = 0;
  private inFrame = false;
  private frame: number[] = [];
  private real: boolean[] = [];
  private schemaCrc = -1;

  constructor(private readonly sink: FrameSink) {}

  /** The next schema is told even if it is the last one again. */
  expectSchema(): void {
    this.schemaCrc = -1;
  }

  feed(bytes: Uint8Array): void {
    let text = '';
    for (const byte of bytes) {
      if (byte !== 0) {
        if (this.inFrame) {
          this.frame.push(byte);
        } else {
          text += String.fromCharCode(byte);
        }
        if (this.frame.length > kMostWireBytes) {
          // Longer than any: its end was lost, and this is text.
          ++this.damaged;
          text += String.fromCharCode(...this.frame);
          this.frame = [];
          this.inFrame = false;
        }
      } else if (!this.inFrame || this.frame.length === 0) {
        this.inFrame = true;
      } else {
        // Only a whole frame is followed by text. After a broken one the zero may as well have begun the next.
        this.inFrame = !this.takeFrame(Uint8Array.from(this.frame));
        this.damaged += this.inFrame ? 1 : 0;
        this.frame = [];
      }
    }
    if (text !== '') {
      this.sink.text(text);
    }
  }

  private takeFrame(frame: Uint8Array): boolean {
    const packet = cobsDecode(frame);
    if (packet === undefined || packet.length < kHeaderBytes + 2) {
      return false;
    }
    const view = new DataView(packet.buffer);
    const body = packet.subarray(0, packet.length - 2);
    if (crc16(body) !== view.getUint16(packet.length - 2, true) || packet[1] !== kVersion) {
      return false;
    }
    return packet[0] === kSchemaTag ? this.takeSchema(body, view) : packet[0] === kDataTag && this.takeData(body, view);
  }

  private takeSchema(body: Uint8Array, view: DataView): boolean {
    const crc = crc16(body);
    if (crc === this.schemaCrc) {
      return true;
    }
    const columns: string[] = [];
    const real: boolean[] = [];
    let at = kHeaderBytes + 1;
    for (let i = 0; i < body[kHeaderBytes]! && at < body.length; ++i) {
      let end = body.indexOf(0, at + 1);
      end = end < 0 ? body.length : end;
      real.push(body[at] === 0);
      columns.push(String.fromCharCode(...body.subarray(at + 1, end)));
      at = end + 1;
    }
    if (columns.length === 0) {
      return false;
    }
    this.real = real;
    this.schemaCrc = crc;
    this.sink.schema({ everyMs: Math.max(1, view.getUint16(2, true)), columns });
    return true;
  }

  private takeData(body: Uint8Array, view: DataView): boolean {
    const first = kHeaderBytes + 4;
    if (body.length < first || (body.length - first) % 4 !== 0) {
      return false;
    }
    if (view.getUint16(2, true) === this.schemaCrc && (body.length - first) / 4 === this.real.length) {
      this.sink.sample(
        view.getUint32(kHeaderBytes, true),
        this.real.map((real, i) => (real ? view.getInt32(first + 4 * i, true) / 16777216 : view.getUint32(first + 4 * i, true))),
      );
    }
    return true;
  }
}
