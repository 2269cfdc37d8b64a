// SPDX-License-Identifier: Apache-2.0
// The board's scope: the signals shown, in every cycle around a trigger, drawn as a log whose time 0 is the trigger.
import type { Board } from './board';
import { byId, options } from './dom';
import type { LiveView } from './live_view';
import { LogTable } from './log_table';

const kLookEveryMs = 300;
const kCaptured = 'scope done';

export class ScopeView {
  private timer = 0;
  private readonly words = byId('scope-answer');
  private readonly when = byId<HTMLSelectElement>('scope-when');

  constructor(
    private readonly board: Board,
    private readonly live: LiveView,
  ) {
    byId('scope-form').addEventListener('submit', (event) => {
      event.preventDefault();
      void this.start();
    });
    byId('scope-stop').addEventListener('click', () => void this.stop());
    this.when.addEventListener('change', () => this.show());
    this.show();
  }

  connected(): void {
    window.clearTimeout(this.timer);
    options(byId<HTMLSelectElement>('scope-signal'), this.live.known, byId<HTMLSelectElement>('scope-signal').value || 'joint0.reference');
  }

  private show(): void {
    const level = !['now', 'fault'].includes(this.when.value);
    document.querySelectorAll<HTMLElement>('.scope-level').forEach((element) => (element.hidden = !level));
  }

  private async start(): Promise<void> {
    window.clearTimeout(this.timer);
    const value = (id: string) => byId<HTMLInputElement>(id).value.trim();
    const trigger = ['now', 'fault'].includes(this.when.value) ? this.when.value : `${value('scope-signal')} ${this.when.value} ${value('scope-level')}`;
    const lines = [`channels ${this.live.chosenNames.join(' ')}`, `trigger ${trigger}`, `start ${value('scope-samples')} ${value('scope-before')}`];
    for (const line of lines) {
      const error = (await this.board.ask(`scope ${line}`)).error;
      if (error !== undefined) {
        this.words.textContent = error;
        return;
      }
    }
    this.look();
  }
  private async stop(): Promise<void> {
    window.clearTimeout(this.timer);
    this.words.textContent = (await this.board.ask('scope stop')).error ?? 'stopped';
  }

  private look(): void {
    this.timer = window.setTimeout(async () => {
      const answer = await this.board.ask('scope');
      this.words.textContent = answer.error ?? answer.lines[0] ?? '';
      if (answer.lines[0]?.startsWith(kCaptured) === true) {
        await this.dump();
      } else if (this.board.link !== undefined) {
        this.look();
      }
    }, kLookEveryMs);
  }

  private async dump(): Promise<void> {
    await this.live.standBack();
    const log = new LogTable(this.live);
    const answer = await this.board.ask('scope dump', (row) => log.take(row));
    this.live.showAll();
    this.words.textContent = answer.error ?? `captured ${log.rows} samples; time 0 is the trigger`;
  }
}
