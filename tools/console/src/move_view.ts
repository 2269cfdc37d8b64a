// SPDX-License-Identifier: Apache-2.0
// Moves joints within the limits that the board says it has.
import type { Board } from './board';
import { byId, make } from './dom';
import { parseParameters, type Status } from './knowledge';

const kDegrees = 180 / Math.PI;
const kSteps = [-10, -1, 1, 10];

export class MoveView {
  private joints: string[] = [];
  private readonly angles = new Map<string, HTMLElement>();
  private readonly targets = new Map<string, HTMLInputElement>();

  constructor(
    private readonly board: Board,
    private readonly say: (text: string) => void,
  ) {}

  /** Reads the limits again: they may have been changed. */
  async load(): Promise<void> {
    const joints = this.board.status?.joints.map((joint) => joint.name) ?? [];
    const boxes: HTMLElement[] = [];
    for (const joint of joints) {
      const limits = parseParameters((await this.board.lookUp(`list ${joint}.limits`)).lines);
      const limit = (name: string) => Number(limits.find((one) => one.name === `limits.${name}`)?.value ?? 0) * kDegrees;
      boxes.push(this.box(joint, limit('joint_min'), limit('joint_max')));
      this.aim(joint, (this.board.status?.joints.find((one) => one.name === joint)?.angleRad ?? 0) * kDegrees); // nothing moves by 'Go' alone
    }
    this.joints = joints;
    byId('joints').replaceChildren(...boxes);
    this.show(this.board.status);
  }

  show(status: Status | undefined): void {
    const torque = status !== undefined && this.board.mayHaveTorque;
    byId('joints').querySelectorAll<HTMLButtonElement>('button').forEach((button) => (button.disabled = !torque));
    for (const joint of status?.joints ?? []) {
      const place = this.angles.get(joint.name);
      if (place !== undefined) {
        place.textContent = `${(joint.angleRad * kDegrees).toFixed(2)} deg`;
      }
    }
    if (status !== undefined && status.joints.length !== this.joints.length && !byId('move').hidden) {
      void this.load();
    }
  }

  private box(joint: string, low: number, high: number): HTMLElement {
    const target = make('input', { type: 'range', min: String(Math.ceil(low * 10) / 10), max: String(Math.floor(high * 10) / 10), step: '0.1', value: '0', 'aria-label': `target of ${joint}, degrees` });
    const number = make('output', {}, '0.0 deg');
    target.addEventListener('input', () => (number.textContent = `${Number(target.value).toFixed(1)} deg`));
    const angle = make('output', {}, '');
    this.angles.set(joint, angle);
    this.targets.set(joint, target);
    const button = (text: string, action: () => void) => make('button', { type: 'button', click: action, 'aria-label': `${joint}: ${text}` }, text);
    return make(
      'div',
      { class: 'joint' },
      make('h2', {}, joint, ' at ', angle),
      make('div', { class: 'bar' }, make('span', {}, `${low.toFixed(0)} deg`), target, make('span', {}, `${high.toFixed(0)} deg`)),
      make(
        'div',
        { class: 'bar' },
        button('Go', () => void this.go(joint, Number(target.value))),
        number,
        ...kSteps.map((step) => button(`${step > 0 ? '+' : ''}${step} deg`, () => void this.step(joint, step))),
        button('Hold', () => void this.hold(joint)),
      ),
    );
  }

  private aim(joint: string, degrees: number): void {
    const target = this.targets.get(joint)!;
    target.value = String(degrees);
    target.dispatchEvent(new Event('input'));
  }

  private async go(joint: string, degrees: number): Promise<void> {
    this.say((await this.board.ask(`move ${joint} ${degrees.toFixed(1)} deg`)).error ?? '');
  }
  private async step(joint: string, degrees: number): Promise<void> {
    const target = this.targets.get(joint)!;
    this.aim(joint, Number(target.value) + degrees);
    await this.go(joint, Number(target.value));
  }
  private async hold(joint: string): Promise<void> {
    this.say((await this.board.ask(`hold ${joint}`)).error ?? '');
  }
}
