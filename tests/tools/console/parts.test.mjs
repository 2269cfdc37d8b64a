// SPDX-License-Identifier: Apache-2.0
// node --test parts.test.mjs: the page's parts without a page, against the firmware itself.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { Board } from '../../boards/browser/module.mjs';

const require = createRequire(join(process.env.CAPSTAN_NODE_MODULES, 'any.js'));
const sources = join(dirname(fileURLToPath(import.meta.url)), '../../../tools/console/src');
globalThis.window = globalThis;  // for its timers
async function part(name) {
  const { outputFiles } = await require('esbuild').build({ entryPoints: [join(sources, `${name}.ts`)], bundle: true, write: false, format: 'esm' });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString('base64')}`);
}
const { FrameSplitter, crc16 } = await part('frames');
const { Series } = await part('series');
const { ShellClient } = await part('shell_client');
const knowledge = await part('knowledge');
const { StepTrace, stepFigures } = await part('step_response');

function started() {
  const board = new Board(process.env.CAPSTAN_MODULE);
  assert.equal(board.start(), '');
  return board;
}
const lines = (answer) => answer.split(/\r?\n/).slice(0, -1);
function collector() {
  const got = { text: '', schemas: [], samples: [] };
  const splitter = new FrameSplitter({ text: (text) => (got.text += text), schema: (schema) => got.schemas.push(schema), sample: (tick, values) => got.samples.push([tick, ...values]) });
  return { got, splitter };
}
// TextDecoder's latin1 is windows-1252, which changes bytes; this is the real one.
function bytesOf(board) {
  board.decoder = { decode: (bytes) => Buffer.from(bytes).toString('latin1') };
  return board;
}

test('the CRC is that of the standard', () => assert.equal(crc16(Buffer.from('123456789')), 0x29b1));

/** 300 ms of frames as bytes, with a status in the middle. */
function frames() {
  const board = bytesOf(started());
  board.text = '';
  board.wasm.capstan_receive(board.put('frames 1 joint0.q1 machine.state\n'));
  board.tick(150);
  board.wasm.capstan_receive(board.put('status\n'));
  board.tick(150);
  return Buffer.from(board.text, 'latin1');
}

test('text and frames of the firmware come apart, in pieces of any size', () => {
  const bytes = frames();
  for (const size of [1, 7, 100000]) {
    const { got, splitter } = collector();
    for (let at = 0; at < bytes.length; at += size) splitter.feed(bytes.subarray(at, at + size));
    assert.deepEqual(got.schemas, [{ everyMs: 1, columns: ['axis0/q1_rad', 'state'] }]);
    assert.ok(got.samples.length > 290);
    assert.ok(got.samples.every(([tick], i) => i === 0 || tick === got.samples[i - 1][0] + 1));
    assert.match(got.text, /^ok\r\nstate disarmed .*ok\r\n$/s);
    assert.equal(splitter.damaged, 0);
  }
});

test('a damaged frame is dropped and counted, and nothing else is lost', () => {
  const bytes = Buffer.from(frames());
  const whole = collector();
  whole.splitter.feed(bytes);
  const at = bytes.indexOf(Buffer.from('T\x01', 'latin1'), bytes.length / 2);
  bytes[at + 3] ^= 0x40;
  const { got, splitter } = collector();
  splitter.feed(bytes);
  assert.equal(got.samples.length, whole.got.samples.length - 1);
  assert.equal(got.text, whole.got.text);
  assert.equal(splitter.damaged, 1);
});

test('noise is no sample', () => {
  const { got, splitter } = collector();
  let random = 1;
  splitter.feed(Uint8Array.from({ length: 100000 }, () => (random = (random * 48271) % 2147483647) & 0xff));
  assert.deepEqual(got.samples, []);
});

test('a value below zero stays below zero', () => {
  const board = bytesOf(started());
  board.ask('arm');
  board.ask('move joint0 -30 deg');
  board.tick(3000);
  board.text = '';
  board.wasm.capstan_receive(board.put('frames 1 joint0.q2\n'));
  board.tick(50);
  const { got, splitter } = collector();
  splitter.feed(Buffer.from(board.text, 'latin1'));
  assert.ok(Math.abs(got.samples.at(-1)[1] + Math.PI / 6) < 0.02);
});

test('every parameter, signal, state and fault that the firmware prints is understood', () => {
  const board = started();
  const count = Number(/parameters (\d+)/.exec(board.ask('version'))[1]);
  const parameters = knowledge.parseParameters(lines(board.ask('list')));
  assert.equal(parameters.length, count);
  for (const group of new Set(parameters.map((one) => one.name.split('.')[0]))) knowledge.addHelp(parameters, lines(board.ask(`help ${group}`)));
  for (const one of parameters) {
    assert.ok(one.fallback !== '' && one.when !== '' && one.meaning !== '', JSON.stringify(one));
    assert.equal(one.value, one.fallback, `${one.name} of a new board`);
    assert.ok(Number(one.low) <= Number(one.value) && Number(one.value) <= Number(one.high), one.name);
  }
  assert.deepEqual({ ...parameters.find((one) => one.name === 'limits.current') }, {
    joint: 'joint0', name: 'limits.current', value: '3', unit: 'A', low: '0.001', high: '100', meaning: 'peak current', fallback: '3', when: 'changes while disarmed and in maintenance',
  });
  const answer = lines(board.ask('scope signals'));
  assert.equal(knowledge.parseSignals(answer).length, answer.length);
  assert.equal(knowledge.parseStatus(lines(board.ask('status'))).state, 'disarmed');
  assert.equal(knowledge.parseStatus(['what is this']), undefined);
  assert.ok(knowledge.parseKnown(board.ask('fail ?')).includes('encoder'));
});

test('faults are read with cause and cure', () => {
  const board = started();
  board.ask('fail encoder off');
  board.tick(5);
  const blocked = knowledge.parseFaults(lines(board.ask('arm')))[0];
  assert.equal(blocked.kind, 'blocked by');
  assert.equal(blocked.name, 'sensor_missing');
  assert.match(blocked.cure, /cable/);
});

test('a plot of many samples keeps the smallest and the largest', () => {
  const series = new Series();
  series.reset(['a'], 1);
  for (let i = 0; i < 50000; ++i) series.push(i, [i === 31234 ? 5 : i === 31240 ? -7 : Math.sin(i / 900)]);
  const [times, values] = series.view(0, 50000, 500);
  assert.ok(times.length <= 1000 && times.every((time, i) => i === 0 || time > times[i - 1]));
  assert.equal(Math.max(...values), 5);
  assert.equal(Math.min(...values), -7);
});

test('of one signal against another, both values are of the same sample', () => {
  const series = new Series();
  series.reset(['a', 'b'], 1);
  for (let i = 0; i < 20000; ++i) series.push(i, [Math.sin(i / 7), 3 * Math.sin(i / 7) + 1]);
  const [x, y] = series.pairs(0, 1, 0, 20000, 3000);
  assert.ok(x.length > 1500 && x.length <= 3000, `${x.length}`);
  x.forEach((value, i) => assert.equal(y[i], 3 * value + 1));
});

/** As people without one kind of cone see it: G. M. Machado and others, IEEE TVCG 15 (2009), severity 1. */
const kVision = {
  'everybody': [1, 0, 0, 0, 1, 0, 0, 0, 1],
  'without red cones': [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  'without green cones': [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  'without blue cones': [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};
/** Lightness, and the two colour axes of CIELAB, D65. */
function lab(hex, vision) {
  const linear = [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
  const [r, g, b] = [0, 3, 6].map((row) => Math.min(1, Math.max(0, vision[row] * linear[0] + vision[row + 1] * linear[1] + vision[row + 2] * linear[2])));
  const white = [0.95047, 1, 1.08883];
  const f = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175], [0.0193339, 0.119192, 0.9503041]]
    .map(([x, y, z], i) => (x * r + y * g + z * b) / white[i]).map((t) => (t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 * t + 16) / 116));
  return [116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])];
}

test('the eight lines are told apart by people with any colour vision, in both themes: by colour, or by their dashes', async () => {
  for (const isDark of [false, true]) {
    globalThis.matchMedia = () => ({ matches: isDark });
    const { stroke } = await part('palette');
    const lines = Array.from({ length: 8 }, (_, i) => stroke(i));
    for (const [who, vision] of Object.entries(kVision)) {
      for (let i = 0; i < 8; ++i) {
        for (let k = 0; k < i; ++k) {
          const [a, b] = [lab(lines[i].colour, vision), lab(lines[k].colour, vision)];
          const apart = Math.hypot(...a.map((value, axis) => value - b[axis]));
          assert.ok(apart > 10 || String(lines[i].dash) !== String(lines[k].dash), `${who}, dark ${isDark}: ${k} and ${i} are ${apart.toFixed(1)} apart`);
          assert.ok(i > 3 || apart > 10, `${who}, dark ${isDark}: of the four lines shown at first ${k} and ${i} are ${apart.toFixed(1)} apart`);
        }
      }
    }
  }
});

test('the series forgets what is older than its room, counts what is lost and begins anew with the board', () => {
  const series = new Series();
  series.reset(['a'], 2);
  for (let i = 0; i < 70000; ++i) series.push(2 * i, [i]);
  assert.equal(series.size, 61000);
  assert.equal(series.value(0, 0), 9000);
  assert.equal(series.lost, 0);
  series.push(2 * 70000 + 6, [1]);
  assert.equal(series.lost, 3);
  series.push(4, [2]);
  assert.equal(series.size, 1);
  assert.equal(series.csv(), 'time_s,a\n0.004,2\n');
});

/** A client whose board is this test. */
function talk() {
  const sent = [];
  const client = new ShellClient((text) => sent.push(text));
  return { client, sent };
}
const quiet = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

test('a line waits for the answer before it', async () => {
  const { client, sent } = talk();
  const first = client.ask('one');
  const second = client.ask('two');
  assert.deepEqual(sent, ['one\n']);
  client.receive('capstan> one\r\nvalue\r\n# a remark\r\nok\r');
  client.receive('\n');
  assert.deepEqual(await first, { lines: ['value'] });
  assert.deepEqual(sent, ['one\n', 'two\n']);
  client.receive('error name: sentence; cure\r\n');
  assert.deepEqual(await second, { lines: [], error: 'name: sentence; cure' });
});

test('disarm waits for nothing, what waited is told so, and the answers find their questions again', async () => {
  const { client, sent } = talk();
  const [streaming, waiting] = [client.ask('log joint0 1000'), client.ask('move joint0 1')];
  client.disarm();
  client.disarm();
  assert.equal(sent.slice(1).join(''), '\x03disarm\nversion\n\x03disarm\nversion\n');
  assert.match((await streaming).error, /interrupted/);
  assert.match((await waiting).error, /interrupted/);
  const after = client.ask('status');
  client.receive('1,2,3\r\nerror cancelled: x; y\r\nok\r\ncapstan 0.1.0 board sim\r\nok\r\nok\r\n');
  await quiet(20);
  client.receive('capstan 0.1.0 board sim\r\nok\r\n');
  await quiet(120);
  assert.equal(sent.at(-1), 'status\n');
  client.receive('state disarmed\r\nok\r\n');
  assert.deepEqual(await after, { lines: ['state disarmed'] });
  assert.ok(!sent.includes('move joint0 1\n'), 'no motion comes after all');
});

test('a line that is lost leaves nobody waiting', async () => {
  const { client } = talk();
  const answer = client.ask('status');
  client.lost();
  assert.match((await answer).error, /^line: /);
});

/** A step of 0.02 rad from 0.1 rad, answered as `share` says, sampled every ms. */
function answered(share, ms = 1000) {
  const times = Array.from({ length: ms }, (_, i) => i);
  return stepFigures(times, times.map((t) => 0.1 + 0.02 * share(t / 1000)), 0.1, 0.12);
}

test('overshoot, rise and settling are those of the textbook for systems of first and second order', () => {
  const first = answered((t) => 1 - Math.exp(-t / 0.05));
  assert.equal(first.overshoot, 0);
  assert.ok(Math.abs(first.rise - 50 * Math.log(9)) < 0.1, `${first.rise}`);
  assert.ok(Math.abs(first.settling - 50 * Math.log(20)) < 0.1, `${first.settling}`);
  for (const damping of [0.4, 0.2]) {
    const w = 20;
    const wd = w * Math.sqrt(1 - damping ** 2);
    const y = (t) => 1 - (Math.exp(-damping * w * t) * Math.sin(wd * t + Math.acos(damping))) / Math.sqrt(1 - damping ** 2);
    const second = answered(y, 2000);
    assert.ok(Math.abs(second.overshoot - Math.exp((-Math.PI * damping) / Math.sqrt(1 - damping ** 2))) < 1e-4, `${second.overshoot}`);
    let last = 0;
    for (let t = 0; t < 2; t += 1e-6) last = Math.abs(y(t) - 1) > 0.05 ? t : last;
    assert.ok(Math.abs(second.settling - 1000 * last) < 0.5, `${second.settling} ${last}`);
  }
});

test('a step that is not reached has no rise and does not settle, also downwards', () => {
  const half = answered((t) => 0.5 * Math.min(1, t / 0.1));
  assert.deepEqual([half.rise, half.settling, half.overshoot], [undefined, undefined, 0]);
  const down = stepFigures([0, 1, 2, 3], [0.1, 0.09, 0.07, 0.08], 0.1, 0.08);
  assert.ok(Math.abs(down.overshoot - 0.5) < 1e-9);
});

test('a step begins at the last sample at which its reference stood', () => {
  const trace = new StepTrace();
  for (let i = 0; i < 20; ++i) trace.push(1000 + 2 * i, i < 5 ? 0.1 : 0.12, i < 8 ? 0.1 : 0.12, i === 9 ? -0.004 : 0.001);
  assert.equal(trace.zero, 1008);
  assert.equal(trace.lasted, 1038 - 1008);
  assert.equal(trace.largestTorque, 0.004);
  const { settling } = trace.figures();
  assert.ok(settling > 1014 - 1008 && settling <= 1016 - 1008, `${settling}`);
  const still = new StepTrace();
  for (let i = 0; i < 20; ++i) still.push(i, 0.1, 0.1, 0);
  assert.equal(still.figures(), undefined);
});
