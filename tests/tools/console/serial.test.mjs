// SPDX-License-Identifier: Apache-2.0
// node --test serial.test.mjs: the page on a serial line, behind which is the firmware as a module of this test. The line is slow to
// answer, echoes as a board's console does, can break and can say anything.
import assert from 'node:assert/strict';
import test, { afterEach } from 'node:test';
import { Board } from '../../boards/browser/module.mjs';
import { arm, armMoveDisarm, kPatience, message as told, pages, state, type, view } from './browser.mjs';

const rig = pages();
let one;
let board;
afterEach(() => clearInterval(board?.timer));

/** In the page: a port whose other end is the test. */
function fakeSerial() {
  const port = {
    async open() {
      if (window.portTaken) throw new Error('Failed to open serial port.');
      this.readable = new ReadableStream({ start: (controller) => (window.port = controller) });
      this.writable = new WritableStream({ write: (bytes) => window.toBoard([...bytes]) });
    },
    async close() { window.portClosed = true; },
  };
  Object.defineProperty(navigator, 'serial', { value: { requestPort: async () => port } });
}

/** The board behind the line, 1 ms of it every ms. */
class SerialBoard extends Board {
  constructor(page) {
    super(process.env.CAPSTAN_MODULE);
    this.decoder = { decode: (bytes) => Buffer.from(bytes).toString('latin1') };
    this.start();
    this.page = page;
    this.waiting = '';
    this.heard = '';
    this.last = performance.now();
    this.timer = setInterval(() => this.step(), 20);
  }
  receive(bytes) {
    const text = String.fromCharCode(...bytes);
    this.waiting += text;
    this.heard += text;
    this.say(text.replace('\x03', '').replaceAll('\n', '\r\n'));
  }
  step() {
    const now = performance.now();
    const cycles = Math.min(100, Math.floor(now - this.last));
    this.last += cycles;
    for (let i = 0; i < cycles; ++i) {
      this.waiting = this.waiting.slice(this.wasm.capstan_receive(this.put(this.waiting)));
      this.tick(1);
    }
    this.say(this.text);
    this.text = '';
  }
  say(text) {
    if (text !== '') void this.page.evaluate((bytes) => window.port?.enqueue(Uint8Array.from(bytes)), [...Buffer.from(text, 'latin1')]).catch(() => undefined);
  }
}

async function connected() {
  one = await rig.open({ script: fakeSerial });
  await one.page.exposeFunction('toBoard', (bytes) => board.receive(bytes));
  board = new SerialBoard(one.page);
  await one.page.click('#serial');
  await message('real joints may move');
  await state(one, 'disarmed');
}
const message = (part) => told(one, part);

test('arms, moves and disarms a board on a serial line, and shows its signals', async () => {
  await connected();
  await one.page.waitForFunction(() => /one every 10 ms/.test(document.getElementById('rate').textContent), null, { timeout: kPatience });
  assert.ok(await one.page.isHidden('#tab-break'), 'a board is not broken by a click');
  await armMoveDisarm(one);
  assert.match(board.heard, /move joint0 10\.0 deg\n/);
});

test('a page that loses focus disarms over the line', async () => {
  await connected();
  await arm(one);
  await one.page.evaluate(() => window.dispatchEvent(new Event('blur')));
  await state(one, 'disarmed');
  assert.match(board.heard, /\x03disarm\n/);
});

test('a line that breaks is told, and the page says nothing more of a state', async () => {
  await connected();
  await arm(one);
  await one.page.evaluate(() => window.port.error(new Error('The device has been lost.')));
  await message('the serial line is gone (The device has been lost.); check the cable');
  await message('may still have torque: press the emergency stop');
  assert.equal(await one.page.textContent('#state'), 'not connected');
  assert.ok(await one.page.isDisabled('#arm'));
});

test('garbage on the line is no state, no sample and no end', async () => {
  await connected();
  await view(one, 'live');
  let random = 7;
  const garbage = Array.from({ length: 5000 }, () => (random = (random * 48271) % 2147483647) & 0xff);
  await one.page.evaluate((bytes) => window.port.enqueue(Uint8Array.from(bytes)), garbage);
  await one.page.waitForTimeout(300);
  await arm(one);
  await one.page.click('#disarm');
  await state(one, 'disarmed');
});

test('a line on which nobody answers is told', async () => {
  await connected();
  clearInterval(board.timer);
  await view(one, 'shell');
  await one.page.waitForFunction(() => document.getElementById('console').textContent.includes('no answer within 5 s'), null, { timeout: kPatience });
});

test('a port that is taken is told', async () => {
  one = await rig.open({ script: fakeSerial });
  await one.page.evaluate(() => (window.portTaken = true));
  await one.page.click('#serial');
  await message('the port does not open (Failed to open serial port.); see that no other program has it');
});

test('choosing an instrument disarms the board, lets go of the port and leads back to the simulator', async () => {
  await connected();
  await arm(one);
  await one.page.selectOption('#instrument', 'robot_finger');
  await one.page.waitForFunction(() => window.portClosed, null, { timeout: kPatience });
  await state(one, 'disarmed');
  assert.match(await type(one, 'version'), /joints 2 /);
  board.step();
  assert.equal(board.state(), 'disarmed none');
});
