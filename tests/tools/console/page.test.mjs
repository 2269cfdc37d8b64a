// SPDX-License-Identifier: Apache-2.0
// node --test page.test.mjs: what the page shows and does, in Chromium.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, readdirSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import test, { before } from 'node:test';
import { arm, eventually, kPatience, moved, pages, site, state, type, view } from './browser.mjs';

const pictures = process.env.CAPSTAN_PICTURES;
const axe = createRequire(join(process.env.CAPSTAN_NODE_MODULES, 'any.js')).resolve('axe-core/axe.min.js');
const { McapIndexedReader } = createRequire(join(process.env.CAPSTAN_NODE_MODULES, 'any.js'))('@mcap/core');
const kViews = ['live', 'states', 'move', 'setup', 'diagnose', 'parameters', 'break', 'shell'];
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
  const one = await fresh();
  await one.page.selectOption('#window', '2');
  for (const signal of ['joint0.current', 'joint0.drive', 'joint0.disturbance', 'joint0.misfit']) {
    await one.page.selectOption('#signal-add', signal);
    await until(one, (name) => document.getElementById('signals').textContent.includes(name), signal);
  }
  await one.page.waitForTimeout(2500);
  const words = await text(one, '#rate');
  console.log(`eight signals: ${words}`);
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
  const box = await one.page.locator('#plot .u-over').boundingBox();
  await one.page.mouse.move(box.x + box.width * 0.9, box.y + 80);
  await one.page.mouse.down();
  await one.page.mouse.move(box.x + box.width * 0.95, box.y + 80, { steps: 4 });
  await one.page.mouse.up();
  await eventually(async () => (await picture()) !== still, 'another picture');
  await one.page.mouse.dblclick(box.x + box.width / 2, box.y + 80);
  await eventually(async () => (await picture()) === still, 'the picture before');
});

test('one signal against another', async () => {
  const one = await fresh();
  await arm(one);
  await view(one, 'move');
  for (const [button, degrees] of [['+10 deg', 10], ['-10 deg', 0], ['+10 deg', 10]]) {
    await one.page.click(`text="${button}"`);
    await moved(one, degrees);
  }
  await view(one, 'live');
  await one.page.selectOption('#plot-kind', 'xy');
  await one.page.waitForTimeout(200);
  assert.ok(await one.page.isVisible('#xy-plot'));
  assert.ok(await one.page.isHidden('#plot'));
  assert.equal(await one.page.inputValue('#xy-x'), 'joint0.q1');
  await one.page.screenshot({ path: join(pictures, 'xy.png') });
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

test('a picture is saved', async () => {
  const one = await fresh();
  await one.page.waitForTimeout(300);
  const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click('#png')]);
  assert.equal(readFileSync(await download.path()).toString('latin1', 1, 4), 'PNG');
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
  await one.page.click('text="Start anew with it"');
  await until(one, () => /impossible/.test(document.getElementById('effect-answer').textContent));
  await one.page.fill('#effect-value', '0.05');
  await one.page.click('text="Start anew with it"');
  await until(one, () => document.getElementById('effect-answer').textContent.startsWith('started anew with play'));
  await state(one, 'disarmed');
  await arm(one);
});

test('a plant that diverges is told, and a start anew leads on', async () => {
  const one = await fresh();
  await view(one, 'break');
  await one.page.selectOption('#effect', 'stiffness_hardening.per_n');
  await one.page.fill('#effect-value', '100');
  await one.page.click('text="Start anew with it"');
  await until(one, () => document.getElementById('effect-answer').textContent.startsWith('started anew'));
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
});

test('everything that was asked of the server is the page itself', () => {
  assert.deepEqual([...new Set(rig.server.asked)].sort(), ['/', '/console.css', '/console.js', '/icon.svg']);
});

test('the page works from the folder, without a server', async () => {
  const began = performance.now();
  const one = await rig.open({}, `file://${site}/index.html`);
  console.log(`console page: signals ${Math.round(performance.now() - began)} ms after it was opened`);
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

for (const colorScheme of ['light', 'dark']) {
  test(`axe finds nothing serious, ${colorScheme}`, async () => {
    const one = await fresh({ colorScheme, bypassCSP: true });
    await one.page.addScriptTag({ path: axe });
    await one.page.evaluate(() => document.querySelectorAll('details').forEach((one) => (one.open = true)));
    await view(one, 'parameters');
    await one.page.fill('#search', 'limits');  // some rows stand for all: axe takes its time
    for (const name of kViews) {
      await view(one, name);
      if (name === 'parameters') await one.page.waitForSelector('#parameter-table tbody tr:not([hidden])');
      await one.page.waitForTimeout(400);
      const { violations } = await one.page.evaluate(() => window.axe.run());
      const bad = violations.filter((one) => ['serious', 'critical'].includes(one.impact));
      assert.deepEqual(bad.map((one) => `${one.id}: ${one.nodes[0].html}`), [], name);
    }
    await view(one, 'live');
    await one.page.screenshot({ path: join(pictures, `${colorScheme}.png`) });
  });
}

test('on a screen of 360 pixels nothing is wider than it', async () => {
  const one = await fresh({ viewport: { width: 360, height: 740 } });
  for (const name of kViews) {
    await view(one, name);
    await one.page.waitForTimeout(name === 'parameters' ? 1500 : 300);
    const width = await one.page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 360, `${name} is ${width} pixels wide`);
  }
  await one.page.screenshot({ path: join(pictures, 'narrow.png') });
});
