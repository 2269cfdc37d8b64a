// SPDX-License-Identifier: Apache-2.0
// What the law of a joint lacks, or the law itself: the host program looks at a log, and the board takes what it finds. Where no host program is
// behind the page, the log is offered with the command to run.
import type { Board } from './board';
import { byId, download, jointOptions, make } from './dom';
import { valuesOf } from './knowledge';
import type { ParameterView } from './parameter_view';
import { XyPlot } from './xy_plot';

interface Errors {
  rmse: number;
}
interface Answer {
  status: number;
  said: string;
  lines: string[];
  not_applied?: string;
  diagnosis?: { verdict: string; effects: { name: string }[]; law?: { status: string }; before: Errors | null; after: Errors | null };
}

const kMostLog = 64 * 1024 * 1024; // tools/console_server/web_server.cpp

/** Columns of a log by the contract. */
function columns(csv: string): Map<string, number[]> {
  const rows = csv.trim().split('\n').map((row) => row.split(','));
  return new Map(rows[0]!.map((name, i) => [name, rows.slice(1).map((row) => Number(row[i]))]));
}

export class DiagnoseView {
  private readonly source = byId<HTMLSelectElement>('diagnose-source');
  private readonly task = byId<HTMLSelectElement>('diagnose-task');
  private readonly joint = byId<HTMLSelectElement>('diagnose-joint');
  private readonly model = byId<HTMLSelectElement>('diagnose-model');
  private readonly target = byId<HTMLSelectElement>('diagnose-target');
  private readonly words = byId('diagnose-answer');
  private readonly apply = byId<HTMLButtonElement>('diagnose-apply');
  private readonly loop = new XyPlot(byId<HTMLCanvasElement>('diagnose-loop'));
  private lines: string[] = [];
  private busy = false;

  /** @param served  by the host program, which diagnoses then   @param logs  of the last experiment and of what is shown */
  constructor(
    private readonly board: Board,
    private readonly served: boolean,
    private readonly parameters: ParameterView,
    private readonly logs: { experiment(): string | undefined; live(): string },
  ) {
    byId('diagnose-form').addEventListener('submit', (event) => {
      event.preventDefault();
      void this.begin();
    });
    for (const choice of [this.source, this.task, this.joint, this.model, this.target]) {
      choice.addEventListener('change', () => this.show());
    }
    this.apply.addEventListener('click', () => void this.give());
    this.show();
  }

  load(): void {
    jointOptions(this.joint, this.board.status?.joints);
    this.show();
  }

  private show(): void {
    byId('diagnose-file').hidden = this.source.value !== 'file';
    byId('diagnose-file-label').hidden = this.source.value !== 'file';
    byId('diagnose-run').textContent = !this.served ? 'Save log' : this.identifies ? 'Identify' : 'Diagnose';
    byId('diagnose-model-label').hidden = !this.identifies;
    byId('diagnose-target-label').hidden = this.identifies;
    const axis = this.axis === 0 ? '' : ` --axis ${this.axis}`;
    const work = this.identifies ? `identify capstan_log.csv --model ${this.model.value}` : `diagnose capstan_log.csv --target ${this.explained} --report report`;
    byId('diagnose-command').textContent = this.served ? '' : `then: capstan ${work}${axis} -o law.toml, and capstan apply law.toml${axis} --port PORT`;
    this.apply.disabled = this.lines.length === 0 || this.busy;
  }

  private get identifies(): boolean {
    return this.task.value === 'identify';
  }
  /** Of the log and of the board. */
  private get axis(): number {
    return Number(this.joint.value.replace('joint', ''));
  }
  /** The column. */
  private get explained(): string {
    return `axis${this.axis}/${this.identifies ? 'q2_rad' : this.target.value}`;
  }

  private async log(): Promise<string | undefined> {
    if (this.source.value === 'file') {
      return byId<HTMLInputElement>('diagnose-file').files?.[0]?.text();
    }
    return this.source.value === 'live' ? this.logs.live() : this.logs.experiment();
  }

  private async begin(): Promise<void> {
    const log = await this.log();
    if (this.busy || log === undefined) {
      this.words.textContent = this.busy ? 'a diagnosis is under way; wait for it' : 'there is no log yet; run an experiment in Move, or choose a file';
      return;
    }
    if (log.length > kMostLog && this.served) {
      this.words.textContent = "the log is larger than 64 MB; diagnose it by 'capstan diagnose'";
      return;
    }
    if (!log.split('\n', 1)[0]!.split(',').includes('time_s')) {
      this.words.textContent = "this is no log: its first line names no column time_s; docs/logs.md says what a log is, and 'capstan diagnose --map' reads other names";
      return;
    }
    this.draw(log);
    if (!this.served) {
      download('capstan_log.csv', [log], 'text/csv');
      return;
    }
    this.busy = true;
    this.lines = [];
    this.words.textContent = 'the host program looks at the log …';
    this.show();
    try {
      this.found(await this.ask(log));
    } catch (problem) {
      this.words.textContent = problem instanceof Error ? problem.message : String(problem);
    }
    await this.compare();
    this.busy = false;
    this.show();
  }

  /** What the board has, beside what it would have. */
  private async compare(): Promise<void> {
    const values = valuesOf(this.lines);
    byId('diagnose-table').hidden = values.size === 0;
    if (values.size > 0) {
      await this.parameters.load();
    }
    const rows = [...values].map(([name, after]) => [name, this.parameters.find(name), after] as const);
    byId('diagnose-table').querySelector('tbody')!.replaceChildren(
      ...rows.map(([name, now, after]) => make('tr', {}, make('th', { scope: 'row' }, name), make('td', {}, `${now?.value ?? ''} ${now?.unit ?? ''}`), make('td', {}, after))),
    );
  }

  private async ask(log: string): Promise<Answer> {
    const response = await fetch(this.identifies ? `identify/${this.axis}/${this.model.value}` : `diagnose/${this.axis}/${this.explained}`, { method: 'POST', body: log }).catch(() => {
      throw new Error('capstan console has gone; start it again and open the address that it prints');
    });
    if (!response.ok) {
      throw new Error((await response.text()).trim());
    }
    return (await response.json()) as Answer;
  }

  private found(answer: Answer): void {
    const { diagnosis } = answer;
    byId('diagnose-said').textContent = answer.said;
    byId('diagnose-report').replaceChildren();
    const not = answer.not_applied === undefined ? '' : `; not for this board: ${answer.not_applied}`;
    if (diagnosis === undefined) {
      const lines = answer.said.trim().split('\n').map((line) => line.trim());
      const fit = lines.find((line) => line.startsWith('error (RMSE) '));
      this.words.textContent = answer.status === 0 && fit !== undefined ? `${this.model.value}: ${fit}${not}` : (lines.at(-1) ?? '');
      this.lines = answer.lines;
      return;
    }
    const unit = this.target.value.endsWith('_Nm') ? 'N m' : 'rad';
    const error = (errors: Errors | null) => (errors === null ? 'not known' : `${errors.rmse.toPrecision(3)} ${unit}`);
    const effects = diagnosis.effects.map((one) => one.name).join(', ');
    this.words.textContent = `verdict: ${diagnosis.verdict}${effects === '' ? '' : ` (${effects})`}; error before ${error(diagnosis.before)}, after ${error(diagnosis.after)}${not}`;
    this.lines = answer.lines;
    byId('diagnose-report').append(make('iframe', { src: `report?${Date.now()}`, title: 'report', sandbox: '' }));
  }

  /** The loop that is explained: over the motor's angle. */
  private draw(log: string): void {
    const all = columns(log);
    const motor = `axis${this.axis}/q1_rad`;
    byId('diagnose-loop').hidden = false;
    this.loop.show(all.get(motor) ?? [], all.get(this.explained) ?? [], motor, this.explained);
  }

  /** All of them or none; the board reads them back, and Parameters can undo them. */
  private async give(): Promise<void> {
    this.busy = true;
    this.show();
    const values = valuesOf(this.lines);
    const refusal = await this.parameters.take(values);
    this.words.textContent = refusal ?? `the board has the law now, ${values.size} parameters; save them in Parameters, then record and diagnose again to see what is left`;
    byId('diagnose-said').textContent = (await this.board.ask('model')).lines.join('\n');
    this.busy = false;
    this.show();
  }
}
