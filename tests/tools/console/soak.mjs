// SPDX-License-Identifier: Apache-2.0
// node soak.mjs MINUTES [tcp]: eight signals at 1 kHz for so long, of the page's own simulator or of a board by TCP behind `capstan console`;
// prints samples lost, pictures a second and memory. By hand, with the environment that CMakeLists.txt gives the tests.
import { arm, launch, open, serve, type, view } from './browser.mjs';
import { board, console_, endAll } from './served.mjs';

const minutes = Number(process.argv[2] ?? 10);
const browser = await launch();
const server = process.argv[3] === 'tcp' ? await console_((await board()).name) : await serve();
const one = await open(browser, server.address, { everyPicture: true });
for (const signal of ['joint0.current', 'joint0.drive', 'joint0.disturbance', 'joint0.misfit']) {
  await one.page.selectOption('#signal-add', signal);
  await one.page.waitForFunction((name) => document.getElementById('signals').textContent.includes(name), signal);
}
await arm(one);
const session = await one.page.context().newCDPSession(one.page);
const rates = [];
async function report(at) {
  await session.send('HeapProfiler.collectGarbage');
  const { usedSize } = await session.send('Runtime.getHeapUsage');
  const of = rates.splice(0).sort((a, b) => a - b);
  console.log(`${at} min: ${await one.page.textContent('#rate')}; least, median, most of the minute ${of[0]}, ${of[of.length >> 1]}, ${of.at(-1)}; heap ${(usedSize / 1e6).toFixed(2)} MB`);
}
for (let minute = 0; minute < minutes; ++minute) {
  for (const degrees of [20, -20]) {
    await type(one, `move joint0 ${degrees} deg`);
    await view(one, 'live');
    await one.page.waitForTimeout(3000);  // the pictures are counted by the second, and there were none while the shell was in front
    for (let second = 3; second < 30; ++second) {
      await one.page.waitForTimeout(1000);
      rates.push(Number(/(\d+) pictures/.exec(await one.page.textContent('#rate'))[1]));
    }
  }
  await report(minute + 1);
}
console.log(one.complaints);
await browser.close();
server.close?.();
endAll();
process.exit(0);
