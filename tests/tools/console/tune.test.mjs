// SPDX-License-Identifier: Apache-2.0
// node --test tune.test.mjs: gains changed and undone in the page, with the response of the joint beside them.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import test, { before } from 'node:test';
import { arm, eventually, kPatience, pages, responses, state, type, view } from './browser.mjs';

const pictures = process.env.CAPSTAN_PICTURES;
const rig = pages();
before(() => mkdirSync(pictures, { recursive: true }));
const fresh = (options) => rig.open(options);
const text = ({ page }, place) => page.textContent(place);
const until = ({ page }, check, given) => page.waitForFunction(check, given, { timeout: kPatience });

test('undo takes back edit by edit, then commit by commit on the board; forget takes all edits back', async () => {
  const one = await fresh();
  await view(one, 'parameters');
  const field = (name) => `tr[data-name="joint0.control.${name}"] input`;
  await one.page.waitForSelector(field('kp'));
  const commit = async (name, value) => {
    await one.page.fill(field(name), value);
    await one.page.click('#commit');
    await until(one, () => document.getElementById('staged').textContent === '');
  };
  assert.ok(await one.page.isDisabled('#undo'));
  await one.page.fill(field('kp'), '0.4');
  await one.page.fill(field('ki'), '7');
  await one.page.click('#undo');
  assert.deepEqual([await one.page.inputValue(field('kp')), await one.page.inputValue(field('ki'))], ['0.4', '4']);
  await one.page.click('#forget');
  assert.equal(await one.page.inputValue(field('kp')), '0.2');
  await commit('kp', '0.3');
  await one.page.fill(field('kp'), '0.35');
  await commit('ki', '5');
  const undone = async (part) => {
    await one.page.click('#undo');
    await until(one, (wanted) => document.getElementById('message').textContent.includes(wanted), part);
  };
  await undone('joint0.control.ki is 4 again');
  assert.match(await type(one, 'get joint0.control.kp'), /kp 0\.3 /, 'what was committed together is taken back together');
  await view(one, 'parameters');
  await commit('kd', '0.001');
  await undone('joint0.control.kd is 0 again');
  await type(one, 'set joint0.control.kp 0.25');
  await view(one, 'parameters');
  await undone('was changed since then by another way');
  assert.match(await type(one, 'get joint0.control.kp'), /kp 0\.25 /);
  await view(one, 'parameters');
  assert.ok(await one.page.isDisabled('#undo'));
});

const answer = (one, part) => until(one, (wanted) => document.getElementById('response-answer').textContent.includes(wanted), part);
async function stepping(one, options = {}) {
  await arm(one);
  await view(one, 'move');
  await one.page.waitForSelector('#response-gains input');
  for (const [id, value] of Object.entries(options)) await one.page.fill(`#response-${id}`, value);
  await one.page.click('#response-run');
  await eventually(async () => (await responses(one)).length > 1, 'two responses');
}

test('steps are repeated and their numbers shown; more integral gain is seen to be faster; it is undone; DISARM ends it', async () => {
  const one = await fresh();
  await stepping(one, { step: '3', every: '3' });
  const [newest] = await responses(one);
  assert.ok(Math.abs(Math.abs(Number(newest[0])) - 3) < 0.01, newest.join());
  assert.ok(Number(newest[2]) > 0 && Number(newest[2]) < 3000, newest.join());
  await one.page.fill('[data-gain="control.ki"]', '12');
  await one.page.press('[data-gain="control.ki"]', 'Enter');
  await answer(one, 'joint0.control.ki is 12 now');
  const changed = async () => (await responses(one)).find((row) => row[5] === 'ki 12');
  await eventually(async () => (await changed()) !== undefined, 'the response with it');
  assert.ok(Number((await changed())[2]) < 0.6 * Number(newest[2]), `${await changed()} after ${newest}`);
  await one.page.screenshot({ path: join(pictures, 'response.png'), fullPage: true });
  await one.page.click('#response-undo');
  await answer(one, 'joint0.control.ki is 4 again');
  await one.page.keyboard.press('Escape');
  await answer(one, 'ended');
  await state(one, 'disarmed');
  const before = (await responses(one)).length;
  await one.page.waitForTimeout(1200);
  assert.equal((await responses(one)).length, before, 'no step comes after it');
  assert.ok(await one.page.isDisabled('#response-run'));
  await view(one, 'live');
  await until(one, () => document.getElementById('plot').textContent.includes('joint0.q1'));  // what was shown before comes back
});

test('a gain that is being typed while the board lists its gains is kept, and Enter sets it', async () => {
  const one = await fresh();
  await view(one, 'move');
  const field = '[data-gain="control.ki"]';
  await one.page.waitForSelector(field);
  await one.page.fill(field, '5');
  await one.page.evaluate(() => {
    window.listed = new Promise((resolve) => {
      const { set } = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'defaultValue');
      Object.defineProperty(document.querySelector('[data-gain="control.kp"]'), 'defaultValue', { set(value) { set.call(this, value); resolve(); } });
    });
    document.getElementById('tab-move').click();  // as the page itself would; the field keeps its focus
  });
  await one.page.evaluate(() => window.listed);
  assert.equal(await one.page.inputValue(field), '5');
  await one.page.press(field, 'Enter');
  await until(one, () => document.getElementById('response-answer').textContent.includes('joint0.control.ki is 5 now'));
});

test('a fault ends the steps, and so do Stop and leaving the view, which hold the joint', async () => {
  const one = await fresh();
  await stepping(one, { every: '0.5' });
  await one.page.click('#response-stop');
  await answer(one, 'stopped');
  await state(one, 'holding');
  await one.page.click('#response-run');
  await answer(one, 'steps between');
  await view(one, 'live');
  await view(one, 'move');
  await answer(one, 'stopped');
  await one.page.click('#response-run');
  await answer(one, 'steps between');
  await one.page.evaluate(() => {
    document.getElementById('fault-target').value = 'encoder';
    document.getElementById('fault-kind').value = 'off';
    document.getElementById('fault-form').requestSubmit();
  });
  await answer(one, 'ended: ');
  await state(one, 'faulted');
});

test('a step that leaves the limits goes the other way, and one that fits nowhere is refused', async () => {
  const one = await fresh();
  await arm(one);
  const high = Number(/joint_max (\S+) /.exec(await type(one, 'get joint0.limits.joint_max'))[1]) * 180 / Math.PI;
  await type(one, `move joint0 ${(high - 1).toFixed(2)} deg`);
  await view(one, 'move');
  await one.page.waitForSelector('#response-gains input');
  await eventually(async () => Math.abs(parseFloat(await text(one, '#joints output')) - high + 1) < 0.5, 'the end of its range');
  await one.page.fill('#response-step', '5');
  await one.page.click('#response-run');
  await eventually(async () => (await responses(one)).length > 0, 'a response');
  assert.ok(Number((await responses(one))[0][0]) < 0, 'away from the limit');
  await one.page.click('#response-stop');
  await one.page.fill('#response-step', '11');
  await one.page.click('#response-run');
  assert.equal(await text(one, '#response-answer'), 'stopped', 'more than 10 deg is no small step');
});

test('without a host program commissioning tells its command, and the log of a shaken joint is offered with the one of tune', async () => {
  const one = await fresh();
  await view(one, 'setup');
  assert.ok(await one.page.isDisabled('#commission-start'));
  await one.page.fill('#commission-inertia', '0.02');
  assert.match(await text(one, '#commission-command'), /capstan commission PORT --axis 0 --corridor 0\.8 --inertia 0\.02 --report page/);
  const said = (part) => until(one, (wanted) => document.getElementById('tune-answer').textContent.includes(wanted), part);
  await one.page.click('#tune-run');
  await one.page.click('#tune-no');
  await said('nothing moved');
  await one.page.click('#tune-run');
  await one.page.click('#tune-yes');
  await said('not_holding');
  await type(one, 'maintenance open');
  await arm(one);
  await view(one, 'setup');
  await one.page.fill('#tune-duration', '5');
  await one.page.fill('#tune-travel', '0.2');
  await one.page.fill('#tune-speed', '0.2');
  await one.page.fill('#tune-amplitude', '3');
  await one.page.click('#tune-run');
  await one.page.click('#tune-yes');
  await said('recorded');
  const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click('#tune-save')]);
  const saved = readFileSync(await download.path(), 'utf8');
  assert.match(saved, /^set joint0\.control\.stiffness 1 Nm\/rad$/m);
  assert.match(saved, /^time_s,/m);
  assert.ok(saved.split('\n').filter((line) => /^\d/.test(line)).length >= 5000, 'every row');
  assert.match(await text(one, '#tune-command'), /capstan tune capstan_shaken\.txt --dump capstan_shaken\.txt/);
});
