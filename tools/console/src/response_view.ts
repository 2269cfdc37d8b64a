// SPDX-License-Identifier: Apache-2.0
// Steps of a joint repeated while its gains are changed: the newest response, and faintly those before it.
import uPlot from 'uplot';
import type { Board } from './board';
import { byId, jointOptions, make } from './dom';
import { parseParameters, type Parameter, type Status } from './knowledge';
import type { LiveView } from './live_view';
import type { ParameterView } from './parameter_view';
import { StepTrace } from './step_response';
import { TimePlot, type Line } from './time_plot';

const kDegrees = 180 / Math.PI;
const kBehind = 5;
const kDrawEveryMs = 100;
const kMostPoints = 500;
const kAttempts = 5; // of a move, while the board takes another request

/** A trace's columns behind its time: reference, estimate and torque since it began, steps downwards turned upwards. */
function table(trace: StepTrace): uPlot.AlignedData {
  const zero = trace.zero ?? trace.ticks[0] ?? 0;
  const step = Math.max(1, Math.ceil(trace.ticks.length / kMostPoints));
  const kept = trace.ticks.map((_, i) => i).filter((i) => i % step === 0);
  const up = trace.size < 0 ? -1 : 1;
  const pick = (values: number[], from: number, scale: number) => kept.map((i) => (values[i]! - from) * up * scale);
  const from = trace.reference[0] ?? 0;
  return [
    kept.map((i) => (trace.ticks[i]! - zero) / 1000),
    pick(trace.reference, from, kDegrees),
    pick(trace.estimate, from, kDegrees),
    pick(trace.torque, trace.torque[0] ?? 0, 1000),
  ];
}

function linesOf(behind: number): Line[] {
  const of = (faint: boolean): Line[] => [
    { name: 'reference', unit: 'deg', meaning: '', like: 0, faint },
    { name: 'estimate', unit: 'deg', meaning: '', like: 1, faint },
    { name: 'torque', unit: 'mNm', meaning: '', like: 2, faint },
  ];
  return [...Array.from({ length: behind }, () => of(true)).flat(), ...of(false)];
}

export class ResponseView {
  private readonly plot = new TimePlot(byId('response-plot'));
  private readonly joint = byId<HTMLSelectElement>('response-joint');
  private readonly words = byId('response-answer');
  private traces: StepTrace[] = [];
  private trace: StepTrace | undefined;
  private running = false;
  private gains: HTMLInputElement[] = [];
  private listed = ''; // names of these
  private changes: string[] = [];
  private before: string[] = [];
  private base: number | undefined;
  private enough: (() => void) | undefined;
  private lasts = 0;
  private shaped = -1;
  private drawnAt = 0;

  constructor(
    private readonly board: Board,
    private readonly live: LiveView,
    private readonly parameters: ParameterView,
  ) {
    byId('response-form').addEventListener('submit', (event) => {
      event.preventDefault();
      void this.run();
    });
    byId('response-stop').addEventListener('click', () => void this.stop());
    this.joint.addEventListener('change', () => this.chooseJoint());
  }

  /** The view is shown: joints and gains are those of the board that is there. */
  async load(): Promise<void> {
    jointOptions(this.joint, this.board.status?.joints);
    await this.listGains();
  }
  /** The view is left. */
  leave(): void {
    if (this.running) {
      void this.stop();
    }
  }

  show(status: Status | undefined): void {
    const torque = status !== undefined && this.board.mayHaveTorque && !this.board.looking;
    byId<HTMLButtonElement>('response-run').disabled = !torque || this.running;
    byId<HTMLButtonElement>('response-stop').disabled = !this.running;
    if (this.running && (!torque || status.fault !== 'none')) {
      this.end(`ended: ${status === undefined ? 'the board is gone' : status.fault === 'none' ? 'the torque is off' : `${status.fault}; see State`}`);
    }
  }

  sample(tick: number, values: number[]): void {
    if (this.trace === undefined || values.length !== 3) {
      return;
    }
    this.trace.push(tick, values[0]!, values[1]!, values[2]!);
    if (this.trace.lasted >= this.lasts) {
      this.enough?.();
    }
    if (performance.now() - this.drawnAt > kDrawEveryMs) {
      this.draw();
    }
  }

  private chooseJoint(): void {
    this.leave();
    this.traces = [];
    this.base = undefined;
    void this.listGains();
    this.draw();
    this.list();
  }

  /** Only these: reading every parameter takes a second on a serial line. */
  private async readGains(): Promise<Parameter[]> {
    return parseParameters((await this.board.lookUp(`list ${this.joint.value}.control`)).lines);
  }

  private async listGains(): Promise<void> {
    const joint = this.joint.value;
    const gains = await this.readGains();
    const listed = gains.map((gain) => `${joint}.${gain.name}`).join();
    if (listed === this.listed) {
      this.put(gains);
      return;
    }
    this.listed = listed;
    this.gains = gains.map((gain) => {
      const name = gain.name.slice('control.'.length);
      const input: HTMLInputElement = make('input', {
        type: 'text', inputmode: 'decimal', size: '7', value: gain.value, 'data-gain': gain.name, title: gain.meaning, 'aria-label': `${joint} ${name}${gain.unit === '' ? '' : `, ${gain.unit}`}`,
        change: () => {
          input.defaultValue = input.value; // it is typed
          void this.change(`${joint}.${gain.name}`, input.value.trim());
        },
      });
      input.defaultValue = gain.value;
      return input;
    });
    const undo = make('button', { type: 'button', id: 'response-undo', click: () => void this.undo() }, 'Undo last commit');
    byId('response-gains').replaceChildren(...this.gains.map((input, i) => make('label', {}, `${gains[i]!.name.slice('control.'.length)} `, input, ` ${gains[i]!.unit}`)), undo);
  }

  private async change(name: string, value: string): Promise<void> {
    const refusal = await this.parameters.take(new Map([[name, value]]));
    this.words.textContent = refusal ?? `${name} is ${this.parameters.find(name)?.value ?? value} now; save it in Parameters to keep it`;
    if (refusal === undefined) {
      this.changed(`${name.split('.').at(-1)!} ${value}`);
    }
    await this.showGains();
  }
  private async undo(): Promise<void> {
    this.words.textContent = await this.parameters.undoCommit();
    this.changed('undone');
    await this.showGains();
  }
  private changed(what: string): void {
    this.trace?.changes.push(`${what} meanwhile`);
    this.changes.push(what);
  }
  private async showGains(): Promise<void> {
    this.put(await this.readGains());
  }
  /** What the board has, but where somebody is typing: that stays untouched, for a browser tells of no change where a program set the value. */
  private put(gains: Parameter[]): void {
    const values = new Map(gains.map((one) => [one.name, one.value]));
    for (const input of this.gains) {
      const begun = input.value !== input.defaultValue;
      input.defaultValue = values.get(input.dataset['gain']!) ?? input.defaultValue;
      if (!begun) {
        input.value = input.defaultValue;
      }
    }
  }

  /** Both ends of the step in degrees, or a sentence: the joint has no room for it. */
  private async ends(joint: string, step: number): Promise<[number, number] | string> {
    const limits = parseParameters((await this.board.lookUp(`list ${joint}.limits`)).lines);
    const limit = (name: string) => Number(limits.find((one) => one.name === `limits.${name}`)?.value ?? 0) * kDegrees;
    const here = (this.board.status?.joints.find((one) => one.name === joint)?.angleRad ?? 0) * kDegrees;
    if (this.base === undefined || Math.abs(here - this.base) > 2 * step) {
      this.base = here;
    }
    const [low, high] = [limit('joint_min'), limit('joint_max')];
    const other = [this.base + step, this.base - step].find((one) => one > low && one < high);
    const inside = this.base > low && this.base < high;
    return other === undefined || !inside ? `no step of ${step} deg fits between limits.joint_min ${low.toFixed(1)} and limits.joint_max ${high.toFixed(1)} deg from here; make it smaller, or move the joint first` : [this.base, other];
  }

  private async run(): Promise<void> {
    const joint = this.joint.value;
    const number = (id: string) => Number(byId<HTMLInputElement>(id).value);
    if (this.running || !byId<HTMLFormElement>('response-form').reportValidity()) {
      return;
    }
    this.running = true;
    const ends = await this.ends(joint, number('response-step'));
    if (typeof ends === 'string') {
      this.end(ends);
      return;
    }
    this.lasts = number('response-every') * 1000;
    this.words.textContent = `${joint} steps between ${ends[0].toFixed(2)} and ${ends[1].toFixed(2)} deg`;
    this.before = this.live.chosenNames;
    const every = this.board.link?.everyMs ?? 1;
    await this.live.show([`${joint}.reference`, `${joint}.q2`, `${joint}.torque`], Math.ceil(every / 2)); // three signals in place of eight
    for (let to = 1; this.running; to = 1 - to) {
      await this.step(joint, ends[to]!);
    }
  }

  private async step(joint: string, degrees: number): Promise<void> {
    this.trace = new StepTrace();
    this.trace.changes.push(...this.changes.splice(0));
    const over = new Promise<void>((resolve) => (this.enough = resolve));
    for (let attempt = 1; ; ++attempt) {
      const { error } = await this.board.ask(`move ${joint} ${degrees.toFixed(3)} deg`);
      if (error !== undefined && (attempt === kAttempts || !error.startsWith('busy'))) {
        this.end(`ended: ${error}`);
      }
      if (error === undefined || !this.running) {
        break;
      }
    }
    if (this.running) {
      await over;
    }
    if (this.running && this.trace !== undefined) {
      this.traces = [...this.traces, this.trace].slice(-1 - kBehind);
      this.trace = undefined;
      this.list();
    }
  }

  private async stop(): Promise<void> {
    const joint = this.joint.value;
    const held = this.board.ask(`hold ${joint}`);
    this.end('stopped');
    await held;
  }

  private end(why: string): void {
    this.running = false;
    this.trace = undefined;
    this.words.textContent = why;
    this.enough?.();
    this.draw();
    this.show(this.board.status);
    if (this.before.length > 0 && this.board.link !== undefined && !this.board.looking) {
      void this.live.show(this.before.splice(0));
    }
  }

  private list(): void {
    const text = (value: number | undefined, scale: number, otherwise: string) => (value === undefined ? otherwise : (value * scale).toFixed(scale === 1 ? 0 : 1));
    const rows = [...this.traces].reverse().map((trace) => {
      const figures = trace.figures();
      return [
        (trace.size * kDegrees).toFixed(2),
        text(figures?.overshoot, 100, ''),
        text(figures?.rise, 1, 'not reached'),
        text(figures?.settling, 1, 'not within the step'),
        (trace.largestTorque * 1000).toFixed(2),
        trace.changes.join(', '),
      ];
    });
    byId('response-table').hidden = rows.length === 0;
    byId('response-table').querySelector('tbody')!.replaceChildren(...rows.map((row) => make('tr', {}, ...row.map((cell) => make('td', {}, cell)))));
  }

  private draw(): void {
    this.drawnAt = performance.now();
    if (byId('move').hidden || document.hidden) {
      return;
    }
    const all = [...this.traces, ...(this.trace === undefined ? [] : [this.trace])].filter((one) => one.zero !== undefined).slice(-1 - kBehind);
    if (all.length === 0) {
      return;
    }
    if (all.length !== this.shaped) {
      this.shaped = all.length;
      this.plot.shape(linesOf(all.length - 1), 'time since the reference moves, s');
    }
    const joined = uPlot.join(all.map(table)) as unknown as number[][];
    this.plot.show(joined, -0.05, Math.max(this.lasts, ...all.map((one) => one.lasted)) / 1000, !this.running);
  }
}
