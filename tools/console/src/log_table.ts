// SPDX-License-Identifier: Apache-2.0
// A log that the board prints, row by row: drawn as it comes and kept as text.
import type { LiveView } from './live_view';

export class LogTable {
  private readonly lines: string[] = [];

  constructor(private readonly live: LiveView) {}

  /** Rows below the header. */
  get rows(): number {
    return Math.max(0, this.lines.length - 1);
  }
  get csv(): string {
    return `${this.lines.join('\n')}\n`;
  }

  take(line: string): void {
    this.lines.push(line);
    const cells = line.split(',');
    if (this.lines.length === 1) {
      this.live.columns(cells.slice(1));
    } else {
      this.live.sample(Math.round(Number(cells[0]) * 1000), cells.slice(1).map(Number));
    }
  }
}
