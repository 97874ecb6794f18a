// Opens a finished recording with both readers of @mcap/core and compares what they see; prints counts per topic as JSON.
// SPDX-License-Identifier: Apache-2.0
//
// usage: node check.mjs FILE        exit 0: every checksum is present and right and both readers agree; 1: not so; 2: usage
import { open } from "node:fs/promises";
import { crc32 } from "node:zlib";

import { McapIndexedReader, McapStreamReader } from "@mcap/core";

const PIECE = 1 << 20;
const DATA_END_SIZE = 13;

function ensure(condition, what) {
  if (!condition) throw new Error(what);
}

/** What McapIndexedReader asks of a file. */
class Readable {
  constructor(handle) {
    this.handle = handle;
  }
  async size() {
    return BigInt((await this.handle.stat()).size);
  }
  async read(offset, length) {
    const bytes = new Uint8Array(Number(length));
    const { bytesRead } = await this.handle.read(bytes, 0, bytes.length, Number(offset));
    ensure(bytesRead === bytes.length, `the file ends inside a read at byte ${offset}`);
    return bytes;
  }
}

function count(counts, topic) {
  counts[topic] = (counts[topic] ?? 0) + 1;
}

/** From front to back, as a reader of a pipe would. */
async function readAsStream(handle, size) {
  const reader = new McapStreamReader({ validateCrcs: true, includeChunks: true });
  const topics = new Map();
  const seen = { counts: {}, chunks: 0, metadata: [], dataSectionCrc: undefined, bytes: 0 };
  const piece = Buffer.alloc(PIECE);
  for (let at = 0; at < size; ) {
    const { bytesRead } = await handle.read(piece, 0, PIECE, at);
    ensure(bytesRead > 0, "the file shrank");
    reader.append(piece.subarray(0, bytesRead));
    at += bytesRead;
    for (let record; (record = reader.nextRecord()); ) {
      if (record.type === "Channel") topics.set(record.id, record.topic);
      if (record.type === "Message") {
        count(seen.counts, topics.get(record.channelId));
        seen.bytes += record.data.length;
      }
      if (record.type === "Chunk") {
        seen.chunks += 1;
        ensure(record.uncompressedCrc !== 0, "a chunk has no checksum");
      }
      if (record.type === "Metadata") seen.metadata.push([record.name, Object.fromEntries(record.metadata)]);
      if (record.type === "DataEnd") seen.dataSectionCrc = record.dataSectionCrc;
    }
  }
  ensure(reader.done() && reader.bytesRemaining() === 0, "the stream reader is not done at the end of the file");
  return seen;
}

/** Through the summary, message by message in the order of time. */
async function readThroughSummary(handle) {
  const reader = await McapIndexedReader.Initialize({ readable: new Readable(handle) });
  ensure(reader.footer.summaryCrc !== 0, "the summary has no checksum");
  ensure(reader.dataSectionCrc, "the data section has no checksum");
  const seen = { counts: {}, bytes: 0, reader };
  let last = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    ensure(message.logTime >= last, "messages do not come in the order of time");
    last = message.logTime;
    const channel = reader.channelsById.get(message.channelId);
    ensure(reader.schemasById.has(channel.schemaId), `channel ${channel.topic} has no schema`);
    count(seen.counts, channel.topic);
    seen.bytes += message.data.length;
    if (channel.messageEncoding === "json") JSON.parse(new TextDecoder().decode(message.data));
  }
  seen.metadata = [];
  for await (const record of reader.readMetadata()) seen.metadata.push([record.name, Object.fromEntries(record.metadata)]);
  return seen;
}

/** CRC-32 of everything before the DataEnd record. */
async function dataSectionCrc(handle, end) {
  const piece = Buffer.alloc(PIECE);
  let crc = 0;
  for (let at = 0; at < end; ) {
    const { bytesRead } = await handle.read(piece, 0, Math.min(PIECE, end - at), at);
    ensure(bytesRead > 0, "the file shrank");
    crc = crc32(piece.subarray(0, bytesRead), crc);
    at += bytesRead;
  }
  return crc;
}

const sorted = (object) => JSON.stringify(Object.fromEntries(Object.entries(object).sort(([a], [b]) => (a < b ? -1 : 1))));

async function check(handle) {
  const size = (await handle.stat()).size;
  const stream = await readAsStream(handle, size);
  const { reader, ...indexed } = await readThroughSummary(handle);

  ensure(sorted(stream.counts) === sorted(indexed.counts), "the two readers see different messages");
  ensure(stream.bytes === indexed.bytes, "the two readers see different message data");
  const statistics = reader.statistics;
  const counted = {};
  for (const [id, n] of statistics.channelMessageCounts) counted[reader.channelsById.get(id).topic] = Number(n);
  ensure(sorted(counted) === sorted(stream.counts), "the statistics count other messages");
  ensure(statistics.chunkCount === stream.chunks && reader.chunkIndexes.length === stream.chunks, "chunks are not all indexed");
  ensure(statistics.metadataCount === stream.metadata.length, "the statistics count other metadata");
  ensure(JSON.stringify(indexed.metadata) === JSON.stringify(stream.metadata), "metadata indexes lead elsewhere");
  ensure(statistics.channelCount === reader.channelsById.size, "the statistics count other channels");
  ensure(statistics.schemaCount === reader.schemasById.size, "the statistics count other schemas");

  const dataEnd = Number(reader.footer.summaryStart) - DATA_END_SIZE;
  const crc = await dataSectionCrc(handle, dataEnd);
  ensure(crc === stream.dataSectionCrc && crc === reader.dataSectionCrc, "checksum of the data section is wrong");
  return {
    profile: reader.header.profile,
    library: reader.header.library,
    chunks: stream.chunks,
    messages: Number(statistics.messageCount),
    bytes: stream.bytes,
    topics: stream.counts,
    metadata: stream.metadata.map(([name]) => name),
  };
}

const [path, ...more] = process.argv.slice(2);
if (path === undefined || more.length > 0) {
  console.error("usage: node check.mjs FILE");
  process.exit(2);
}
try {
  const handle = await open(path, "r");
  try {
    console.log(JSON.stringify(await check(handle)));
  } finally {
    await handle.close();
  }
} catch (error) {
  console.error(`${path}: ${error.message}`);
  process.exit(1);
}
