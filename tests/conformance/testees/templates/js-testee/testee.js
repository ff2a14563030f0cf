"use strict";
/*
 * Answers requests about the messages, one JSON object a line: node testee.js
 * The protocol is described with the conformance tests.
 */
const fs = require("node:fs");
const path = require("node:path");
const codec = require("./codec.js");
const json = require("./json.js");

const MOST_VALUES = 65536n;
const KINDS = { telecommand: ["telecommand"], telemetry: ["telemetry"], configuration: ["set", "get"] };
const nodes = new Map(JSON.parse(fs.readFileSync(path.join(__dirname, "nodes.json"), "utf8")).map((node) => [node.name, node]));
for (const node of nodes.values()) {
  node.enums = new Map(node.enums.map(([name, members]) => [name, new Map(members.map(([value, text]) => [BigInt(value), text]))]));
}

class Refusal extends Error {
  constructor(error, more) {
    super(error);
    this.answer = { ok: false, error, ...more };
  }
}

const isText = (value) => typeof value === "string";
const isInteger = (value) => typeof value === "bigint";
const isObject = (value) => value instanceof Map;

function key(request, name, test) {
  const value = request.get(name);
  if (!test(value)) throw new Refusal("request", { detail: `${name} is missing or has the wrong type` });
  return value;
}

function bytesOf(text, size) {
  if (!isText(text) || !/^(?:[0-9A-Fa-f]{2})*$/.test(text) || (size !== undefined && text.length !== 2 * size)) {
    throw new Refusal("request", { detail: "not the hex digits that are expected" });
  }
  return Uint8Array.from(Buffer.from(text, "hex"));
}

const hexOf = (bytes) => Buffer.from(bytes).toString("hex");
const bitsOf = (double) => codec.doubleBits(double).toString(16).padStart(16, "0");
const numberOf = (hex) => codec.doubleOf(BigInt(`0x${hexOf(bytesOf(hex, 8))}`));

function nodeOf(request) {
  const node = nodes.get(key(request, "node", isText));
  if (!node) throw new Refusal("unknown-node");
  return node;
}

/** What the node declares or includes under this id: {plan, node}. */
function messageOf(request) {
  key(request, "node", isText);
  const kind = key(request, "kind", isText);
  const id = key(request, "id", isInteger);
  if (!Object.hasOwn(KINDS, kind)) throw new Refusal("request", { detail: "there is no such kind" });
  const node = nodeOf(request);
  for (const way of KINDS[kind]) {
    for (const name of node.speaks) {
      const plan = nodes.get(name).messages.find((message) => way in message.ways && BigInt(message.ways[way]) === id);
      if (plan) return { plan, node: nodes.get(name) };
    }
  }
  throw new Refusal("unknown-id");
}

function enumOf(node, name) {
  for (const one of node.speaks) {
    const found = nodes.get(one).enums.get(name);
    if (found) return found;
  }
  return new Map();
}

function shown(field, raw) {
  if (field.type === "bytes") return hexOf(raw);
  if (field.type === "float") return raw.toString(16).padStart(field.bits / 4, "0");
  return field.type === "bool" ? raw === 1n : raw;
}

function physicalOf(field, raw) {
  if (!field.text) return bitsOf(codec.physical(field, raw));
  const said = codec.text(raw);
  return said.includes("\ufffd") ? null : Buffer.from(said).toString("hex");
}

function fromPhysical(field, given) {
  if (!field.text) return codec.rawFromPhysical(field, numberOf(given));
  return codec.rawFromText(field, Buffer.from(bytesOf(given)).toString("utf8"));
}

function described({ plan, node }, raw, names) {
  const pairs = plan.fields.map((field, index) => [field, raw[index]]);
  const scaled = pairs.filter(([field]) => field.scale || field.text);
  const answer = {
    ok: true,
    raw: Object.fromEntries(pairs.map(([field, value]) => [field.name, shown(field, value)])),
    physical: Object.fromEntries(scaled.map(([field, value]) => [field.name, physicalOf(field, value)])),
    bytes: hexOf(codec.encode(plan, raw)),
  };
  if (names) {
    const enums = pairs.filter(([field]) => field.enum !== undefined);
    answer.names = Object.fromEntries(enums.map(([field, value]) => [field.name, enumOf(node, field.enum).get(value) ?? null]));
  }
  return answer;
}

function rawOf(field, given) {
  if (field.type === "float") return BigInt(`0x${hexOf(bytesOf(given, field.bits / 8))}`);
  if (field.type === "bytes") return bytesOf(given);
  if (isInteger(given)) return given;
  if (field.type === "bool" && typeof given === "boolean") return given ? 1n : 0n;
  throw new Refusal("request", { detail: `a value of ${field.name} has the wrong type` });
}

const bound = ([numerator, denominator]) => bitsOf(codec.nearestDouble(BigInt(numerator), BigInt(denominator)));

const operations = {
  decode(request) {
    const frame = bytesOf(key(request, "bytes", isText));
    const names = request.get("names") ?? false;
    if (typeof names !== "boolean" || request.get("names") === null) throw new Refusal("request");
    const found = messageOf(request);
    return described(found, codec.decode(found.plan, frame), names);
  },

  encode(request) {
    const given = request.has("raw") ? key(request, "raw", isObject) : new Map();
    const physical = request.has("physical") ? key(request, "physical", isObject) : new Map();
    const found = messageOf(request);
    const fields = new Map(found.plan.fields.map((field) => [field.name, field]));
    for (const field of given.keys()) if (!fields.has(field)) throw new Refusal("unknown-field", { field });
    for (const field of physical.keys()) if (!fields.get(field)?.scale && !fields.get(field)?.text) throw new Refusal("unknown-field", { field });
    const raw = found.plan.fields.map((field) => {
      if (physical.has(field.name)) return fromPhysical(field, physical.get(field.name));
      if (!given.has(field.name)) throw new Refusal("missing-field", { field: field.name });
      const value = rawOf(field, given.get(field.name));
      codec.check(field, value);
      return value;
    });
    return described(found, raw);
  },

  constants(request) {
    const { plan } = messageOf(request);
    const fresh = codec.fresh(plan);
    const some = (property, make) =>
      Object.fromEntries(plan.fields.filter((f) => f[property]).map((field) => [field.name, make(field[property])]));
    return {
      ok: true,
      name: plan.name,
      ids: plan.ids,
      length: plan.length,
      default: Object.fromEntries(plan.fields.map((field, index) => [field.name, shown(field, fresh[index])])),
      special: some("special", (rows) => rows.map(([value]) => BigInt(value))),
      limits: some("limits", (limits) => Object.fromEntries(Object.entries(limits).map(([name, one]) => [name, bound(one)]))),
    };
  },

  enum(request) {
    const [, name, value] = [key(request, "node", isText), key(request, "enum", isText), key(request, "value", isInteger)];
    const members = nodeOf(request).enums.get(name);
    if (!members) throw new Refusal("unknown-enum");
    return { ok: true, name: members.get(value) ?? null };
  },

  node(request) {
    const { node_type, interface_version } = nodeOf(request);
    return { ok: true, node_type, interface_version };
  },

  sweep(request) {
    const name = key(request, "field", isText);
    let values = request.get("values");
    if (values !== undefined) {
      key(request, "values", Array.isArray);
    } else {
      const [from, to] = [key(request, "from", isInteger), key(request, "to", isInteger)];
      if (to - from >= MOST_VALUES) throw new Refusal("request");
      values = Array.from({ length: Math.max(Number(to - from) + 1, 0) }, (_, index) => from + BigInt(index));
    }
    if (values.length > MOST_VALUES || !values.every(isInteger)) throw new Refusal("request");
    const field = messageOf(request).plan.fields.find((one) => one.name === name && one.scale);
    if (!field) throw new Refusal("unknown-field", { field: name });
    let failures = 0;
    let all = "";
    for (const raw of values) {
      codec.check(field, raw);
      const value = codec.physical(field, raw);
      all += bitsOf(value);
      if (!comesBack(field, value, raw)) failures += 1;
    }
    return { ok: true, physical: all, failures };
  },
};


/** Whether setting the physical value gives the raw value again: that of 64 bits may be too wide for a double. */
function comesBack(field, value, raw) {
  try {
    return codec.rawFromPhysical(field, value) === raw;
  } catch (error) {
    if (error instanceof codec.CodecError) return false;
    throw error;
  }
}

const utf8 = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true });

function answer(line) {
  try {
    const request = json.parse(utf8.decode(line));
    if (!isObject(request)) throw new Refusal("request");
    const op = key(request, "op", isText);
    if (!Object.hasOwn(operations, op)) throw new Refusal("request", { detail: "there is no such op" });
    return operations[op](request);
  } catch (error) {
    if (error instanceof Refusal) return error.answer;
    if (error instanceof codec.CodecError) {
      const { kind, message, field, expected, actual } = error;
      return { ok: false, error: kind, detail: message, field, expected, actual };
    }
    return { ok: false, error: "request", detail: String(error) };
  }
}

let rest = [];
process.stdin.on("data", (chunk) => {
  let from = 0;
  let answers = "";
  for (let end = chunk.indexOf(10); end >= 0; end = chunk.indexOf(10, from)) {
    rest.push(chunk.subarray(from, end));
    answers += `${json.stringify(answer(Buffer.concat(rest)))}\n`;
    rest = [];
    from = end + 1;
  }
  rest.push(chunk.subarray(from));
  if (answers) process.stdout.write(answers);
});
