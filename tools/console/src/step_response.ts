// SPDX-License-Identifier: Apache-2.0
// A joint's answer to a step: its samples, and the numbers that a person tunes by.

/** What counts as settled, of the step. */
export const kSettledBand = 0.05;
const kReferenceMoves = 1e-6; // rad; a reference that stands has the same value to the bit

export interface StepFigures {
  /** Share of the step. */
  overshoot: number;
  /** ms from 10 to 90 % of the step; undefined: it does not get there. */
  rise: number | undefined;
  /** ms from the step until it stays within kSettledBand; undefined: it does not. */
  settling: number | undefined;
}

/** Where a straight line between two samples crosses a level. */
function crossing(times: number[], values: number[], i: number, level: number): number {
  const [before, now] = [values[i - 1]!, values[i]!];
  return now === before ? times[i]! : times[i - 1]! + ((times[i]! - times[i - 1]!) * (level - before)) / (now - before);
}

function firstAbove(times: number[], values: number[], level: number): number | undefined {
  const i = values.findIndex((value) => value >= level);
  return i < 0 ? undefined : i === 0 ? times[0] : crossing(times, values, i, level);
}

function settledAt(times: number[], values: number[]): number | undefined {
  let last = values.length - 1;
  while (last >= 0 && Math.abs(values[last]! - 1) <= kSettledBand) {
    --last;
  }
  if (last < 0) {
    return times[0];
  }
  const outside = values[last]! > 1 ? 1 + kSettledBand : 1 - kSettledBand;
  return last === values.length - 1 ? undefined : crossing(times, values, last + 1, outside);
}

/** @param times  ms since the step   @param estimates  of the joint, that goes from `from` to `to` */
export function stepFigures(times: number[], estimates: number[], from: number, to: number): StepFigures {
  const shares = estimates.map((value) => (value - from) / (to - from));
  const [tenth, most] = [firstAbove(times, shares, 0.1), firstAbove(times, shares, 0.9)];
  return {
    overshoot: Math.max(0, shares.reduce((a, b) => Math.max(a, b), 0) - 1),
    rise: tenth === undefined || most === undefined ? undefined : most - tenth,
    settling: settledAt(times, shares),
  };
}

/** One step as it is recorded, from shortly before the reference moves. */
export class StepTrace {
  /** ms since the board's start. */
  readonly ticks: number[] = [];
  readonly reference: number[] = [];
  readonly estimate: number[] = [];
  readonly torque: number[] = [];
  /** What was changed before it, or while it was recorded. */
  readonly changes: string[] = [];
  private begun: number | undefined;

  push(tick: number, reference: number, estimate: number, torque: number): void {
    if (this.begun === undefined && this.reference.length > 0 && Math.abs(reference - this.reference[0]!) > kReferenceMoves) {
      this.begun = this.ticks.at(-1);
    }
    this.ticks.push(tick);
    this.reference.push(reference);
    this.estimate.push(estimate);
    this.torque.push(torque);
  }

  /** The last tick at which the reference still stood; undefined until it moves. */
  get zero(): number | undefined {
    return this.begun;
  }
  /** ms recorded since the reference moved. */
  get lasted(): number {
    return this.begun === undefined ? 0 : this.ticks.at(-1)! - this.begun;
  }
  get size(): number {
    return this.reference.length === 0 ? 0 : this.reference.at(-1)! - this.reference[0]!;
  }
  get largestTorque(): number {
    return this.torque.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  }

  /** Nothing if the reference did not move. */
  figures(): StepFigures | undefined {
    const zero = this.begun;
    if (zero === undefined || this.size === 0) {
      return undefined;
    }
    const first = this.ticks.indexOf(zero);
    return stepFigures(this.ticks.slice(first).map((tick) => tick - zero), this.estimate.slice(first), this.reference[0]!, this.reference.at(-1)!);
  }
}
