// SPDX-License-Identifier: Apache-2.0
// One signal against another: the hysteresis loop of a joint, for instance.
import { stroke, themed } from './palette';

interface Range {
  low: number;
  high: number;
}
function rangeOf(values: number[]): Range {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  const margin = Math.max((high - low) * 0.05, 1e-3);
  return low > high ? { low: -1, high: 1 } : { low: low - margin, high: high + margin };
}

const kLeft = 70;
const kBottom = 44;
const kEdge = 12;

export class XyPlot {
  constructor(private readonly canvas: HTMLCanvasElement) {}

  show(x: number[], y: number[], xLabel: string, yLabel: string): void {
    const ratio = window.devicePixelRatio;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const context = this.canvas.getContext('2d')!;
    context.scale(ratio, ratio);
    const [xs, ys] = [rangeOf(x), rangeOf(y)];
    const across = (value: number) => kLeft + ((value - xs.low) / (xs.high - xs.low)) * (width - kLeft - kEdge);
    const up = (value: number) => height - kBottom - ((value - ys.low) / (ys.high - ys.low)) * (height - kBottom - kEdge);
    this.frame(context, xs, ys, across, up);
    context.fillText(xLabel, (kLeft + width) / 2, height - 6);
    context.save();
    context.translate(14, (height - kBottom) / 2);
    context.rotate(-Math.PI / 2);
    context.fillText(yLabel, 0, 0);
    context.restore();
    context.strokeStyle = stroke(0).colour;
    context.lineWidth = 1.5;
    context.beginPath();
    x.forEach((value, i) => context.lineTo(across(value), up(y[i]!)));
    context.stroke();
    if (x.length > 0) {
      context.fillStyle = stroke(1).colour;
      context.beginPath();
      context.arc(across(x.at(-1)!), up(y.at(-1)!), 5, 0, 2 * Math.PI);
      context.fill();
    }
  }

  private frame(context: CanvasRenderingContext2D, xs: Range, ys: Range, across: (v: number) => number, up: (v: number) => number): void {
    context.font = `${Math.round(0.75 * parseFloat(getComputedStyle(document.documentElement).fontSize))}px system-ui, sans-serif`;
    context.fillStyle = themed('ink');
    context.strokeStyle = themed('grid');
    context.textAlign = 'center';
    for (let i = 0; i <= 4; ++i) {
      const x = xs.low + ((xs.high - xs.low) * i) / 4;
      const y = ys.low + ((ys.high - ys.low) * i) / 4;
      context.beginPath();
      context.moveTo(across(x), up(ys.low));
      context.lineTo(across(x), up(ys.high));
      context.moveTo(across(xs.low), up(y));
      context.lineTo(across(xs.high), up(y));
      context.stroke();
      context.fillText(x.toPrecision(3), Math.min(across(x), context.canvas.clientWidth - 24), up(ys.low) + 16);
      context.fillText(y.toPrecision(3), kLeft - 24, up(y) + 4);
    }
  }
}
