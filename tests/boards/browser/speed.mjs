// SPDX-License-Identifier: Apache-2.0
// node speed.mjs MODULE: how many times faster than real time the module is, armed and moving, by the processor's time: others may use this machine.
// Less than 20 times with one axis is an error.
import { Board } from './module.mjs';

for (const [name, scenario] of [['one axis', ''], ['three axes', 'instrument = "da_vinci_wrist.toml"']]) {
  const board = new Board(process.argv[2]);
  board.start(scenario);
  board.ask('arm');
  board.ask('move joint0 30 deg');
  board.tick(2000);
  board.ask('move joint0 -30 deg');
  const before = process.cpuUsage();
  board.tick(10000);
  const { user, system } = process.cpuUsage(before);
  const times = (10000 * 1000) / (user + system);
  console.log(`${name}: ${times.toFixed(0)} times real time (WebAssembly in Node, processor time)`);
  if (scenario === '' && times < 20) process.exitCode = 1;
}
