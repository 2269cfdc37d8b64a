// SPDX-License-Identifier: Apache-2.0
// Our MCAP files beside the reference implementation, npm's @mcap/core, both ways and in every compression.
// node mcap_core_test.mjs PARTNER MODULES FOLDER. Exit status 77: @mcap/core, zstd or lz4 is not installed (tools/setup does that).
import {createRequire} from 'node:module';
import {execFileSync} from 'node:child_process';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import assert from 'node:assert/strict';

const [partner, modules, folder] = process.argv.slice(2);
const skip = (what) => { console.log(`skipped: ${what} is not installed; tools/setup installs it`); process.exit(77); };
let core;
try { core = createRequire(modules + '/')('@mcap/core'); } catch { skip('npm module @mcap/core'); }
for (const tool of ['zstd', 'lz4']) { try { execFileSync(tool, ['--version'], {stdio: 'pipe'}); } catch { skip(tool); } }
mkdirSync(folder, {recursive: true});

const limit = {maxBuffer: 1 << 28};
const run = (tool, flags) => (bytes) => new Uint8Array(execFileSync(tool, flags, {input: bytes, ...limit}));
const decompressHandlers = {zstd: run('zstd', ['-dc']), lz4: run('lz4', ['-dc'])};
const compress = {zstd: run('zstd', ['-qc']), lz4: run('lz4', ['-qc'])};

class MemoryReadable {
  constructor(bytes) { this.bytes = bytes; }
  async size() { return BigInt(this.bytes.length); }
  async read(offset, length) { return new Uint8Array(this.bytes.subarray(Number(offset), Number(offset + length))); }
}

/// Everything that core reads from what we wrote: by its indices, and as a stream with all checksums.
async function readOurs(compression) {
  const path = `${folder}/ours_${compression || 'plain'}.mcap`;
  execFileSync(partner, ['write', compression || 'none', path]);
  const bytes = readFileSync(path);
  const reader = await core.McapIndexedReader.Initialize({readable: new MemoryReadable(bytes), decompressHandlers});
  assert.equal(reader.statistics.messageCount, 8000n);
  assert.equal(reader.statistics.channelMessageCounts.get(1), 2000n);
  assert.equal(reader.statistics.messageEndTime, 5999000000n);
  assert.equal(reader.statistics.chunkCount, reader.chunkIndexes.length);
  assert.ok(reader.chunkIndexes.length > 1, 'several chunks');
  const counts = {};
  for await (const message of reader.readMessages()) {
    const topic = reader.channelsById.get(message.channelId).topic;
    const value = JSON.parse(new TextDecoder().decode(message.data));
    const row = Number(message.logTime / 1000000n);
    if (topic === 'axis0') assert.equal(value.q1_rad, Number((0.001 * row).toPrecision(17)));
    else assert.equal(value.angle, -0.5 * row);
    counts[topic] = (counts[topic] ?? 0) + 1;
  }
  assert.deepEqual(counts, {axis0: 6000, camera: 2000});
  const some = [];
  for await (const message of reader.readMessages({topics: ['camera'], startTime: 3000000000n, endTime: 3010000000n})) some.push(message.logTime);
  assert.deepEqual(some, [3000000000n, 3003000000n, 3006000000n, 3009000000n], 'seeking by the indices');
  const stream = new core.McapStreamReader({decompressHandlers, validateCrcs: true});
  stream.append(bytes);
  const types = {};
  for (let record; (record = stream.nextRecord());) types[record.type] = (types[record.type] ?? 0) + 1;
  assert.ok(stream.done());
  assert.equal(types.Message, 8000);
  assert.equal(types.Footer, 1);
}

/// What we read from what core wrote.
async function readTheirs(compression) {
  const parts = [];
  let position = 0n;
  const writable = {position: () => position, write: async (b) => { parts.push(Buffer.from(b)); position += BigInt(b.length); }};
  const writer = new core.McapWriter({writable, chunkSize: 20000, compressChunk: compression ? (b) => ({compression, compressedData: compress[compression](b)}) : undefined});
  await writer.start({profile: '', library: 'test'});
  const schemaId = await writer.registerSchema({name: 'x', encoding: 'jsonschema', data: new TextEncoder().encode('{"type":"object"}')});
  const channel = async (topic) => writer.registerChannel({schemaId, topic, messageEncoding: 'json', metadata: new Map([['key', 'value']])});
  const [motor, joint] = [await channel('/axis0'), await channel('/camera')];
  let expected = 'time_s,axis0/q1_rad,camera/angle\n';
  const add = (channelId, logTime, value) => writer.addMessage({channelId, sequence: 0, logTime, publishTime: logTime, data: new TextEncoder().encode(JSON.stringify(value))});
  for (let i = 0; i < 2000; ++i) {
    const logTime = BigInt(i) * 2000000n;
    await add(motor, logTime, {q1_rad: i * 0.25});
    if (i % 2 === 0) await add(joint, logTime, {angle: -i});
    expected += `${Math.floor(i / 500)}.${String((i % 500) * 2000000).padStart(9, '0')},${i * 0.25},${i % 2 === 0 ? -i : ''}\n`;
  }
  await writer.addMetadata({name: 'm', metadata: new Map([['a', 'b']])});
  await writer.addAttachment({name: 'f', logTime: 0n, createTime: 0n, mediaType: 'text/plain', data: new Uint8Array([1, 2, 3])});
  await writer.end();
  const path = `${folder}/theirs_${compression || 'plain'}.mcap`;
  writeFileSync(path, Buffer.concat(parts));
  assert.equal(execFileSync(partner, ['read', path], limit).toString(), expected.replaceAll('-0\n', '0\n').replaceAll(',-0,', ',0,'));
}

for (const compression of ['', 'lz4', 'zstd']) {
  await readOurs(compression);
  await readTheirs(compression);
  console.log(`${compression || 'plain'}: read both ways`);
}
