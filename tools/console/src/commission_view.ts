// SPDX-License-Identifier: Apache-2.0
// `capstan commission` on the board behind `capstan console`, step by step: what it explains, asks and finds. Where no host program is
// behind the page, the command to run.
import type { Board } from './board';
import { byId, download, jointOptions, make } from './dom';

/** What of a link can be told to start a commissioning. */
export interface Commissioner {
  /** Says it to the host program: "start {...}", "answer yes", "answer no", "stop". */
  commission(words: string): void;
}

/** Steps and findings: "shake: explains", and below it "  what was found". */
const kStep = /^(\w+): (.*)$/;

export class CommissionView {
  /** From the start until the program has ended. */
  running = false;
  private readonly words = byId('commission-answer');
  private readonly steps = byId('commission-steps');
  private readonly question = byId('commission-question');
  private machine = '';
  private begun = 0;
  private timer = 0;

  /** @param link  to the host program; nothing where none is behind the page */
  constructor(
    private readonly board: Board,
    private readonly link: () => Commissioner | undefined,
    private readonly served: boolean,
    private readonly prepare: () => Promise<void>,
  ) {
    const form = byId<HTMLFormElement>('commission-form');
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      if (form.reportValidity()) {
        void this.start();
      }
    });
    form.addEventListener('input', () => this.showCommand());
    byId('commission-stop').addEventListener('click', () => this.link()?.commission('stop'));
    byId('commission-yes').addEventListener('click', () => this.answer(true));
    byId('commission-no').addEventListener('click', () => this.answer(false));
    byId('commission-machine').addEventListener('click', () => download('machine.toml', [this.machine], 'text/plain'));
    this.showCommand();
    this.show();
  }

  load(): void {
    jointOptions(byId('commission-joint'), this.board.status?.joints);
  }

  private value(id: string): string {
    return byId<HTMLInputElement>(id).value.trim();
  }
  private get axis(): number {
    return Number(this.value('commission-joint').replace('joint', ''));
  }

  private showCommand(): void {
    const inertia = this.value('commission-inertia');
    byId('commission-command').textContent = this.served
      ? ''
      : `A host program does this: capstan console PORT shows it on this page, or by itself capstan commission PORT --axis ${this.axis} --corridor ${this.value('commission-corridor')}${inertia === '' ? '' : ` --inertia ${inertia}`} --report page`;
  }

  private show(): void {
    byId<HTMLButtonElement>('commission-start').disabled = this.running || !this.served;
    byId<HTMLButtonElement>('commission-stop').disabled = !this.running;
    byId('commission-machine').hidden = this.running || this.machine === '';
  }

  private async start(): Promise<void> {
    const link = this.link();
    if (this.running || link === undefined || this.board.looking || this.board.link === undefined) {
      this.words.textContent = this.running ? 'it is under way' : 'no board is commanded by this page; connect one, or take the command';
      return;
    }
    this.running = true;
    this.board.guided = true;
    this.machine = '';
    this.steps.replaceChildren();
    byId('commission-report').replaceChildren();
    this.words.textContent = 'the host program begins …';
    this.begun = performance.now();
    this.timer = window.setInterval(() => this.tick(), 1000);
    this.show();
    await this.prepare();
    const inertia = this.value('commission-inertia');
    const asked = {
      axis: this.axis,
      corridor: Number(this.value('commission-corridor')),
      ...(inertia === '' ? {} : { inertia: Number(inertia) }),
      key: byId<HTMLInputElement>('commission-key').value,
      again: byId<HTMLInputElement>('commission-again').checked,
    };
    byId<HTMLInputElement>('commission-key').value = '';
    link.commission(`start ${JSON.stringify(asked)}`);
  }

  private tick(): void {
    byId('commission-time').textContent = `${Math.round((performance.now() - this.begun) / 1000)} s`;
  }

  private answer(yes: boolean): void {
    this.question.hidden = true;
    this.link()?.commission(`answer ${yes ? 'yes' : 'no'}`);
  }

  /** What the host program says. */
  hear(words: string): void {
    const [, word, rest = ''] = /^(\w+) (.*)$/s.exec(words) ?? [];
    if (word === 'said') {
      this.said(rest);
    } else if (word === 'asks') {
      byId('commission-asks').textContent = rest;
      this.question.hidden = false;
      byId('commission-no').focus();
    } else if (word === 'ended') {
      const { status, machine, response } = JSON.parse(rest) as { status: number; machine: string; response?: boolean };
      this.ended(status, machine, response === true);
    }
  }

  private said(line: string): void {
    const step = kStep.exec(line);
    const problem = line.startsWith('capstan: ');
    if (step !== null && !problem) {
      this.steps.append(make('li', {}, make('strong', {}, step[1]!), `: ${step[2]!}`, make('ul')));
    } else {
      const place = problem ? null : this.steps.querySelector(':scope > li:last-child > ul');
      (place ?? this.steps).append(make('li', problem ? { class: 'refusal' } : {}, line.trim()));
    }
    this.words.textContent = problem ? line.slice('capstan: '.length) : line.trim();
  }

  private ended(status: number, machine: string, response: boolean): void {
    this.running = false;
    this.board.guided = false;
    this.question.hidden = true;
    this.machine = status === 0 ? machine : '';
    window.clearInterval(this.timer);
    if (status === 0) {
      this.words.textContent = 'done: the joint has its gains, and its torque is off. What was found is below';
      const frame = (name: string, title: string) => make('iframe', { src: `${name}?${Date.now()}`, title, sandbox: '' });
      byId('commission-report').append(frame('commission_report', 'report of commissioning'), ...(response ? [frame('response/index.html', 'frequency response of commissioning')] : []));
    }
    this.show();
  }

  /** The line is gone, and the program with it. */
  lost(): void {
    if (this.running) {
      this.ended(-1, '', false);
      this.words.textContent = 'ended: the line to capstan console is gone';
    }
  }
}
