"use strict";
/* Bytes in the envelope that an ICD describes -> the messages in them, and what was dropped, as generated decoders find them. */
const icdgenEnvelopes = ((frames) => {
  const DIRECTIONS = ["telecommand", "telemetry"];
  const ENDS = { slip: [0xc0, 0xdb], hdlc: [0x7e, 0x7d], cobs: [0x00, -1] };
  const SLIP_MEANT = { 0xdc: 0xc0, 0xdd: 0xdb };

  const fieldOf = (form, role) => form.fields.find((field) => field.role === role);

  /** A field of a frame of which `length` bytes are whole. */
  function get(form, field, frame, length) {
    const from = field.at + (field.in_trailer ? length - form.trailer : 0);
    const part = [...frame.slice(from, from + field.size)];
    if (field.little) part.reverse();
    const value = part.reduce((sum, byte) => sum * 256 + byte, 0);
    return Math.floor(value / 2 ** field.shift) % 2 ** field.bits;
  }

  /** A checksum of up to 32 bits. */
  function sum({ kind, crc }, data) {
    if (kind === "crc") return frames.crc(crc, data);
    let found;
    if (kind === "sum") {
      found = data.reduce((value, byte) => value + byte, crc.init) % 2 ** crc.width;
    } else if (kind === "xor") {
      found = data.reduce((value, byte) => value ^ byte, crc.init);
    } else {
      const modulus = kind === "fletcher_255" ? 255 : 256;
      let [first, second] = [crc.init & 0xff, crc.init >> 8];
      for (const byte of data) {
        first = (first + byte) % modulus;
        second = (second + first) % modulus;
      }
      found = (second % modulus) * 256 + (first % modulus);
    }
    return (found ^ crc.xor_out) >>> 0;
  }

  /** The checksum that a frame must have; `row` has the seed of its message. */
  function checksum(form, row, frame) {
    const { from, trailer, seeded } = form.check;
    const covered = [...frame.slice(from, frame.length - form.trailer + trailer)];
    return sum(form.check, seeded ? [...covered, row[3]] : covered);
  }

  /** `{ event, id, data, values, is }` of a frame; `is` says whether it is one: `message`, `proven` (of no use) or `doubtful`. */
  function judge(form, rows, constants, frame) {
    const count = frame.length - form.header - form.trailer;
    const of = (role) => fieldOf(form, role);
    const read = (field) => get(form, field, frame, frame.length);
    if (count < 0) return { event: "length", is: "doubtful" };
    if (constants.some(({ field, value }) => read(field) !== value)) return { event: "framing", is: "doubtful" };
    if (of("length") && read(of("length")) - form.plus !== count) return { event: "length", is: "doubtful" };
    const id = of("id") ? read(of("id")) : Math.min(...rows.keys());
    const row = rows.get(id);
    if (of("checksum") && form.check) {
      if (form.check.seeded && !row) return { event: "unknown_id", id, is: "doubtful" };
      if (read(of("checksum")) !== checksum(form, row, frame)) return { event: "checksum", id, is: "doubtful" };
    }
    if (!row) return { event: "unknown_id", id, is: "proven" };
    if (count < row[1] || count > row[2]) return { event: "length", id, is: "proven" };
    const values = Object.fromEntries(form.fields.filter((field) => form.given.includes(field.role)).map((field) => [field.role, read(field)]));
    return { event: "message", id, data: frame.slice(form.header, form.header + count), values, is: "message" };
  }

  /** `{ events, lost }` of the messages of a direction; `lost` bytes belong to no message. */
  function decode(form, direction, bytes) {
    const rows = new Map(form[direction].map((row) => [row[0], row]));
    const side = DIRECTIONS.indexOf(direction);
    const constants = form.fields.filter(({ role }) => role === "constant").map((field) => ({ field, value: field.values[side] }));
    const [events, found] = [[], { lost: 0 }];
    function take(frame, size) {
      const one = judge(form, rows, constants, frame);
      events.push(one);
      if (one.is !== "message") found.lost += size;
    }
    if (form.delimited_by === "none") take(bytes, bytes.length);
    else if (form.delimited_by === "length") found.lost += byLength(form, rows, constants, bytes, events);
    else {
      const read = unstuffed(form, bytes);
      for (const { frame, size, fault } of read.frames) {
        if (fault) {
          events.push({ event: fault });
          found.lost += size;
        } else {
          take(Uint8Array.from(frame), size);
        }
      }
      found.lost += read.left;
    }
    return { events, lost: found.lost };
  }

  /** Adds the events where the length delimits; how many bytes belong to no message. */
  function byLength(form, rows, constants, bytes, events) {
    const ahead = constants.filter(({ field }) => !field.in_trailer);
    const length = fieldOf(form, "length");
    let lost = 0;
    for (let at = 0; at < bytes.length; ) {
      const left = bytes.length - at;
      const front = bytes.subarray(at, at + form.header);
      if (ahead.some(({ field, value }) => field.at + field.size <= left && get(form, field, front, 0) !== value)) {
        lost += 1;
        at += 1;
        continue;
      }
      if (left < form.header) return lost + left;
      const data = get(form, length, front, 0) - form.plus;
      const size = form.header + data + form.trailer;
      if (data < 0 || size > form.longest) {
        events.push({ event: "length" });
        lost += 1;
        at += 1;
        continue;
      }
      if (left < size) return lost + left;
      const one = judge(form, rows, constants, bytes.slice(at, at + size));
      events.push(one);
      const used = one.is === "doubtful" ? 1 : size;
      if (one.is !== "message") lost += used;
      at += used;
    }
    return lost;
  }

  /** `{ frames, left }` between delimiters: what stood there, of so many bytes, and its fault; `left` bytes follow. */
  function unstuffed(form, bytes) {
    const [end, escape] = ENDS[form.delimited_by];
    const isCobs = form.delimited_by === "cobs";
    const found = [];
    const fresh = () => ({ frame: [], size: 0, fault: null, escaped: false, block: 0, zero: false });
    let now = fresh();
    function put(byte) {
      if (now.frame.length === form.longest) now.fault = "overrun";
      else now.frame.push(byte);
    }
    for (const byte of bytes) {
      now.size += 1;
      if (byte === end) {
        if (now.escaped || now.block) now.fault ??= "framing";
        if (now.frame.length || now.fault) found.push(now);
        now = fresh();
      } else if (!now.fault) {
        if (isCobs && now.block) {
          now.block -= 1;
          put(byte);
        } else if (isCobs) {
          if (now.zero) put(0);
          [now.block, now.zero] = [byte - 1, byte !== 0xff];
        } else if (now.escaped) {
          now.escaped = false;
          const meant = form.delimited_by === "slip" ? SLIP_MEANT[byte] : byte ^ 0x20;
          if (meant === undefined) now.fault = "framing";
          else put(meant);
        } else if (byte === escape) {
          now.escaped = true;
        } else {
          put(byte);
        }
      }
    }
    return { frames: found, left: now.size };
  }

  /** Whether a message shows that it is one, by a constant or a checksum. */
  const isMarked = (form) => Boolean(form.check || fieldOf(form, "constant"));

  const chosen = (values) => Object.entries(values).map(([role, value]) => `${role} ${value}`).join(", ");

  /** What is said of a message that was in an envelope. */
  function removed({ id, values }) {
    return `envelope with id ${id} removed${chosen(values) ? `; it has ${chosen(values)}` : ""}`;
  }

  /** What is said of what is around the messages. */
  function around({ events, lost }) {
    const wrong = new Set(events.filter(({ event }) => event !== "message").map(({ event }) => event.replaceAll("_", " ")));
    const left = lost ? [`${lost} byte${lost === 1 ? "" : "s"} around the frame belong to none`] : [];
    return [...left, ...[...wrong].map((event) => `the stream has an error: ${event}`)];
  }

  /** What is said of bytes that begin with a message whose checksum is wrong; null if they do not. */
  function damaged(form, { events: [first] }) {
    if (first?.event !== "checksum" || !isMarked(form)) return null;
    return `a message in an envelope${first.id === undefined ? "" : `, with id ${first.id},`} has a wrong checksum`;
  }

  return { DIRECTIONS, decode, isMarked, removed, around, damaged };
})(typeof icdgenFrames === "undefined" ? require("./frames.js") : icdgenFrames);
if (typeof module !== "undefined") module.exports = icdgenEnvelopes;
