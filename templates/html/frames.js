"use strict";
/* Bytes as people write them, and as they go over a wire: hexadecimal in any spelling, framing with escapes, checksums. */
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

  /** A checksum of up to 32 bits from its parameters. */
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

  /** The checksum of a message, over the id too where the device says so. */
  const checksum = (facts, id, data) => crc(facts, facts.covers_id ? [id, ...data] : data);

  /** The message as it goes over the wire, with framing; `check` appends the checksum. */
  function framed(wire, data, check) {
    const [escape, start, end, doubled] = wire.framing;
    const body = [wire.id, ...data, ...(check ? [checksum(wire.crc[0], wire.id, data)] : [])];
    const escaped = (byte, at) => (byte === escape && (at > 0 || !wire.plain_id) ? [escape, doubled] : [byte]);
    return Uint8Array.from([escape, start, ...body.flatMap(escaped), escape, end]);
  }

  /** Id and data between the framing; null where there is none. Throws an Error where it is broken. */
  function unframed(wire, bytes) {
    if (!wire.framing || bytes.length < 2) return null;
    const [escape, start, end, doubled] = wire.framing;
    if (bytes[0] !== escape || bytes[1] !== start) return null;
    const body = [];
    for (let at = 2; at < bytes.length; at += 1) {
      if (bytes[at] !== escape || (at === 2 && wire.plain_id)) {
        body.push(bytes[at]);
        continue;
      }
      at += 1;
      if (bytes[at] === doubled) body.push(escape);
      else if (bytes[at] === end && at === bytes.length - 1) return body;
      else if (bytes[at] === end) throw new Error(`${bytes.length - 1 - at} bytes follow the end of the message`);
      else throw new Error(`byte ${at}: the escape byte is followed by neither itself nor an end of message`);
    }
    throw new Error("the end of the message is missing");
  }

  /** The id that bytes begin with: its most significant byte comes first. */
  const idOf = (wire, bytes) => bytes.slice(0, wire.id_bytes || 1).reduce((id, byte) => id * 256 + byte, 0);

  /** The data in what was pasted, and remarks about what was around it. Throws an Error where it cannot be this message. */
  function unwrap(wire, length, bytes) {
    const remarks = [];
    const size = wire.id_bytes || 1;
    let data = bytes;
    const body = unframed(wire, bytes);
    if (body) {
      if (!wire.ids.includes(body[0])) throw new Error(`framed with id ${body[0]}, which is another message's`);
      remarks.push(`framing with id ${body[0]} removed`);
      data = Uint8Array.from(body.slice(1));
    }
    const id = body ? body[0] : wire.id;
    const checked = (some, of) => some.length > 0 && wire.crc.some((facts) => checksum(facts, of, some.slice(0, -1)) === some[some.length - 1]);
    if (data.length === length + 1 && checked(data, id)) {
      remarks.push("CRC is right");
      data = data.slice(0, length);
    } else if (!body && data.length === length + size && wire.ids.includes(idOf(wire, data))) {
      remarks.push(`id ${idOf(wire, data)} removed`);
      data = data.slice(size);
    } else if (!body && data.length === length + 2 && wire.ids.includes(data[0]) && checked(data.slice(1), data[0])) {
      remarks.push(`id ${data[0]} removed`, "CRC is right");
      data = data.slice(1, -1);
    } else if (data.length === length + 1 && wire.crc.length) {
      const right = checksum(wire.crc[0], id, data.slice(0, length));
      throw new Error(`one byte too many: as CRC it would have to be ${hex([right])}, not ${hex([data[length]])}`);
    }
    return { data, remarks };
  }

  return { parseHex, hex, crc, checksum, framed, unwrap };
})();
if (typeof module !== "undefined") module.exports = icdgenFrames;
