// SPDX-License-Identifier: Apache-2.0
// A page of the console in Chromium, served by a server of the test's own that knows nothing but the folder.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { extname, join } from 'node:path';
import { after, afterEach, before } from 'node:test';

const require = createRequire(join(process.env.CAPSTAN_NODE_MODULES, 'any.js'));
const { chromium } = require('playwright-core');
export const site = process.env.CAPSTAN_SITE;
export const kPatience = Number(process.env.CAPSTAN_PATIENCE_MS ?? 30000);

const kTypes = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };

/** What was asked for stands in `asked`: nothing else may leave the page. */
export async function serve() {
  const asked = [];
  const server = createServer((request, response) => {
    asked.push(request.url);
    const path = request.url === '/' ? '/index.html' : request.url;
    try {
      const body = readFileSync(join(site, path));
      response.writeHead(200, { 'content-type': kTypes[extname(path)] }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { address: `http://127.0.0.1:${server.address().port}/`, asked, close: () => server.close() };
}

export function launch() {
  const quiet = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];
  return chromium.launch({ executablePath: process.env.CAPSTAN_CHROMIUM, args: quiet });
}

/** Ten pictures a second: without a graphics processor 50 take two processors, and the tests that ask how the page looks do not ask how often. */
function drawSeldom() {
  const next = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (draw) => window.setTimeout(() => next(draw), 100);
}

/** Opens the page and waits until the simulator runs. Whatever the page complains of is in `complaints`. */
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  const complaints = [];
  // Warnings are Chromium's advice on speed, the test's own reading of pixels among it.
  page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(String(error)));
  if (options.everyPicture !== true) await page.addInitScript(drawSeldom);
  if (options.script !== undefined) await page.addInitScript(options.script);
  await page.goto(address);
  const console_ = { page, complaints, close: () => context.close() };
  if (options.looks !== true) {
    await state(console_, 'disarmed');
    await page.waitForFunction(() => document.querySelectorAll('#signals button').length > 0, null, { timeout: kPatience });
  }
  return console_;
}

/** Browser and server for the tests of a file. A page that was opened is closed after its test, and must not have complained. */
export function pages() {
  const rig = {
    opened: [],
    async open(options, address = rig.server.address) {
      const one = await open(rig.browser, address, options);
      rig.opened.push(one);
      return one;
    },
  };
  before(async () => {
    rig.browser = await launch();
    rig.server = await serve();
  });
  after(async () => {
    await rig.browser.close();
    rig.server.close();
  });
  afterEach(async () => {
    const opened = rig.opened.splice(0);
    for (const one of opened) await one.close();
    for (const one of opened) assert.deepEqual(one.complaints, [], 'the page complained');
  });
  return rig;
}

/** Waits until the page says so. */
export function message({ page }, part) {
  return page.waitForFunction((wanted) => document.getElementById('message').textContent.includes(wanted), part, { timeout: kPatience });
}

/** Waits until the page says that the machine is in this state. */
export async function state({ page }, words) {
  try {
    await page.waitForFunction((wanted) => document.getElementById('state').textContent.startsWith(wanted), words, { timeout: kPatience });
  } catch {
    throw new Error(`not '${words}' but '${await page.textContent('#state')}'; the page says: ${await page.textContent('#message')}`);
  }
}

/** The two actions. */
export async function arm(console_) {
  await console_.page.click('#arm');
  await console_.page.click('#arm-confirm');
  await state(console_, 'holding');
}

/** From rest: 10 degrees by a click and no torque by a key. */
export async function armMoveDisarm(console_) {
  const { page } = console_;
  await arm(console_);
  await view(console_, 'move');
  await page.waitForSelector('#joints .joint');
  await page.click('text="+10 deg"');
  await moved(console_, 10);
  await page.keyboard.press('Space');
  await state(console_, 'disarmed');
}

/** Waits until the first joint stands there, degrees. */
export function moved({ page }, degrees) {
  return page.waitForFunction((wanted) => Math.abs(parseFloat(document.querySelector('#joints output').textContent) - wanted) < 0.7, degrees, { timeout: kPatience });
}

/** The step responses that Move lists, the newest first, cell by cell. */
export function responses({ page }) {
  return page.$$eval('#response-table tbody tr', (all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
}

/** Asks again until it is so. */
export async function eventually(check, what) {
  const end = performance.now() + kPatience;
  while (!(await check())) {
    if (performance.now() > end) throw new Error(`not within ${kPatience} ms: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

export async function view({ page }, name) {
  await page.click(`#tab-${name}`);
}

/** Types a line at the shell and waits for its answer. */
export async function type(console_, line) {
  const { page } = console_;
  await view(console_, 'shell');
  const before = (await page.textContent('#console')).length;
  await page.fill('#line', line);
  await page.press('#line', 'Enter');
  await page.waitForFunction((from) => /\n(ok|error [^\n]*)\n$/.test(document.getElementById('console').textContent.slice(from)), Math.max(0, before - 1), { timeout: kPatience });
  return (await page.textContent('#console')).slice(before);
}

/** Degrees, as the shell tells them. */
export async function angle(console_, joint = 'joint0') {
  const answer = await type(console_, 'status');
  return (Number(new RegExp(`${joint} .* joint (\\S+) rad`).exec(answer)[1]) * 180) / Math.PI;
}
