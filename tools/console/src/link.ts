// SPDX-License-Identifier: Apache-2.0
// A way to a board: bytes go both ways. What it is beyond that stays behind this face.

export interface LinkEvents {
  bytes(bytes: Uint8Array): void;
  /** The line is gone; `why` is a sentence with its cure. */
  lost(why: string): void;
}

export interface Link {
  readonly name: string;
  /** True where joints are programs and faults can be injected. */
  readonly simulated: boolean;
  /** ms from sample to sample that the line carries for eight signals. */
  readonly everyMs: number;
  send(bytes: Uint8Array): void;
  /** Takes the torque away where another page commands. */
  disarm?(): void;
  /** Nobody watches any more: the board shall take the torque away by itself, where its line can tell it. */
  leave(): void;
  close(): void | Promise<void>;
}
