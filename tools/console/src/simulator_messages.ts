// SPDX-License-Identifier: Apache-2.0
// What page and simulator's thread say to each other.

/** The page says 'alive' five times within this. A page that hangs or sleeps for longer has lost its line. */
export const kAliveWithinMs = 1000;

export type ToSimulator =
  | { kind: 'start'; scenario: string }
  | { kind: 'bytes'; bytes: Uint8Array }
  | { kind: 'alive' }
  | { kind: 'heard'; count: number } // so many bytes arrived
  | { kind: 'leave' }
  | { kind: 'speed'; factor: number }; // of real time; Infinity: as fast as it goes

export type FromSimulator =
  | { kind: 'loaded'; tables: string }
  | { kind: 'started'; problem: string }
  | { kind: 'bytes'; bytes: Uint8Array }
  | { kind: 'unattended' }
  | { kind: 'problem'; text: string };
