// SPDX-License-Identifier: Apache-2.0
// Two cursors on a plot that stands: where they are, what the signals are there, and what lies between.
import { byId, make } from './dom';
import type { Signal } from './knowledge';
import type { Series } from './series';
import type { TimePlot } from './time_plot';

const kFirst = [0.25, 0.75]; // of the window
const kDigits = 5;

export class CursorView {
  private readonly sliders = ['cursor-a', 'cursor-b'].map((id) => byId<HTMLInputElement>(id));
  private signals: Signal[] = [];
  private shown = '';

  constructor(
    private readonly series: Series,
    private readonly plot: TimePlot,
  ) {
    for (const slider of this.sliders) {
      slider.addEventListener('input', () => this.list());
    }
    plot.onPick = (time) => this.pick(time * 1000);
  }

  /** @param window  ms of the plot that stands; undefined: it moves, and has no cursors */
  show(window: [number, number] | undefined, signals: Signal[]): void {
    const what = `${window?.join() ?? ''} ${signals.map((one) => one.name).join()}`;
    if (what === this.shown) {
      return;
    }
    this.shown = what;
    this.signals = signals;
    byId('cursors').hidden = window === undefined;
    this.plot.cursors = [];
    if (window !== undefined && this.series.size > 0) {
      this.sliders.forEach((slider, i) => {
        const before = Number(slider.value);
        const stays = slider.max !== '' && before >= window[0] && before <= window[1];
        slider.min = String(window[0]);
        slider.max = String(window[1]);
        slider.step = String(this.series.everyMs);
        slider.value = String(stays ? before : Math.round(window[0] + (window[1] - window[0]) * kFirst[i]!));
      });
      this.list();
    }
  }

  /** The one that is nearer goes there. */
  private pick(tick: number): void {
    if (byId('cursors').hidden) {
      return;
    }
    const far = (slider: HTMLInputElement) => Math.abs(Number(slider.value) - tick);
    const [a, b] = this.sliders as [HTMLInputElement, HTMLInputElement];
    (far(a) <= far(b) ? a : b).value = String(Math.round(tick));
    this.list();
  }

  private list(): void {
    const at = this.sliders.map((slider) => Math.min(this.series.size - 1, this.series.firstFrom(Number(slider.value))));
    const times = at.map((i) => this.series.tick(i) / 1000) as [number, number];
    this.plot.cursors = times.map((time, i) => ({ name: 'AB'[i]!, time }));
    this.plot.redraw();
    this.sliders.forEach((slider, i) => slider.setAttribute('aria-valuetext', `${times[i]!.toFixed(3)} s`));
    const row = (name: string, a: number, b: number, unit: string) =>
      make('tr', {}, make('th', { scope: 'row' }, name), ...[a, b, b - a].map((value) => make('td', {}, `${value.toPrecision(kDigits)} ${unit}`)));
    byId('cursor-table').querySelector('tbody')!.replaceChildren(
      row('time', times[0], times[1], 's'),
      ...this.signals.map((signal, channel) => row(signal.name, this.series.value(channel, at[0]!), this.series.value(channel, at[1]!), signal.unit)),
    );
  }
}
