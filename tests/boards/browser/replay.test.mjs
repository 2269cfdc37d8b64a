// SPDX-License-Identifier: Apache-2.0
// node --test replay.test.mjs: the recorded four-axis run gives the same bytes as on this machine. CAPSTAN_REPLAY is the module,
// CAPSTAN_FIXTURE the host's program, CAPSTAN_SECONDS how long the run is.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import test, { after } from 'node:test';
import { load } from './module.mjs';

const seconds = Number(process.env.CAPSTAN_SECONDS);
const folder = mkdtempSync(join(tmpdir(), 'capstan-replay-'));
after(() => rmSync(folder, { recursive: true }));
console.log(execFileSync(process.env.CAPSTAN_FIXTURE, [String(seconds), join(folder, 'input'), join(folder, 'output')]).toString());
const input = readFileSync(join(folder, 'input'));
const expected = readFileSync(join(folder, 'output'));

function replay(bytes) {
  const wasm = load(process.env.CAPSTAN_REPLAY);
  const place = wasm.replay_input(bytes.length);
  new Uint8Array(wasm.memory.buffer, place, bytes.length).set(bytes);
  const began = performance.now();
  const result = wasm.replay_run();
  const took = (performance.now() - began) / 1000;
  return { result, took, output: Buffer.from(wasm.memory.buffer, wasm.replay_output(), wasm.replay_output_size()) };
}

test('the same bytes as on the host', () => {
  assert.ok(expected.length > seconds * 1000 * 100, 'the run is too short to prove anything');
  const { result, took, output } = replay(input);
  assert.equal(result, 0);
  assert.equal(output.compare(expected), 0);
  console.log(`${seconds * 1000} cycles agree bit for bit; ${(1e6 * took / seconds / 1000).toFixed(1)} us each`);
});

test('one changed bit of one sensor value shows', () => {
  const changed = Buffer.from(input);
  const axes = changed.readUInt32LE(4);
  changed[12 + 4 * axes * changed.readUInt32LE(8) + (5 + 34 * axes) * 8000 + 5] ^= 1;  // an encoder's lowest byte (cycle_replay.hpp)
  assert.notEqual(replay(changed).output.compare(expected), 0);
});

test('a file that is none is refused', () => {
  assert.equal(replay(Buffer.from('this is no recorded run')).result, 10);
  assert.equal(replay(input.subarray(0, input.length - 1)).result, 11);
});
