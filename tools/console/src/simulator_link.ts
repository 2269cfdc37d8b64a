// SPDX-License-Identifier: Apache-2.0
// The simulator in a worker of this page. Its program is part of this file, so that the page also works from a folder, without a server.
import workerSource from 'capstan.worker';
import type { Link, LinkEvents } from './link';
import { kAliveWithinMs, type FromSimulator, type ToSimulator } from './simulator_messages';

export class SimulatorLink implements Link {
  readonly name = 'simulator';
  readonly simulated = true;
  readonly everyMs = 1;
  private readonly worker: Worker;
  private readonly heart: number;
  private loaded!: (tables: string) => void;
  private started: ((problem: string) => void) | undefined;
  /** The firmware's own tables, once it is loaded. */
  readonly tables = new Promise<string>((resolve) => (this.loaded = resolve));

  constructor(private readonly events: LinkEvents) {
    const address = URL.createObjectURL(new Blob([workerSource], { type: 'text/javascript' }));
    this.worker = new Worker(address);
    URL.revokeObjectURL(address);
    this.worker.addEventListener('message', (event: MessageEvent<FromSimulator>) => this.take(event.data));
    this.worker.addEventListener('error', () => events.lost('the simulator stopped; reload the page'));
    this.heart = window.setInterval(() => this.post({ kind: 'alive' }), kAliveWithinMs / 5);
  }

  /** Starts with a scenario; resolves to a sentence if it is none. */
  start(scenario: string): Promise<string> {
    return new Promise((resolve) => {
      this.started = resolve;
      this.post({ kind: 'start', scenario });
    });
  }
  setSpeed(factor: number): void {
    this.post({ kind: 'speed', factor });
  }
  send(bytes: Uint8Array): void {
    this.post({ kind: 'bytes', bytes });
  }
  leave(): void {
    this.post({ kind: 'leave' });
  }
  close(): void {
    window.clearInterval(this.heart);
    this.worker.terminate();
  }

  private post(message: ToSimulator): void {
    this.worker.postMessage(message);
  }
  private take(message: FromSimulator): void {
    switch (message.kind) {
      case 'loaded':
        this.loaded(message.tables);
        break;
      case 'started':
        this.started?.(message.problem);
        break;
      case 'bytes':
        this.post({ kind: 'heard', count: message.bytes.length });
        this.events.bytes(message.bytes);
        break;
      case 'unattended':
        this.events.bytes(new TextEncoder().encode('# no page answered for a second: the connection counts as lost, and the torque is off\r\n'));
        break;
      case 'problem':
        this.events.lost(message.text);
        break;
    }
  }
}
