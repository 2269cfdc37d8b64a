// SPDX-License-Identifier: Apache-2.0
// Breaks the simulated joint: faults now, effects from a start anew.
import type { Board } from './board';
import { byId, options } from './dom';
import { parseKnown, type Tables } from './knowledge';

export class BreakView {
  private tables: Tables | undefined;
  private readonly effect = byId<HTMLSelectElement>('effect');

  constructor(
    private readonly board: Board,
    private readonly startAnew: (effects: string) => Promise<string>,
  ) {
    byId('fault-form').addEventListener('submit', (event) => {
      event.preventDefault();
      void this.fail();
    });
    byId('effect-form').addEventListener('submit', (event) => {
      event.preventDefault();
      void this.start(`${this.effect.value}=${byId<HTMLInputElement>('effect-value').value.trim()}`);
    });
    byId('effect-none').addEventListener('click', () => void this.start(''));
    this.effect.addEventListener('change', () => this.showRange());
  }

  know(tables: Tables): void {
    this.tables = tables;
    options(this.effect, tables.effects.filter((one) => one.primary).map((one) => `${one.effect}.${one.field}`));
    this.showRange();
  }

  /** What can fail, and how, is what the board says when it does not understand. @param anew  it can be started anew from here */
  async connected(joints: number, anew: boolean): Promise<void> {
    byId('effects').hidden = !anew;
    byId('effects-elsewhere').hidden = anew;
    const targets = parseKnown((await this.board.lookUp('fail ?')).error ?? '');
    byId('fault-form').hidden = targets.length === 0;
    byId('fault-answer').textContent = targets.length > 0 ? '' : "this board's shell has no command 'fail': its joints are simulated by another program; give that program's scenario the faults, or connect a board of 'capstan run'";
    options(byId<HTMLSelectElement>('fault-target'), targets);
    options(byId<HTMLSelectElement>('fault-kind'), parseKnown((await this.board.lookUp(`fail ${targets[0] ?? ''} ?`)).error ?? ''));
    options(byId<HTMLSelectElement>('fault-joint'), Array.from({ length: joints }, (_, i) => String(i)));
  }

  private showRange(): void {
    const found = this.tables?.effects.find((one) => `${one.effect}.${one.field}` === this.effect.value);
    byId('effect-range').textContent = found === undefined ? '' : `${found.low} to ${found.high}`;
  }

  private async fail(): Promise<void> {
    const value = (id: string) => byId<HTMLInputElement>(id).value.trim();
    const words = ['fail', value('fault-target'), value('fault-kind')];
    for (const [word, id] of [['for', 'fault-for'], ['amount', 'fault-amount']] as const) {
      if (value(id) !== '') {
        words.push(word, value(id));
      }
    }
    words.push('axis', value('fault-joint'));
    const answer = await this.board.ask(words.join(' '));
    byId('fault-answer').textContent = answer.error ?? `${words.join(' ')}: done`;
  }

  private async start(effects: string): Promise<void> {
    const problem = await this.startAnew(effects);
    byId('effect-answer').textContent = problem !== '' ? problem : effects === '' ? 'restarted without an effect' : `restarted with ${effects}, which the firmware does not know`;
  }
}
