// SPDX-License-Identifier: Apache-2.0
// The last minute of the signals that are shown, at the rate at which they come. Memory is taken once.

const kCapacity = 61000;

export class Series {
  columns: string[] = [];
  everyMs = 1;
  lost = 0;
  private readonly ticks = new Float64Array(kCapacity);
  private readonly values: Float64Array[] = [];
  private begin = 0;
  private count = 0;

  get size(): number {
    return this.count;
  }
  get lastTick(): number {
    return this.count === 0 ? 0 : this.tick(this.count - 1);
  }

  reset(columns: string[], everyMs: number): void {
    this.columns = columns;
    this.everyMs = everyMs;
    while (this.values.length < columns.length) {
      this.values.push(new Float64Array(kCapacity));
    }
    this.begin = this.count = this.lost = 0;
  }

  push(tick: number, values: number[]): void {
    if (this.count > 0) {
      const passed = tick - this.lastTick;
      if (passed <= 0) {
        this.reset(this.columns, this.everyMs); // the board has started anew
      } else {
        this.lost += Math.round(passed / this.everyMs) - 1;
      }
    }
    const at = (this.begin + this.count) % kCapacity;
    this.ticks[at] = tick;
    values.forEach((value, i) => (this.values[i]![at] = value));
    if (this.count < kCapacity) {
      ++this.count;
    } else {
      this.begin = (this.begin + 1) % kCapacity;
    }
  }

  /** ms since the board's start of the i-th sample, the oldest being 0. */
  tick(i: number): number {
    return this.ticks[(this.begin + i) % kCapacity]!;
  }
  value(channel: number, i: number): number {
    return this.values[channel]![(this.begin + i) % kCapacity]!;
  }
  /** The first sample that is not older. */
  firstFrom(tick: number): number {
    let low = 0;
    let high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.tick(middle) < tick) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }

  /**
   * Time in s and the channels between two ticks, in at most 2 `buckets` points. Where there are more samples, each bucket
   * gives its smallest and largest value in the order in which they came, so that no spike is lost.
   */
  view(fromTick: number, toTick: number, buckets: number): number[][] {
    const first = this.firstFrom(fromTick);
    const end = this.firstFrom(toTick + 1);
    const out: number[][] = [[], ...this.columns.map((): number[] => [])];
    const width = Math.max(1, Math.ceil((end - first) / buckets));
    for (let start = first; start < end; start += width) {
      const stop = Math.min(end, start + width);
      if (width <= 2) {
        for (let i = start; i < stop; ++i) {
          out[0]!.push(this.tick(i) / 1000);
          this.columns.forEach((_, channel) => out[channel + 1]!.push(this.value(channel, i)));
        }
        continue;
      }
      out[0]!.push(this.tick(start) / 1000, this.tick(start + ((stop - start) >> 1)) / 1000);
      this.columns.forEach((_, channel) => out[channel + 1]!.push(...this.extremes(channel, start, stop)));
    }
    return out;
  }

  /** Two channels of the same samples, at most `most` of them: of one against another, no value may come from a neighbour. */
  pairs(x: number, y: number, fromTick: number, toTick: number, most: number): [number[], number[]] {
    const first = this.firstFrom(fromTick);
    const end = this.firstFrom(toTick + 1);
    const out: [number[], number[]] = [[], []];
    for (let i = first, step = Math.max(1, Math.ceil((end - first) / most)); i < end; i += step) {
      out[0].push(this.value(x, i));
      out[1].push(this.value(y, i));
    }
    return out;
  }

  private extremes(channel: number, start: number, stop: number): [number, number] {
    let low = start;
    let high = start;
    for (let i = start + 1; i < stop; ++i) {
      low = this.value(channel, i) < this.value(channel, low) ? i : low;
      high = this.value(channel, i) > this.value(channel, high) ? i : high;
    }
    const [first, second] = low < high ? [low, high] : [high, low];
    return [this.value(channel, first), this.value(channel, second)];
  }

  /** A log by the contract: header, then one row a sample. */
  csv(fromTick = -Infinity, toTick = Infinity): string {
    const rows = [`time_s,${this.columns.join(',')}`];
    for (let i = this.firstFrom(fromTick); i < this.firstFrom(toTick + 1); ++i) {
      const values = this.columns.map((_, channel) => String(this.value(channel, i)));
      rows.push(`${(this.tick(i) / 1000).toFixed(3)},${values.join(',')}`);
    }
    return `${rows.join('\n')}\n`;
  }
}
