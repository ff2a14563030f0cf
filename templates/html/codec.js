"use strict";
/*
 * Decodes and encodes messages from their plans: which bits of which bytes, which scale. Exact throughout.
 *
 * Raw values are BigInt (of uint, int, enum and bool, and the IEEE 754 bits of a float, so that every NaN survives) or, of byte
 * arrays, Uint8Array. A frame is a Uint8Array. Runs in a page and under Node; knows nothing of either.
 */
const icdgenCodec = (() => {
  /** What does not fit. `kind` is "length", "range" or "missing-field"; `field` is the name of the field, where it is about one. */
  class CodecError extends Error {
    constructor(kind, text, more) {
      super(text);
      this.kind = kind;
      Object.assign(this, more);
    }
  }

  /**
   * The plan with all elements of arrays as fields. Of an array that the page shows once, each field has the number of the field
   * of the first element that stands for it as `leader`, and as `section` the element of the outermost such array.
   */
  function expanded(plan) {
    const fields = [];
    const add = (items, owner) => {
      for (const item of items) {
        if (item.array === undefined) fields.push(placed(item, owner));
        else addArray(item, owner);
      }
    };
    const addArray = ({ array, count, step, fields: items, initial = 0, isShownOnce }, owner) => {
      const first = fields.length;
      for (let index = 0; index < count; index += 1) {
        const [begin, prefix] = [fields.length, `${owner.prefix}${array}[${index}]`];
        const isStruct = (items[0].name ?? items[0].array) !== undefined;
        const section = owner.section ?? (isShownOnce ? (isStruct ? prefix : owner.prefix + array) : undefined);
        const stored = owner.stored || index < initial;
        add(items, { prefix: isStruct ? `${prefix}.` : prefix, bytes: owner.bytes + index * step, section, stored });
        if (!isShownOnce) continue;
        for (let at = begin; at < fields.length; at += 1) fields[at].leader = fields[first + at - begin].leader ?? first + at - begin + 1;
      }
    };
    add(plan.fields, { prefix: "", bytes: 0 });
    return { ...plan, fields };
  }

  /** A field of an element that begins so many bytes behind the first one. */
  function placed(item, { prefix, bytes, section, stored }) {
    const field = { ...item, name: prefix + (item.name ?? "") };
    if (item.first !== undefined) field.first = item.first + bytes;
    if (item.pieces) field.pieces = item.pieces.map(([byte, ...bits]) => [byte + bytes, ...bits]);
    if (section !== undefined) field.section = section;
    if (stored) field.inner = true;
    return field;
  }

  /** Raw value of each field, in their order, null of what is not there; elements that are not in the frame are 0. Throws a CodecError unless the frame has a length of the message. */
  function decode(message, frame) {
    const { tail } = message;
    const actual = frame.length;
    const behind = frame.slice(Math.max(0, actual - behindOf(message)));
    if (message.inner) frame = spread(message, frame);
    const count = tail ? elementsIn(message, frame.length, frame.length - actual) : 0;
    const endsEarly = message.endsEarly && frame.length > 0 && frame.length < message.length;
    if (!tail && !endsEarly && frame.length !== message.length) throw misfit(message, message.endsEarly && !frame.length ? 1 : message.length, frame.length);
    const longest = tail || endsEarly ? new Uint8Array(message.length) : frame;
    if (longest !== frame) longest.set(frame);
    if (behindOf(message)) longest.set(behind, endOf(message));
    const raw = message.fields.map((field) => read(field, longest));
    if (message.conditional) message.fields.forEach((field, index) => (raw[index] = isThere(message, field, raw) ? raw[index] : null));
    message.fields.forEach((field, index) => {
      if (field.derived) raw[index] = doubleBits(derived(message, field, raw));
    });
    if (!tail) return raw;
    const counter = counterOf(message);
    if (message.fields[counter].implied) raw[counter] = BigInt(count);
    else if (raw[counter] !== BigInt(count - plusOf(message))) {
      const told = BigInt(tail.least - (frame.length - actual)) + (raw[counter] + BigInt(plusOf(message))) * BigInt(tail.step);
      throw misfit(message, told > 0n ? told : 0n, actual);
    }
    return raw;
  }

  /**
   * Places and sizes of the bytes of the longest frame that a frame does not have, in order; null of a count that is not valid.
   * `counter` returns the raw value of the field at an index.
   */
  function gaps(message, counter) {
    const elements = (part) => {
      const count = Number(counter(part.counter)) + part.plus;
      return count < Math.max(0, part.plus) || count > part.most ? null : count;
    };
    const gap = (part, count) => (count === null ? null : [part.begin + count * part.step, (part.most - count) * part.step]);
    return message.inner.flatMap((part) => {
      const [count, found] = [elements(part), []];
      const nested = (part.nested ?? []).map((inner) => gap(inner, elements(inner)));
      if (nested.includes(null)) return [null];
      for (let element = 0; element < count; element += 1) {
        found.push(...nested.map(([place, size]) => [part.begin + element * part.step + place, size]));
      }
      return part.begin === message.tail.least && count !== null ? found : [...found, gap(part, count)];
    });
  }

  /** The longest frame up to its open end: with zeros for what inner open parts do not have. Throws a CodecError for a frame that cannot be. */
  function spread(message, frame) {
    if (frame.length < message.fewest) throw misfit(message, message.fewest, frame.length);
    let whole = frame.slice(0, frame.length - behindOf(message));
    for (const gap of gaps(message, (index) => read(message.fields[index], frame))) {
      if (!gap) throw misfit(message, frame.length === message.length ? message.inner[0].begin : message.length, frame.length);
      const [place, lacking] = gap;
      const wider = new Uint8Array(whole.length + lacking);
      wider.set(whole.subarray(0, place));
      wider.set(whole.subarray(place), Math.min(place, whole.length) + lacking);
      whole = wider;
    }
    return whole;
  }

  /** Of each byte of the frame of raw values, the place in the longest frame. Throws a CodecError for a count that cannot be. */
  function places(message, raw) {
    const [size, end] = [sizeOf(message, raw), endOf(message)];
    const found = Array.from({ length: size + behindOf(message) }, (_, at) => (at < size ? at : at - size + end));
    for (const [place, lacking] of gaps(message, (index) => raw[index]).reverse()) found.splice(place, lacking);
    return found;
  }

  /** How many elements the end of a frame of so many bytes has, of which it lacks some. Throws a CodecError if no frame has so many. */
  function elementsIn(message, actual, lacking) {
    const { least, step } = message.tail;
    const refuse = (expected) => misfit(message, expected - lacking, actual - lacking);
    const shortest = least + Math.max(0, plusOf(message)) * step;
    if (actual < shortest) throw refuse(shortest);
    if (actual > endOf(message)) throw refuse(endOf(message));
    if ((actual - least) % step) throw refuse(actual - ((actual - least) % step));
    return (actual - least) / step;
  }

  /** How many more elements the end of a message has than the field says that counts them. */
  const plusOf = (message) => message.tail.plus ?? 0;

  /** Bytes of the fields behind the open end of a message. */
  const behindOf = (message) => message.tail?.behind ?? 0;

  /** First byte behind the open end of the longest frame. */
  const endOf = (message) => message.length - behindOf(message);

  function misfit(message, expected, actual) {
    return new CodecError("length", `${message.name} has ${expected} bytes, ${actual} given`, { expected, actual });
  }

  /** The place of the field that says how many elements the end of a message has; -1 where frames have one length. */
  function counterOf(message) {
    return message.tail ? message.fields.findIndex((field) => field.name === message.tail.counter) : -1;
  }

  /** Whether a field is there, by the raw values of those on which it depends; null is the value of what is not. */
  function isThere(message, field, raw) {
    return (field.when ?? []).every(([index, values]) => values.some((value) => BigInt(value) === raw[index]));
  }

  /** Bytes of the longest frame up to the last element of its open end. Throws a CodecError for more elements than there can be. */
  function sizeOf(message, raw) {
    if (!message.tail) return message.length;
    const counter = counterOf(message);
    const { least, step, most } = message.tail;
    check(message.fields[counter], raw[counter]);
    const plus = plusOf(message);
    const [low, high] = [Math.max(0, -plus), most - plus];
    if (raw[counter] < low || raw[counter] > high) throw unfit(message.fields[counter], `takes ${low} to ${high}, not ${raw[counter]}`);
    return least + (Number(raw[counter]) + plus) * step;
  }

  /** Whether a frame with so many bytes up to its last element has a field; open bytes and text are there, if only in part. */
  function isIn(message, field, size) {
    if (field.type === "bytes") return Boolean(field.isOpen) || field.first + field.bits / 8 <= size || field.first >= endOf(message);
    return field.pieces.every(([byte]) => byte < size || byte >= endOf(message));
  }

  /** Parts with their own counters, and the arrays in their elements. */
  function countedParts(message) {
    const parts = message.inner ?? [];
    return [...parts, ...parts.flatMap((part) => part.nested ?? [])];
  }

  /** The frame of raw values in the order of the fields; reserved bits are 0. Throws a CodecError for a value that does not fit; views have none. */
  function encode(message, raw) {
    const frame = new Uint8Array(message.length);
    const size = sizeOf(message, raw);
    countedParts(message).forEach(({ counter, most, plus }) => {
      const [low, high] = [Math.max(0, -plus), most - plus];
      check(message.fields[counter], raw[counter]);
      if (raw[counter] < low || raw[counter] > high) throw unfit(message.fields[counter], `takes ${low} to ${high}, not ${raw[counter]}`);
    });
    message.fields.forEach((field, index) => {
      if (field.view || !isIn(message, field, size) || !isThere(message, field, raw)) return;
      check(field, raw[index]);
      write(field, frame, raw[index]);
    });
    if (message.inner) return Uint8Array.from(places(message, raw), (at) => frame[at]);
    return message.tail ? frame.slice(0, size) : frame;
  }

  function read(field, frame) {
    if (field.type === "bytes") return frame.slice(field.first, field.first + field.bits / 8);
    let value = 0n;
    for (const [byte, shift, bits, at] of field.pieces) {
      value |= BigInt((frame[byte] >> shift) & ((1 << bits) - 1)) << BigInt(at);
    }
    return field.signed ? BigInt.asIntN(field.bits, value) : value;
  }

  function write(field, frame, raw) {
    if (field.type === "bytes") {
      frame.set(raw, field.first);
      return;
    }
    const value = BigInt.asUintN(field.bits, raw);
    for (const [byte, shift, bits, at] of field.pieces) {
      frame[byte] |= Number((value >> BigInt(at)) & BigInt((1 << bits) - 1)) << shift;
    }
  }

  /** Smallest and largest raw value of a field that is not a byte array. */
  function range(field) {
    const top = 1n << BigInt(field.bits - (field.signed ? 1 : 0));
    return [field.signed ? -top : 0n, top - 1n];
  }

  /** Throws a CodecError unless the field can hold the raw value. */
  function check(field, raw) {
    if (raw === undefined || raw === null) throw new CodecError("missing-field", `no value for ${field.name}`, { field: field.name });
    if (field.type === "bytes") {
      if (raw.length !== field.bits / 8) throw unfit(field, `takes ${field.bits / 8} bytes, not ${raw.length}`);
      return;
    }
    const [low, high] = range(field);
    if (raw < low || raw > high) throw unfit(field, `takes ${low} to ${high}, not ${raw}`);
  }

  function unfit(field, text) {
    return new CodecError("range", `${field.name} ${text}`, { field: field.name });
  }

  /** The raw values of a fresh message: 0, or what is demanded. */
  function fresh(message) {
    const counted = new Map();
    countedParts(message).forEach(({ counter, plus }) => {
      const { name } = message.fields[counter];
      counted.set(name, Math.max(0, -plus, counted.get(name) ?? 0));
    });
    if (message.tail) counted.set(message.tail.counter, Math.max(0, -plusOf(message)));
    const first = (field) => BigInt(field.const ?? counted.get(field.name) ?? 0);
    const raw = message.fields.map((field) => (field.type === "bytes" ? new Uint8Array(field.bits / 8) : first(field)));
    const read = decode(message, encode(message, raw));
    if (message.inner) message.fields.forEach((field, index) => (read[index] = field.inner ? raw[index] : read[index]));
    return read;
  }

  /** Exact physical value of a scaled field as [numerator, denominator]; null without a scale. */
  function exact(field, raw) {
    if (!field.scale) return null;
    const [p, c, q] = field.scale.map(BigInt);
    return [raw * p + c, q];
  }

  /**
   * A curve in doubles: from each start on, the terms of a polynomial in what is above that, by Horner's rule; the constant
   * stands first, and without terms there is no number. NaN has always the same bits.
   */
  function onCurve(pieces, raw) {
    let [first, end] = [0, pieces.length];
    while (end - first > 1) {
      const middle = Math.floor((first + end) / 2);
      if (pieces[middle][0] <= raw) first = middle;
      else end = middle;
    }
    const [start, terms] = pieces[first];
    if (!terms.length || Number.isNaN(raw)) return NaN;
    const above = raw - start;
    const value = terms.reduceRight((sum, term) => sum * above + term);
    return Number.isNaN(value) ? NaN : value;
  }

  /** What is derived from the values of fields, in doubles: each step takes two of the row and adds one to it, the last one is it. */
  function derived(message, field, raw) {
    const [places, numbers, steps] = field.derived;
    const row = [...places.map((place) => number(message.fields[place], raw[place])), ...numbers];
    for (const [operator, left, right] of steps) row.push(OPERATORS[operator](row[left], row[right]));
    return Number.isNaN(row.at(-1)) ? NaN : row.at(-1);
  }

  const OPERATORS = { "+": (a, b) => a + b, "-": (a, b) => a - b, "*": (a, b) => a * b, "/": (a, b) => a / b, "^": power };

  /** By squaring, from the lowest bit of a whole exponent on; of a negative one the reciprocal. */
  function power(base, exponent) {
    let found = 1;
    for (let [left, square] = [Math.abs(exponent), base]; left > 0; left = Math.floor(left / 2), square *= square) {
      if (left % 2) found *= square;
    }
    return exponent < 0 ? 1 / found : found;
  }

  /** The physical value of a number, of one without a formula its raw value. */
  function number(field, raw) {
    return physical(field, raw) ?? (field.type === "float" ? floatValue(field, raw) : Number(raw));
  }

  /** Raw value nearest to a physical one of a curve, ties to even. */
  function rawFromCurve(field, value) {
    if (field.oneWay) throw unfit(field, "takes raw values only, as its physical value does not lead back to one");
    if (field.type === "float") {
      const [[, [constant, slope]]] = field.curve;
      const inverse = (value - constant) / slope;
      const narrow = field.bits === 32 ? Math.fround(inverse) : inverse;
      if (!Number.isFinite(narrow)) throw unfit(field, `cannot hold ${value}`);
      return floatBits(field, narrow);
    }
    let [low, high] = (field.ends ?? range(field)).map(Number);
    const at = (raw) => onCurve(field.curve, raw);
    const ends = [at(low), at(high)];
    const rises = ends[0] < ends[1];
    if (!rises) ends.reverse();
    if (value < ends[0] || value > ends[1]) throw unfit(field, `takes ${ends[0]} to ${ends[1]}, not ${value}`);
    while (high - low > 1) {
      const middle = Math.floor((low + high) / 2);
      if (rises ? at(middle) <= value : at(middle) >= value) low = middle;
      else high = middle;
    }
    const [below, above] = [Math.abs(value - at(low)), Math.abs(at(high) - value)];
    return BigInt(below < above || (below === above && low % 2 === 0) ? low : high);
  }

  /** The correctly rounded double of the physical value, that of a curve as it is defined; null without a formula. */
  function physical(field, raw) {
    if (field.curve) return onCurve(field.curve, field.type === "float" ? floatValue(field, raw) : Number(raw));
    const ratio = exact(field, raw);
    return ratio && nearestDouble(...ratio);
  }

  /** Raw value nearest to a physical one, ties to even. Throws a CodecError for what is not finite or does not fit. */
  function rawFromPhysical(field, value) {
    if (!Number.isFinite(value)) throw unfit(field, `takes a finite number, not ${value}`);
    if (field.curve) return rawFromCurve(field, value);
    const [p, c, q] = (field.scale ?? [1, 0, 1]).map(BigInt);
    let [number, exponent] = split(value);
    let over = p;
    number *= q;
    if (exponent >= 0n) number = (number << exponent) - c;
    else {
      number -= c << -exponent;
      over <<= -exponent;
    }
    const raw = over < 0n ? rounded(-number, -over) : rounded(number, over);
    const [low, high] = range(field);
    if (raw < low || raw > high) {
      const ends = [low, high].map((end) => (field.scale ? physical(field, end) : Number(end))).sort((a, b) => a - b);
      throw unfit(field, `takes ${ends[0]} to ${ends[1]}, not ${value}`);
    }
    return raw;
  }

  /** n / d, rounded to the nearest integer, ties to even; d > 0. */
  function rounded(n, d) {
    if (n < 0n) return -rounded(-n, d);
    const whole = n / d;
    const twice = 2n * (n % d);
    return twice > d || (twice === d && whole & 1n) ? whole + 1n : whole;
  }

  function bitLength(n) {
    const hex = n.toString(16);
    return 4 * hex.length - Math.clz32(parseInt(hex[0], 16)) + 28;
  }

  /** The double nearest to n / d, ties to even; d > 0. */
  function nearestDouble(n, d) {
    if (n === 0n) return 0;
    if (n < 0n) return -nearestDouble(-n, d);
    let exponent = Math.max(bitLength(n) - bitLength(d) - 53, -1074);
    const digits = (e) => (e < 0 ? rounded(n << BigInt(-e), d) : rounded(n, d << BigInt(e)));
    if (bitLength(digits(exponent)) > 53) exponent += 1;
    return Number(digits(exponent)) * 2 ** exponent;
  }

  const scratch = new DataView(new ArrayBuffer(8));

  /** A finite double as [integer, power of two], exactly. */
  function split(value) {
    scratch.setFloat64(0, value);
    const bits = scratch.getBigUint64(0);
    const exponent = (bits >> 52n) & 0x7ffn;
    const fraction = bits & 0xfffffffffffffn;
    const digits = exponent ? fraction | 0x10000000000000n : fraction;
    return [bits >> 63n ? -digits : digits, (exponent || 1n) - 1075n];
  }

  /** What the bytes of a text field say before the first NUL; U+FFFD for each that is not ASCII. */
  function text(raw) {
    const end = raw.indexOf(0);
    return Array.from(end < 0 ? raw : raw.subarray(0, end), (byte) => (byte < 0x80 ? String.fromCharCode(byte) : "\ufffd")).join("");
  }

  /** The bytes of a text, filled with NUL. Throws a CodecError if it is too long, not ASCII or has a NUL in it. */
  function rawFromText(field, said) {
    const raw = new Uint8Array(field.bits / 8);
    if (said.length > raw.length || !/^[\x01-\x7f]*$/.test(said)) {
      throw unfit(field, `takes up to ${raw.length} ASCII characters, none of them NUL`);
    }
    raw.set(Array.from(said, (one) => one.charCodeAt(0)));
    return raw;
  }

  /** The bits of a double. */
  function doubleBits(value) {
    scratch.setFloat64(0, value);
    return scratch.getBigUint64(0);
  }

  /** The double of these bits. */
  function doubleOf(bits) {
    scratch.setBigUint64(0, bits);
    return scratch.getFloat64(0);
  }

  /** The number that the bits of a float field stand for. */
  function floatValue(field, raw) {
    if (field.bits === 64) return doubleOf(raw);
    scratch.setUint32(0, Number(raw));
    return scratch.getFloat32(0);
  }

  /** The bits of the nearest float of the field's width. Throws a CodecError for a finite number that is too large. */
  function floatBits(field, value) {
    if (field.bits === 64) return doubleBits(value);
    scratch.setFloat32(0, value);
    if (Number.isFinite(value) && !Number.isFinite(scratch.getFloat32(0))) {
      throw unfit(field, `is a 32-bit float and cannot hold ${value}`);
    }
    return BigInt(scratch.getUint32(0));
  }

  /** The name of a value; undefined for what is no member. Each has a value and a name, a range its last value, too. */
  function memberName(members, value) {
    return members.find(([first, , last = first]) => BigInt(first) <= value && value <= BigInt(last))?.[1];
  }

  return {
    CodecError, expanded, plusOf, decode, encode, places, isIn, isThere, sizeOf, check, range, fresh, exact, physical, rawFromPhysical, nearestDouble, doubleBits, doubleOf, text,
    rawFromText, floatValue, floatBits, memberName,
  };
})();
if (typeof module !== "undefined") module.exports = icdgenCodec;
