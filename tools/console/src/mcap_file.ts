// SPDX-License-Identifier: Apache-2.0
// A log as MCAP, in the form of the host program's: a topic for each axis, a JSON message per row and topic.
import { McapWriter } from '@mcap/core';
import type { Series } from './series';

/** Of the samples between two ticks; a log whose time begins before its trigger begins at 0. */
export async function mcapOf(series: Series, fromTick: number, toTick: number): Promise<Uint8Array[]> {
  const parts: Uint8Array[] = [];
  let size = 0n;
  const writer = new McapWriter({
    writable: {
      position: () => size,
      write: (bytes: Uint8Array) => {
        parts.push(bytes.slice());
        size += BigInt(bytes.length);
        return Promise.resolve();
      },
    },
  });
  await writer.start({ profile: '', library: 'capstan console' });
  const first = series.firstFrom(fromTick);
  const end = series.firstFrom(toTick + 1);
  const origin = Math.min(0, series.size > 0 ? series.tick(0) : 0);
  const text = new TextEncoder();
  const topics = new Map<string, { id: number; fields: [string, number][] }>();
  series.columns.forEach((column, i) => {
    const [, name = 'log', field = column] = /^(\w+)\/(.*)$/.exec(column) ?? [];
    topics.set(name, { id: 0, fields: [...(topics.get(name)?.fields ?? []), [field, i]] });
  });
  for (const [name, topic] of topics) {
    const properties = Object.fromEntries(topic.fields.map(([field]) => [field, { type: 'number' }]));
    const schemaId = await writer.registerSchema({ name: `capstan.${name}`, encoding: 'jsonschema', data: text.encode(JSON.stringify({ type: 'object', properties })) });
    topic.id = await writer.registerChannel({ topic: name, schemaId, messageEncoding: 'json', metadata: new Map() });
  }
  for (let i = first; i < end; ++i) {
    const logTime = BigInt(Math.round(series.tick(i) - origin)) * 1000000n;
    for (const topic of topics.values()) {
      const data = text.encode(JSON.stringify(Object.fromEntries(topic.fields.map(([field, channel]) => [field, series.value(channel, i)]))));
      await writer.addMessage({ channelId: topic.id, sequence: i - first, logTime, publishTime: logTime, data });
    }
  }
  await writer.end();
  return parts;
}
