// SPDX-License-Identifier: Apache-2.0
// `capstan console` and boards behind it, as processes of a test.
import { spawn } from 'node:child_process';
import { createServer, connect } from 'node:net';

const program = process.env.CAPSTAN_PROGRAM;
const running = new Set();

/** Starts the program and waits until it says something of this form; resolves to what was found. */
export function start(words, form) {
  const child = spawn(program, words);
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

/** A board of the host, by TCP or a pseudo-terminal; `name` is what `capstan console` is given. */
export async function board(kind = 'tcp') {
  if (kind === 'pty') {
    const one = await start(['run', '--shell', 'pty'], /shell at (\/dev\/pts\/\d+)/);
    return { ...one, name: one.found[1] };
  }
  const port = await freePort();
  const one = await start(['run', '--shell', `tcp:${port}`], /shell at/);
  return { ...one, port, name: `tcp:${port}` };
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
  return one;
}

/** Ends what a test has left. */
export function endAll() {
  for (const child of running) child.kill('SIGKILL');
}
