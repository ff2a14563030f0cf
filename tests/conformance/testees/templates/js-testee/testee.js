"use strict";
/* Answers what the conformance run asks about the messages, a line of words in, one out: node testee.js */
const path = require("node:path");
const readline = require("node:readline");
const codec = require("./codec.js");
const { isLike } = require("./frames.js");
const { messages: plans, nodes } = require(path.join(__dirname, "nodes.json"));

/** The plan of a message with all elements as fields, views last, and enumerations in the fields. */
function withViewsLast(compact) {
  const plan = codec.expanded(compact);
  const order = [...plan.fields.keys()].sort((a, b) => Boolean(plan.fields[a].view) - Boolean(plan.fields[b].view));
  const places = new Map(order.map((before, now) => [before, now]));
  const fields = order.map((before) => {
    const { when, derived, ...field } = plan.fields[before];
    if (field.enum) field.enum = plan.enums[field.enum];
    if (when) field.when = when.map(([place, values]) => [places.get(place), values]);
    if (derived) field.derived = [derived[0].map((place) => places.get(place)), ...derived.slice(1)];
    return field;
  });
  const withCounter = (part) => ({ ...part, counter: places.get(part.counter), nested: part.nested?.map(withCounter) });
  return { ...plan, fields, inner: plan.inner?.map(withCounter) };
}

const messages = plans.map(withViewsLast);

const hexOf = (bytes) => Buffer.from(bytes).toString("hex");
const hexOfText = (text) => hexOf(Buffer.from(text, "utf8"));
const bytesOf = (hex) => Uint8Array.from(Buffer.from(hex, "hex"));
const bound = ([numerator, denominator]) => codec.doubleBits(codec.nearestDouble(BigInt(numerator), BigInt(denominator)));

/** The messages that an id of a direction leads to, the narrower ones first: place and signs of each. */
function candidatesOf(node, direction, id) {
  const found = nodes[node].ways[direction][id];
  if (found === undefined) throw new codec.CodecError("unknown-id");
  return Array.isArray(found) ? found : [[found, []]];
}

/** The message that is meant by an id, or by an id and a name. */
function messageOf(node, direction, word) {
  const [id, name] = word.split(":");
  const found = candidatesOf(node, direction, id).map(([place]) => messages[place]);
  return name === undefined ? found[0] : found.find((one) => hexOfText(one.name) === name);
}

/** What not every frame of a message has all of. */
const endOf = (plan) => (plan.endsEarly ? { least: 1, step: 1 } : plan.tail && { least: shortest(plan), step: stepOf(plan) });
const shortest = ({ fewest, tail }) => fewest ?? tail.least + Math.max(0, tail.plus ?? 0) * tail.step;
const stepOf = ({ inner = [], tail }) => [...inner.flatMap(stepsOf), ...(inner.some((part) => part.begin === tail.least) ? [] : [tail.step])].reduce(gcd);
const stepsOf = ({ step, nested = [] }) => [step - nested.reduce((sum, part) => sum + (part.most - Math.max(0, part.plus)) * part.step, 0), ...nested.map((part) => part.step)];
const gcd = (one, other) => (other ? gcd(other, one % other) : one);

/** Name and bytes of the message that a frame of a shared id is. */
function told(candidates, frame) {
  const [place] = candidates.find(([at, signs]) => isLike(messages[at].length, endOf(messages[at]), signs, frame)) ?? [];
  if (place !== undefined) {
    const plan = messages[place];
    return `name=${hexOfText(plan.name)} bytes=${hexOf(codec.encode(plan, codec.decode(plan, frame)))}`;
  }
  const lengths = new Set(candidates.flatMap(([at]) => [endOf(messages[at])?.least ?? messages[at].length, messages[at].length]));
  if (lengths.size > 1 || lengths.has(frame.length)) throw new codec.CodecError("unknown-id");
  throw new codec.CodecError("length", "", { expected: [...lengths][0], actual: frame.length });
}

function fieldsOf(plan, raw) {
  return plan.fields.map((field, index) => {
    const value = raw[index] === null ? "-" : field.type === "bytes" ? hexOf(raw[index]) : String(raw[index]);
    return { field, raw: raw[index], row: `field field=${hexOfText(field.name)} raw=${value}` };
  });
}

function physicalOf(field, raw) {
  if (raw === null) return "";
  if (field.scale || field.curve) return ` physical=${codec.doubleBits(codec.physical(field, raw))}`;
  const text = field.text ? codec.text(raw) : "\ufffd";
  return text.includes("\ufffd") ? "" : ` physical=${hexOfText(text)}`;
}

function described(plan, raw) {
  const rows = fieldsOf(plan, raw).map(({ field, raw: value, row }) => {
    const name = value === null || !field.enum ? undefined : codec.memberName(field.enum, value);
    return row + physicalOf(field, value) + (name === undefined ? "" : ` name=${hexOfText(name)}`);
  });
  return [`bytes=${hexOf(codec.encode(plan, raw))}`, ...rows].join(" ");
}

function rawOf(field, word) {
  if (field.view) return 0n;
  if (word === "n") return null;
  const [way, value] = [word[0], word.slice(1)];
  if (way === "p" && field.text) return codec.rawFromText(field, Buffer.from(value, "hex").toString("utf8"));
  if (way === "p") return codec.rawFromPhysical(field, codec.doubleOf(BigInt(value)));
  const raw = field.type === "bytes" ? bytesOf(value) : BigInt(value);
  codec.check(field, raw);
  return raw;
}

/** The raw value after the physical one was set; nothing if that was refused: that of 64 bits may be too wide for a double. */
function setAgain(field, value) {
  try {
    return codec.rawFromPhysical(field, value);
  } catch (error) {
    if (error instanceof codec.CodecError) return "";
    throw error;
  }
}

const operations = {
  decode(node, direction, id, frame) {
    const candidates = id.includes(":") ? [] : candidatesOf(node, direction, id);
    if (candidates.length > 1) return told(candidates, bytesOf(frame));
    const plan = messageOf(node, direction, id);
    return described(plan, codec.decode(plan, bytesOf(frame)));
  },

  encode(node, direction, id, ...words) {
    const plan = messageOf(node, direction, id);
    const raw = plan.fields.map((field, index) => rawOf(field, words[index]));
    return described(plan, codec.decode(plan, codec.encode(plan, raw)));
  },

  constants(node, direction, id) {
    const plan = messageOf(node, direction, id);
    const rows = fieldsOf(plan, codec.fresh(plan)).map(({ field, row }) => {
      const special = (field.special ?? []).map(([value]) => `${value},`).join("");
      const limits = Object.entries(field.limits ?? {}).map(([name, one]) => ` ${name}=${bound(one)}`);
      return `${row} special=${special}${limits.join("")}`;
    });
    return [`name=${hexOfText(plan.name)} length=${plan.length} ids=${plan.ids.join(",")}`, ...rows].join(" ");
  },

  sweep(node, direction, id, place, ...words) {
    const field = messageOf(node, direction, id).fields[place];
    const values = words.map((word) => {
      const raw = BigInt(word);
      codec.check(field, raw);
      const value = codec.physical(field, raw);
      return `${codec.doubleBits(value)},${setAgain(field, value)},`;
    });
    return `values=${values.join("")}`;
  },

  enum(node, place, value) {
    const name = codec.memberName(nodes[node].enums[place], BigInt(value));
    return name === undefined ? "" : `name=${hexOfText(name)}`;
  },

  node(node) {
    const facts = Object.entries(nodes[node].facts).filter(([, value]) => value !== null);
    return facts.map(([key, value]) => `${key}=${value}`).join(" ");
  },
};

function answer(line) {
  const [name, ...words] = line.split(" ");
  if (!Object.hasOwn(operations, name)) return "refused unsupported";
  try {
    return `ok ${operations[name](...words)}`.trimEnd();
  } catch (error) {
    if (!(error instanceof codec.CodecError)) throw error;
    const { kind, field, expected, actual } = error;
    const told = { field: field === undefined ? undefined : hexOfText(field), expected, actual };
    const keys = Object.entries(told).filter(([, value]) => value !== undefined);
    return ["refused", kind, ...keys.map(([key, value]) => `${key}=${value}`)].join(" ");
  }
}

readline.createInterface({ input: process.stdin }).on("line", (line) => process.stdout.write(`${answer(line)}\n`));
