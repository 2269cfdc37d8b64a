// SPDX-License-Identifier: Apache-2.0
// node --test looks.test.mjs: what people see: pictures of each view, both themes, small and large screens, what screen readers read.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import test, { before } from 'node:test';
import { arm, eventually, kPatience, moved, pages, state, type, view } from './browser.mjs';

const pictures = process.env.CAPSTAN_PICTURES;
const axe = createRequire(join(process.env.CAPSTAN_NODE_MODULES, 'any.js')).resolve('axe-core/axe.min.js');
const kViews = ['live', 'states', 'move', 'setup', 'diagnose', 'parameters', 'break', 'shell'];
const rig = pages();
before(() => mkdirSync(pictures, { recursive: true }));
const fresh = (options) => rig.open(options);
const until = ({ page }, check, given) => page.waitForFunction(check, given, { timeout: kPatience });

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
  await compareWithReadme(one, join(pictures, 'xy.png'));
});

/** The README's picture is this test's: as large, and but for where the trace ends the same. */
async function compareWithReadme(one, made) {
  const kept = new URL('../../../docs/pictures/console.png', import.meta.url);
  const other = await rig.browser.newContext();
  const page = await other.newPage();
  const differs = await page.evaluate(async (files) => {
    const [a, b] = await Promise.all(files.map(async (file) => createImageBitmap(await (await fetch(`data:image/png;base64,${file}`)).blob())));
    if (a.width !== b.width || a.height !== b.height) return 1;
    const [left, right] = [a, b].map((image) => {
      const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height).data;
    });
    let count = 0;
    for (let i = 0; i < left.length; i += 4) count += Math.abs(left[i] - right[i]) + Math.abs(left[i + 1] - right[i + 1]) + Math.abs(left[i + 2] - right[i + 2]) > 60 ? 1 : 0;
    return (4 * count) / left.length;
  }, [made, kept].map((file) => readFileSync(file).toString('base64')));
  await other.close();
  console.log(`console page: ${(100 * differs).toFixed(1)} % of the README's picture differ from the test's`);
  assert.ok(differs < 0.1, `${differs}: cp build/browser/pictures/xy.png docs/pictures/console.png`);
}

test('a picture is saved', async () => {
  const one = await fresh();
  await one.page.waitForTimeout(300);
  const [download] = await Promise.all([one.page.waitForEvent('download'), one.page.click('#png')]);
  const picture = readFileSync(await download.path());
  assert.equal(picture.toString('latin1', 1, 4), 'PNG');
  const other = await rig.browser.newContext();
  const page = await other.newPage();
  const [ground, plotted] = await page.evaluate(async (file) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${file}`)).blob());
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, image.height - 20, image.width, 20);
    let coloured = 0;
    for (let i = 0; i < data.length; i += 4) coloured += data[i] < 200 ? 1 : 0;
    return [[...context.getImageData(1, 1, 1, 1).data], coloured];
  }, picture.toString('base64'));
  await other.close();
  assert.deepEqual(ground, [255, 255, 255, 255], 'it has its ground');
  assert.ok(plotted > 200, 'the lines are named below it');
});

test('two cursors on a plot that stands say what the signals are there and what lies between, by click and by keyboard', async () => {
  const one = await fresh();
  await arm(one);
  await type(one, 'move joint0 10 deg');
  await view(one, 'live');
  assert.ok(await one.page.isHidden('#cursors'), 'none while it moves');
  await one.page.waitForTimeout(1500);
  await one.page.click('#pause');
  await until(one, () => !document.getElementById('cursors').hidden);
  const cells = async () => Object.fromEntries(await one.page.$$eval('#cursor-table tbody tr', (all) => all.map((row) => [row.children[0].textContent, [...row.children].slice(1).map((cell) => parseFloat(cell.textContent))])));
  await one.page.focus('#cursor-a');
  await one.page.keyboard.press('Home');
  await one.page.focus('#cursor-b');
  await one.page.keyboard.press('End');
  const all = await cells();
  assert.ok(Math.abs(all['joint0.reference'][2] - (10 * Math.PI) / 180) < 1e-3, JSON.stringify(all));
  for (const [a, b, between] of Object.values(all)) assert.ok(Math.abs(b - a - between) < 1e-3);
  await one.page.keyboard.press('ArrowLeft');
  assert.ok(Math.abs((await cells()).time[1] - all.time[1] + 0.001) < 1e-6, 'one sample');
  const box = await one.page.locator('#plot .u-over').boundingBox();
  await one.page.mouse.click(box.x + box.width / 2, box.y + 60);
  await eventually(async () => {
    const { time } = await cells();
    return Math.min(...time.slice(0, 2).map((at) => Math.abs(at - (all.time[0] + all.time[1]) / 2))) < 0.02 * all.time[2];
  }, 'a cursor where the click was');
  await one.page.screenshot({ path: join(pictures, 'cursors.png') });
  await one.page.click('#pause');
  await until(one, () => document.getElementById('cursors').hidden);
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
      await one.page.screenshot({ path: join(pictures, `${colorScheme}_${name}.png`) });
    }
  });
}

test('DISARM stays where it is whatever the state says', async () => {
  const one = await fresh();
  const place = () => one.page.locator('#disarm').boundingBox();
  const before = await place();
  assert.ok(before.y < 10, JSON.stringify(before));
  await arm(one);
  await type(one, 'fail encoder off');
  await state(one, 'faulted by sensor_missing');
  assert.deepEqual(await place(), before);
  assert.ok(await one.page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
});

test('on a screen of 360 pixels nothing is wider than it', async () => {
  const one = await fresh({ viewport: { width: 360, height: 740 } });
  for (const name of kViews) {
    await view(one, name);
    await one.page.waitForTimeout(name === 'parameters' ? 1500 : 300);
    const width = await one.page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 360, `${name} is ${width} pixels wide`);
    const thin = await one.page.$$eval(`#${name} input, #${name} select, #${name} button`, (all) => all.filter((element) => element.offsetParent !== null && element.type !== 'checkbox' && element.getBoundingClientRect().width < 40).map((element) => element.id));
    assert.deepEqual(thin, [], `${name}: too narrow to use`);
    const disarm = await one.page.locator('#disarm').boundingBox();
    assert.ok(disarm.y + disarm.height <= 740 && disarm.width > 100 && disarm.height >= 44, `${name}: DISARM is in sight`);
    await one.page.screenshot({ path: join(pictures, `narrow_${name}.png`) });
  }
});

test('on a screen of 3840 by 2160 pixels texts are larger and the plot fills it', async () => {
  const one = await fresh({ viewport: { width: 3840, height: 2160 } });
  const size = await one.page.$eval('#pause', (button) => parseFloat(getComputedStyle(button).fontSize));
  assert.ok(size >= 20, `${size} pixels`);
  const plot = await one.page.locator('#plot canvas').boundingBox();
  assert.ok(plot.width > 3600 && plot.height > 1000, JSON.stringify(plot));
  for (const name of kViews) {
    await view(one, name);
    const width = await one.page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 3840, `${name} is ${width} pixels wide`);
    await one.page.screenshot({ path: join(pictures, `wide_${name}.png`) });
  }
});
