// SPDX-License-Identifier: Apache-2.0
// The simulator's thread: gives the firmware time as it passes and carries its bytes. The page has to say that it is there: if it
// does not, the line counts as lost, and the torque goes as on any board whose console leaves.
import wasm from 'capstan.wasm';
import { FirmwareModule } from './module';
import { kAliveWithinMs, type FromSimulator, type ToSimulator } from './simulator_messages';

const kStepMs = 10;
const kMostUnheard = 200000; // bytes; as fast as it goes is no faster than the page listens
const kMostBehindMs = 100; // a machine that is too slow lets the joint's time pass slower instead of catching up

const post = (message: FromSimulator, transfer: Transferable[] = []) =>
  (self as unknown as { postMessage(message: unknown, transfer: Transferable[]): void }).postMessage(message, transfer);

let firmware: FirmwareModule | undefined;
let running = false;
let waiting = new Uint8Array();
let speed = 1; // Infinity: as fast as it goes
let unheard = 0; // bytes on their way to the page
let lastMs = 0;
let owedMs = 0;
let aliveMs = 0;
let attended = true;

function leave(): void {
  waiting = new Uint8Array();
  firmware?.peerLeft();
}

function step(): void {
  const now = performance.now();
  aliveMs += Math.max(0, now - lastMs - kMostBehindMs); // while this thread slept, nobody was heard
  owedMs = speed === Infinity ? 0 : Math.min(owedMs + (now - lastMs) * speed, Math.max(kMostBehindMs, kStepMs * speed));
  lastMs = now;
  if (firmware === undefined || !running) {
    return;
  }
  if (attended && now - aliveMs > kAliveWithinMs) {
    attended = false;
    leave();
    post({ kind: 'unattended' });
  }
  try {
    if (speed === Infinity) {
      while (performance.now() < now + kStepMs && unheard < kMostUnheard) {
        pass(firmware, kStepMs);
      }
    } else {
      const cycles = Math.floor(owedMs);
      owedMs -= cycles;
      pass(firmware, cycles);
    }
  } catch (problem) {
    running = false;
    post({ kind: 'problem', text: problem instanceof Error ? problem.message : String(problem) });
  }
}

function pass(board: FirmwareModule, cycles: number): void {
  let left = cycles;
  do {
    waiting = waiting.subarray(board.receive(waiting));
    const now = waiting.length > 0 ? Math.min(left, 1) : left; // while somebody waits for room, look after every cycle
    const said = board.tick(now);
    left -= now;
    if (said.length > 0) {
      unheard += said.length;
      post({ kind: 'bytes', bytes: said }, [said.buffer]);
    }
  } while (left > 0);
}

function take(message: ToSimulator): void {
  switch (message.kind) {
    case 'start': {
      const problem = firmware?.start(message.scenario) ?? 'the simulator is not loaded yet; try again';
      running ||= problem === '';
      waiting = problem === '' ? new Uint8Array() : waiting;
      post({ kind: 'started', problem });
      break;
    }
    case 'bytes': {
      const all = new Uint8Array(waiting.length + message.bytes.length);
      all.set(waiting);
      all.set(message.bytes, waiting.length);
      waiting = all;
      break;
    }
    case 'heard':
      unheard -= message.count;
      break;
    case 'alive':
      aliveMs = performance.now();
      attended = true;
      break;
    case 'leave':
      leave();
      break;
    case 'speed':
      speed = message.factor;
      break;
  }
}

self.addEventListener('message', (event: MessageEvent<ToSimulator>) => take(event.data));
void FirmwareModule.load(wasm).then(
  (loaded) => {
    firmware = loaded;
    lastMs = aliveMs = performance.now();
    post({ kind: 'loaded', tables: loaded.tables() });
    setInterval(step, kStepMs);
  },
  (problem: unknown) => post({ kind: 'problem', text: `the simulator does not load (${String(problem)}); use a browser of 2022 or later` }),
);
