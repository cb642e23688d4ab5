// Reads an MCAP file by MCAP's own readers, the streaming one with all CRCs checked and the indexed one, which must give
// the same messages, and prints a line of JSON for each message:
//
//   node read_mcap.mjs FILE [SCHEMAS]
//
// {"topic", "time" (ns, a text), "schema", "encoding", "sequence", "base64"}; at last {"statistics": {...}, "crcs": n}.
// Messages in JSON are validated against the schema in the file and, where it is of Foxglove, against the official one of
// @foxglove/schemas, and have "json" in place of "base64"; those in CDR are decoded by @foxglove/rosmsg2-serialization.
// With SCHEMAS ("schemas"), prints {"schema", "same": whether the file's schema has the members, types and required
// names of the official one}. Needs @mcap/core; of Foxglove's @foxglove/schemas, ajv, @foxglove/rosmsg and
// @foxglove/rosmsg2-serialization where such messages are there; zstd and lz4.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { isDeepStrictEqual } from "node:util";

const [file, wants] = process.argv.slice(2);
const modules = createRequire(import.meta.url);
const { McapStreamReader, McapIndexedReader } = modules("@mcap/core");

const unpack = (program) => (buffer, size) => {
  const bytes = execFileSync(program, ["-d", "-c"], { input: buffer, maxBuffer: Number(size) + 1024,
                                                     stdio: ["pipe", "pipe", "ignore"] });
  if (BigInt(bytes.length) !== BigInt(size)) throw new Error(`unpacks to ${bytes.length} bytes, not ${size}`);
  return bytes;
};
const decompressHandlers = { zstd: unpack("zstd"), lz4: unpack("lz4") };
const contents = readFileSync(file);

/// The two that MCAP's readers pass over: of all before DataEnd, as MCAP's own writer has it, and of the summary.
function checkDataAndSummary() {
  const { crc32 } = createRequire(modules.resolve("@mcap/core"))("@foxglove/crc");
  const check = (what, begin, end, told) => {
    const found = crc32(contents.subarray(begin, end));
    if (found !== told) throw new Error(`the CRC of the ${what} is ${told}, not ${found}`);
  };
  let at = 8;
  for (; contents[at] !== 0x0f; at += 9 + Number(contents.readBigUInt64LE(at + 1)));
  check("data", 0, at, contents.readUInt32LE(at + 9));
  const footer = contents.length - 8 - 29;
  check("summary", Number(contents.readBigUInt64LE(footer + 9)), footer + 25, contents.readUInt32LE(footer + 25));
}

/// Messages and checksums in the order of the file.
function streamed() {
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers, includeChunks: true });
  reader.append(contents);
  const channels = new Map(), schemas = new Map(), messages = [];
  let crcs = 0, statistics;
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") messages.push({ record, channel: channels.get(record.channelId) });
    if (record.type === "Statistics") statistics = record;
    if (record.type === "Chunk") crcs += record.uncompressedCrc !== 0;
    if (record.type === "DataEnd") crcs += record.dataSectionCrc !== 0;
    if (record.type === "Footer") crcs += record.summaryCrc !== 0;
  }
  if (!reader.done()) throw new Error("the file ends too soon");
  return { messages: messages.map((m) => ({ ...m, schema: schemas.get(m.channel.schemaId) })), statistics, crcs };
}

async function indexed() {
  const readable = { size: async () => BigInt(contents.length),
                     read: async (offset, size) => contents.subarray(Number(offset), Number(offset + size)) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const messages = [];
  for await (const message of reader.readMessages()) messages.push(message);
  return messages;
}

const text = (bytes) => Buffer.from(bytes).toString("utf8");

let validators;
function validate(schema, message) {
  const Ajv = modules("ajv").default;
  validators ??= { ajv: new Ajv({ strict: false, allErrors: true }), of: new Map() };
  if (!validators.of.has(schema.name)) {
    const all = [JSON.parse(text(schema.data))];
    if (schema.name.startsWith("foxglove.")) all.push(official(schema.name));
    validators.of.set(schema.name, all.map((one) => validators.ajv.compile(one)));
  }
  for (const check of validators.of.get(schema.name))
    if (!check(message)) throw new Error(`${schema.name}: ${validators.ajv.errorsText(check.errors)}`);
}

const official = (name) => modules("@foxglove/schemas/jsonschema")[name.replace("foxglove.", "")];

function decoded(message) {
  if (message.channel.messageEncoding === "json") {
    const value = JSON.parse(text(message.record.data));
    validate(message.schema, value);
    return { json: value };
  }
  if (message.channel.messageEncoding === "cdr") {
    const { parse } = modules("@foxglove/rosmsg");
    const { MessageReader } = modules("@foxglove/rosmsg2-serialization");
    const reader = new MessageReader(parse(text(message.schema.data), { ros2: true }));
    const value = reader.readMessage(message.record.data);
    return { json: JSON.parse(JSON.stringify(value, (_, v) => (ArrayBuffer.isView(v) ? Array.from(v) : v))) };
  }
  return { base64: Buffer.from(message.record.data).toString("base64") };
}

/// What a validator makes use of; no words for people, and no limits.
function bare(schema) {
  if (Array.isArray(schema)) return schema.map(bare);
  if (typeof schema !== "object" || schema === null) return schema;
  const kept = {};
  for (const [key, value] of Object.entries(schema)) {
    if (["description", "$comment", "minimum", "maximum"].includes(key) && typeof value !== "object") continue;
    if (key === "title" && typeof value === "string" && value !== "time" && value !== "duration") continue;
    kept[key] = key === "required" ? [...value].sort() : bare(value);
  }
  return kept;
}

const found = streamed();
if (wants === "schemas") {
  const seen = new Map(found.messages.map((m) => [m.schema.name, m.schema]));
  for (const [name, schema] of seen)
    if (name.startsWith("foxglove."))
      console.log(JSON.stringify({ schema: name,
                                   same: isDeepStrictEqual(bare(JSON.parse(text(schema.data))), bare(official(name))) }));
} else {
  checkDataAndSummary();
  const by_index = await indexed();
  const key = (m) => `${m.logTime} ${m.channelId} ${m.sequence} ${Buffer.from(m.data).toString("base64")}`;
  const sorted = (messages) => messages.map(key).sort();
  if (!isDeepStrictEqual(sorted(found.messages.map((m) => m.record)), sorted(by_index)))
    throw new Error("the index does not find the messages that are there");
  if (found.statistics.messageCount !== BigInt(found.messages.length)) throw new Error("the statistics miscount");
  for (const message of found.messages)
    console.log(JSON.stringify({ topic: message.channel.topic, time: String(message.record.logTime),
                                 schema: message.schema.name, encoding: message.channel.messageEncoding,
                                 sequence: message.record.sequence, ...decoded(message) }));
  console.log(JSON.stringify({ statistics: found.statistics, crcs: found.crcs },
                             (_, v) => (typeof v === "bigint" ? String(v) : v instanceof Map ? [...v] : v)));
}
