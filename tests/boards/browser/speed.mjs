// SPDX-License-Identifier: Apache-2.0
// node speed.mjs MODULE: prints how many times faster than real time the module is, armed and moving. A figure, no test.
import { Board } from './module.mjs';

for (const [name, scenario] of [['one axis', ''], ['three axes', 'instrument = "da_vinci_wrist.toml"']]) {
  const board = new Board(process.argv[2]);
  board.start(scenario);
  board.ask('arm');
  board.ask('move joint0 30 deg');
  board.tick(2000);
  board.ask('move joint0 -30 deg');
  const began = performance.now();
  board.tick(10000);
  console.log(`${name}: ${(10000 / (performance.now() - began)).toFixed(0)} times real time (WebAssembly in Node)`);
}
