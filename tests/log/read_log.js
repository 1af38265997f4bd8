// SPDX-License-Identifier: Apache-2.0
// Reads a mission's log with the public reader and decodes every message. Ends with 1 and a line for each thing
// that is not as expected.
//   node read_log.js LOG LAST_ROW_OF_STEPS_CSV
"use strict";
const fs = require("fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const [, , path, lastRow] = process.argv;
let failures = 0;
function check(sound, what) {
  if (sound) return;
  console.error("FAILED: " + what);
  ++failures;
}

async function main() {
  const bytes = new Uint8Array(fs.readFileSync(path));
  const decompressHandlers = await loadDecompressHandlers();

  // From end to end, with every checksum.
  const stream = new McapStreamReader({ validateCrcs: true, decompressHandlers });
  stream.append(bytes);
  let streamed = 0, ended = false;
  for (let record; (record = stream.nextRecord()); ) {
    if (record.type === "Message") ++streamed;
    if (record.type === "DataEnd") check(record.dataSectionCrc !== 0, "no checksum of the data");
    if (record.type === "Footer") {
      ended = true;
      check(record.summaryCrc !== 0, "no checksum of the summary");
    }
  }
  check(ended && stream.done(), "the file has no end");

  // By its index.
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.slice(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  check(reader.header.profile === "ros2", "the profile is " + reader.header.profile);
  check(reader.statistics.messageCount === BigInt(streamed), "the statistics count other messages than there are");
  check(reader.chunkIndexes.every((chunk) => chunk.compression === "zstd"), "chunks that are not compressed");
  const decoders = new Map();
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    check(schema.encoding === "ros2msg" && channel.messageEncoding === "cdr", channel.topic + " is encoded otherwise");
    const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
    decoders.set(channel.id, { topic: channel.topic, reader: new MessageReader(definitions) });
  }
  const counts = {};
  let last, step, time = 0n;
  for await (const message of reader.readMessages()) {
    check(message.logTime >= time, "messages out of order");
    time = message.logTime;
    const decoder = decoders.get(message.channelId);
    counts[decoder.topic] = (counts[decoder.topic] ?? 0) + 1;
    last = decoder.reader.readMessage(message.data);
    if (decoder.topic === "/plan/step") step = last;
    if (decoder.topic === "/map") check(last.data.length === last.info.width * last.info.height, "a map of other size");
    if (decoder.topic === "/scan") check(last.ranges.length > 10, "a scan of few beams");
  }
  const all = Object.values(counts).reduce((sum, count) => sum + count, 0);
  check(all === streamed, all + " messages by the index, " + streamed + " in the file");
  for (const topic of ["/tf", "/tf_static", "/odometry", "/cmd_vel", "/map", "/map_updates", "/plan", "/plan/markers",
    "/plan/step", "/scan"]) {
    check(counts[topic] > 0, "no message of " + topic);
  }
  const values = Object.fromEntries(step.status[0].values.map((entry) => [entry.key, entry.value]));
  const row = lastRow.split(",");
  for (const [name, column] of [["step", 0], ["time", 1], ["true_x", 2], ["estimated_x", 5], ["command_omega", 10]]) {
    check(values[name] === row[column], name + " is " + values[name] + " in the log, " + row[column] + " in steps.csv");
  }
  const metadata = {};
  for await (const record of reader.readMetadata()) metadata[record.name] = record.metadata;
  check(metadata.run?.get("world") === "office" && metadata.run.get("configuration").includes("planner:"),
    "the run's metadata are not there");
  check(JSON.parse(metadata.summary?.get("json") ?? "{}").world === "office", "no summary");
  console.log(all + " messages of " + Object.keys(counts).length + " topics, " + reader.chunkIndexes.length + " chunks");
}

main().then(() => process.exit(failures > 0 ? 1 : 0), (error) => {
  console.error("FAILED: " + error.stack);
  process.exit(1);
});
