// SPDX-License-Identifier: Apache-2.0
// `capstan console` and boards behind it, as processes of a test.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { createServer, connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const installed = createRequire(join(process.env.CAPSTAN_NODE_MODULES, 'any.js'));
const { FoxgloveClient } = installed('@foxglove/ws-protocol');
const { WebSocket } = installed('ws');
const program = process.env.CAPSTAN_PROGRAM;
const motorBoard = process.env.CAPSTAN_MOTOR_BOARD ?? '';
const folders = [];
const running = new Set();
const proxies = [];

/** Starts the program and waits until it says something of this form; resolves to what was found. */
export function start(words, form, what = program) {
  const child = spawn(what, words, { detached: true });  // a group, so that what it starts ends with it
  running.add(child);
  child.on('exit', () => running.delete(child));
  let said = '';
  const ended = new Promise((resolve) => child.on('close', (status, signal) => resolve({ status, signal, said })));
  return new Promise((resolve, reject) => {
    const hear = (part) => {
      said += part;
      const found = form.exec(said);
      if (found !== null) resolve({ child, ended, found });
    };
    child.stdout.on('data', hear);
    child.stderr.on('data', hear);
    child.on('close', (status) => reject(new Error(`ended with ${status}: ${said}`)));
  });
}

/** The page's address, with its token, beside the process. */
export async function console_(...words) {
  const one = await start(['console', '--page', process.env.CAPSTAN_SITE, ...words], /(http:\/\/127\.0\.0\.1:(\d+)\/([0-9a-f]{32})\/)\n/);
  return { ...one, address: one.found[1], port: Number(one.found[2]), token: one.found[3] };
}

/** A board of the host, by TCP ('fast': whose time passes as fast as it goes) or a pseudo-terminal; `name` is what `capstan console` is given. */
export async function board(kind = 'tcp') {
  if (kind === 'pty') {
    const one = await start(['run', '--shell', 'pty'], /shell at (\/dev\/pts\/\d+)/);
    return { ...one, name: one.found[1] };
  }
  const port = await freePort();
  const one = await start(['run', '--shell', `tcp:${port}`, ...(kind === 'fast' ? ['--fast'] : [])], /shell at/);
  return { ...one, port, name: `tcp:${port}` };
}

/** The preset stm32f405's folder, or why there is no emulated motor board. */
export const noMotorBoard = existsSync(join(motorBoard, 'bin/capstan_stm32f405_emulated.elf')) ? false : 'preset stm32f405 is not built';

/** The motor board in its emulator, behind its serial line, with joints of a plant simulator. */
export async function emulatedBoard() {
  const folder = mkdtempSync(join(tmpdir(), 'capstan_'));
  folders.push(folder);
  const axes = Array.from({ length: 4 }, (_, i) => `[[axes]]\nname = "joint${i}"\n[axes.plant]\npretension_n = 27.6984\nelement_count = 4\n`);
  writeFileSync(join(folder, 'joints.toml'), `name = "joints of a test"\n${axes.join('')}`);
  writeFileSync(join(folder, 'scenario.toml'), 'name = "console"\nseed = 1\ninstrument = "joints.toml"\n');
  const plant = spawn(join(motorBoard, 'tests/boards/stm32f405/capstan_plant'), ['--scenario', join(folder, 'scenario.toml'), '--axes', '4', `connect:${folder}/socket`], { detached: true });
  running.add(plant);
  const runner = new URL('../../../tools/qemu_stm32f405', import.meta.url).pathname;
  const words = ['--pty', '--limit', '280', '--plant', join(folder, 'socket'), join(motorBoard, 'bin/capstan_stm32f405_emulated.elf')];
  const one = await start(words, /redirected to (\/dev\/pts\/\d+)/, runner);
  return { ...one, name: one.found[1] };
}

export function freePort() {
  return new Promise((resolve) => {
    const server = createServer().listen(0, '127.0.0.1', () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

/** Stands between a board and who connects: `change` sees the board's words, `say` adds to them. */
export async function between(port, change) {
  const one = { say: () => undefined };
  const server = createServer((near) => {
    const far = connect(port, '127.0.0.1');
    one.say = (bytes) => near.write(bytes);
    far.on('data', (bytes) => near.write(Buffer.from(change(bytes.toString('latin1')), 'latin1')));
    near.on('data', (bytes) => far.write(bytes));
    for (const [from, to] of [[near, far], [far, near]]) {
      from.on('error', () => to.destroy());
      from.on('close', () => to.destroy());
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  one.name = `tcp:${server.address().port}`;
  one.close = () => server.close();
  proxies.push(one);
  return one;
}

/** Foxglove's own client; `topics` are those that are offered now. */
export async function foxglove(served, options = {}) {
  const socket = new WebSocket(`ws://127.0.0.1:${served.port}/${served.token}/foxglove`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL], options);
  const client = new FoxgloveClient({ ws: socket });
  const one = { client, socket, topics: new Map(), messages: [], status: [], info: undefined };
  client.on('serverInfo', (info) => (one.info = info));
  client.on('advertise', (channels) => channels.forEach((channel) => one.topics.set(channel.id, channel)));
  client.on('unadvertise', (ids) => ids.forEach((id) => one.topics.delete(id)));
  client.on('message', (message) => one.messages.push({ ...message, data: JSON.parse(new TextDecoder().decode(message.data)) }));
  client.on('status', (status) => one.status.push(status.message));
  await new Promise((resolve, reject) => {
    client.on('open', resolve);
    client.on('error', reject);
  });
  return one;
}

/** Ends what a test has left. */
/** A WebSocket to the board as a page has it; `heard` is what it was told. */
export async function boardSocket(served) {
  const socket = new WebSocket(`ws://127.0.0.1:${served.port}/${served.token}/board`, { origin: `http://127.0.0.1:${served.port}` });
  const heard = [];
  socket.on('message', (data, binary) => binary || heard.push(String(data)));
  await new Promise((resolve, reject) => socket.on('open', resolve).on('error', reject));
  return { socket, heard };
}

export function endAll() {
  for (const child of running) {
    try {
      process.kill(-child.pid, 'SIGKILL');
    } catch {
      // it has ended meanwhile
    }
  }
  running.clear();
  for (const one of proxies.splice(0)) one.close();
  for (const folder of folders.splice(0)) rmSync(folder, { recursive: true, force: true });
}
