// SPDX-License-Identifier: Apache-2.0
// node --test served_commission.test.mjs: `capstan commission` guided by the page that `capstan console` serves.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import test, { afterEach } from 'node:test';
import { arm, kPatience, pages, state, type, view } from './browser.mjs';
import { board, console_, endAll } from './served.mjs';

const rig = pages();
afterEach(endAll);
const until = ({ page }, check, given) => page.waitForFunction(check, given, { timeout: kPatience });
const open = (served, options) => rig.open(options, served.address);

/** Every step that `capstan commission` told of, and what it found. */
const steps = (one) => one.page.textContent('#commission-steps');
async function commissioned(one, part) {
  try {
    await until(one, (wanted) => document.getElementById('commission-answer').textContent.includes(wanted), part);
  } catch {
    throw new Error(`not '${part}' but '${await one.page.textContent('#commission-answer')}', after: ${await steps(one)}; the page says: ${await one.page.textContent('#message')}`);
  }
}
async function beginCommissioning(one) {
  await view(one, 'setup');
  await one.page.fill('#commission-inertia', '0.02');
  await one.page.click('#commission-start');
  await until(one, () => !document.getElementById('commission-question').hidden);
  assert.equal(await one.page.textContent('#commission-asks'), 'may the joint move?');
}

test('commission is guided: it explains, asks before the joint moves, and No ends it without torque; a second start goes on from there', async () => {
  const there = await board();
  const one = await open(await console_(there.name));
  await beginCommissioning(one);
  assert.match(await steps(one), /look: reads encoder and current sensor.*current sensor: zero .*shake: shakes the motor/s);
  await state(one, 'commissioning');
  assert.ok(await one.page.isDisabled('#arm'));
  await one.page.click('#commission-no');
  await commissioned(one, 'stopped on request');
  await state(one, 'disarmed');
  assert.match(await type(one, 'version'), /capstan .*\nok/s, 'the page commands again');
  await beginCommissioning(one);
  assert.match(await steps(one), /look: done before/);
  await one.page.check('#commission-again');
  await one.page.click('#commission-stop');
  await commissioned(one, 'stopped on request');
  await beginCommissioning(one);
  assert.doesNotMatch(await steps(one), /done before/);
});

test('commission goes to its end: every step, every answer Yes, gains found and saved, report and machine.toml, no torque left', async () => {
  const there = await board('fast');
  const one = await open(await console_(there.name));
  await view(one, 'setup');
  await one.page.fill('#commission-inertia', '0.02');
  await one.page.click('#commission-start');
  let asked = 0;
  await until(one, () => !document.getElementById('commission-stop').disabled);
  for (;;) {
    await one.page.waitForFunction(() => !document.getElementById('commission-question').hidden || document.getElementById('commission-stop').disabled, null, { timeout: 120000 });
    if (await one.page.isHidden('#commission-question')) break;
    await one.page.click('#commission-yes');
    ++asked;
  }
  await commissioned(one, 'done: the joint has its gains, and its torque is off');
  console.log(`console page: ${await one.page.textContent('#commission-time')} for a commissioning, the joint's time as fast as it goes`);
  assert.ok(asked >= 6, `${asked} questions`);
  assert.deepEqual(await one.page.$$eval('#commission-steps > li > strong', (all) => all.map((step) => step.textContent)), ['look', 'shake', 'press', 'travel', 'motor', 'tune', 'check', 'save']);
  await state(one, 'disarmed');
  const reports = one.page.locator('#commission-report iframe');
  assert.equal(await reports.count(), 2);
  for (const title of ['report of commissioning', 'frequency response of commissioning']) {
    await one.page.frameLocator(`#commission-report iframe[title="${title}"]`).locator('h1').first().waitFor({ timeout: kPatience });
  }
  await one.page.screenshot({ path: join(process.env.CAPSTAN_PICTURES, 'commission.png'), fullPage: true });
  const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click('#commission-machine')]);
  assert.match(readFileSync(await download.path(), 'utf8'), /inertia/);
  const told = await type(one, 'get joint0.control.stiffness');
  assert.match(told, /stiffness \S+ /);
  assert.notEqual(Number(/stiffness (\S+) /.exec(told)[1]), 1);
});

test('DISARM ends a commissioning that shakes the joint: no torque comes back, and the gains are those of before', async () => {
  const there = await board();
  const served = await console_(there.name);
  const one = await open(served);
  const before = await type(one, 'dump');
  await beginCommissioning(one);
  const two = await open(served, { looks: true });
  await one.page.click('#commission-yes');
  await one.page.waitForTimeout(4000);  // within the first shake, which takes 11 s
  await two.page.click('#take');
  await two.page.waitForTimeout(300);
  assert.ok(await one.page.isEnabled('#commission-stop'), 'the command is not taken from it');
  await one.page.keyboard.press('Escape');
  await state(one, 'disarmed');
  const after = await type(one, 'dump');
  assert.equal(after.replace(/^.*\n/, ''), before.replace(/^.*\n/, ''));
  await one.page.waitForTimeout(1500);
  assert.equal(await one.page.textContent('#state'), 'disarmed');
});

test('a page that is gone, or loses focus, takes its commissioning and the torque along', async () => {
  const there = await board();
  const served = await console_(there.name);
  const two = await open(served);
  const one = await open(served, { looks: true });
  await one.page.click('#take');
  await until(one, () => document.querySelectorAll('#signals button').length > 0);
  await beginCommissioning(one);
  await one.page.click('#commission-yes');
  await one.page.waitForTimeout(3000);
  await one.page.evaluate(() => window.dispatchEvent(new Event('blur')));
  await until(one, () => !document.getElementById('commission-start').disabled);
  await state(one, 'disarmed');
  await beginCommissioning(one);
  await one.page.click('#commission-yes');
  await one.page.waitForTimeout(3000);
  await one.page.goto('chrome://crash').catch(() => undefined);
  await state(two, 'disarmed');
  await arm(two);
});

test('a commissioning that can not begin says why', async () => {
  const one = await open(await console_());
  await view(one, 'setup');
  await one.page.fill('#commission-inertia', '0.02');
  await one.page.evaluate(() => (document.querySelector('#commission-joint option').value = 'joint3'));
  await one.page.click('#commission-start');
  await commissioned(one, 'the board has no joint3');
  await state(one, 'disarmed');
});
