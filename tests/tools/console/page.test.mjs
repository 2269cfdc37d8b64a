// SPDX-License-Identifier: Apache-2.0
// node --test page.test.mjs: what the page shows and does, in Chromium.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, readdirSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import test, { before } from 'node:test';
import { arm, eventually, kPatience, moved, pages, site, state, type, view } from './browser.mjs';

const pictures = process.env.CAPSTAN_PICTURES;
const { McapIndexedReader } = createRequire(join(process.env.CAPSTAN_NODE_MODULES, 'any.js'))('@mcap/core');
const rig = pages();
before(() => mkdirSync(pictures, { recursive: true }));
const fresh = (options) => rig.open(options);
const text = ({ page }, place) => page.textContent(place);
const until = ({ page }, check, given) => page.waitForFunction(check, given, { timeout: kPatience });

test('the page is below 1.5 MB with the simulator', () => {
  const bytes = readdirSync(site).reduce((sum, file) => sum + statSync(join(site, file)).size, 0);
  console.log(`console page: ${(bytes / 1e6).toFixed(2)} MB with the simulator`);
  assert.ok(bytes < 1.5e6, `${bytes} bytes`);
});

test('arms, moves by a click, and the trace shows it', async () => {
  const one = await fresh();
  await arm(one);
  await view(one, 'move');
  await one.page.click('text="+10 deg"');
  await one.page.click('text="+10 deg"');
  await moved(one, 20);
  await view(one, 'live');
  const ink = () => one.page.evaluate(() => {
    const canvas = document.querySelector('#plot canvas');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let blue = 0;
    for (let i = 0; i < data.length; i += 4) blue += data[i] < 40 && data[i + 2] > 140 && data[i + 3] > 60 ? 1 : 0;  // a line that moves is thin
    return blue;
  });
  await eventually(async () => (await ink()) > 300, 'the trace of the reference');
  await one.page.screenshot({ path: join(pictures, 'live.png') });
});

test('samples come at 1 kHz and none is lost', async () => {
  const one = await fresh({ everyPicture: true });
  await one.page.selectOption('#window', '2');
  for (const signal of ['joint0.current', 'joint0.drive', 'joint0.disturbance', 'joint0.misfit']) {
    await one.page.selectOption('#signal-add', signal);
    await until(one, (name) => document.getElementById('signals').textContent.includes(name), signal);
  }
  await one.page.waitForTimeout(1500);
  const session = await one.page.context().newCDPSession(one.page);
  const heap = async () => {
    await session.send('HeapProfiler.collectGarbage');
    return (await session.send('Runtime.getHeapUsage')).usedSize / 1e6;
  };
  const machine = await rig.browser.newBrowserCDPSession();
  const processor = async () => (await machine.send('SystemInfo.getProcessInfo')).processInfo.reduce((sum, process) => sum + process.cpuTime, 0);
  await one.page.evaluate(() => {
    window.pictures = 0;
    const count = () => requestAnimationFrame(() => (++window.pictures, count()));
    count();
  });
  const [heapBefore, before] = [await heap(), await processor()];
  await one.page.waitForTimeout(4000);
  const [pictures, used] = [await one.page.evaluate(() => window.pictures), (await processor()) - before];
  const grown = (await heap()) - heapBefore;
  const words = await text(one, '#rate');
  console.log(`eight signals: ${words}; ${((1000 * used) / pictures).toFixed(1)} ms of a processor for each of ${pictures} pictures, all of the browser and the simulator in it; heap ${grown.toFixed(2)} MB more after 4 s`);
  assert.ok(used < 2 * pictures / 50, 'two processors without other work draw 50 pictures a second');
  assert.ok(grown < 1, `${grown} MB`);
  const [, samples, every, lost] = /^(\d+) samples kept, one every (\d+) ms, (\d+) lost/.exec(words);
  assert.equal(every, '1');
  assert.equal(lost, '0');
  assert.ok(Number(samples) > 200, words);
  await one.page.selectOption('#signal-add', 'joint0.mode');
  await until(one, () => document.getElementById('message').textContent.includes('8 signals at most'));
});

test('a log that is saved is one by the contract', async () => {
  const one = await fresh();
  await one.page.waitForTimeout(1500);
  await one.page.click('#pause');
  const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click('#csv')]);
  const rows = readFileSync(await download.path(), 'utf8').trim().split('\n');
  assert.equal(rows[0], 'time_s,axis0/q2_ref_rad,axis0/q2_est_rad,axis0/q1_rad,axis0/tau_Nm');
  const times = rows.slice(1).map((row) => Number(row.split(',')[0]));
  assert.ok(times.length > 100 && times.every((time, i) => i === 0 || Math.abs(time - times[i - 1] - 0.001) < 1e-9));
});

test('pause stops the picture, a drag zooms, a double click shows all again', async () => {
  const one = await fresh();
  await one.page.waitForTimeout(600);
  await one.page.click('#pause');
  const picture = () => one.page.evaluate(() => document.querySelector('#plot canvas').toDataURL());
  await one.page.waitForTimeout(500);
  const still = await picture();
  await one.page.waitForTimeout(500);
  assert.equal(await picture(), still);
  const window = () => one.page.$eval('#cursor-a', (slider) => [Number(slider.min), Number(slider.max)]);
  const whole = await window();
  const box = await one.page.locator('#plot .u-over').boundingBox();
  await one.page.mouse.move(box.x + box.width * 0.9, box.y + 80);
  await one.page.mouse.down();
  await one.page.mouse.move(box.x + box.width * 0.95, box.y + 80, { steps: 4 });
  await one.page.mouse.up();
  await eventually(async () => (await picture()) !== still, 'another picture');
  await one.page.mouse.dblclick(box.x + box.width / 2, box.y + 80);
  await eventually(async () => String(await window()) === String(whole), 'the window before');
});

test('time goes as fast as it can, more than 20 times real time in this browser, and the page stays in charge', async () => {
  const one = await fresh();
  await type(one, 'frames off');
  await arm(one);
  await type(one, 'move joint0 30 deg');
  const cycles = async () => Number(/cycles (\d+)/.exec(await type(one, 'status'))[1]);
  await one.page.selectOption('#speed', 'Infinity');
  const [from, began] = [await cycles(), performance.now()];
  await one.page.waitForTimeout(1500);
  const times = ((await cycles()) - from) / (performance.now() - began);
  console.log(`console page: ${times.toFixed(0)} times real time in the browser, one axis`);
  assert.ok(times > 20, `${times}`);
  await one.page.keyboard.press('Escape');
  await state(one, 'disarmed');
  await one.page.selectOption('#speed', '1');
  await arm(one);
});

test('a file that is no log is told in a sentence', async () => {
  const one = await fresh();
  await view(one, 'diagnose');
  await one.page.selectOption('#diagnose-source', 'file');
  await one.page.setInputFiles('#diagnose-file', { name: 'poem.csv', mimeType: 'text/csv', buffer: Buffer.from('so much depends\nupon\n') });
  await one.page.click('#diagnose-run');
  await until(one, () => document.getElementById('diagnose-answer').textContent.startsWith('this is no log: its first line names no column time_s'));
});

test('an experiment runs, is drawn and ends in a log; another is stopped, and one unarmed is refused', async () => {
  const one = await fresh();
  const answer = (part) => until(one, (wanted) => document.getElementById('experiment-answer').textContent.includes(wanted), part);
  await view(one, 'move');
  await one.page.selectOption('#experiment-recipe', 'triangle');
  await one.page.fill('#experiment-options', 'amplitude=0.1 speeds=1 cycles=1 repeats=1 every=1');
  await one.page.click('#experiment-run');
  await answer('not_holding: ');
  await arm(one);
  await one.page.click('#experiment-run');
  await answer('done: ');
  const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click('#experiment-save')]);
  const rows = readFileSync(await download.path(), 'utf8').trim().split('\n');
  assert.match(rows[0], /^time_s,axis0\/q1_rad,/);
  assert.ok(rows.length > 300, `${rows.length} rows`);
  await view(one, 'live');
  await until(one, () => document.getElementById('plot').textContent.includes('axis0/q1_rad'));
  await one.page.click('#go-on');
  await until(one, () => document.getElementById('plot').textContent.includes('joint0.q2'));
  await view(one, 'move');
  await one.page.fill('#experiment-options', 'amplitude=0.1 speeds=0.2 cycles=20');
  await one.page.click('#experiment-run');
  await until(one, () => /^runs: \d\d/.test(document.getElementById('experiment-answer').textContent));
  await one.page.click('#experiment-stop');
  await answer('ended early');
  await state(one, 'holding');
});

test('the scope captures around a trigger, with what was before; a level that is none is refused', async () => {
  const one = await fresh();
  const answer = (part) => until(one, (wanted) => document.getElementById('scope-answer').textContent.includes(wanted), part);
  await one.page.click('#scope summary');
  await one.page.fill('#scope-level', 'high');
  await one.page.click('#scope-form button[type="submit"]');
  await answer('not_a_level');
  await one.page.fill('#scope-level', '5 deg');
  await one.page.fill('#scope-samples', '400');
  await one.page.fill('#scope-before', '100');
  await one.page.click('#scope-form button[type="submit"]');
  await answer('waiting for its trigger');
  await arm(one);
  await view(one, 'move');
  await one.page.waitForSelector('#joints .joint');
  await one.page.click('text="+10 deg"');
  await view(one, 'live');
  await answer('captured 400 samples');
  const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click('#csv')]);
  const rows = readFileSync(await download.path(), 'utf8').trim().split('\n').slice(1).map((row) => row.split(',').map(Number));
  assert.equal(rows.length, 400);
  assert.deepEqual([rows[0][0], rows[100][0]], [-0.1, 0]);
  assert.ok(rows[99][1] < (5 * Math.PI) / 180 && rows[100][1] >= (5 * Math.PI) / 180 - 1e-6, 'the reference crosses 5 degrees there');
});

test('without a host program the log of an experiment is offered, with the command to run', async () => {
  const one = await fresh();
  await arm(one);
  await view(one, 'move');
  await one.page.selectOption('#experiment-recipe', 'triangle');
  await one.page.fill('#experiment-options', 'amplitude=0.1 speeds=1 cycles=1 repeats=1 every=1');
  await one.page.click('#experiment-run');
  await until(one, () => document.getElementById('experiment-answer').textContent.startsWith('done: '));
  await view(one, 'diagnose');
  const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click('#diagnose-run')]);
  assert.match(readFileSync(await download.path(), 'utf8'), /^time_s,axis0\/q1_rad,axis0\/tau_Nm/);
  assert.match(await text(one, '#diagnose-command'), /capstan diagnose capstan_log\.csv --target axis0\/tau_Nm/);
});

test('a log is saved as MCAP with what the CSV has, and MCAP that its own library reads', async () => {
  const one = await fresh();
  await one.page.waitForTimeout(800);
  await one.page.click('#pause');
  const save = async (button) => {
    const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click(button)]);
    return readFileSync(await download.path());
  };
  const rows = (await save('#csv')).toString().trim().split('\n');
  const bytes = await save('#mcap');
  const reader = await McapIndexedReader.Initialize({ readable: {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)),
  } });
  const messages = [];
  for await (const message of reader.readMessages()) messages.push({ time: Number(message.logTime) / 1e9, ...JSON.parse(Buffer.from(message.data).toString()) });
  assert.deepEqual([...reader.channelsById.values()].map((channel) => channel.topic), ['axis0']);
  const names = rows[0].split(',').map((name) => name.replace('axis0/', ''));
  assert.equal(messages.length, rows.length - 1);
  messages.forEach((message, i) => assert.deepEqual(rows[i + 1].split(',').map(Number), names.map((name) => message[name === 'time_s' ? 'time' : name])));
});

test('a parameter is staged, taken whole, and marked; what is refused changes nothing', async () => {
  const one = await fresh();
  await view(one, 'parameters');
  const row = (name) => `tr[data-name="joint0.${name}"]`;
  await one.page.waitForSelector(row('control.kp'));
  await one.page.fill('#search', 'joint loop');
  assert.ok(await one.page.isHidden(row('limits.current')));
  assert.match(await text(one, row('control.kp')), /0 to 20.*0\.2.*proportional.*changes at any time/s);
  await one.page.fill(`${row('control.kp')} input`, '0.3');
  await one.page.fill(`${row('control.ki')} input`, '500');
  await one.page.click('#commit');
  await until(one, () => document.getElementById('message').textContent.includes('nothing was changed'));
  assert.match(await text(one, row('control.ki')), /range: control\.ki takes 0 to 100/);
  assert.match(await type(one, 'get joint0.control.kp'), /kp 0\.2 /);
  await view(one, 'parameters');
  await one.page.fill(`${row('control.ki')} input`, '5');
  await one.page.click('#commit');
  await until(one, () => document.getElementById('staged').textContent === '');
  assert.match(await type(one, 'get joint0.control.kp'), /kp 0\.3 /);
  assert.match(await type(one, 'get joint0.control.ki'), /ki 5 /);
  await view(one, 'parameters');
  await one.page.check('#changed-only');
  await one.page.fill('#search', '');
  assert.equal(await one.page.locator('#parameter-table tbody tr:visible').count(), 2);
  await one.page.screenshot({ path: join(pictures, 'parameters.png') });
  await one.page.click('#save');
  await until(one, () => document.getElementById('message').textContent.startsWith('saved'));
});

test('a safety limit needs maintenance, and undo takes an edit back', async () => {
  const one = await fresh();
  await view(one, 'parameters');
  const field = 'tr[data-name="joint0.limits.current"] input';
  await one.page.waitForSelector(field);
  await one.page.fill(field, '2');
  await one.page.click('#commit');
  await until(one, () => document.querySelector('tr[data-name="joint0.limits.current"]').textContent.includes('maintenance open'));
  await one.page.click('#undo');
  assert.equal(await one.page.inputValue(field), '3');
  await one.page.click('#maintenance');
  await until(one, () => document.getElementById('message').textContent.includes('ten minutes'));
  await one.page.fill(field, '2');
  await one.page.click('#commit');
  await until(one, () => document.getElementById('message').textContent.startsWith('taken'));
});

test('a fault by a click is shown with cause and cure, and blocks arming until it is over', async () => {
  const one = await fresh();
  await arm(one);
  await view(one, 'break');
  await one.page.selectOption('#fault-target', 'encoder');
  await one.page.selectOption('#fault-kind', 'off');
  await one.page.fill('#fault-for', '15');
  await one.page.click('text="Break it now"');
  await state(one, 'faulted by sensor_missing');
  await view(one, 'states');
  await until(one, () => /latched sensor_missing: .*To do: /.test(document.getElementById('faults').textContent));
  assert.equal(await one.page.locator('#machine .here').getAttribute('data-state'), 'faulted');
  await one.page.screenshot({ path: join(pictures, 'fault.png') });
  await one.page.click('#disarm');
  await state(one, 'disarmed');
  await one.page.click('#arm');
  await one.page.click('#arm-confirm');
  await until(one, () => document.getElementById('message').textContent.includes('blocked by sensor_missing'));
  assert.equal(await text(one, '#state'), 'disarmed');
  await one.page.selectOption('#speed', '5');
  await until(one, () => !/present|blocked/.test(document.getElementById('faults').textContent));
  await arm(one);
});

test('a fault that cannot be is refused by a sentence', async () => {
  const one = await fresh();
  await view(one, 'break');
  await one.page.selectOption('#fault-target', 'encoder');
  await one.page.selectOption('#fault-kind', 'snap');
  await one.page.click('text="Break it now"');
  await until(one, () => document.getElementById('fault-answer').textContent.startsWith('fault: '));
});

test('an effect that the firmware does not know, and one that is none', async () => {
  const one = await fresh();
  await view(one, 'break');
  await one.page.selectOption('#effect', 'play.half_width_rad');
  await one.page.fill('#effect-value', '7');
  await one.page.click('text="Restart with it"');
  await until(one, () => /impossible/.test(document.getElementById('effect-answer').textContent));
  await one.page.fill('#effect-value', '0.05');
  await one.page.click('text="Restart with it"');
  await until(one, () => document.getElementById('effect-answer').textContent.startsWith('restarted with play'));
  await state(one, 'disarmed');
  await arm(one);
});

test('a plant that diverges is told, and a start anew leads on', async () => {
  const one = await fresh();
  await view(one, 'break');
  await one.page.selectOption('#effect', 'stiffness_hardening.per_n');
  await one.page.fill('#effect-value', '100');
  await one.page.click('text="Restart with it"');
  await until(one, () => document.getElementById('effect-answer').textContent.startsWith('restarted'));
  await state(one, 'disarmed');
  await one.page.click('#arm');
  await one.page.click('#arm-confirm');
  await view(one, 'move');
  await one.page.waitForSelector('#joints .joint');
  for (let i = 0; i < 6 && (await text(one, '#state')) !== 'not connected'; ++i) {
    await one.page.click('text="+10 deg"', { timeout: 1000 }).catch(() => undefined);
    await one.page.waitForTimeout(200);
  }
  await until(one, () => document.getElementById('message').textContent.includes('the plant diverged'));
  await state(one, 'not connected');
  await view(one, 'break');
  await one.page.click('#effect-none');
  await state(one, 'disarmed');
  await arm(one);
});

test('another instrument has its own joints', async () => {
  const one = await fresh();
  await one.page.selectOption('#instrument', 'da_vinci_wrist');
  await view(one, 'move');
  await until(one, () => document.querySelectorAll('#joints .joint').length === 3);
  await one.page.screenshot({ path: join(pictures, 'move.png') });
  await view(one, 'diagnose');
  await one.page.selectOption('#diagnose-joint', 'joint2');
  assert.match(await text(one, '#diagnose-command'), /--target axis2\/tau_Nm .*--axis 2 .*apply law\.toml --axis 2 /);
});

test('everything that was asked of the server is the page itself', () => {
  assert.deepEqual([...new Set(rig.server.asked)].sort(), ['/', '/console.css', '/console.js', '/icon.svg']);
});

test('the page works from the folder, without a server', async () => {
  const began = performance.now();
  const one = await rig.open({}, `file://${site}/index.html`);
  console.log(`console page: signals ${Math.round(performance.now() - began)} ms after it was opened`);
  await one.page.context().setOffline(true);
  await arm(one);
});

test('no script of another can run, and nothing leaves the page', async () => {
  const one = await fresh();
  const { page } = one;
  const blocked = await page.evaluate(async () => {
    const script = document.createElement('script');
    script.textContent = 'window.injected = true';
    document.body.append(script);
    const left = await fetch('/index.html').then(() => 'left', () => 'stayed');
    setTimeout('window.injected = true');
    await new Promise((resolve) => setTimeout(resolve, 50));
    return { injected: window.injected === true, left };
  });
  assert.deepEqual(blocked, { injected: false, left: 'stayed' });
  assert.ok(one.complaints.length > 0 && one.complaints.every((line) => /Content Security Policy|Fetch API cannot load/.test(line)), one.complaints.join('\n'));
  one.complaints.length = 0;
});
