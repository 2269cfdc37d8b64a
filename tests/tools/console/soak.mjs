// SPDX-License-Identifier: Apache-2.0
// node soak.mjs MINUTES: eight signals at 1 kHz for so long; prints samples lost, pictures a second and memory. By hand, with the
// environment that CMakeLists.txt gives the tests.
import { arm, launch, open, serve, type, view } from './browser.mjs';

const minutes = Number(process.argv[2] ?? 10);
const browser = await launch();
const server = await serve();
const one = await open(browser, server.address);
for (const signal of ['joint0.current', 'joint0.drive', 'joint0.disturbance', 'joint0.misfit']) await one.page.selectOption('#signal-add', signal);
await one.page.waitForTimeout(500);
await arm(one);
const session = await one.page.context().newCDPSession(one.page);
async function report(at) {
  await session.send('HeapProfiler.collectGarbage');
  const { usedSize } = await session.send('Runtime.getHeapUsage');
  console.log(`${at} min: ${await one.page.textContent('#rate')}; heap ${(usedSize / 1e6).toFixed(2)} MB`);
}
for (let minute = 0; minute < minutes; ++minute) {
  for (const degrees of [20, -20]) {
    await type(one, `move joint0 ${degrees} deg`);
    await view(one, 'live');
    await one.page.waitForTimeout(30000);
  }
  await report(minute + 1);
}
console.log(one.complaints);
await browser.close();
server.close();
