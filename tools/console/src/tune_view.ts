// SPDX-License-Identifier: Apache-2.0
// Gains from a frequency response, step by step: the board shakes the joint, `capstan tune` takes gains from the log, and the person takes
// or leaves them. Where no host program is behind the page, the log is offered with the command to run.
import type { Board } from './board';
import { byId, download, jointOptions, make } from './dom';
import { valuesOf } from './knowledge';
import type { LiveView } from './live_view';
import { LogTable } from './log_table';
import type { ParameterView } from './parameter_view';

interface Answer {
  status: number;
  said: string;
  lines: string[];
}

const kMostRate = 1; // ms; a slower line does not carry every row

export class TuneView {
  private readonly words = byId('tune-answer');
  private readonly progress = byId<HTMLProgressElement>('tune-progress');
  private text = '';
  private values = new Map<string, string>();
  private running = false;

  constructor(
    private readonly board: Board,
    private readonly served: boolean,
    private readonly live: LiveView,
    private readonly parameters: ParameterView,
  ) {
    const form = byId<HTMLFormElement>('tune-form');
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      if (form.reportValidity()) {
        this.ask();
      }
    });
    byId('tune-yes').addEventListener('click', () => void this.shake());
    byId('tune-no').addEventListener('click', () => this.refuse());
    byId('tune-stop').addEventListener('click', () => this.board.shell.cancel());
    byId('tune-take').addEventListener('click', () => void this.take());
    byId('tune-leave').addEventListener('click', () => this.leave());
    byId('tune-save').addEventListener('click', () => download('capstan_shaken.txt', [this.text], 'text/plain'));
    this.show();
  }

  load(): void {
    jointOptions(byId('tune-joint'), this.board.status?.joints);
  }

  private value(id: string): string {
    return byId<HTMLInputElement>(id).value.trim();
  }

  private show(): void {
    byId<HTMLButtonElement>('tune-run').disabled = this.running;
    byId<HTMLButtonElement>('tune-stop').disabled = !this.running;
    byId('tune-save').hidden = this.text === '' || this.running;
    byId('tune-choice').hidden = this.values.size === 0;
    this.progress.hidden = !this.running;
    const bandwidth = this.value('tune-bandwidth');
    byId('tune-command').textContent = this.served ? '' : `The log can be saved below when it is there; then: capstan tune capstan_shaken.txt --dump capstan_shaken.txt${bandwidth === '' ? '' : ` --bandwidth ${bandwidth}`} --report response, and paste what it prints into Shell. Behind capstan console PORT this page does that.`;
  }

  private ask(): void {
    if (this.running) {
      return;
    }
    if ((this.board.link?.everyMs ?? kMostRate) > kMostRate) {
      this.words.textContent = 'this line is too slow for every row of the log; connect the board by TCP, or see docs/tuning.md for a joint at rest';
      return;
    }
    byId('tune-asks').textContent = `May ${this.value('tune-joint')} move ${this.value('tune-travel')} rad back and forth around its position for ${this.value('tune-duration')} s, while its motor is shaken?`;
    byId('tune-question').hidden = false;
    byId('tune-no').focus();
  }
  private refuse(): void {
    byId('tune-question').hidden = true;
    this.words.textContent = 'nothing moved';
  }

  /** The recording: what the gains are, then the rows. */
  private async shake(): Promise<void> {
    byId('tune-question').hidden = true;
    this.running = true;
    this.text = '';
    this.values.clear();
    byId('tune-report').replaceChildren();
    this.show();
    const joint = this.value('tune-joint');
    const seconds = Number(this.value('tune-duration'));
    await this.live.standBack();
    const dump = await this.board.ask('dump');
    const log = new LogTable(this.live);
    const options = `multisine on=torque amplitude=${this.value('tune-amplitude')}mNm travel=${this.value('tune-travel')} speed=${this.value('tune-speed')} duration=${seconds}`;
    this.words.textContent = `${joint} is shaken …`;
    const shaken = await this.board.ask(`experiment ${joint} ${options}`, (row) => {
      log.take(row);
      this.progress.value = log.rows / (seconds * 1000);
    });
    const refusal = dump.error ?? shaken.error;
    if (refusal === undefined) {
      this.text = `${dump.lines.join('\n')}\n${log.csv}`;
      this.words.textContent = 'recorded';
      await this.judge();
    } else {
      this.words.textContent = log.rows > 0 ? `ended early after ${log.rows} rows: ${refusal}` : refusal;
    }
    this.running = false;
    this.show();
    await this.live.goOn();
  }

  private async judge(): Promise<void> {
    if (!this.served) {
      return;
    }
    this.words.textContent = 'the host program looks at the log …';
    const bandwidth = this.value('tune-bandwidth');
    try {
      const response = await fetch(`tune/${this.value('tune-joint').replace('joint', '')}${bandwidth === '' ? '' : `/${bandwidth}`}`, { method: 'POST', body: this.text }).catch(() => {
        throw new Error('capstan console has gone; start it again and open the address that it prints');
      });
      if (!response.ok) {
        throw new Error((await response.text()).trim());
      }
      await this.found((await response.json()) as Answer);
    } catch (problem) {
      this.words.textContent = problem instanceof Error ? problem.message : String(problem);
    }
  }

  private async found(answer: Answer): Promise<void> {
    byId('tune-said').textContent = answer.said;
    if (answer.status !== 0) {
      this.words.textContent = answer.said.trim().split('\n').at(-1) ?? '';
      return;
    }
    this.values = valuesOf(answer.lines);
    await this.parameters.load();
    byId('tune-table').querySelector('tbody')!.replaceChildren(
      ...[...this.values].map(([name, value]) => {
        const now = this.parameters.find(name);
        return make('tr', {}, make('th', { scope: 'row' }, name), make('td', {}, `${now?.value ?? ''} ${now?.unit ?? ''}`), make('td', {}, value));
      }),
    );
    this.words.textContent = 'gains are found and are not on the board yet: take them or leave them';
    byId('tune-report').append(make('iframe', { src: `report?${Date.now()}`, title: 'frequency response', sandbox: '' }));
  }

  private async take(): Promise<void> {
    const refusal = await this.parameters.take(this.values);
    this.words.textContent = refusal ?? 'the board has these gains now; Parameters undoes or saves them. Record again to see what they reach';
    if (refusal === undefined) {
      this.values.clear();
    }
    this.show();
  }
  private leave(): void {
    this.values.clear();
    this.words.textContent = 'left: the board keeps the gains that it has';
    this.show();
  }
}
