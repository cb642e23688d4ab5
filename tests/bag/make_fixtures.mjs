// Writes the MCAP files of tests/bag/data, and the CDR messages that make_fixtures.py puts into SQLite files; and where
// the chunks of these files are, and with which messages, into chunks_of_mcap.csv, as another reader sees it.
//
//   node make_fixtures.mjs FOLDER
//
// Needs @mcap/core, @foxglove/rosmsg2-serialization and @foxglove/rosmsg-serialization: `scripts/setup --judges`, and
// NODE_PATH=build/judges/node_modules.
//
// The recording that all fixtures hold is described in recording.h.
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [folder] = process.argv.slice(2);
const modules = createRequire(import.meta.url);
const { McapStreamReader, McapWriter, TempBuffer } = modules("@mcap/core");
const { MessageWriter: Ros2Writer } = modules("@foxglove/rosmsg2-serialization");
const { MessageWriter: Ros1Writer } = modules("@foxglove/rosmsg-serialization");
const { ros1, ros2humble } = modules("@foxglove/rosmsg-msgs-common");
const { parse } = modules("@foxglove/rosmsg");

const WIDTH = 16, HEIGHT = 12, STEP = 20, FRAMES = 8;
const BASE = 1700000000123456789n, MS = 1000000n;

const time = (ns) => ({ sec: Number(ns / 1000000000n), nsec: Number(ns % 1000000000n) });

function messages() {
  const all = [];
  for (let k = 0; k < FRAMES; ++k) {
    const stamp = BASE + BigInt(k) * 100n * MS;
    const log = stamp + (15n + BigInt(k % 3)) * MS;
    const header = { seq: k, stamp: time(stamp), frame_id: "camera_optical" };
    const data = new Uint8Array(STEP * HEIGHT).fill(0xee);
    for (let y = 0; y < HEIGHT; ++y)
      for (let x = 0; x < WIDTH; ++x) data[y * STEP + x] = (7 * x + 13 * y + 31 * k) & 255;
    all.push({ topic: "/camera/image_raw", type: "sensor_msgs/Image", log,
               message: { header, height: HEIGHT, width: WIDTH, encoding: "mono8", is_bigendian: 0, step: STEP, data } });
    const info = {
      header, height: HEIGHT, width: WIDTH, distortion_model: "plumb_bob", binning_x: 0, binning_y: 0,
      roi: { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false },
    };
    const D = [-0.25, 0.125, 0.0009765625, -0.001953125, 0.0625], K = [20.5, 0, 7.25, 0, 21.5, 5.75, 0, 0, 1];
    const R = [1, 0, 0, 0, 1, 0, 0, 0, 1], P = [19, 0, 7, 0, 0, 20, 6, 0, 0, 0, 1, 0];
    if (k === 0 || k === 5) all.push({ topic: "/camera/camera_info", type: "sensor_msgs/CameraInfo", log: log + 1000n,
               message: { ...info, D, K, R, P, d: D, k: K, r: R, p: P } });
    if (k % 3 === 0)
      all.push({ topic: "/notes", type: "std_msgs/String", log: log + 2000n, message: { data: `note ${k}` } });
    for (let i = 5 * k; i < 5 * k + 5; ++i) {
      const at = BASE + BigInt(i) * 20n * MS;
      all.push({ topic: "/gyro", type: "geometry_msgs/Vector3", log: at + MS, message: { x: i, y: 0.5, z: -0.25 } });
    }
  }
  return all;
}

function definitions(types, root) {
  const wanted = [root], out = [];
  while (wanted.length > 0) {
    const name = wanted.shift();
    if (out.some((one) => one.name === name)) continue;
    const definition = { ...types[name], name };
    out.push(definition);
    for (const field of definition.definitions) if (field.isComplex) wanted.push(field.type);
  }
  return [{ ...out[0] }, ...out.slice(1)];
}

const writers = new Map();
function serialise(one, ros) {
  const key = `${ros} ${one.type}`;
  if (!writers.has(key)) {
    const list = definitions(ros === 2 ? ros2humble : ros1, one.type);
    delete list[0].name;  // the first is the one that is written
    writers.set(key, ros === 2 ? new Ros2Writer(list) : new Ros1Writer(list));
  }
  const message = structuredClone(one.message);
  return writers.get(key).writeMessage(message);
}

const packers = { lz4: ["lz4", ["-q", "-c"]], zstd: ["zstd", ["-q", "-c"]] };

async function writeMcap(file, { ros, compression, chunks, index }) {
  const buffer = new TempBuffer();
  const options = {
    writable: buffer, chunkSize: 1500, useChunks: chunks, useChunkIndex: index, useMessageIndex: index,
    useStatistics: index, useSummaryOffsets: index, repeatSchemas: index, repeatChannels: index,
  };
  if (compression)
    options.compressChunk = (input) => {
      const [program, words] = packers[compression];
      return { compression, compressedData: new Uint8Array(execFileSync(program, words, { input })) };
    };
  const writer = new McapWriter(options);
  await writer.start({ profile: ros === 2 ? "ros2" : "ros1", library: "apriltrack fixtures" });
  const channels = new Map();
  let sequence = 0;
  for (const one of messages()) {
    if (!channels.has(one.topic)) {
      const name = ros === 2 ? one.type.replace("/", "/msg/") : one.type;
      const schemaId = await writer.registerSchema({
        name, encoding: ros === 2 ? "ros2msg" : "ros1msg", data: new TextEncoder().encode("# left out\n") });
      channels.set(one.topic, await writer.registerChannel({
        schemaId, topic: one.topic, messageEncoding: ros === 2 ? "cdr" : "ros1", metadata: new Map() }));
    }
    await writer.addMessage({ channelId: channels.get(one.topic), sequence: sequence++, logTime: one.log,
                              publishTime: one.log, data: serialise(one, ros) });
  }
  await writer.end();
  writeFileSync(path.join(folder, file), buffer.get());
  if (index && chunks) listChunks(file, buffer.get());
}

const chunkLines = [];
function listChunks(file, bytes) {
  const reader = new McapStreamReader({
    includeChunks: true,
    decompressHandlers: Object.fromEntries(Object.keys(packers).map((name) =>
      [name, (data) => new Uint8Array(execFileSync(packers[name][0], ["-q", "-d", "-c"], { input: data }))])) });
  reader.append(bytes);
  const times = [], places = [];
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Chunk") times.push([]);
    if (record.type === "Message") times.at(-1).push(record.logTime - BASE);
    if (record.type === "ChunkIndex") places.push([record.chunkStartOffset, record.chunkStartOffset + record.chunkLength]);
  }
  times.forEach((list, i) => chunkLines.push(`${file},${places[i][0]},${places[i][1]},${list.join(" ")}`));
}

await writeMcap("plain.mcap", { ros: 2, chunks: true, index: true });
await writeMcap("lz4.mcap", { ros: 2, compression: "lz4", chunks: true, index: true });
await writeMcap("zstd.mcap", { ros: 2, compression: "zstd", chunks: true, index: true });
await writeMcap("ros1_zstd.mcap", { ros: 1, compression: "zstd", chunks: true, index: true });
await writeMcap("without_chunks.mcap", { ros: 2, chunks: false, index: true });
await writeMcap("without_index.mcap", { ros: 2, compression: "zstd", chunks: true, index: false });
writeFileSync(path.join(folder, "chunks_of_mcap.csv"), chunkLines.join("\n") + "\n");
const lines = messages().map((one) => JSON.stringify({
  topic: one.topic, type: one.type.replace("/", "/msg/"), log: one.log.toString(),
  data: Buffer.from(serialise(one, 2)).toString("base64") }));
process.stdout.write(lines.join("\n") + "\n");
