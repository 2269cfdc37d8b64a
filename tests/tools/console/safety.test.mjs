// SPDX-License-Identifier: Apache-2.0
// node --test safety.test.mjs: every way in which the page takes torque away, and the only one in which it gives it.
import assert from 'node:assert/strict';
import test from 'node:test';
import { angle, arm, kPatience, message as told, pages, state, type, view } from './browser.mjs';

const rig = pages();
let one;
async function armed(options) {
  one = await rig.open(options);
  await arm(one);
}
const message = (part) => told(one, part);

test('one action gives no torque, and the second comes too late after three seconds', async () => {
  one = await rig.open();
  assert.ok(await one.page.isDisabled('#arm-confirm'));
  await one.page.click('#arm');
  await one.page.waitForTimeout(4000);
  assert.ok(await one.page.isDisabled('#arm-confirm'));
  assert.equal(await one.page.textContent('#state'), 'disarmed');
});

test('a page without focus gives no torque', async () => {
  one = await rig.open({ script: () => { Document.prototype.hasFocus = () => false; } });
  await one.page.click('#arm');
  await one.page.click('#arm-confirm');
  await message('not in front');
  await one.page.waitForTimeout(300);
  assert.equal(await one.page.textContent('#state'), 'disarmed');
});

test('the shell of the page does not arm', async () => {
  one = await rig.open();
  await view(one, 'shell');
  await one.page.fill('#line', 'arm');
  await one.page.press('#line', 'Enter');
  await one.page.waitForFunction(() => document.getElementById('console').textContent.includes('two actions'), null, { timeout: kPatience });
  await one.page.waitForTimeout(300);
  assert.equal(await one.page.textContent('#state'), 'disarmed');
});

test('DISARM takes the torque', async () => {
  await armed();
  await one.page.click('#disarm');
  await state(one, 'disarmed');
});

test('DISARM takes the torque in the middle of a motion, and the joint is not moved again', async () => {
  await armed();
  await one.page.selectOption('#speed', '0.1');
  await type(one, 'move joint0 60 deg');
  await one.page.click('#disarm');
  await state(one, 'disarmed');
  await one.page.selectOption('#speed', '1');
  await arm(one);
  await one.page.waitForTimeout(800);
  assert.ok((await angle(one)) < 50);
  assert.equal(await one.page.textContent('#state'), 'holding', 'nothing takes the new torque');
});

test('DISARM does not wait for an answer that streams', async () => {
  await armed();
  await type(one, 'frames off');
  await one.page.fill('#line', 'log joint0 1000000 1');
  await one.page.press('#line', 'Enter');
  await one.page.waitForFunction(() => document.getElementById('console').textContent.includes('time_s,'), null, { timeout: kPatience });
  await one.page.click('#disarm');
  await state(one, 'disarmed');
  assert.match(await type(one, 'version'), /capstan \S+ board sim/);
});

test('DISARM twice at once leaves the talk with the board in order', async () => {
  await armed();
  await one.page.evaluate(() => {
    for (let i = 0; i < 5; ++i) document.getElementById('disarm').click();
  });
  await state(one, 'disarmed');
  assert.match(await type(one, 'get joint0.control.kp'), /joint0\.control\.kp 0\.2 .*\nok/);
  assert.match(await type(one, 'timing'), /cycles \d+ of 1 ms.*\nok/s);
});

test('DISARM ends an experiment', async () => {
  await armed();
  await view(one, 'move');
  await one.page.selectOption('#experiment-recipe', 'triangle');
  await one.page.fill('#experiment-options', 'amplitude=0.1 speeds=0.2 cycles=20');
  await one.page.click('#experiment-run');
  await one.page.waitForFunction(() => /^runs: \d\d/.test(document.getElementById('experiment-answer').textContent), null, { timeout: kPatience });
  await one.page.click('#disarm');
  await state(one, 'disarmed');
  await one.page.waitForFunction(() => document.getElementById('experiment-answer').textContent.startsWith('ended early'), null, { timeout: kPatience });
});

test('the space bar takes the torque, wherever the focus is', async () => {
  await armed();
  await one.page.focus('#pause');
  await one.page.keyboard.press('Space');
  await state(one, 'disarmed');
  assert.equal(await one.page.getAttribute('#pause', 'aria-pressed'), 'false', 'and does nothing else');
});

test('a space that is typed is typed, and Escape takes the torque there', async () => {
  await armed();
  await view(one, 'shell');
  await one.page.focus('#line');
  await one.page.keyboard.type('move joint0');
  assert.equal(await one.page.inputValue('#line'), 'move joint0');
  assert.equal(await one.page.textContent('#state'), 'holding');
  await one.page.keyboard.press('Escape');
  await state(one, 'disarmed');
});

test('the keyboard alone arms, moves and disarms', async () => {
  one = await rig.open();
  await one.page.focus('#arm');
  await one.page.keyboard.press('Enter');
  await one.page.keyboard.press('Enter');
  await state(one, 'holding');
  await one.page.selectOption('#speed', '0.1');  // time for a look while it moves
  await one.page.focus('#tab-live');
  await one.page.keyboard.press('ArrowRight');
  await one.page.keyboard.press('ArrowRight');
  await one.page.waitForSelector('#joints .joint');
  await one.page.keyboard.press('Tab');
  await one.page.keyboard.press('End');
  await one.page.keyboard.press('Tab');
  await one.page.keyboard.press('Enter');
  await state(one, 'moving');
  await one.page.keyboard.press('Space');
  await state(one, 'disarmed');
});

test('a page that loses focus takes the torque along', async () => {
  await armed();
  await one.page.evaluate(() => window.dispatchEvent(new Event('blur')));
  await state(one, 'disarmed');
  await message('lost focus');
});

test('a page that is hidden takes the torque along', async () => {
  await armed();
  await one.page.evaluate(() => {
    Object.defineProperty(document, 'hidden', { value: true });
    document.dispatchEvent(new Event('visibilitychange'));
  });
  await state(one, 'disarmed');
  await message('hidden');
});

test('a page that is reloaded comes back without torque', async () => {
  await armed();
  await type(one, 'move joint0 60 deg');
  await one.page.reload();
  await state(one, 'disarmed');
  assert.ok(Math.abs(await angle(one)) < 1, 'a simulated joint starts anew');
});

test('a page that hangs loses its line: the simulator takes the torque by itself', async () => {
  await armed();
  await one.page.evaluate(() => {
    const end = performance.now() + 2500;
    while (performance.now() < end);
  });
  await state(one, 'disarmed');
  await view(one, 'shell');
  await one.page.waitForFunction(() => document.getElementById('console').textContent.includes('the connection counts as lost'), null, { timeout: kPatience });
});

test('a fault takes the torque, and only DISARM and two actions give it back', async () => {
  await armed();
  await type(one, 'fail current nan for 0.1');
  await state(one, 'faulted');
  await one.page.waitForTimeout(500);
  assert.match(await one.page.textContent('#state'), /^faulted/);
  await one.page.click('#disarm');
  await state(one, 'disarmed');
  await one.page.waitForTimeout(500);
  assert.equal(await one.page.textContent('#state'), 'disarmed');
  await arm(one);
});

test('another instrument, chosen under torque, starts without', async () => {
  await armed();
  await one.page.selectOption('#instrument', 'robot_finger');
  await state(one, 'disarmed');
});
