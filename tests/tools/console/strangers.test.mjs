// SPDX-License-Identifier: Apache-2.0
// node --test strangers.test.mjs: whom `capstan console` lets in, and what others get.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createServer, request } from 'node:http';
import test, { afterEach } from 'node:test';
import { arm, eventually, pages } from './browser.mjs';
import { boardSocket, console_, endAll, foxglove } from './served.mjs';

const rig = pages();
afterEach(endAll);

/** What the server says to a request of this kind. */
function visit(served, { host = `127.0.0.1:${served.port}`, path = `/${served.token}/`, method = 'GET', body, ...headers } = {}) {
  return new Promise((resolve, reject) => {
    const one = request({ port: served.port, hostname: '127.0.0.1', path, method, headers: { host, ...headers } }, (response) => {
      let said = '';
      response.on('data', (part) => (said += part));
      response.on('end', () => resolve({ status: response.statusCode, headers: response.headers, body: said }));
    });
    one.on('upgrade', (response, socket) => {
      socket.destroy();
      resolve({ status: response.statusCode });
    });
    one.on('error', reject);
    one.end(body);
  });
}
const kUpgrade = { connection: 'Upgrade', upgrade: 'websocket', 'sec-websocket-version': '13', 'sec-websocket-key': 'dGhlIHNhbXBsZSBub25jZQ==' };

test('only the page itself is let in: token, Host and Origin', async () => {
  const served = await console_();
  const own = `http://127.0.0.1:${served.port}`;
  const ws = { ...kUpgrade, path: `/${served.token}/board` };
  assert.equal((await visit(served)).status, 200);
  assert.equal((await visit(served, { ...ws, origin: own })).status, 101);
  for (const [why, trial] of Object.entries({
    'no token': { path: '/' },
    'no token for a file': { path: '/console.js' },
    'a wrong token': { path: `/${'0'.repeat(32)}/` },
    'a name that was made lead here': { host: `evil.example:${served.port}` },
    'another origin': { origin: 'http://evil.example' },
    'a board without token': { ...ws, origin: own, path: '/board' },
    'a diagnosis for nobody': { path: `/${served.token}/diagnose/`, method: 'POST' },
    'a diagnosis for another origin': { path: `/${served.token}/diagnose/`, method: 'POST', origin: 'http://evil.example' },
    'a tuning for nobody': { path: `/${served.token}/tune/0`, method: 'POST' },
    'a tuning for another origin': { path: `/${served.token}/tune/0`, method: 'POST', origin: 'http://evil.example' },
    'an identification for another origin': { path: `/${served.token}/identify/dynamic`, method: 'POST', origin: 'http://evil.example' },
    'a board for another origin': { ...ws, origin: 'http://evil.example' },
    'a board for nobody': ws,
    'a board for a frame without origin': { ...ws, origin: 'null' },
    'a board by a name that was made lead here': { ...ws, host: `evil.example:${served.port}`, origin: `http://evil.example:${served.port}` },
  })) {
    const { status, body } = await visit(served, trial);
    assert.equal(status, 403, why);
    assert.match(body, /open the (whole )?address that 'capstan console' printed/, why);
  }
  assert.equal((await visit(served, { path: `/${served.token}/../../etc/passwd` })).status, 404);
  assert.equal((await visit(served, { path: `/${served.token}/served.html` })).status, 404);
  assert.equal((await visit(served, { path: `/${served.token}/report` })).status, 404);
  assert.equal((await visit(served, { path: `/${served.token}/commission_report` })).status, 404);
  assert.equal((await visit(served, { method: 'DELETE', origin: own })).status, 405);
});

test('it listens on the loopback only', async () => {
  const served = await console_();
  const lines = ['/proc/net/tcp', '/proc/net/tcp6'].map((path) => readFileSync(path, 'latin1')).join('\n').split('\n');
  const port = `:${served.port.toString(16).toUpperCase().padStart(4, '0')}`;
  const listening = lines.map((line) => line.trim().split(/\s+/)).filter((words) => words[3] === '0A' && words[1]?.endsWith(port));
  assert.deepEqual(listening.map((words) => words[1]), [`0100007F${port}`]);
});

test("a stranger's page reaches nothing, even with the token, and no name that leads here helps it", async () => {
  const served = await console_();
  const one = await rig.open({}, served.address);
  await arm(one);
  const stranger = createServer((_, response) => response.writeHead(200, { 'content-type': 'text/html' }).end('<p>hello'));
  await new Promise((resolve) => stranger.listen(0, '127.0.0.1', resolve));
  const context = await rig.browser.newContext();
  const page = await context.newPage();
  await page.goto(`http://127.0.0.1:${stranger.address().port}/`);
  const got = await page.evaluate(async ({ port, token }) => {
    const talk = (address) => new Promise((resolve) => {
      const socket = new WebSocket(address);
      socket.onopen = () => (socket.send('disarm'), resolve('open'));
      socket.onerror = () => resolve('refused');
    });
    const read = (address, options) => fetch(address, options).then((r) => r.text(), () => 'refused');
    const frame = (address) => new Promise((resolve) => {
      const element = document.createElement('iframe');
      element.src = address;
      element.onload = () => resolve(element.contentDocument === null ? 'refused' : 'read');
      document.body.append(element);
    });
    const script = (address) => new Promise((resolve) => {
      const element = document.createElement('script');
      element.src = address;
      element.onload = () => resolve('loaded');
      element.onerror = () => resolve('refused');
      document.body.append(element);
    });
    const base = `127.0.0.1:${port}/${token}`;
    return [
      await talk(`ws://${base}/board`), await talk(`ws://localhost:${port}/${token}/board`), await talk(`ws://127.0.0.1:${port}/board`),
      await read(`http://${base}/`), await read(`http://127.0.0.1:${port}/`, { method: 'POST', body: 'disarm' }), await frame(`http://${base}/`),
      await script(`http://127.0.0.1:${port}/console.js`), await script(`http://${base}/console.js`),
    ];
  }, { port: served.port, token: served.token });
  assert.deepEqual(got, got.map(() => 'refused'));
  await page.waitForTimeout(300);
  assert.equal(await one.page.textContent('#state'), 'holding');
  await context.close();
  stranger.close();
});

test('the policy is strict and comes as a header; what is inline does not run', async () => {
  const served = await console_();
  const { headers, body } = await visit(served);
  const policy = Object.fromEntries(headers['content-security-policy'].split('; ').map((rule) => [rule.split(' ')[0], rule.split(' ').slice(1).join(' ')]));
  assert.equal(policy['default-src'], "'none'");
  assert.equal(policy['script-src'], "'self' 'wasm-unsafe-eval'");
  assert.equal(policy['style-src'], "'self'");
  assert.equal(policy['frame-ancestors'], "'none'");
  assert.equal(policy['connect-src'], `'self' ws://127.0.0.1:${served.port}`);
  assert.doesNotMatch(body, /<script(?![^>]* src=)|\son\w+=|\sstyle=|<style/);
  const context = await rig.browser.newContext();
  const page = await context.newPage();
  await page.goto(served.address);
  const ran = await page.evaluate(async () => {
    const script = document.createElement('script');
    script.textContent = 'window.ran = true';
    document.body.append(script);
    const away = await fetch('http://localhost:9/').then(() => true, (problem) => String(problem));
    return [window.ran, away, document.querySelector('meta[http-equiv]')];
  });
  assert.equal(ran[0], undefined);
  assert.match(ran[1], /Failed to fetch/);
  await context.close();
});

test('Foxglove is let in with the token only, and not as a page of a stranger', async () => {
  const served = await console_('--foxglove');
  for (const [options, token] of [[{ origin: 'http://evil.example' }, served.token], [{ headers: { host: `evil.example:${served.port}` } }, served.token], [{}, '0'.repeat(32)]]) {
    await assert.rejects(foxglove({ ...served, token }, options), /403/);
  }
  (await foxglove(served, { origin: 'https://app.foxglove.dev' })).client.close();
  await assert.rejects(foxglove(await console_()), /403/, 'only where it was asked for');
});

test('a page that says that it leaves commands no longer, though its line stays open', async () => {
  const served = await console_();
  const upgrade = request({
    port: served.port, hostname: '127.0.0.1', path: `/${served.token}/board`,
    headers: { ...kUpgrade, host: `127.0.0.1:${served.port}`, origin: `http://127.0.0.1:${served.port}` },
  });
  const line = await new Promise((resolve) => upgrade.on('upgrade', (_, socket) => resolve(socket)).end());
  const second = await boardSocket(served);
  await eventually(() => second.heard.some((words) => words.startsWith('look ')), 'the second page looks');
  line.write(Buffer.from([0x88, 0x82, 0, 0, 0, 0, 0x03, 0xe8]));  // RFC 6455: close, masked by zeros, status 1000
  await eventually(() => second.heard.some((words) => words.startsWith('command ')), 'the second page commands');
  second.socket.close();
  line.destroy();
});

test('one diagnosis at a time; what is too large is told', async () => {
  const served = await console_();
  const post = { path: `/${served.token}/diagnose/0`, method: 'POST', origin: `http://127.0.0.1:${served.port}` };
  const rows = Array.from({ length: 20000 }, (_, i) => `${i / 200},${Math.sin(i / 100)},${0.02 * Math.sin(i / 100 + 0.3)},${0.9 * Math.sin(i / 100)}`);
  const body = `time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad\n${rows.join('\n')}\n`;
  const first = visit(served, { ...post, body });
  await new Promise((resolve) => setTimeout(resolve, 100));
  const second = await visit(served, { ...post, body });
  const tuning = await visit(served, { ...post, path: `/${served.token}/tune/0`, body });
  assert.equal(tuning.status, 409, 'nor a tuning beside it');
  assert.deepEqual([second.status, second.body], [409, 'the host program is busy with another log; wait for it\n']);
  assert.equal((await first).status, 200);
  const large = await visit(served, { ...post, 'content-length': String(65 * 1024 * 1024) });
  assert.equal(large.status, 413);
  assert.match(large.body, /larger than 64 MB; use 'capstan diagnose', 'identify' or 'tune'/);
});
