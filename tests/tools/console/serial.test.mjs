// SPDX-License-Identifier: Apache-2.0
// node --test serial.test.mjs: the page on a serial line, behind which is the firmware as a module of this test. The line is slow to
// answer, echoes as a board's console does, can break and can say anything.
import assert from 'node:assert/strict';
import test, { afterEach } from 'node:test';
import { Board } from '../../boards/browser/module.mjs';
import { arm, armMoveDisarm, eventually, kPatience, message as told, pages, responses, state, type, view } from './browser.mjs';

const rig = pages();
let one;
let board;
afterEach(() => {
  clearInterval(board?.timer);
  passes = (text) => text;
});

/** In the page: a port whose other end is the test. */
function fakeSerial() {
  // A page that goes calls nobody any more: what its port still takes is kept for the test.
  window.addEventListener('pagehide', () => ([window.leaving, localStorage.leaving] = [true, '']), { capture: true });
  const port = {
    async open() {
      if (window.portTaken) throw new Error('Failed to open serial port.');
      this.readable = new ReadableStream({ start: (controller) => (window.port = controller) });
      // As a port does, it takes the bytes at once: what is said last must not wait for an answer to what was said before.
      const write = (bytes) => void (window.leaving ? (localStorage.leaving += String.fromCharCode(...bytes)) : window.toBoard([...bytes]));
      this.writable = new WritableStream({ write });
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
    this.say(passes(this.text));
    this.text = '';
  }
  say(text) {
    if (text !== '') void this.page.evaluate((bytes) => window.port?.enqueue(Uint8Array.from(bytes)), [...Buffer.from(text, 'latin1')]).catch(() => undefined);
  }
}

/** What the board says passes through this. */
let passes = (text) => text;

async function connected(waits = true) {
  one = await rig.open({ script: fakeSerial });
  await one.page.exposeFunction('toBoard', (bytes) => board.receive(bytes));
  board = new SerialBoard(one.page);
  await one.page.click('#serial');
  if (waits) await message('real joints may move');
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

test('tunes over the line: the step response is drawn, a gain is changed meanwhile and undone', async () => {
  await connected();
  await arm(one);
  await view(one, 'move');
  await one.page.waitForSelector('#response-gains input');
  await one.page.click('#response-run');
  await eventually(async () => (await responses(one)).length > 0, 'a response');
  await one.page.fill('[data-gain="control.ki"]', '12');
  await one.page.press('[data-gain="control.ki"]', 'Enter');
  await eventually(async () => (await responses(one)).some((row) => /^ki 12$/.test(row[5])), 'a response with it');
  for (const row of await responses(one)) assert.ok(Math.abs(Math.abs(Number(row[0])) - 2) < 0.05 && Number(row[2]) > 0, row.join());  // the reference still ends as its last samples come
  assert.match(board.heard, /set joint0\.control\.ki 12\n/);
  await one.page.click('#response-undo');
  await one.page.waitForFunction(() => document.getElementById('response-answer').textContent.includes('joint0.control.ki is 4 again'), null, { timeout: kPatience });
  await one.page.click('#disarm');
  await one.page.waitForFunction(() => document.getElementById('response-answer').textContent.startsWith('ended'), null, { timeout: kPatience });
  assert.equal(board.state(), 'disarmed none');
});

test('captures by the scope over the line, and shows a fault of the board with cause and cure', async () => {
  await connected();
  await view(one, 'live');
  await one.page.waitForFunction(() => document.querySelectorAll('#signals button').length > 0, null, { timeout: kPatience });
  await one.page.click('#scope summary');
  await one.page.selectOption('#scope-when', 'fault');
  await one.page.fill('#scope-samples', '200');
  await one.page.fill('#scope-before', '100');
  await one.page.click('#scope-form button[type="submit"]');
  const answer = (part) => one.page.waitForFunction((wanted) => document.getElementById('scope-answer').textContent.includes(wanted), part, { timeout: kPatience });
  await answer('waiting for its trigger');
  await arm(one);
  board.receive(Buffer.from('fail encoder off\n'));  // what happens to a board, happens beside the page
  await state(one, 'faulted by sensor_missing');
  await answer('captured 200 samples');
  await view(one, 'states');
  await one.page.waitForFunction(() => /latched sensor_missing: .*To do: /.test(document.getElementById('faults').textContent), null, { timeout: kPatience });
});

test('a page that is reloaded under torque has disarmed the board on the line, and another page does not get the port', async () => {
  await connected();
  await arm(one);
  const two = await rig.open({ script: fakeSerial });
  await two.page.evaluate(() => (window.portTaken = true));  // a browser opens a port once
  await two.page.click('#serial');
  await told(two, 'the port does not open');
  await one.page.bringToFront();
  await arm(one).catch(() => undefined);  // it lost the focus meanwhile, and with it the torque
  await eventually(() => board.state() === 'holding none', 'torque');
  await one.page.reload();
  board.receive(Buffer.from(await one.page.evaluate(() => localStorage.leaving), 'latin1'));
  await eventually(() => board.state() === 'disarmed none', 'no torque after the page has gone');
  await state(one, 'disarmed');
});

test('a page that goes before its ARM is answered takes it back, whatever an older answer said', async () => {
  await connected();
  const hears = board.receive.bind(board);
  let asked = false;
  board.receive = (bytes) => {
    hears(bytes);
    if (!board.heard.endsWith('status\n')) return;
    asked = true;
    clearInterval(board.timer);
  };
  await eventually(() => asked, 'a question that is not answered yet');
  await one.page.click('#arm');
  await one.page.click('#arm-confirm');
  await eventually(() => board.heard.includes('arm\n') || (board.step(), false), 'ARM, after the answer that the board is disarmed');
  await one.page.reload();
  assert.match(await one.page.evaluate(() => localStorage.leaving), /\x03disarm\n/);
});

test('a board of another version is told', async () => {
  passes = (text) => text.replace(/capstan \S+ board/, 'capstan 9.9.9 board');
  await connected(false);
  await message("the board's firmware is version 9.9.9, this page is of ");
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
