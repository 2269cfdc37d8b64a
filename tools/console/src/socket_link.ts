// SPDX-License-Identifier: Apache-2.0
// A board behind `capstan console`, by a WebSocket to where this page came from. Binary messages are the board's bytes, texts are what
// the two programs say to each other (tools/console_server/hub.hpp).
import { kAliveWithinMs } from './simulator_messages';
import type { Link, LinkEvents } from './link';

export interface SocketEvents extends LinkEvents {
  /** This page commands the board from now on, or only looks. */
  role(looks: boolean): void;
  /** Something urgent of another page came between: answers that are waited for may never come. */
  cancelled(): void;
  remark(text: string): void;
  /** `capstan commission` says this (tools/console_server/commission_talk.hpp). */
  commission(words: string): void;
}

const kSayTook = 16384; // bytes

export class SocketLink implements Link {
  readonly name = 'capstan console';
  readonly simulated = false;
  everyMs = 10;
  private readonly socket: WebSocket;
  private readonly heart: number;
  private ended = false;
  private took = 0; // bytes that the server was not told of
  /** The board is a simulator of capstan console, which can start it anew with an effect. */
  startsAnew = false;
  private begun: ((problem: string) => void) | undefined;

  constructor(private readonly events: SocketEvents) {
    this.socket = new WebSocket(new URL('board', window.location.href.replace(/^http/, 'ws')));
    this.socket.binaryType = 'arraybuffer';
    this.socket.addEventListener('message', (event: MessageEvent<ArrayBuffer | string>) => {
      if (typeof event.data === 'string') {
        this.take(event.data);
      } else {
        this.events.bytes(new Uint8Array(event.data));
        this.tookBytes(event.data.byteLength);
      }
    });
    this.socket.addEventListener('close', () => this.lost('capstan console has gone; start it again and open the address that it prints'));
    this.heart = window.setInterval(() => this.say('alive'), kAliveWithinMs / 5);
  }

  send(bytes: Uint8Array): void {
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(bytes as Uint8Array<ArrayBuffer>);
    }
  }
  leave(): void {
    this.say('leave');
  }
  disarm(): void {
    this.say('disarm');
  }
  /** This page wants to command; the torque goes first. */
  askForCommand(): void {
    this.say('take');
  }
  /** Starts the simulated board anew, with an effect ("play=0.03") or without; resolves to why not. */
  startAnew(effect: string): Promise<string> {
    return new Promise((resolve) => {
      this.begun = resolve;
      this.say(`anew ${effect}`);
    });
  }
  /** To `capstan commission` on this board. */
  commission(words: string): void {
    this.say(`commission ${words}`);
  }
  close(): void {
    this.ended = true;
    window.clearInterval(this.heart);
    this.socket.close();
  }

  /** The server hears a board later whose page is behind (tools/console_server/backlog.hpp), and counts what the page has worked through. */
  private tookBytes(count: number): void {
    this.took += count;
    if (this.took >= kSayTook) {
      this.say(`took ${this.took}`);
      this.took = 0;
    }
  }
  private say(word: string): void {
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(word);
    }
  }
  private take(words: string): void {
    const [word = '', rest = ''] = /^(\w+) ?(.*)$/s.exec(words)?.slice(1) ?? [];
    if (word === 'command' || word === 'look') {
      const [every, anew] = rest.split(' ');
      this.everyMs = Number(every);
      this.startsAnew = anew === 'anew';
      this.events.role(word === 'look');
    } else if (word === 'anew') {
      this.begun?.(rest);
    } else if (word === 'cancel') {
      this.events.cancelled();
    } else if (word === 'remark') {
      this.events.remark(rest);
    } else if (word === 'commission') {
      this.events.commission(rest);
    } else if (word === 'lost') {
      this.lost(rest);
    }
  }
  private lost(why: string): void {
    if (!this.ended) {
      this.close();
      this.events.lost(why);
    }
  }
}
