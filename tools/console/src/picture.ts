// SPDX-License-Identifier: Apache-2.0
// A plot as a picture that stands alone: with its ground, and with the names of its lines.
import type { Signal } from './knowledge';
import { stroke, themed } from './palette';

const kLine = 22;
const kGap = 24;
const kSwatch = 28;

/** @param signals  named below the plot; none: the plot names its axes itself */
export function pictureOf(plot: HTMLCanvasElement, signals: Signal[]): HTMLCanvasElement {
  const ratio = window.devicePixelRatio;
  const picture = document.createElement('canvas');
  const context = picture.getContext('2d')!;
  const font = `${13 * ratio}px system-ui, sans-serif`;
  context.font = font;
  const widths = signals.map((signal) => (kSwatch + kGap) * ratio + context.measureText(signal.name).width);
  const lines: number[][] = signals.length > 0 ? [[]] : [];
  let used = 0;
  widths.forEach((width, i) => {
    if (used + width > plot.width && used > 0) {
      lines.push([]);
      used = 0;
    }
    lines.at(-1)!.push(i);
    used += width;
  });
  picture.width = plot.width;
  picture.height = plot.height + lines.length * kLine * ratio;
  context.fillStyle = themed('ground');
  context.fillRect(0, 0, picture.width, picture.height);
  context.drawImage(plot, 0, 0);
  context.font = font;
  context.fillStyle = themed('ink');
  context.lineWidth = 2 * ratio;
  lines.forEach((line, row) => {
    let x = kGap * ratio;
    const y = plot.height + (row + 0.6) * kLine * ratio;
    for (const i of line) {
      const { colour, dash } = stroke(i);
      context.strokeStyle = colour;
      context.setLineDash(dash.map((length) => length * ratio));
      context.beginPath();
      context.moveTo(x, y - 4 * ratio);
      context.lineTo(x + (kSwatch - 6) * ratio, y - 4 * ratio);
      context.stroke();
      context.fillText(signals[i]!.name, x + kSwatch * ratio, y);
      x += widths[i]!;
    }
  });
  return picture;
}
