// SPDX-License-Identifier: Apache-2.0
// node --test motor_board.test.mjs: the page, `capstan console`, a serial line and the motor board in its emulator.
import assert from 'node:assert/strict';
import test, { afterEach } from 'node:test';
import { arm, kPatience, pages, state, type, view } from './browser.mjs';
import { console_, emulatedBoard, endAll, noMotorBoard } from './served.mjs';

const rig = pages();
afterEach(endAll);

test('arms, moves and disarms the emulated motor board behind its serial line, and a page that is gone takes the torque', { skip: noMotorBoard }, async () => {
  const there = await emulatedBoard();
  const served = await console_(there.name);
  const one = await rig.open({}, served.address);
  assert.match(await type(one, 'version'), /board stm32f405-emulated joints 4/);
  await arm(one);
  await view(one, 'move');
  await one.page.waitForSelector('#joints .joint');
  await one.page.locator('text="+10 deg"').first().click();
  await one.page.waitForFunction(() => parseFloat(document.querySelector('#joints output').textContent) > 5, null, { timeout: kPatience });  // its time passes ten times slower
  await one.page.keyboard.press('Space');
  await state(one, 'disarmed');
  await arm(one);
  const two = await rig.open({ looks: true }, served.address);
  await state(two, 'holding');
  await one.page.goto('chrome://crash').catch(() => undefined);
  await state(two, 'disarmed');
});
