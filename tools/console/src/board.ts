// SPDX-License-Identifier: Apache-2.0
// The board that the page is connected to: its line, its shell, its frames, and how it stands.
import { FrameSplitter, type Schema } from './frames';
import { parseStatus, type Status } from './knowledge';
import type { Link, LinkEvents } from './link';
import { ShellClient, type Answer } from './shell_client';

const kStatusEveryMs = 150;
/** After this without `disarmed`, DISARM is sent again and the line is left. */
const kDisarmWithinMs = 500;

export interface BoardEvents {
  /** Something was learned of the state; `undefined`: nothing is known any more. */
  status(status: Status | undefined): void;
  schema(schema: Schema): void;
  sample(tick: number, values: number[]): void;
  /** What the board says by itself. */
  remark(text: string): void;
  connected(): void;
  lost(why: string): void;
}

export class Board {
  readonly shell: ShellClient;
  status: Status | undefined;
  /** Until the board has said that it has none. */
  mayHaveTorque = true;
  link: Link | undefined;
  /** Another page commands; this one sees what the board tells that one. */
  looking = false;
  /** It is a program that this page has started, which commands meanwhile: the torque is as good as this page's. */
  guided = false;
  /** States without torque, from the firmware's table; whatever else a board says may have it. */
  safeStates = new Set<string>();
  private readonly frames: FrameSplitter;
  private poll = 0;
  private insist = 0;
  private asking = false;
  /** Until the board has answered `arm`, a status that was asked before it says nothing of the torque. */
  private arming = false;

  constructor(private readonly events: BoardEvents) {
    this.shell = new ShellClient((text) => this.link?.send(Uint8Array.from(text, (c) => c.charCodeAt(0))));
    this.shell.onRemark = (line) => events.remark(line);
    this.shell.onOverheard = (lines) => this.looking && this.learn(lines.slice(lines.findIndex((line) => line.startsWith('state '))));
    this.frames = new FrameSplitter({
      text: (text) => this.shell.receive(text),
      schema: (schema) => events.schema(schema),
      sample: (tick, values) => events.sample(tick, values),
    });
  }

  /** What a line is to tell this board; it is heard while it is the one attached. */
  eventsOf(link: () => Link): LinkEvents {
    const heard = () => this.link !== undefined && this.link === link();
    return {
      bytes: (bytes) => heard() && this.frames.feed(bytes),
      lost: (why) => heard() && this.lost(why),
    };
  }

  /** Takes the torque away and lets go of the line. */
  async detach(): Promise<void> {
    const link = this.link;
    if (link !== undefined) {
      if (!this.looking) {
        this.shell.disarm();
        link.leave();
      }
      this.lost('');
      if (!link.simulated) {
        await link.close();
      }
    }
  }

  attach(link: Link, looking = false): void {
    this.link = link;
    this.looking = looking;
    this.mayHaveTorque = true;
    window.clearInterval(this.poll);
    if (looking) {
      this.shell.lost(); // whatever was asked is the other page's now
      this.frames.expectSchema();
      if (this.guided) {
        this.events.status({ state: 'commissioning', fault: 'none', cycles: 0, joints: [] });
      }
    } else {
      this.shell.cancel(); // whatever was half said before
      this.poll = window.setInterval(() => void this.askStatus(), kStatusEveryMs);
    }
    this.events.connected();
  }

  ask(line: string, heard?: (line: string) => void): Promise<Answer> {
    if (this.link === undefined || this.looking) {
      const error = this.link === undefined ? 'line: no board is connected; connect one' : 'looking: another page commands this board; take the command first';
      return Promise.resolve({ lines: [], error });
    }
    return this.shell.ask(line, heard);
  }

  /** Asks what changes nothing, and again where something urgent came between: DISARM, or a board that was slow to answer. */
  async lookUp(line: string): Promise<Answer> {
    const { link } = this;
    for (;;) {
      const answer = await this.ask(line);
      if (answer.error?.startsWith('interrupted: ') !== true || this.link !== link || this.looking) {
        return answer;
      }
    }
  }

  /** Frames are about to begin. */
  expectSchema(): void {
    this.frames.expectSchema();
  }

  /** Gives torque. Who calls it has seen to it that the operator means it. */
  async arm(): Promise<Answer> {
    this.mayHaveTorque = true;
    this.arming = true;
    const answer = await this.ask('arm');
    this.arming = false;
    await this.askStatus();
    return answer;
  }

  /** Takes the torque away, whatever is under way. */
  disarm(): void {
    if (this.link === undefined) {
      return;
    }
    this.mayHaveTorque = true;
    if (this.looking) {
      this.link.disarm?.();
      return;
    }
    this.shell.disarm();
    void this.askStatus(true);
    window.clearTimeout(this.insist);
    this.insist = window.setTimeout(() => {
      if (this.mayHaveTorque && this.link !== undefined) {
        this.shell.disarm();
        this.link.leave();
      }
    }, kDisarmWithinMs);
  }

  async askStatus(now = false): Promise<void> {
    if (this.asking && !now) {
      return;
    }
    this.asking = true;
    const { lines } = await this.ask('status');
    this.asking = false;
    this.learn(lines);
  }

  private learn(lines: string[]): void {
    const status = parseStatus(lines);
    if (status !== undefined) {
      this.status = status;
      this.mayHaveTorque = this.guided || this.arming || !this.safeStates.has(status.state); // a program gives it again by itself
      if (!this.mayHaveTorque) {
        window.clearTimeout(this.insist);
      }
      this.events.status(this.guided && status.state === 'disarmed' ? { ...status, state: 'commissioning' } : status);
    }
  }

  private lost(why: string): void {
    const left = why !== '' && this.mayHaveTorque && this.link?.simulated === false;
    window.clearInterval(this.poll);
    window.clearTimeout(this.insist);
    this.link = undefined;
    this.looking = false;
    this.status = undefined;
    this.mayHaveTorque = false;
    this.shell.lost();
    this.events.status(undefined);
    this.events.lost(left ? `${why}. The joints may still have torque: press the emergency stop` : why);
  }
}
