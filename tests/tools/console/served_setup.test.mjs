// SPDX-License-Identifier: Apache-2.0
// node --test served_setup.test.mjs: a joint set up by the page that `capstan console` serves: tuned, its response looked at; and a
// simulated one broken.
import assert from 'node:assert/strict';
import { join } from 'node:path';
import test, { afterEach } from 'node:test';
import { arm, eventually, kPatience, message, pages, responses, state, type, view } from './browser.mjs';
import { between, board, console_, endAll } from './served.mjs';

const rig = pages();
afterEach(endAll);
const until = ({ page }, check, given) => page.waitForFunction(check, given, { timeout: kPatience });
const open = (served, options) => rig.open(options, served.address);

for (const kind of ['tcp', 'pty']) {
  test(`the step response of a board by ${kind} is drawn, with its numbers, and ends with the board`, async () => {
    const there = await board(kind);
    const one = await open(await console_(there.name));
    await arm(one);
    await view(one, 'move');
    await one.page.waitForSelector('#response-gains input');
    await one.page.click('#response-run');
    await eventually(async () => (await responses(one)).length > 1, 'two responses');
    const [newest] = await responses(one);
    assert.ok(Math.abs(Math.abs(Number(newest[0])) - 2) < 0.01 && Number(newest[2]) > 0, newest.join());
    there.child.kill();
    await until(one, () => document.getElementById('response-answer').textContent.startsWith('ended: '));
  });
}

async function shake(one, fields) {
  await view(one, 'setup');
  for (const [name, value] of Object.entries(fields)) await one.page.fill(`#tune-${name}`, value);
  await one.page.click('#tune-run');
  assert.match(await one.page.textContent('#tune-asks'), /May joint0 move /);
  await one.page.click('#tune-yes');
}
const tuned = (one, part, timeout = kPatience) => one.page.waitForFunction((wanted) => document.getElementById('tune-answer').textContent.includes(wanted), part, { timeout });

test('gains are found from a log that the page records, shown beside the old ones with the Bode plot, left or taken, and undone', async () => {
  const one = await open(await console_());
  await arm(one);
  await shake(one, { duration: '40', travel: '1.8', speed: '1', amplitude: '8' });
  await tuned(one, 'is shaken');
  await tuned(one, 'gains are found', 90000);
  await one.page.screenshot({ path: join(process.env.CAPSTAN_PICTURES, 'tune.png'), fullPage: true });
  const found = await one.page.$$eval('#tune-table tbody tr', (all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  const stiffness = found.find(([name]) => name === 'joint0.control.stiffness');
  assert.equal(stiffness[1], '1 Nm/rad');
  assert.notEqual(Number.parseFloat(stiffness[2]), 1);
  assert.match(await type(one, 'get joint0.control.stiffness'), /stiffness 1 /, 'not taken yet');
  await view(one, 'setup');
  await one.page.frameLocator('#tune-report iframe').locator('svg').first().waitFor({ timeout: kPatience });
  await one.page.click('#tune-take');
  await tuned(one, 'the board has these gains now');
  const value = async () => Number(/stiffness (\S+) /.exec(await type(one, 'get joint0.control.stiffness'))[1]);
  assert.ok(Math.abs((await value()) - Number.parseFloat(stiffness[2])) < 1e-3);
  await view(one, 'parameters');
  await one.page.click('#undo');
  await message(one, 'joint0.control.stiffness is 1 again');
});

test('a log that gives no gains is told with its cure, and nothing is offered', async () => {
  const one = await open(await console_());
  await arm(one);
  await shake(one, { duration: '5', travel: '0.2', speed: '0.2', amplitude: '0.1' });
  await one.page.waitForFunction(() => /;/.test(document.getElementById('tune-answer').textContent), null, { timeout: 40000 });
  assert.ok(await one.page.isHidden('#tune-choice'));
});

test('the simulated joint of capstan console gets an undeclared effect and a fault by a click; the page that looks follows', async () => {
  const served = await console_();
  const one = await open(served);
  const two = await open(served, { looks: true });
  const answered = (part) => until(one, (wanted) => document.getElementById('effect-answer').textContent.includes(wanted), part);
  await arm(one);
  await view(one, 'break');
  await one.page.selectOption('#effect', 'play.half_width_rad');
  await one.page.fill('#effect-value', '7');
  await one.page.click('text="Restart with it"');
  await answered('impossible');
  assert.equal(await one.page.textContent('#state'), 'holding', 'what is refused changes nothing');
  await one.page.fill('#effect-value', '0.2');
  await one.page.click('text="Restart with it"');
  await answered('restarted with play.half_width_rad=0.2');
  await state(one, 'disarmed');
  await state(two, 'disarmed');
  await arm(one);
  assert.doesNotMatch(await type(one, 'model'), /play/, 'the firmware is not told');
  await view(one, 'break');
  await one.page.selectOption('#fault-target', 'encoder');
  await one.page.selectOption('#fault-kind', 'off');
  await one.page.click('text="Break it now"');
  await state(one, 'faulted by sensor_missing');
  await until(one, () => /latched sensor_missing: .*To do: /.test(document.querySelector('#break .faults').textContent));
  await state(two, 'faulted by sensor_missing');
  await one.page.click('#effect-none');
  await answered('restarted without an effect');
  await state(one, 'disarmed');
  await arm(one);
});

test('a simulated board behind capstan console is broken by a click; a real one is not offered it, and one without the command says so', async () => {
  const there = await board();
  const one = await open(await console_(there.name));
  await arm(one);
  await view(one, 'break');
  assert.ok(await one.page.isHidden('#effects') && await one.page.isVisible('#effects-elsewhere'));
  await one.page.selectOption('#fault-target', 'encoder');
  await one.page.selectOption('#fault-kind', 'off');
  await one.page.click('text="Break it now"');
  await state(one, 'faulted by sensor_missing');
  await one.close();
  for (const [name, shown] of [['stm32f405', false], ['stm32f405-emulated', true]]) {
    const another = await board();
    const line = await between(another.port, (text) => text.replace(/board sim\b/, `board ${name}`).replace(/error fault: .*/, "error unknown_command: there is no such command; 'help' shows all"));
    const page = await open(await console_(line.name));
    await until(page, () => document.querySelectorAll('#experiment-recipe option').length > 0);
    await page.page.waitForTimeout(300);
    assert.equal(await page.page.isVisible('#tab-break'), shown, name);
    if (shown) {
      await view(page, 'break');
      assert.ok(await page.page.isHidden('#fault-form'));
      assert.match(await page.page.textContent('#fault-answer'), /has no command 'fail'/);
    }
    line.close();
  }
});
