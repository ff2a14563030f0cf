"use strict";
/* Bytes as people write them, and as they go over a wire: hexadecimal in any spelling, framing, checksums. */
const icdgenFrames = (() => {
  const TOKEN = /(?<space>[\s,;:{}[\]()_.-]+)|(?<prefix>0[xX]|\\[xX]|[xX#$](?=[0-9A-Fa-f]))|(?<digits>[0-9A-Fa-f]+)/y;

  /** The bytes of `2efb 0a00`, `0x2e,0xfb`, `2E:FB`, `{0x2e, 0xfb}`, `b"\x2e\xfb"`. Throws an Error that says what does not fit. */
  function parseHex(text) {
    const quoted = /^\s*b?(["'])([^]*)\1\s*$/.exec(text);
    const inside = quoted ? quoted[2] : text;
    const found = [];
    let prefixed = -1;
    for (TOKEN.lastIndex = 0; TOKEN.lastIndex < inside.length; ) {
      const at = TOKEN.lastIndex;
      const token = TOKEN.exec(inside);
      if (!token) throw new Error(`${JSON.stringify(String.fromCodePoint(inside.codePointAt(at)))} is not hexadecimal`);
      let { digits } = token.groups;
      if (prefixed === at && digits === undefined) throw new Error("digits must follow the prefix");
      if (digits !== undefined) {
        if (prefixed === at && digits.length === 1) digits = `0${digits}`;
        const after = inside[TOKEN.lastIndex] ?? "";
        if (/[\p{L}\p{N}]/u.test(after)) throw new Error(`${JSON.stringify(after)} is not hexadecimal`);
        if (digits.length % 2) throw new Error(`${digits.slice(0, 20)} is an odd number of digits`);
        for (let i = 0; i < digits.length; i += 2) found.push(parseInt(digits.slice(i, i + 2), 16));
      } else if (token.groups.prefix) {
        prefixed = TOKEN.lastIndex;
      }
    }
    if (prefixed === inside.length) throw new Error("digits must follow the prefix");
    return Uint8Array.from(found);
  }

  /** Pairs of digits with spaces between them. */
  function hex(bytes) {
    return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0").toUpperCase()).join(" ");
  }

  /** A CRC of up to 32 bits from its parameters. */
  function crc(facts, data) {
    if (data.length === 0 && facts.empty !== undefined) return facts.empty;
    const { width = 8, polynomial } = facts;
    const mask = 2 ** width - 1;
    let value = facts.init;
    for (const byte of data) {
      for (let place = 0; place < 8; place += 1) {
        const bit = (byte >> (facts.reflect_in ? place : 7 - place)) & 1;
        const out = (value >>> (width - 1)) ^ bit;
        value = (((value << 1) & mask) ^ (out ? polynomial : 0)) >>> 0;
      }
    }
    if (facts.reflect_out) value = parseInt([...value.toString(2).padStart(width, "0")].reverse().join(""), 2);
    return (value ^ facts.xor_out) >>> 0;
  }

  /** A checksum of up to 32 bits. Without a kind, it is a CRC. */
  function sum(facts, data) {
    const { kind, width, init, xor_out } = facts;
    if (kind === undefined) return crc(facts, data);
    let found;
    if (kind === "sum") {
      found = data.reduce((value, byte) => value + byte, init) % 2 ** width;
    } else if (kind === "xor") {
      found = data.reduce((value, byte) => value ^ byte, init);
    } else {
      const modulus = kind === "fletcher_255" ? 255 : 256;
      let [first, second] = [init & 0xff, init >> 8];
      for (const byte of data) {
        first = (first + byte) % modulus;
        second = (second + first) % modulus;
      }
      found = (second % modulus) * 256 + (first % modulus);
    }
    return (found ^ xor_out) >>> 0;
  }

  /** The bytes of a message's checksum, which covers the id too where the device says so. */
  function checksum(facts, id, data) {
    const value = sum(facts, facts.covers_id ? [id, ...data] : data);
    const bytes = Array.from({ length: facts.bytes }, (_, place) => Math.floor(value / 256 ** place) % 256);
    return facts.little ? bytes : bytes.reverse();
  }

  /** What must follow `length` bytes of data and whether it does, `{ right, fits }`; null without a checksum, or room for it. */
  function check(facts, length, id, data) {
    if (!facts || data.length !== length + facts.bytes) return null;
    const right = checksum(facts, id, data.slice(0, length));
    return { right, fits: right.every((byte, at) => byte === data[length + at]) };
  }

  /** The message as it goes over the wire, with framing; `checked` appends the checksum. */
  function framed(wire, data, checked) {
    const [escape, start, end, doubled] = wire.framing;
    const body = [wire.id, ...data, ...(checked ? checksum(wire.crc[0], wire.id, data) : [])];
    const escaped = (byte, at) => (byte === escape && (at > 0 || !wire.plain_id) ? [escape, doubled] : [byte]);
    return Uint8Array.from([escape, start, ...body.flatMap(escaped), escape, end]);
  }

  /** Whether data are of a message that shares its id: `signs` are byte, mask and value where it has a constant; of a `tail` not every frame has all; zeros that are cut off are read. */
  function isLike(length, tail, signs, data) {
    const { least, step } = tail ?? { least: length, step: 1 };
    const hasLength = data.length >= least && data.length <= length && (data.length - least) % step === 0;
    return hasLength && signs.every(([byte, mask, value]) => ((data[byte] ?? 0) & mask) === value);
  }

  return { parseHex, hex, sum, checksum, check, framed, isLike };
})();
if (typeof module !== "undefined") module.exports = icdgenFrames;
