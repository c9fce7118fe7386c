// Reads an MCAP file with the libraries of Foxglove and prints, as JSON, what it holds.
// Run where these packages are installed: node read_as_foxglove.mjs FILE

import { open } from 'node:fs/promises';
import { McapIndexedReader } from '@mcap/core';
import { parse } from '@foxglove/rosmsg';
import { MessageReader } from '@foxglove/rosmsg2-serialization';

const file = await open(process.argv[2]);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, length) => {
    const buffer = new Uint8Array(Number(length));
    await file.read(buffer, 0, buffer.length, Number(offset));
    return buffer;
  },
};
const reader = await McapIndexedReader.Initialize({ readable });
const decoders = new Map();
const topics = {};
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
  decoders.set(channel.id, [channel.topic, new MessageReader(definition)]);
  topics[channel.topic] = { type: schema.name, hash: channel.metadata.get('topic_type_hash'), messages: [] };
}
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const [topic, decoder] = decoders.get(message.channelId);
  const decoded = decoder.readMessage(message.data);
  const content = decoded.data instanceof Uint8Array ? Buffer.from(decoded.data).toString('base64') : decoded.data;
  topics[topic].messages.push({ stamp: String(message.logTime), ...decoded, data: content });
}
process.stdout.write(JSON.stringify({ profile: reader.header.profile, topics }));
