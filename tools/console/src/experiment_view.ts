// SPDX-License-Identifier: Apache-2.0
// The firmware's recipes of motion: runs one, draws its rows as they come and offers them as a log.
import type { Board } from './board';
import { byId, download, options } from './dom';
import type { LiveView } from './live_view';
import { LogTable } from './log_table';

export class ExperimentView {
  private log: LogTable;
  private running = false;
  private readonly words = byId('experiment-answer');
  private readonly run = byId<HTMLButtonElement>('experiment-run');
  private readonly stop = byId<HTMLButtonElement>('experiment-stop');
  private readonly save = byId<HTMLButtonElement>('experiment-save');

  constructor(
    private readonly board: Board,
    private readonly live: LiveView,
  ) {
    this.log = new LogTable(live);
    byId('experiment-form').addEventListener('submit', (event) => {
      event.preventDefault();
      void this.begin();
    });
    this.stop.addEventListener('click', () => this.board.shell.cancel());
    this.save.addEventListener('click', () => download('capstan_experiment.csv', [this.log.csv], 'text/csv'));
    this.show();
  }

  /** Recipes and their options are those of the board's own help. */
  async connected(joints: number): Promise<void> {
    const help = (await this.board.lookUp('help experiment')).lines.map((line) => /^ *experiment jointN (\S+) (.*)$/.exec(line)).find((found) => found !== null);
    options(byId<HTMLSelectElement>('experiment-recipe'), help?.[1]!.split('|') ?? []);
    byId('experiment-options-help').textContent = help?.[2] ?? '';
    options(byId<HTMLSelectElement>('experiment-joint'), Array.from({ length: joints }, (_, i) => `joint${i}`));
  }

  /** The log of the last experiment; nothing if there was none. */
  get csv(): string | undefined {
    return this.running || this.log.rows === 0 ? undefined : this.log.csv;
  }

  private async begin(): Promise<void> {
    if (this.running) {
      return;
    }
    this.running = true;
    this.log = new LogTable(this.live);
    this.show();
    const value = (id: string) => byId<HTMLInputElement>(id).value.trim();
    await this.live.standBack();
    const line = `experiment ${value('experiment-joint')} ${value('experiment-recipe')} ${value('experiment-options')}`.trim();
    const answer = await this.board.ask(line, (row) => this.take(row));
    this.running = false;
    const { rows } = this.log;
    const whole = answer.error ?? `done: ${rows} rows`;
    this.words.textContent = answer.error !== undefined && rows > 0 ? `ended early after ${rows} rows: ${whole}` : whole;
    this.show();
    if (rows === 0) {
      await this.live.goOn(); // nothing was drawn meanwhile
    }
  }

  private take(row: string): void {
    this.log.take(row);
    this.words.textContent = `runs: ${this.log.rows} rows`;
  }

  private show(): void {
    this.run.disabled = this.running;
    this.stop.disabled = !this.running;
    this.save.disabled = this.running || this.log.rows === 0;
  }
}
