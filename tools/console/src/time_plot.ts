// SPDX-License-Identifier: Apache-2.0
// Signals over time, one scale for each unit.
import uPlot from 'uplot';
import type { Signal } from './knowledge';
import { stroke, themed } from './palette';

const kMostAxes = 3;
const kStillWidth = 1.5;
const kLeastDrag = 4; // pixels
const kDoubleClickMs = 250;

/** A signal and how it is drawn. */
export interface Line extends Signal {
  /** Number of its stroke; its place among the lines otherwise. */
  like?: number;
  /** One of those behind, without a legend. */
  faint?: boolean;
}

function height(): number {
  return Math.max(260, Math.round(window.innerHeight * 0.5));
}

export class TimePlot {
  private plot: uPlot | undefined;
  /** Dragging across the plot: from and to, s; undefined: everything. */
  onZoom: (range: [number, number] | undefined) => void = () => undefined;
  /** A click, s. */
  onPick: (time: number) => void = () => undefined;
  /** Lines across the plot with their names, s. */
  cursors: { name: string; time: number }[] = [];

  constructor(private readonly place: HTMLElement) {
    new ResizeObserver(() => this.plot?.setSize({ width: this.width, height: height() })).observe(place);
  }

  get width(): number {
    return Math.max(200, this.place.clientWidth);
  }

  shape(signals: Line[], across = 'time since start, s'): void {
    this.plot?.destroy();
    const units = [...new Set(signals.map((signal) => signal.unit))];
    const scale = parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;
    const font = `${Math.round(12 * scale)}px system-ui, sans-serif`;
    const common = { font, labelFont: `bold ${font}`, stroke: themed('ink'), grid: { stroke: themed('grid'), width: 1 }, ticks: { stroke: themed('grid'), width: 1 } };
    const axes: uPlot.Axis[] = units.slice(0, kMostAxes).map((unit, i) => ({
      ...common,
      scale: `unit ${unit}`,
      side: i === 0 ? 3 : 1,
      label: unit === '' ? 'number' : unit,
      size: 66 * scale,
      values: (_, splits) => splits.map((value) => String(Number(value.toPrecision(4)))),
      grid: { ...common.grid, show: i === 0 },
    }));
    const series = signals.map((signal, i): uPlot.Series => {
      const { colour, dash } = stroke(signal.like ?? i);
      const faint = signal.faint === true;
      return { ...(faint ? { class: 'faint', alpha: 0.35 } : {}), label: signal.name, scale: `unit ${signal.unit}`, stroke: colour, width: kStillWidth, dash, spanGaps: true, points: { show: false }, value: (_, value) => (value === null || value === undefined ? '' : `${value.toPrecision(5)} ${signal.unit}`) };
    });
    this.plot = new uPlot(
      {
        width: this.width,
        height: height(),
        scales: { x: { time: false, auto: false }, ...Object.fromEntries(units.map((unit) => [`unit ${unit}`, { range: readable }])) },
        axes: [{ ...common, label: across, size: 50 * scale }, ...axes],
        series: [{ label: 'time', value: (_, value) => (value === null || value === undefined ? '' : `${value.toFixed(3)} s`) }, ...series],
        cursor: { drag: { x: true, y: false, setScale: false } },
        hooks: { setSelect: [(plot) => this.selected(plot)], draw: [(plot) => this.drawCursors(plot)] },
      },
      [[], ...signals.map((): number[] => [])] as uPlot.AlignedData,
      this.place,
    );
    this.listen(this.plot.over);
  }

  /** @param still  it is not drawn again at once: lines may take their time */
  show(data: number[][], from: number, to: number, still = false): void {
    if (this.plot !== undefined && data.length === this.plot.series.length) {
      // Without a graphics processor a wider line of noise, two points a pixel, takes five times as long as one of a device's pixel.
      const width = still ? kStillWidth : 1 / window.devicePixelRatio;
      this.plot.series.forEach((one) => (one.width = width));
      this.plot.batch(() => {
        this.plot!.setData(data as uPlot.AlignedData, true);
        this.plot!.setScale('x', { min: from, max: Math.max(to, from + 0.001) });
      });
    }
  }

  /** A click picks; a drag zooms, and a double click shows everything. */
  private listen(over: HTMLElement): void {
    let downAt = 0;
    let timer = 0;
    over.addEventListener('mousedown', (event) => (downAt = event.clientX));
    over.addEventListener('click', (event) => {
      const time = this.plot!.posToVal(event.offsetX, 'x');
      window.clearTimeout(timer);
      if (event.detail === 1 && Math.abs(event.clientX - downAt) <= kLeastDrag) {
        timer = window.setTimeout(() => this.onPick(time), kDoubleClickMs);
      }
    });
    over.addEventListener('dblclick', () => {
      window.clearTimeout(timer);
      this.onZoom(undefined);
    });
  }

  /** Draws again what stands. */
  redraw(): void {
    this.plot?.redraw(false, false);
  }

  private drawCursors(plot: uPlot): void {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.setLineDash([]);
    ctx.strokeStyle = ctx.fillStyle = themed('accent');
    ctx.lineWidth = 2 * window.devicePixelRatio;
    ctx.font = `bold ${14 * window.devicePixelRatio}px system-ui, sans-serif`;
    for (const { name, time } of this.cursors) {
      const x = plot.valToPos(time, 'x', true);
      if (x >= bbox.left && x <= bbox.left + bbox.width) {
        ctx.beginPath();
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + bbox.height);
        ctx.stroke();
        ctx.fillText(name, x + 4, bbox.top + 14 * window.devicePixelRatio);
      }
    }
    ctx.restore();
  }

  private selected(plot: uPlot): void {
    if (plot.select.width > kLeastDrag) {
      const from = plot.posToVal(plot.select.left, 'x');
      const to = plot.posToVal(plot.select.left + plot.select.width, 'x');
      plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
      this.onZoom([from, to]);
    }
  }
}

/** Room around what there is; noise of a joint at rest does not fill the plot. */
function readable(_: uPlot, low: number | null, high: number | null): uPlot.Range.MinMax {
  const least = 1e-3;
  const [from, to] = [low ?? 0, high ?? 0];
  const margin = Math.max((to - from) * 0.08, least);
  return [from - margin, to + margin];
}
