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

  /** An id as people write it: `01 35` where packets have it as bytes, the most significant first, else `309`. */
  function idText(form, id) {
    return form.id_pairs ? frames.hex(bytesOf(id, form.id_pairs, false)) : String(id);
  }

  function bytesOf(value, size, little) {
    const found = Array.from({ length: size }, (_, at) => Math.floor(value / 2 ** (8 * at)) % 256);
    return Uint8Array.from(little ? found : found.reverse());
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
    let end = 0;
    function take(frame, size) {
      const one = judge(form, rows, constants, frame);
      events.push({ ...one, at: end, end: end + size, frame });
      end += size;
      if (one.is !== "message") found.lost += size;
    }
    if (form.delimited_by === "none") take(bytes, bytes.length);
    else if (form.delimited_by === "length") [found.lost, end] = byLength(form, rows, constants, bytes, events);
    else {
      const read = unstuffed(form, bytes);
      for (const { frame, size, fault } of read.frames) {
        if (fault) {
          events.push({ event: fault, at: end, end: end + size, frame: Uint8Array.from(frame) });
          end += size;
          found.lost += size;
        } else {
          take(Uint8Array.from(frame), size);
        }
      }
      found.lost += read.left;
    }
    if (end < bytes.length) events.push({ event: "cut", at: end, end: bytes.length, ...begun(form, bytes.subarray(end)) });
    return { events, lost: found.lost };
  }

  /** Adds the events where the length delimits; how many bytes belong to no message, and where what is undecided begins. */
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
      if (left < form.header) return [lost + left, at];
      const data = get(form, length, front, 0) - form.plus;
      const size = form.header + data + form.trailer;
      if (data < 0 || size > form.longest) {
        events.push({ event: "length", at, end: at + 1, frame: front });
        lost += 1;
        at += 1;
        continue;
      }
      if (left < size) return [lost + left, at];
      const one = judge(form, rows, constants, bytes.slice(at, at + size));
      events.push({ ...one, at, end: at + size, frame: bytes.slice(at, at + size) });
      const used = one.is === "doubtful" ? 1 : size;
      if (one.is !== "message") lost += used;
      at += used;
    }
    return [lost, bytes.length];
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
  function removed(form, { id, values }) {
    return `envelope with id ${idText(form, id)} removed${chosen(values) ? `; it has ${chosen(values)}` : ""}`;
  }

  /** What is said of the bytes around the messages. */
  const around = (lost) => (lost ? [`${lost} byte${lost === 1 ? "" : "s"} around the frame belong to none`] : []);

  // Packets that cannot be decoded

  const count = (number) => `${number} byte${number === 1 ? "" : "s"}`;
  const isDelimitedAhead = (form) => ["slip", "hdlc"].includes(form.delimited_by);
  const constantsOf = (form) => form.fields.filter(({ role, in_trailer }) => role === "constant" && !in_trailer);
  const sideOf = (direction) => DIRECTIONS.indexOf(direction);

  /** Whether packets begin with bytes by which they are recognized. */
  const hasSync = (form) => isDelimitedAhead(form) || constantsOf(form).reduce((bits, field) => bits + field.bits, 0) >= 8;

  /** Whether bytes begin as packets of a direction do: with the delimiter, or with the constants of the header. */
  function begins(form, direction, bytes) {
    if (isDelimitedAhead(form)) return bytes[0] === ENDS[form.delimited_by][0];
    return bytes.length > 0 && hasSync(form) && bitsOfConstants(form, direction, bytes) > 0;
  }

  /** `A5 5A`: bytes that packets of a direction begin with; empty if their first byte is not constant. */
  function syncText(form, direction) {
    if (isDelimitedAhead(form)) return frames.hex([ENDS[form.delimited_by][0]]);
    const constants = new Map(constantsOf(form).map((field) => [field.at, field]));
    const found = [];
    for (let field = constants.get(0); field && field.bits === 8 * field.size; field = constants.get(found.length)) {
      found.push(...bytesOf(field.values[sideOf(direction)], field.size, field.little));
    }
    return frames.hex(found);
  }

  /** Bits of the header's constants that the packet has; -1 if one has another value. A field may be cut off. */
  function bitsOfConstants(form, direction, packet) {
    let found = 0;
    for (const field of constantsOf(form)) {
      const mask = bytesOf((2 ** field.bits - 1) * 2 ** field.shift, field.size, field.little);
      const right = bytesOf(field.values[sideOf(direction)] * 2 ** field.shift, field.size, field.little);
      const came = packet.subarray(field.at, field.at + field.size);
      if (came.some((byte, at) => (byte ^ right[at]) & mask[at])) return -1;
      for (let at = 0; at < came.length; at += 1) found += mask[at].toString(2).replaceAll("0", "").length;
    }
    return found;
  }

  /** Bytes of the packet as its header says; undefined if it does not, or has not come. */
  function sizeOf(form, packet) {
    const field = fieldOf(form, "length");
    return field && packet.length >= form.header ? form.header + get(form, field, packet, 0) - form.plus + form.trailer : undefined;
  }

  /** The packet that bytes begin with, without stuffing, and whether its end came. */
  function begun(form, bytes) {
    if (form.delimited_by === "none") return { frame: bytes, whole: true };
    if (form.delimited_by === "length") {
      const needed = sizeOf(form, bytes);
      return { frame: bytes.slice(0, needed < 0 ? 0 : needed), whole: needed !== undefined && bytes.length >= needed };
    }
    const [first] = unstuffed(form, bytes).frames;
    if (first) return { frame: Uint8Array.from(first.frame), whole: !first.fault };
    const [open] = unstuffed(form, [...bytes, ENDS[form.delimited_by][0]]).frames;
    return { frame: Uint8Array.from(open?.frame ?? []), whole: false };
  }

  /**
   * Why a packet without its stuffing is no message of a direction: `{ rank, text, isOfMessage, isCertain }`; null if it is
   * not even the beginning of a packet. `namesOf` gives the messages of a direction and an id.
   */
  function faultOf(form, direction, packet, isWhole, title, namesOf) {
    const bits = bitsOfConstants(form, direction, packet);
    if (bits < 0) return null;
    const field = fieldOf(form, "id");
    const isThere = field && field.at + field.size <= packet.length && (!field.in_trailer || (isWhole && packet.length >= form.trailer));
    const only = form[direction][0]?.[0];
    const id = field ? (isThere ? get(form, field, packet, packet.length) : undefined) : only;
    const row = id === undefined ? undefined : form[direction].find(([one]) => one === id);
    const names = row ? namesOf(direction, id) : [];
    let told = `packet of ${title}`;
    if (field && id !== undefined) told += ` with the id ${idText(form, id)}`;
    if (names.length) told = `packet of ${title}, ${names.join(" or ")} (${direction} ${idText(form, id)})`;
    const needed = sizeOf(form, packet);
    const data = needed === undefined ? undefined : needed - form.header - form.trailer;
    const fault = (rank, text, isCertain = false) => ({ rank: bits + (row ? 100 : 0) + rank, text: `a ${told} ${text}`, isOfMessage: Boolean(row), isCertain });
    if (data < 0 || needed > form.longest) return fault(0, `says that it has ${count(needed)}; packets have up to ${form.longest}`);
    const isCertain = Boolean(row) && (data === undefined ? isDelimitedAhead(form) : row[1] <= data && data <= row[2]);
    if (!isWhole || needed > packet.length) {
      let wanted = needed === undefined ? `its header has ${form.header}` : `${needed} are needed`;
      if (needed === undefined && packet.length >= form.header && ENDS[form.delimited_by]) {
        wanted = `the byte ${frames.hex([ENDS[form.delimited_by][0]])} that ends it is missing`;
      }
      return fault(0, `is cut off: ${count(packet.length)} came, ${wanted}`, isCertain);
    }
    return wholeFault(form, direction, packet, { row, needed, isCertain, fault, namesOf, field });
  }

  /** Of a packet whose end came. */
  function wholeFault(form, direction, packet, { row, needed, isCertain, fault, namesOf, field }) {
    const size = packet.length - form.header - form.trailer;
    const side = sideOf(direction);
    const read = (one) => get(form, one, packet, packet.length);
    if (size < 0) return fault(0, `is cut off: ${count(packet.length)} came, header and trailer have ${form.header + form.trailer}`);
    if (needed !== undefined && needed !== packet.length) return fault(0, `has ${count(packet.length)}, its length says ${needed}`);
    const end = form.fields.find((one) => one.role === "constant" && one.in_trailer && read(one) !== one.values[side]);
    if (end) return fault(0, `ends with ${valueText(end, read(end))}, expected ${valueText(end, end.values[side])}`);
    const place = fieldOf(form, "checksum");
    if (place && form.check && (row || !form.check.seeded)) {
      const right = checksum(form, row, packet);
      if (read(place) !== right) return fault(200, `has a wrong checksum: it is ${valueText(place, read(place))}, expected ${valueText(place, right)}`, isCertain);
    }
    if (!row) {
      const other = DIRECTIONS[1 - side];
      const names = field && form[other].some(([one]) => one === read(field)) ? namesOf(other, read(field)) : [];
      const none = names.length ? `no ${direction} with this id, but ${other} ${names.join(" or ")}` : "no message with this id";
      return fault(300, `and ${count(size)} of data is no message: it has ${none}`);
    }
    if (size < row[1] || size > row[2]) {
      return fault(300, `has ${count(size)} of data, the ICD says ${row[1] === row[2] ? row[1] : `${row[1]} to ${row[2]}`}`, true);
    }
    return fault(300, "has data that are not those of the message, by length and constants");
  }

  /** A checksum as its bytes are sent; where they are shared with other fields, as a number. */
  function valueText(field, value) {
    if (field.shift || field.bits !== 8 * field.size) return `0x${value.toString(16).toUpperCase()}`;
    return frames.hex(bytesOf(value, field.size, field.little));
  }

  /** The fault of bytes that begin as a packet does; null if they do not. */
  function faultOfBeginning(form, bytes, title, namesOf) {
    const every = DIRECTIONS.filter((one) => begins(form, one, bytes)).map((one) => {
      const { frame, whole } = begun(form, bytes);
      return faultOf(form, one, frame, whole, title, namesOf);
    });
    return likeliest(every.filter(Boolean));
  }

  /** Of several explanations the one by which most of the header fits. */
  const likeliest = (every) => every.reduce((best, one) => (best && best.rank >= one.rank ? best : one), null);

  return { DIRECTIONS, decode, isMarked, removed, around, hasSync, syncText, faultOf, faultOfBeginning, likeliest, idText };
})(typeof icdgenFrames === "undefined" ? require("./frames.js") : icdgenFrames);
if (typeof module !== "undefined") module.exports = icdgenEnvelopes;
