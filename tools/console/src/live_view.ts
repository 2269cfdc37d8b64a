// SPDX-License-Identifier: Apache-2.0
// Up to eight signals as they come, over time or one against another.
import type { Board } from './board';
import { byId, download, make, options } from './dom';
import type { Schema } from './frames';
import { parseSignals, type Signal } from './knowledge';
import { mcapOf } from './mcap_file';
import { CursorView } from './cursor_view';
import { pictureOf } from './picture';
import { Series } from './series';
import { TimePlot } from './time_plot';
import { XyPlot } from './xy_plot';

const kMostSignals = 8;
const kMostBuckets = 2000; // of a plot, each with its smallest and largest value
const kMovingPixels = 2; // of a plot that moves for each of them: half of the points are half of the time
const kMostPairs = 5000;
const kFirst = ['joint0.reference', 'joint0.q2', 'joint0.q1', 'joint0.torque'];

/** A log's columns tell their units. */
function asSignals(columns: string[]): Signal[] {
  return columns.map((name) => ({ name, unit: /_([^_]*)$/.exec(name)?.[1] ?? '', meaning: '' }));
}

export class LiveView {
  readonly series = new Series();
  private all: Signal[] = [];
  private chosen: Signal[] = [];
  private shown: Signal[] = [];
  private readonly plot = new TimePlot(byId('plot'));
  private readonly xy = new XyPlot(byId<HTMLCanvasElement>('xy-plot'));
  private readonly cursors = new CursorView(this.series, this.plot);
  private readonly pauseButton = byId<HTMLButtonElement>('pause');
  private readonly add = byId<HTMLSelectElement>('signal-add');
  private readonly kind = byId<HTMLSelectElement>('plot-kind');
  private readonly across = byId<HTMLSelectElement>('xy-x');
  private readonly up = byId<HTMLSelectElement>('xy-y');
  /** ms; set while paused. */
  private frozen: [number, number] | undefined;
  private whole: [number, number] | undefined;
  /** What the picture shows; it is drawn again when that changes. */
  private drawn = '';
  private shapes = 0;
  private frames = 0;
  private framesSince = performance.now();

  constructor(
    private readonly board: Board,
    private readonly say: (text: string) => void,
  ) {
    this.pauseButton.addEventListener('click', () => this.pause(this.frozen === undefined));
    this.add.addEventListener('change', () => void this.choose([...this.chosenNames, this.add.value]));
    this.kind.addEventListener('change', () => this.showKind());
    byId('csv').addEventListener('click', () => this.save());
    byId('mcap').addEventListener('click', () => void this.saveMcap());
    byId('png').addEventListener('click', () => this.savePicture());
    byId('go-on').addEventListener('click', () => void this.goOn());
    this.plot.onZoom = (range) => this.zoom(range);
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.shape());
    const draw = () => {
      this.draw();
      window.requestAnimationFrame(draw);
    };
    window.requestAnimationFrame(draw);
  }

  async connected(): Promise<void> {
    this.all = parseSignals((await this.board.lookUp('scope signals')).lines);
    const before = this.chosen.map((one) => one.name).filter((name) => this.all.some((one) => one.name === name));
    await this.choose(before.length > 0 ? before : kFirst);
  }

  /** Names of the signals that the board has, and of those shown. */
  get known(): string[] {
    return this.all.map((one) => one.name);
  }
  get chosenNames(): string[] {
    return this.chosen.map((one) => one.name);
  }

  /** Leaves the board's recorder to another; what was shown stays. */
  async standBack(): Promise<void> {
    await this.board.ask('frames off');
    byId('go-on').hidden = false;
  }
  goOn(): Promise<void> {
    return this.choose(this.chosenNames);
  }
  /** Shows these signals, and no others, at this rate or at the line's. */
  show(names: string[], every?: number): Promise<void> {
    return this.choose(names, every);
  }

  /** Rows of a log come instead of frames; its columns tell the units. */
  columns(columns: string[]): void {
    this.series.reset(columns, 1);
    this.shown = asSignals(columns);
    this.pause(false);
    this.shape();
  }
  /** A log that is complete: all of it, and it stands still. */
  showAll(): void {
    this.pause(true);
    this.whole = this.frozen = [this.series.tick(0), this.series.lastTick];
  }
  schema(schema: Schema): void {
    this.series.reset(schema.columns, schema.everyMs);
    this.shown = this.board.looking ? asSignals(schema.columns) : this.chosen;
    this.shape();
  }
  sample(tick: number, values: number[]): void {
    this.series.push(tick, values);
  }

  private async choose(names: string[], every = this.board.link?.everyMs ?? 1): Promise<void> {
    const chosen = this.all.filter((one) => names.includes(one.name)).sort((a, b) => names.indexOf(a.name) - names.indexOf(b.name));
    if (chosen.length > kMostSignals) {
      this.say(`a board sends ${kMostSignals} signals at most; take one away first`);
      options(this.add, this.offered());
      return;
    }
    await this.board.ask('frames off');
    this.board.expectSchema();
    byId('go-on').hidden = true;
    this.chosen = chosen;
    this.pause(false);
    for (let i = 0; chosen.length > 0 && i < 5; ++i) {
      const answer = await this.board.ask(`frames ${every} ${chosen.map((one) => one.name).join(' ')}`);
      if (answer.error === undefined || !answer.error.startsWith('busy')) {
        this.say(answer.error ?? '');
        break;
      }
    }
    this.list();
  }

  private offered(): string[] {
    return ['', ...this.all.filter((one) => !this.chosen.includes(one)).map((one) => one.name)];
  }

  /** The signals as buttons that take them away. */
  private list(): void {
    byId('signals').replaceChildren(
      ...this.chosen.map((signal) =>
        make(
          'button',
          { type: 'button', title: signal.meaning, 'aria-label': `take ${signal.name} away`, click: () => void this.choose(this.chosen.filter((one) => one !== signal).map((one) => one.name)) },
          `${signal.name} ×`,
        ),
      ),
    );
    options(this.add, this.offered());
    for (const [select, fallback] of [[this.across, 'joint0.q1'], [this.up, 'joint0.torque']] as const) {
      const names = this.chosenNames;
      options(select, names, names.includes(select.value) ? select.value : fallback);
    }
  }

  private shape(): void {
    ++this.shapes;
    this.plot.shape(this.shown);
  }

  private showKind(): void {
    const xy = this.kind.value === 'xy';
    byId('plot').hidden = xy;
    byId('xy-plot').hidden = !xy;
    document.querySelectorAll<HTMLElement>('.xy').forEach((element) => (element.hidden = !xy));
  }

  private window(): [number, number] {
    const last = this.series.lastTick;
    const first = this.series.size > 0 ? this.series.tick(0) : 0;
    return this.frozen ?? [Math.max(first, last - Number(byId<HTMLSelectElement>('window').value) * 1000), last];
  }

  private pause(stop: boolean): void {
    this.whole = this.frozen = stop ? this.window() : undefined;
    this.pauseButton.setAttribute('aria-pressed', String(stop));
    this.pauseButton.textContent = stop ? 'Go on' : 'Pause';
  }
  private zoom(range: [number, number] | undefined): void {
    if (this.frozen === undefined) {
      this.pause(true);
    }
    this.frozen = range === undefined ? this.whole : [range[0] * 1000, range[1] * 1000];
  }

  /** What is kept, or what is shown while it stands still. */
  csv(): string {
    const [from, to] = this.frozen ?? [-Infinity, Infinity];
    return this.series.csv(from, to);
  }
  private async saveMcap(): Promise<void> {
    const [from, to] = this.frozen ?? [-Infinity, Infinity];
    download('capstan.mcap', (await mcapOf(this.series, from, to)) as BlobPart[], 'application/octet-stream');
  }
  private save(): void {
    download('capstan.csv', [this.csv()], 'text/csv');
  }

  private savePicture(): void {
    const xy = this.kind.value === 'xy';
    const canvas = xy ? byId<HTMLCanvasElement>('xy-plot') : byId('plot').querySelector('canvas');
    canvas && pictureOf(canvas, xy ? [] : this.shown).toBlob((blob) => blob !== null && download('capstan.png', [blob], 'image/png'));
  }

  private draw(): void {
    if (byId('live').hidden || document.hidden) {
      return;
    }
    const [from, to] = this.window();
    const what = [from, to, this.frozen === undefined, this.kind.value, this.across.value, this.up.value, this.plot.width, this.shapes].join();
    this.count();
    if (what === this.drawn) {
      return;
    }
    this.drawn = what;
    const still = this.frozen !== undefined;
    this.cursors.show(still && this.kind.value === 'time' ? [from, to] : undefined, this.shown);
    if (this.kind.value === 'xy') {
      const names = this.shown.map((one) => one.name);
      const [x, y] = [names.indexOf(this.across.value), names.indexOf(this.up.value)];
      const label = (i: number) => `${this.shown[i]?.name ?? ''} ${this.shown[i]?.unit ?? ''}`;
      const [xs, ys] = x < 0 || y < 0 ? [[], []] : this.series.pairs(x, y, from, to, kMostPairs);
      this.xy.show(xs, ys, label(x), label(y));
    } else {
      const data = this.series.view(from, to, Math.min(kMostBuckets, this.plot.width) / (still ? 1 : kMovingPixels));
      this.plot.show(data, from / 1000, to / 1000, still);
    }
  }

  private count(): void {
    ++this.frames;
    const passed = performance.now() - this.framesSince;
    if (passed > 1000) {
      const rate = Math.round((1000 * this.frames) / passed);
      byId('rate').textContent = `${this.series.size} samples kept, one every ${this.series.everyMs} ms, ${this.series.lost} lost; ${rate} pictures a second`;
      this.frames = 0;
      this.framesSince = performance.now();
    }
  }
}
