// SPDX-License-Identifier: Apache-2.0
// node --test board.test.mjs: the firmware and its plant as WebAssembly, without a page. CAPSTAN_MODULE is the module.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Board } from './module.mjs';

const path = process.env.CAPSTAN_MODULE;
function started(scenario) {
  const board = new Board(path);
  assert.equal(board.start(scenario), '');
  return board;
}
function angle(board, joint = 0) {
  return Number(new RegExp(`^joint${joint} .* joint (\\S+) rad`, 'm').exec(board.ask('status'))[1]);
}

test('boots disarmed and says which board it is', () => {
  const board = started();
  assert.equal(board.state(), 'disarmed none');
  assert.match(board.ask('version'), /^capstan \S+ board sim joints 1 parameters \d+/);
});

test('arms, moves where it was told, disarms', () => {
  const board = started();
  board.ask('arm');
  board.ask('move joint0 30 deg');
  board.tick(3000);
  assert.equal(board.state(), 'holding none');
  assert.ok(Math.abs(angle(board) - Math.PI / 6) < 0.02, `at ${angle(board)} rad`);
  board.ask('disarm');
  assert.equal(board.state(), 'disarmed none');
});

test('does not move unarmed', () => {
  const board = started();
  assert.match(board.ask('move joint0 30 deg'), /^error /);
  board.tick(1000);
  assert.ok(Math.abs(angle(board)) < 0.001);
});

test('time stands still unless somebody ticks', () => {
  const cycles = (board) => Number(/cycles (\d+)/.exec(board.ask('status'))[1]);
  const board = started();
  const before = cycles(board);
  board.tick(500);
  const passed = cycles(board) - before;
  assert.ok(passed >= 500 && passed <= 503, `${passed} cycles`);
});

test('a fault takes the torque and is told with cause and cure', () => {
  const board = started();
  board.ask('arm');
  board.ask('fail encoder off');
  board.tick(20);
  assert.equal(board.state(), 'faulted sensor_missing');
  assert.match(board.ask('faults'), /sensor_missing: .+; .+/);
});

test('who leaves takes the torque along', () => {
  const board = started();
  board.ask('arm');
  board.ask('move joint0 30 deg');
  board.wasm.capstan_peer_left();
  board.tick(2);
  assert.equal(board.state(), 'disarmed none');
});

test('disarm overtakes an answer that streams', () => {
  const board = started();
  board.ask('arm');
  board.text = '';
  board.wasm.capstan_receive(board.put('log joint0 100000\n'));
  board.tick(100);
  board.wasm.capstan_receive(board.put('disarm\n'));
  board.tick(10);
  assert.match(board.text, /ok\r\n$/);
  assert.equal(board.state(), 'disarmed none');
});

test('what is saved outlives a reboot, what is not does not', () => {
  const board = started();
  board.ask('set joint0.control.kp 0.3');
  board.ask('save');
  board.ask('set joint0.control.ki 5');
  board.wasm.capstan_receive(board.put('reboot\n'));
  board.tick(5);
  assert.match(board.text, /ok\r\n# capstan .*, state disarmed\r\n/);
  assert.match(board.ask('get joint0.control.kp'), / 0\.3 /);
  assert.match(board.ask('get joint0.control.ki'), / 4 /);
});

test('characters that find no room are given back', () => {
  const board = started();
  const lines = 'set joint0.control.kp 0.25\n'.repeat(100);
  const taken = board.wasm.capstan_receive(board.put(lines));
  assert.ok(taken > 0 && taken < lines.length);
  assert.equal(board.wasm.capstan_receive(board.put(lines)), 0);
  board.tick(1);
  assert.ok(board.wasm.capstan_receive(board.put(lines)) > 0);
});

test('frames come between the text, one a cycle, none lost', () => {
  const board = started();
  board.ask('frames 1 joint0.q1 joint0.q2');
  board.text = '';
  for (let i = 0; i < 90; ++i) board.tick(10);
  const frames = board.text.split('\0').filter((frame) => frame !== '');
  assert.ok(frames.every((frame) => frame.includes('T\x01')), 'data only: the next schema comes after a second');
  assert.equal(frames.length, 900);
});

test('every built-in instrument starts with all its joints', () => {
  const instruments = started().tables().filter(([kind]) => kind === 'instrument');
  assert.deepEqual(instruments.map((row) => row[1]), ['micro_forceps', 'da_vinci_wrist', 'raven2', 'robot_finger']);
  for (const [, name, axes] of instruments) {
    const board = started(`instrument = "${name}.toml"`);
    assert.match(board.ask('version'), new RegExp(`joints ${axes} `));
    board.tick(10);
    assert.equal(board.state(), 'disarmed none');
  }
});

test('the tables name every state and fault the shell knows', () => {
  const tables = started().tables();
  const states = tables.filter(([kind]) => kind === 'state').map((row) => row[1]);
  assert.ok(states.includes('disarmed') && states.includes('faulted'));
  for (const [, from, , to] of tables.filter(([kind]) => kind === 'transition')) {
    assert.ok(states.includes(from) && states.includes(to), `${from} to ${to}`);
  }
  const board = started();
  board.ask('arm');
  board.ask('fail encoder off');
  board.tick(20);
  const fault = tables.find(([kind, , name]) => kind === 'fault' && name === 'sensor_missing');
  assert.ok(board.ask('faults').includes(fault[3]), 'the same cause as the shell tells');
});

test('an undeclared effect changes the plant, and the firmware is not told', () => {
  const still = started('instrument = "micro_forceps.toml"');
  const worn = started('instrument = "micro_forceps.toml"\n[effects]\nplay = 0.05\n');
  assert.equal(still.ask('dump'), worn.ask('dump'));
});

test('a plant that diverges ends its board by a sentence, and another one starts', () => {
  const board = started('instrument = "micro_forceps.toml"\n[effects]\nstiffness_hardening = 100\n');
  assert.throws(() => {
    board.ask('arm');
    board.ask('move joint0 60 deg');
    board.tick(5000);
  }, /the plant diverged: .*; /);
  assert.equal(board.wasm.capstan_tick(10), 0);
  assert.equal(board.wasm.capstan_receive(board.put('status\n')), 0);
  assert.equal(board.start(), '');
  assert.equal(board.state(), 'disarmed none');
});

test('a scenario that is none is answered by a sentence, and the board before goes on', () => {
  const board = started();
  assert.match(board.start('instrument = "no_such.toml"'), /no_such/);
  assert.match(board.start('what is this'), /scenario:1/);
  assert.equal(board.state(), 'disarmed none');
});
