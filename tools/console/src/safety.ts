// SPDX-License-Identifier: Apache-2.0
// DISARM by every way there is, and ARM by two actions with the page in front.
import type { Board } from './board';
import { byId } from './dom';

const kArmWithinMs = 3000;

/** Whether a key that is pressed there is typed. */
function types(target: EventTarget | null): boolean {
  return target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && !['checkbox', 'radio', 'range', 'button'].includes(target.type));
}

export class Safety {
  private readonly arm = byId<HTMLButtonElement>('arm');
  private readonly confirm = byId<HTMLButtonElement>('arm-confirm');
  private timer = 0;
  private swallowing = false;

  constructor(
    private readonly board: Board,
    private readonly say: (text: string) => void,
    private readonly refused: (lines: string[], error: string) => void,
  ) {
    byId('disarm').addEventListener('click', () => this.disarm('DISARM'));
    this.arm.addEventListener('click', () => this.offer());
    this.confirm.addEventListener('click', () => void this.give());
    // Before anything else of the page sees the key: the space bar would otherwise press a button again.
    window.addEventListener('keydown', (event) => this.key(event), { capture: true });
    window.addEventListener('keyup', (event) => this.swallow(event), { capture: true });
    window.addEventListener('blur', () => this.away('the page lost focus'));
    document.addEventListener('visibilitychange', () => {
      if (document.hidden) {
        this.away('the page was hidden');
      }
    });
    window.addEventListener('pagehide', () => this.away('the page was left'));
  }

  disarm(why: string): void {
    this.withdraw();
    if (this.board.link === undefined) {
      return;
    }
    this.board.disarm();
    this.say(`torque taken away: ${why}`);
  }

  private away(why: string): void {
    this.withdraw();
    if (this.board.mayHaveTorque && this.board.link !== undefined && (!this.board.looking || this.board.guided)) {
      this.disarm(why);
      this.board.link?.leave();
    }
  }

  private key(event: KeyboardEvent): void {
    const escape = event.key === 'Escape';
    if (!escape && (event.key !== ' ' || types(event.target))) {
      return;
    }
    if (this.board.mayHaveTorque) {
      event.preventDefault();
      event.stopPropagation();
      this.swallowing = true;
      this.disarm(escape ? 'Escape' : 'space bar');
    } else if (escape) {
      this.withdraw();
    }
  }
  /** A button is pressed when the space bar is let go. */
  private swallow(event: KeyboardEvent): void {
    if (this.swallowing && event.key === ' ') {
      event.preventDefault();
      event.stopPropagation();
    }
    this.swallowing = false;
  }

  /** The first of two actions. */
  private offer(): void {
    window.clearTimeout(this.timer);
    this.confirm.disabled = false;
    this.confirm.focus();
    this.timer = window.setTimeout(() => this.withdraw(), kArmWithinMs);
  }
  private withdraw(): void {
    window.clearTimeout(this.timer);
    this.confirm.disabled = true;
  }

  private async give(): Promise<void> {
    this.withdraw();
    if (!document.hasFocus() || document.hidden) {
      this.say('not armed: the page is not in front');
      return;
    }
    const answer = await this.board.arm();
    if (answer.error !== undefined) {
      this.refused(answer.lines, answer.error);
    }
  }

  /** What may be pressed now. */
  show(connected: boolean, torque: boolean): void {
    const not = !connected || torque || this.board.looking;
    this.arm.disabled = not;
    if (not) {
      this.withdraw();
    }
  }
}
