// SPDX-License-Identifier: Apache-2.0
// node --test served.test.mjs: the page as `capstan console` serves it, with a simulated joint and with boards; who commands, who looks,
// when the torque goes, what the host program makes of a log, and Foxglove.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import test, { afterEach } from 'node:test';
import { arm, armMoveDisarm, eventually, kPatience, message, moved, pages, state, type, view } from './browser.mjs';
import { between, board, console_, endAll, foxglove, freePort } from './served.mjs';

const rig = pages();
afterEach(endAll);
const until = ({ page }, check, given) => page.waitForFunction(check, given, { timeout: kPatience });
const open = (served, options) => rig.open(options, served.address);
const said = (one, part) => until(one, (wanted) => document.getElementById('console').textContent.includes(wanted), part);
/** Asks a board behind TCP that nobody else talks to. */
const ask = (name, line) => execFileSync(process.env.CAPSTAN_PROGRAM, ['shell', name], { input: `${line}\n`, encoding: 'latin1' });

async function armedAndLooker() {
  const served = await console_();
  const one = await open(served);
  const two = await open(served, { looks: true });
  await message(two, 'another page commands');
  await arm(one);
  await state(two, 'holding');
  return { served, one, two };
}

test('from the first request to a trace that moves: the time is printed, for it depends on what else the machine does', async () => {
  const served = await console_();
  const context = await rig.browser.newContext({ viewport: { width: 1280, height: 800 } });
  const page = await context.newPage();
  const began = performance.now();
  await page.goto(served.address);
  await page.waitForFunction(() => {
    const picture = document.querySelector('#plot canvas')?.toDataURL();
    window.pictures ??= new Set();
    if (picture !== undefined && document.querySelectorAll('#signals button').length > 0) window.pictures.add(picture);
    return window.pictures.size > 2;
  }, null, { timeout: kPatience });
  console.log(`console page: ${((performance.now() - began) / 1000).toFixed(2)} s from capstan console to a trace that moves`);
  await context.close();
});

test('arms, moves and disarms the simulated joint of capstan console, at 1 kHz without a loss', async () => {
  const one = await open(await console_());
  await until(one, () => /one every 1 ms, 0 lost/.test(document.getElementById('rate').textContent));
  await armMoveDisarm(one);
});

for (const kind of ['tcp', 'pty']) {
  test(`arms and moves a board by ${kind}; it says so when the board is gone, and reloading finds it again`, async () => {
    const there = await board(kind);
    const served = await console_(there.name);
    const one = await open(served);
    await arm(one);
    await type(one, 'move joint0 10 deg');
    await view(one, 'move');
    await one.page.waitForSelector('#joints .joint');
    await moved(one, 10);
    there.child.kill();
    await message(one, 'the connection to the board is lost');
    await message(one, 'may still have torque: press the emergency stop');
    assert.equal(await one.page.textContent('#state'), 'not connected');
    await one.page.reload();
    await message(one, kind === 'tcp' ? 'nothing answers' : 'the port does not open');
  });
}

test('the page that came second looks: it shows state and signals, and cannot arm, move or set', async () => {
  const { two } = await armedAndLooker();
  await until(two, () => /\d+ samples kept, one every 1 ms/.test(document.getElementById('rate').textContent));
  assert.ok(await two.page.isDisabled('#arm'));
  await view(two, 'shell');
  await two.page.fill('#line', 'move joint0 10 deg');
  await two.page.press('#line', 'Enter');
  await said(two, 'another page commands this board');
  assert.equal(await two.page.textContent('#state'), 'holding');
});

test('a page that looks takes the torque away, and the other goes on talking', async () => {
  const { one, two } = await armedAndLooker();
  await two.page.click('#disarm');
  await state(two, 'disarmed');
  await state(one, 'disarmed');
  assert.match(await type(one, 'version'), /capstan \S+ board sim.*\nok/s);
  await arm(one);
  await two.page.keyboard.press('Space');
  await state(one, 'disarmed');
});

test('a page that looks and loses focus takes nothing away', async () => {
  const { one, two } = await armedAndLooker();
  await two.page.evaluate(() => window.dispatchEvent(new Event('blur')));
  await two.close();
  await one.page.waitForTimeout(700);
  assert.equal(await one.page.textContent('#state'), 'holding');
});

test('the command is taken without torque', async () => {
  const { one, two } = await armedAndLooker();
  await two.page.click('#take');
  await state(two, 'disarmed');
  await until(two, () => document.querySelectorAll('#signals button').length > 0);
  await message(one, 'another page commands');
  await arm(two);
  await state(one, 'holding');
});

test('a page that crashes takes the torque along, and the other one commands', async () => {
  const { one, two } = await armedAndLooker();
  await one.page.goto('chrome://crash').catch(() => undefined);
  await state(two, 'disarmed');
  await until(two, () => document.getElementById('take').hidden);
  await arm(two);
});

test('a page that hangs for more than a second loses the torque', async () => {
  const { one, two } = await armedAndLooker();
  await one.page.evaluate(() => {
    const end = performance.now() + 2500;
    while (performance.now() < end);
  });
  await state(two, 'disarmed');
  await state(one, 'disarmed');
  await said(one, 'the connection counts as lost');
});

test('a page that is reloaded under torque comes back without', async () => {
  const one = await open(await console_());
  await arm(one);
  await one.page.reload();
  await state(one, 'disarmed');
  await until(one, () => document.getElementById('events').textContent.includes('disarmed'));
});

test('capstan console that ends takes the torque along, and the page says so', async () => {
  for (const signal of ['SIGTERM', 'SIGKILL']) {
    const there = await board();
    const served = await console_(there.name);
    const one = await open(served);
    await arm(one);
    served.child.kill(signal);
    await message(one, 'capstan console has gone');
    await eventually(() => /state disarmed/.test(ask(there.name, 'status')), 'a board that its console has left');
  }
});

test('garbage on the line is no state, no sample and no end', async () => {
  const there = await board();
  const line = await between(there.port, (text) => text);
  const one = await open(await console_(line.name));
  await until(one, () => document.querySelectorAll('#fault-kind option').length > 0);  // what the page asks first is answered
  let random = 7;
  line.say(Uint8Array.from({ length: 5000 }, () => (random = (random * 48271) % 2147483647) & 0xff));
  await one.page.waitForTimeout(300);
  await arm(one);
  await one.page.click('#disarm');
  await state(one, 'disarmed');
  line.close();
});

test('a board of another version is told', async () => {
  const there = await board();
  const line = await between(there.port, (text) => text.replace(/capstan \S+ board/, 'capstan 9.9.9 board'));
  const one = await open(await console_(line.name));
  await message(one, "the board's firmware is version 9.9.9, this page is of ");
  line.close();
});

test('a port that is taken is told in a sentence: of the page, and of the board', async () => {
  const served = await console_();
  await assert.rejects(console_('--listen', String(served.port)), /ended with 2: capstan: --listen \d+: the port cannot be opened .*; give another one/);
  const there = await board('pty');
  await console_(there.name);
  await assert.rejects(console_(there.name), /ended with 2: .*another Capstan program uses this port; end it first/);
  await assert.rejects(console_(`tcp:${await freePort()}`), /ended with 2: .*nothing answers/);
});

const answer = (one, part) => until(one, (wanted) => document.getElementById('diagnose-answer').textContent.includes(wanted), part);
async function diagnoseFile(one, csv) {
  await view(one, 'diagnose');
  await one.page.selectOption('#diagnose-source', 'file');
  await one.page.selectOption('#diagnose-target', 'q2_rad');
  await one.page.setInputFiles('#diagnose-file', { name: 'log.csv', mimeType: 'text/csv', buffer: Buffer.from(csv) });
  await one.page.click('#diagnose-run');
}

test('a log is diagnosed beside its loop, the report is shown, and APPLY gives the law to the board', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'capstan_'));
  const scenario = new URL('../../../tools/scenarios/identify.toml', import.meta.url).pathname;
  execFileSync(process.env.CAPSTAN_PROGRAM, ['run', '--scenario', scenario, '--fast', '--plant-effect', 'play=0.03', '--log', join(folder, 'run.csv')]);
  const rows = readFileSync(join(folder, 'run.csv'), 'utf8').trim().split('\n');
  rmSync(folder, { recursive: true });
  const csv = rows.filter((_, i) => i % 10 === 0).join('\n');
  const one = await open(await console_());
  assert.doesNotMatch(await type(one, 'model'), /play/);
  await diagnoseFile(one, csv);
  await one.page.waitForFunction(() => /^verdict: /.test(document.getElementById('diagnose-answer').textContent), null, { timeout: 60000 });
  const [, before, after] = /verdict: effect.*\(.*play.*\); error before (\S+) rad, after (\S+) rad/.exec(await one.page.textContent('#diagnose-answer'));
  assert.ok(Number(after) < 0.2 * Number(before), `${before} ${after}`);
  const report = one.page.frameLocator('#diagnose-report iframe');
  await report.locator('h1').waitFor({ timeout: kPatience });
  assert.equal(await report.locator('h1').textContent(), 'Diagnosis of axis0/q2_rad');
  await one.page.screenshot({ path: join(process.env.CAPSTAN_PICTURES, 'diagnose.png') });
  await one.page.click('#diagnose-apply');
  await answer(one, 'the board has the law now');
  assert.match(await type(one, 'model'), /play/);
  await view(one, 'diagnose');
  await one.page.selectOption('#diagnose-task', 'identify');
  await one.page.selectOption('#diagnose-model', 'kinematic');
  await one.page.click('#diagnose-run');
  await one.page.waitForFunction(() => /^kinematic: error \(RMSE\) \S+ rad/.test(document.getElementById('diagnose-answer').textContent), null, { timeout: 60000 });
  assert.match(await one.page.textContent('#diagnose-said'), /95 % interval/);
  const changed = () => one.page.$$eval('#diagnose-table tbody tr', (all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  const changes = await changed();
  assert.ok(changes.length > 0 && changes.every(([name, before, after]) => /^joint0\./.test(name) && before !== '' && after !== ''), JSON.stringify(changes));
  await one.page.click('#diagnose-apply');
  await answer(one, 'the board has the law now');
  assert.doesNotMatch(await type(one, 'model'), /play/);
  await view(one, 'diagnose');
  await one.page.setInputFiles('#diagnose-file', { name: 'log.csv', mimeType: 'text/csv', buffer: Buffer.from(csv.replaceAll('axis0/', 'axis1/')) });
  await one.page.click('#diagnose-run');
  await answer(one, 'axis0/q1_rad');  // which this log has not
  await one.page.evaluate(() => (document.querySelector('#diagnose-joint option').value = 'joint1'));
  await one.page.click('#diagnose-run');
  await eventually(async () => (await changed()).length > 0, 'what APPLY would change');
  assert.deepEqual((await changed()).filter(([name]) => !name.startsWith('joint1.')), []);
});

test('an experiment of the board is diagnosed; a log that is none is told in a sentence, and so is none at all', async () => {
  const one = await open(await console_());
  await view(one, 'diagnose');
  await one.page.click('#diagnose-run');
  await answer(one, 'there is no log yet; run an experiment in Move');
  await diagnoseFile(one, 'a poem\n');
  await answer(one, 'this is no log: its first line names no column time_s');
  await diagnoseFile(one, 'time_s,axis0/q1_rad\n0,zero\n');
  await answer(one, 'capstan: log.csv');
  assert.ok(await one.page.isDisabled('#diagnose-apply'));
  await arm(one);
  await view(one, 'move');
  await one.page.selectOption('#experiment-recipe', 'triangle');
  await one.page.fill('#experiment-options', 'amplitude=0.4 speeds=1 cycles=2 repeats=2 every=10');
  await one.page.click('#experiment-run');
  await until(one, () => document.getElementById('experiment-answer').textContent.startsWith('done: '));
  await view(one, 'diagnose');
  await one.page.selectOption('#diagnose-source', 'experiment');
  await one.page.selectOption('#diagnose-target', 'tau_Nm');
  await one.page.click('#diagnose-run');
  await one.page.waitForFunction(() => /^verdict: /.test(document.getElementById('diagnose-answer').textContent), null, { timeout: 60000 });
  assert.equal(await one.page.textContent('#state'), 'holding', 'the board is not left meanwhile');
});

test('an answer that is lost while the page learns what the board has is asked for again', async () => {
  const there = await board();
  let lost = 0;
  const line = await between(there.port, (text) => {
    if (lost === 0 && text.includes('experiment jointN')) lost = performance.now();
    return lost > 0 && performance.now() - lost < 300 ? '' : text;
  });
  const one = await open(await console_(line.name));
  await until(one, () => document.querySelectorAll('#experiment-recipe option').length > 0);
  assert.ok(lost > 0);
});

test("Foxglove's own client sees the signals, with and without a page, and can do nothing else", async () => {
  const served = await console_('--foxglove');
  const one = await foxglove(served);
  await eventually(() => one.topics.size === 1, 'a topic');
  assert.equal(one.info.name, 'capstan console');
  const alone = [...one.topics.values()][0];
  assert.deepEqual([alone.topic, alone.encoding, alone.schemaEncoding], ['axis0', 'json', 'jsonschema']);
  const id = one.client.subscribe(alone.id);
  await eventually(() => one.messages.length > 20, 'messages');
  const columns = ['q2_ref_rad', 'q2_est_rad', 'q1_rad', 'tau_Nm'];
  for (const message of one.messages) assert.deepEqual([message.subscriptionId, Object.keys(message.data).sort()], [id, columns.toSorted()]);
  assert.deepEqual(Object.keys(JSON.parse(alone.schema).properties).sort(), columns.toSorted());
  assert.ok(Math.abs(Number(one.messages.at(-1).timestamp) / 1e6 - Date.now()) < 5000, 'time of day');
  const passed = one.messages.slice(1).map((message, i) => Number(message.timestamp - one.messages[i].timestamp) / 1e6);
  assert.deepEqual([...new Set(passed)], [10]);
  one.client.setParameters([{ name: 'joint0.control.kp', value: 5 }], 'x');
  one.socket.send('garbage');
  one.socket.send(JSON.stringify({ op: 'subscribe' }));
  await eventually(() => one.status.length === 3, 'three refusals');
  const page = await open(served);
  await page.page.selectOption('#signal-add', 'joint0.current');
  await eventually(() => [...one.topics.values()].some((topic) => topic.id !== alone.id && topic.schema.includes('current_A')), 'what the page chose');
  one.messages.length = 0;
  one.client.subscribe([...one.topics.keys()].at(-1));
  await arm(page);
  await type(page, 'move joint0 10 deg');
  await eventually(() => one.messages.some((message) => Math.abs(message.data.q2_est_rad * 180 / Math.PI - 10) < 1), 'the motion');
  one.client.close();
});
