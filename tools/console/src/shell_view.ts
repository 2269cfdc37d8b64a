// SPDX-License-Identifier: Apache-2.0
// The board's console itself: everything it says, and a line to type.
import type { Board } from './board';
import { byId } from './dom';

const kMostCharacters = 200000;
const kMostHistory = 100;

export class ShellView {
  private readonly out = byId('console');
  private readonly line = byId<HTMLInputElement>('line');
  private readonly history: string[] = [];
  private at = 0;
  private text = '';
  private due = false;

  constructor(private readonly board: Board) {
    byId('shell-form').addEventListener('submit', (event) => {
      event.preventDefault();
      void this.send(this.line.value);
      this.line.value = '';
    });
    byId('cancel').addEventListener('click', () => this.cancel());
    this.line.addEventListener('keydown', (event) => this.key(event));
  }

  show(text: string): void {
    this.text = `${this.text}${text}\n`.slice(-kMostCharacters);
    if (!this.due) {
      this.due = true;
      window.setTimeout(() => this.draw(), 50);
    }
  }

  private draw(): void {
    this.due = false;
    const atEnd = this.out.scrollTop + this.out.clientHeight > this.out.scrollHeight - 30;
    this.out.textContent = this.text;
    if (atEnd) {
      this.out.scrollTop = this.out.scrollHeight;
    }
  }

  private cancel(): void {
    this.show('^C');
    this.board.shell.cancel();
  }

  private key(event: KeyboardEvent): void {
    if (event.key === 'c' && event.ctrlKey && this.line.selectionStart === this.line.selectionEnd) {
      event.preventDefault();
      this.cancel();
    } else if (event.key === 'ArrowUp' || event.key === 'ArrowDown') {
      event.preventDefault();
      this.at = Math.max(0, Math.min(this.history.length, this.at + (event.key === 'ArrowUp' ? -1 : 1)));
      this.line.value = this.history[this.at] ?? '';
    }
  }

  private async send(line: string): Promise<void> {
    if (this.history.at(-1) !== line && !line.startsWith('maintenance')) {
      this.history.push(line);
      this.history.splice(0, this.history.length - kMostHistory);
    }
    this.at = this.history.length;
    this.show(`capstan> ${line.startsWith('maintenance') ? 'maintenance ***' : line}`);
    if (line.trim() === 'disarm') {
      this.board.disarm(); // waits for nothing, as at a terminal
      return;
    }
    if (line.trim().split(/\s+/)[0] === 'arm') {
      this.show('arm by the buttons above: it takes two actions there');
      return;
    }
    const answer = await this.board.ask(line, (said) => this.show(said));
    this.show(answer.error === undefined ? 'ok' : `error ${answer.error}`);
  }
}
