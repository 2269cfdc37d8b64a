// SPDX-License-Identifier: Apache-2.0
// node --test motor_board.test.mjs: the page, `capstan console`, a serial line and the motor board in its emulator, whose time passes
// ten times slower: one board for all of it.
import assert from 'node:assert/strict';
import test, { after } from 'node:test';
import { arm, kPatience, message, pages, state, type, view } from './browser.mjs';
import { console_, emulatedBoard, endAll, noMotorBoard } from './served.mjs';

const rig = pages();
after(endAll);
const until = ({ page }, check, given) => page.waitForFunction(check, given, { timeout: kPatience });

/** Torque, and ten degrees more by a click. */
async function armAndMove(one) {
  await arm(one);
  await view(one, 'move');
  await one.page.waitForSelector('#joints .joint');
  await one.page.locator('text="+10 deg"').first().click();
}

/** Types it again where the page says that no answer came in time: the emulator's time may pass so slowly. */
async function changeGain(one) {
  await view(one, 'move');
  await one.page.waitForSelector('[data-gain="control.ki"]');
  for (let told = 'interrupted'; told.includes('interrupted');) {
    await one.page.fill('[data-gain="control.ki"]', '5');
    await one.page.press('[data-gain="control.ki"]', 'Enter');
    await until(one, () => /joint0\.control\.ki is 5 now|interrupted/.test(document.getElementById('response-answer').textContent));
    told = await one.page.textContent('#response-answer');
  }
}

async function captureByScope(one) {
  await view(one, 'live');
  await one.page.click('#scope summary');
  await one.page.selectOption('#scope-when', 'now');
  await one.page.fill('#scope-samples', '100');
  await one.page.fill('#scope-before', '0');
  await one.page.click('#scope-form button[type="submit"]');
  await until(one, () => document.getElementById('scope-answer').textContent.includes('captured 100 samples'));
  await one.page.click('#go-on');
}

/** An encoder that moves faster than it may is a fault; here it may hardly move, which its noise at rest does not reach. */
async function breakByMoving(one) {
  await type(one, 'maintenance open');
  assert.match(await type(one, 'set joint0.motor.speed_limit 1'), /ok\n$/);
  await armAndMove(one);
  await state(one, 'faulted by ');
  await view(one, 'states');
  await until(one, () => /latched \w+: .*To do: /.test(document.getElementById('faults').textContent));
  await one.page.click('#disarm');
  await state(one, 'disarmed');
  assert.match(await type(one, 'set joint0.motor.speed_limit 60'), /ok\n$/);
  assert.match(await type(one, 'zero joint0'), /ok\n$/, 'after such a fault its position is not known');
}

test('the emulated motor board behind its serial line: arm, move, tune, scope, fault, disarm; reload, crash and lost line take the torque or tell', { skip: noMotorBoard }, async () => {
  const there = await emulatedBoard();
  const served = await console_(there.name);
  const one = await rig.open({}, served.address);
  assert.match(await type(one, 'version'), /board stm32f405-emulated joints 4/);
  await armAndMove(one);
  await until(one, () => parseFloat(document.querySelector('#joints output').textContent) > 5);
  await one.page.keyboard.press('Space');
  await state(one, 'disarmed');
  await changeGain(one);
  await captureByScope(one);
  await breakByMoving(one);
  const two = await rig.open({ looks: true }, served.address);
  await message(two, 'another page commands');
  await one.page.bringToFront();
  await arm(one);
  await state(two, 'holding');
  await one.page.reload();
  await state(two, 'disarmed');
  await until(two, () => document.getElementById('take').hidden);  // the page that was there commands now
  await two.page.bringToFront();
  await arm(two);
  const three = await rig.open({ looks: true }, served.address);
  await state(three, 'holding');
  await two.page.goto('chrome://crash').catch(() => undefined);
  await state(three, 'disarmed');
  there.child.kill();
  await message(three, 'the connection to the board is lost');
  assert.equal(await three.page.textContent('#state'), 'not connected');
});
