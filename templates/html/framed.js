"use strict";
/* Bytes in the packets that an ICD describes -> the messages in them, and what was dropped, as generated decoders find them. */
const icdgenFramed = ((frames) => {
  const DIRECTIONS = ["telecommand", "telemetry"];
  const ENDS = { slip: [0xc0, 0xdb], hdlc: [0x7e, 0x7d], cobs: [0x00, -1] };
  const SLIP_MEANT = { 0xdc: 0xc0, 0xdd: 0xdb };

  const fieldOf = (packet, role) => packet.fields.find((field) => field.role === role);
  const sideOf = (direction) => DIRECTIONS.indexOf(direction);

  /** A field of a frame of a packet format, of which `length` bytes are whole. */
  function get(packet, field, frame, length) {
    const from = field.at + (field.in_trailer ? length - packet.trailer : 0);
    const part = [...frame.slice(from, from + field.size)];
    if (field.little) part.reverse();
    const value = part.reduce((sum, byte) => sum * 256 + byte, 0);
    return Math.floor(value / 2 ** field.shift) % 2 ** field.bits;
  }

  /** The id of a frame from all its parts; undefined in a packet without id. */
  function idOf(packet, frame, length) {
    const parts = packet.fields.filter(({ role }) => role === "id");
    return parts.length ? parts.reduce((id, field) => id + get(packet, field, frame, length) * 2 ** (field.id_shift ?? 0), 0) : undefined;
  }

  /** The checksum that a frame must have; `row` has the seed of its message. */
  function checksum(packet, row, frame) {
    const { from, trailer, seeded } = packet.check;
    const covered = [...frame.slice(from, frame.length - packet.trailer + trailer)];
    return frames.sum(packet.check, seeded && row ? [...covered, row[3]] : covered);
  }

  /** An id as people write it: `01 35` where packets have it as bytes, the most significant first, else `309`. */
  function idText(form, id) {
    return form.id_pairs ? frames.hex(bytesOf(id, form.id_pairs, false)) : String(id);
  }

  function bytesOf(value, size, little) {
    const found = Array.from({ length: size }, (_, at) => Math.floor(value / 2 ** (8 * at)) % 256);
    return Uint8Array.from(little ? found : found.reverse());
  }

  /**
   * The packet formats of a direction, with what its decoder needs of each: `rows` of its messages and of the telemetry that
   * it requests, by id, and `only`, the id of the message of a packet without id.
   */
  function packetsOf(form, direction) {
    const kept = prepared.get(form) ?? {};
    prepared.set(form, kept);
    kept[direction] ??= prepare(form, direction);
    return kept[direction];
  }

  const prepared = new WeakMap();

  function prepare(form, direction) {
    const byId = (rows) => new Map(rows.map((row) => [row[0], row]));
    return form.packets.flatMap((packet, number) => {
      if (!packet.directions.includes(direction)) return [];
      const requested = direction === "telecommand" && form.request?.packet === number ? form.request.ids : [];
      const own = form[direction].filter((row) => row[4] === number);
      const tellsMessage = ["message", "request"].includes(packet.content);
      const rows = byId(tellsMessage ? own : []);
      const sizes = packet.content === "requested" ? own.flatMap(([, least, most]) => [least, most]) : [packet.reserved];
      return {
        ...packet,
        number,
        rows,
        requested: byId(form.telemetry.filter(([id]) => requested.includes(id))),
        constants: packet.fields.filter(({ role }) => role === "constant").map((field) => ({ field, value: field.values[sideOf(direction)] })),
        lengths: packet.fields.filter(({ role }) => role === "length"),
        tellsMessage,
        sizes: [Math.min(...sizes), Math.max(...sizes)],
        only: rows.size ? Math.min(...rows.keys()) : 0,
      };
    });
  }

  /** The message, or the requested telemetry, of an id; undefined without one. */
  const rowOf = (packet, id) => packet.rows.get(id ?? packet.only) ?? packet.requested.get(id ?? packet.only);

  const isRequested = (packet, row) => Boolean(row) && packet.requested.get(row[0]) === row;

  /** The smallest and the largest number of data bytes of a packet with the message of `row`, or without a message. */
  function boundsOf(form, packet, row) {
    if (isRequested(packet, row)) return [packet.reserved, packet.reserved];
    return row ? [row[1], row[2]] : packet.sizes;
  }

  /** The bytes of data that a value of a length says. */
  const bytesSaid = (field, value) => value * (field.unit ?? 1) - (field.plus ?? 0);

  /** Whether the request of a message says its length, if it says one. */
  function awaits(packet, row, read) {
    const field = isRequested(packet, row) && fieldOf(packet, "response_length");
    return !field || bytesSaid(field, read(field)) === row[2];
  }

  /** Whether a constant of the header, as far as it came, differs; `left` bytes came. */
  const differs = (packet, front, left) =>
    packet.constants.some(({ field, value }) => !field.in_trailer && field.at + field.size <= left && get(packet, field, front, 0) !== value);

  /** Whether a frame has the size of header and trailer, and all constants. */
  const fits = (packet, frame) =>
    frame.length >= packet.header + packet.trailer && packet.constants.every(({ field, value }) => get(packet, field, frame, frame.length) === value);

  /**
   * `{ event, id, data, values, is, packet }` of a frame: a `message`, a `request` of telemetry, a `packet` without a message, or a
   * fault. `is` says whether it is a packet of the link: `message`, `proven` (of no use) or `doubtful`.
   */
  function judge(form, packet, frame) {
    const count = frame.length - packet.header - packet.trailer;
    const read = (field) => get(packet, field, frame, frame.length);
    if (count < 0) return { event: "length", is: "doubtful" };
    if (!fits(packet, frame)) return { event: "framing", is: "doubtful" };
    if (packet.lengths.some((field) => bytesSaid(field, read(field)) !== count)) return { event: "length", is: "doubtful" };
    const given = idOf(packet, frame, frame.length);
    const [id, row, needsRow] = [given ?? packet.only, rowOf(packet, given), packet.tellsMessage];
    const sent = fieldOf(packet, "checksum");
    if (sent && packet.check) {
      if (packet.check.seeded && !row && needsRow) return { event: "unknown_id", id, is: "doubtful" };
      if (read(sent) !== checksum(packet, row, frame)) return { event: "checksum", id, is: "doubtful" };
    }
    if (!row && needsRow) return { event: "unknown_id", id, is: "proven" };
    const [least, most] = boundsOf(form, packet, row);
    if (count < least || count > most || !awaits(packet, row, read)) return { event: "length", id, is: "proven" };
    const values = Object.fromEntries(packet.fields.filter((field) => form.given.includes(field.role)).map((field) => [field.role, read(field)]));
    const event = !row ? "packet" : isRequested(packet, row) ? "request" : "message";
    const hasData = event === "message" || packet.content === "requested";
    const data = frame.slice(packet.header, hasData ? packet.header + count : packet.header);
    return { event, id, data, values, is: "message", packet: packet.number };
  }

  /** `{ events, lost }` of the messages of a direction; `lost` bytes belong to no message. */
  function decode(form, direction, bytes) {
    const packets = packetsOf(form, direction);
    const [events, found] = [[], { lost: 0 }];
    let end = 0;
    function refuse(event, frame, size) {
      events.push({ event, at: end, end: end + size, frame });
      end += size;
      found.lost += size;
    }
    function take(frame, size) {
      const one = judge(form, packets.find((packet) => fits(packet, frame)) ?? packets[0], frame);
      events.push({ ...one, at: end, end: end + size, frame });
      end += size;
      if (one.is !== "message") found.lost += size;
    }
    if (form.delimited_by === "datagram" && bytes.length > form.longest) refuse("overrun", bytes, bytes.length);
    else if (form.delimited_by === "datagram") take(bytes, bytes.length);
    else if (form.delimited_by === "length") [found.lost, end] = byLength(form, packets, bytes, events);
    else {
      const read = unstuffed(form, bytes);
      for (const { frame, size, fault } of read.frames) {
        if (fault === "noise") {
          end += size;
          found.lost += size;
        } else if (fault) refuse(fault, Uint8Array.from(frame), size);
        else take(Uint8Array.from(frame), size);
      }
      found.lost += read.left;
    }
    if (end < bytes.length) events.push({ event: "cut", at: end, end: bytes.length, ...begun(form, direction, bytes.subarray(end)) });
    return { events, lost: found.lost };
  }

  /** Adds the events where the length delimits; how many bytes belong to no message, and where what is undecided begins. */
  function byLength(form, packets, bytes, events) {
    let lost = 0;
    for (let at = 0; at < bytes.length; ) {
      const left = bytes.length - at;
      const packet = packets.find((one) => !differs(one, bytes.subarray(at, at + one.header), left));
      if (!packet) {
        lost += 1;
        at += 1;
        continue;
      }
      const front = bytes.subarray(at, at + packet.header);
      if (left < packet.header) return [lost + left, at];
      const data = dataOf(form, packet, front);
      const size = packet.header + data + packet.trailer;
      if (data === undefined || data < 0 || size > form.longest) {
        events.push({ event: data === undefined ? "unknown_id" : "length", id: idOf(packet, front, 0), at, end: at + 1, frame: front });
        lost += 1;
        at += 1;
        continue;
      }
      if (left < size) return [lost + left, at];
      const one = judge(form, packet, bytes.slice(at, at + size));
      events.push({ ...one, at, end: at + size, frame: bytes.slice(at, at + size) });
      const used = one.is === "doubtful" ? 1 : size;
      if (one.is !== "message") lost += used;
      at += used;
    }
    return [lost, bytes.length];
  }

  /** Bytes of the data behind a header: of its length field, else those of the message; undefined for the id of no message. */
  function dataOf(form, packet, front) {
    const [length] = packet.lengths;
    if (length) return bytesSaid(length, get(packet, length, front, 0));
    if (!packet.tellsMessage) return packet.sizes[1];
    if (packet.content === "request") return packet.reserved;
    const row = rowOf(packet, idOf(packet, front, 0));
    return row && boundsOf(form, packet, row)[1];
  }

  /**
   * `{ frames, left, open }` between delimiters: what stood there, of so many bytes, and its fault; `left` bytes follow, which are
   * the beginning `open` of a frame. The fault `noise` is that of bytes in no frame.
   */
  function unstuffed(form, bytes) {
    if (form.escaping) return unescaped(form, bytes);
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
    return { frames: found, left: now.size, open: now.frame };
  }

  /** Whether a byte after the escape byte begins a packet. */
  function isStart({ escape, start, end, data }, byte) {
    return start === undefined ? ![escape, end, data].includes(byte) : byte === start;
  }

  function unescaped(form, bytes) {
    const { escape, start, end, data, ignores_other: ignoresOther } = form.escaping;
    const found = [];
    const outside = () => ({ frame: [], size: 0, fault: null, inside: false });
    let [now, escaped] = [outside(), false];
    const noise = (size) => found.push({ frame: [], size, fault: "noise" });
    function put(byte) {
      if (now.fault) return;
      if (now.frame.length === form.longest) now.fault = "overrun";
      else now.frame.push(byte);
    }
    for (const byte of bytes) {
      now.size += 1;
      if (!escaped && byte === escape) {
        escaped = true;
      } else if (!escaped && now.inside) {
        put(byte);
      } else if (!escaped) {
        noise(1);
        now = outside();
      } else if (isStart(form.escaping, byte)) {
        if (now.inside) found.push({ ...now, size: now.size - 2, fault: now.fault ?? "framing" });
        [now, escaped] = [{ ...outside(), size: 2, inside: true }, false];
        if (start === undefined) put(byte);
      } else if (!now.inside) {
        escaped = byte === escape;
        noise(escaped ? 1 : 2);
        now = { ...outside(), size: escaped ? 1 : 0 };
      } else {
        escaped = false;
        if (byte === end) {
          found.push(now);
          now = outside();
        } else if (byte === data) {
          put(escape);
        } else if (!ignoresOther) {
          now.fault ??= "framing";
          escaped = byte === escape;
        }
      }
    }
    return { frames: found, left: now.size, open: now.frame };
  }

  /** Whether each packet shows that it is one, by a constant or a checksum. */
  const isMarked = (form) => form.packets.every((packet) => packet.check || fieldOf(packet, "constant"));

  const chosen = (values) => Object.entries(values).map(([role, value]) => `${role} ${value}`).join(", ");

  /** What is said of a message whose header and trailer were removed. */
  function removed(form, { id, values }) {
    return `header with id ${idText(form, id)} removed${chosen(values) ? `; it has ${chosen(values)}` : ""}`;
  }

  /** What is said of the bytes around the messages. */
  const around = (lost) => (lost ? [`${lost} byte${lost === 1 ? "" : "s"} around the frame belong to none`] : []);

  // Packets without a message

  /** The number at a place; bytes that are not there are 0. */
  function numberAt([at, size, shift, bits, little], bytes) {
    const field = { at, size, shift, bits, little };
    return get({}, field, Uint8Array.from({ length: at + size }, (_, place) => bytes[place] ?? 0), 0);
  }

  /**
   * `{ what, reason, about }` of a packet without a message: `acknowledge` or `refusal`, the name of the reason of a refusal, and
   * `[direction, id]` of the message of its id; without one, of any message. Null if nothing is answered with the packet.
   */
  function statement(form, { packet, id, frame }) {
    const responses = (form.responses ?? []).filter((one) => one.packet === packet);
    const directions = ["telemetry", "telecommand"];
    const declared = directions.map((direction) => [direction, responses.find((one) => one.about[direction]?.includes(id))]);
    const other = directions.find((direction) => form[direction].some(([one]) => one === id));
    const [direction, response] = declared.find(([, one]) => one) ?? [other, responses[0]];
    if (!response) return null;
    const meaning = response.status && response.meanings.find(([value]) => value === numberAt(response.status, frame));
    const what = ["ack", "progress"].includes(meaning ? meaning[1] : response.verdict) ? "acknowledge" : "refusal";
    const code = what === "refusal" && response.reason ? numberAt(response.reason, frame) : undefined;
    const reason = code === undefined ? "" : response.names.find(([value]) => value === code)?.[1] ?? String(code);
    return { what, reason, about: direction && [direction, id] };
  }

  // Packets that cannot be decoded

  const count = (number) => `${number} byte${number === 1 ? "" : "s"}`;
  const isDelimitedAhead = (form) => ["slip", "hdlc", "escape"].includes(form.delimited_by);

  /** The delimiter in front of packets. */
  function opening({ escaping, delimited_by: by }) {
    return escaping ? [escaping.escape, ...(escaping.start === undefined ? [] : [escaping.start])] : [ENDS[by][0]];
  }

  /** What is said of the missing end of a packet; nothing without a delimiter. */
  function closingText({ escaping, delimited_by: by }) {
    if (escaping) return `the bytes ${frames.hex([escaping.escape, escaping.end])} that end it are missing`;
    return ENDS[by] ? `the byte ${frames.hex([ENDS[by][0]])} that ends it is missing` : "";
  }

  const ahead = (packet) => packet.constants.filter(({ field }) => !field.in_trailer);
  const syncBits = (packet) => ahead(packet).reduce((bits, { field }) => bits + field.bits, 0);
  const BITS_OF_SYNC = 8; // constants of fewer bits are in any data

  /** Whether packets of a direction begin with bytes by which they are recognized. */
  const hasSync = (form, direction) => isDelimitedAhead(form) || packetsOf(form, direction).every((packet) => syncBits(packet) >= BITS_OF_SYNC);

  /** Whether bytes begin as packets of a direction do: with the delimiter, or with the constants of the header. */
  function begins(form, direction, bytes) {
    if (isDelimitedAhead(form) && !opening(form).every((byte, at) => bytes[at] === byte)) return false;
    if (form.escaping) return bytes.length === 1 || isStart(form.escaping, bytes[1]);
    if (isDelimitedAhead(form)) return true;
    return bytes.length > 0 && packetsOf(form, direction).some((packet) => syncBits(packet) >= BITS_OF_SYNC && bitsOfConstants(packet, bytes) > 0);
  }

  /** `A5 5A`: bytes that the packets of a direction begin with; none for those whose first byte is not constant. */
  function syncTexts(form, direction) {
    if (isDelimitedAhead(form)) return [frames.hex(opening(form))];
    return packetsOf(form, direction).map(syncText).filter(Boolean);
  }

  function syncText(packet) {
    const constants = new Map(ahead(packet).map((one) => [one.field.at, one]));
    const found = [];
    for (let one = constants.get(0); one && one.field.bits === 8 * one.field.size; one = constants.get(found.length)) {
      found.push(...bytesOf(one.value, one.field.size, one.field.little));
    }
    return frames.hex(found);
  }

  /** Bits of the header's constants that the bytes have; -1 if one has another value. A field may be cut off. */
  function bitsOfConstants(packet, bytes) {
    let found = 0;
    for (const { field, value } of ahead(packet)) {
      const mask = bytesOf((2 ** field.bits - 1) * 2 ** field.shift, field.size, field.little);
      const right = bytesOf(value * 2 ** field.shift, field.size, field.little);
      const came = bytes.subarray(field.at, field.at + field.size);
      if (came.some((byte, at) => (byte ^ right[at]) & mask[at])) return -1;
      for (let at = 0; at < came.length; at += 1) found += mask[at].toString(2).replaceAll("0", "").length;
    }
    return found;
  }

  /** Bytes of the packet as its header says; undefined if it does not, or has not come. */
  function sizeOf(form, packet, bytes) {
    if (bytes.length < packet.header || (!packet.lengths.length && form.delimited_by !== "length")) return undefined;
    const data = dataOf(form, packet, bytes);
    return data === undefined ? undefined : packet.header + data + packet.trailer;
  }

  /** The packet that bytes begin with, without stuffing, and whether its end came. */
  function begun(form, direction, bytes) {
    if (form.delimited_by === "datagram") return { frame: bytes, whole: true };
    if (form.delimited_by === "length") {
      const packet = packetsOf(form, direction).find((one) => bitsOfConstants(one, bytes) >= 0);
      const needed = packet && sizeOf(form, packet, bytes);
      return { frame: bytes.slice(0, needed < 0 ? 0 : needed), whole: needed !== undefined && bytes.length >= needed };
    }
    const read = unstuffed(form, bytes);
    const first = read.frames.find(({ fault }) => fault !== "noise");
    if (first) return { frame: Uint8Array.from(first.frame), whole: !first.fault };
    return { frame: Uint8Array.from(read.open), whole: false };
  }

  /**
   * Why bytes without stuffing are no packet of a direction, for the format whose header fits best:
   * `{ rank, text, isOfMessage, isCertain }`; null if they are not even the beginning of one. `namesOf` gives the messages of a
   * direction and an id.
   */
  function faultOf(form, direction, bytes, isWhole, title, namesOf) {
    const every = packetsOf(form, direction).map((packet) => faultIn(form, direction, packet, bytes, isWhole, title, namesOf));
    return likeliest(every.filter(Boolean));
  }

  function faultIn(form, direction, packet, bytes, isWhole, title, namesOf) {
    const bits = bitsOfConstants(packet, bytes);
    if (bits < 0) return null;
    const parts = packet.fields.filter(({ role }) => role === "id");
    const hasCome = (field) => field.at + field.size <= bytes.length && (!field.in_trailer || (isWhole && bytes.length >= packet.trailer));
    const id = parts.length && parts.every(hasCome) ? idOf(packet, bytes, bytes.length) : undefined;
    const row = parts.length && id === undefined ? undefined : rowOf(packet, id);
    const names = row ? namesOf(isRequested(packet, row) ? "telemetry" : direction, row[0]) : [];
    let told = !packet.tellsMessage ? `packet ${packet.name} of ${title}` : `packet of ${title}`;
    if (names.length) {
      const which = `(${isRequested(packet, row) ? "telemetry" : direction} ${idText(form, row[0])})`;
      told += `, ${isRequested(packet, row) ? "request of " : ""}${names.join(" or ")} ${which}`;
    } else if (id !== undefined) told += ` with the id ${idText(form, id)}`;
    const needed = sizeOf(form, packet, bytes);
    const data = needed === undefined ? undefined : needed - packet.header - packet.trailer;
    const fault = (rank, text, isCertain = false) => ({ rank: bits + (row ? 100 : 0) + rank, text: `a ${told} ${text}`, isOfMessage: Boolean(row), isCertain });
    if (data < 0 || needed > form.longest) return fault(0, `says that it has ${count(needed)}; packets have up to ${form.longest}`);
    const [least, most] = boundsOf(form, packet, row);
    const isCertain = Boolean(row) && (packet.lengths.length && data !== undefined ? least <= data && data <= most : isDelimitedAhead(form));
    const isNone = packet.tellsMessage && !row && (id !== undefined || !parts.length);
    const whole = { row, needed, isCertain, fault, namesOf, id, isNone };
    // Without a length field, only the message of the id says where the packet ends.
    if (form.delimited_by === "length" && !packet.lengths.length && isNone) return noMessage(form, direction, packet, bytes, whole);
    if (!isWhole || needed > bytes.length) {
      let wanted = needed === undefined ? `its header has ${packet.header}` : `${needed} are needed`;
      if (needed === undefined && bytes.length >= packet.header) wanted = closingText(form) || wanted;
      return fault(0, `is cut off: ${count(bytes.length)} came, ${wanted}`, isCertain);
    }
    return wholeFault(form, direction, packet, bytes, whole);
  }

  /** Of a packet whose end came. */
  function wholeFault(form, direction, packet, bytes, whole) {
    const { row, needed, isCertain, fault, isNone } = whole;
    const size = bytes.length - packet.header - packet.trailer;
    const read = (field) => get(packet, field, bytes, bytes.length);
    if (size < 0) return fault(0, `is cut off: ${count(bytes.length)} came, header and trailer have ${packet.header + packet.trailer}`);
    if (needed !== undefined && needed !== bytes.length) return fault(0, `has ${count(bytes.length)}, its length says ${needed}`);
    const end = packet.constants.find(({ field, value }) => field.in_trailer && read(field) !== value);
    if (end) return fault(0, `ends with ${valueText(end.field, read(end.field))}, expected ${valueText(end.field, end.value)}`);
    const place = fieldOf(packet, "checksum");
    if (place && packet.check && (row || !packet.check.seeded || !packet.tellsMessage)) {
      const right = checksum(packet, row, bytes);
      if (read(place) !== right) return fault(200, `has a wrong checksum: it is ${valueText(place, read(place))}, expected ${valueText(place, right)}`, isCertain);
    }
    if (isNone) return noMessage(form, direction, packet, bytes, whole);
    if (packet.content === "none" && size === packet.reserved) return unrelated(form, packet, bytes, whole);
    const [least, most] = boundsOf(form, packet, row);
    if (size < least || size > most) {
      return fault(300, `has ${count(size)} of data, the ICD says ${least === most ? least : `${least} to ${most}`}`, true);
    }
    if (!awaits(packet, row, read)) return fault(300, `asks for another number of bytes than the ${row[2]} of the ICD`);
    return fault(300, "has data that are not those of the message, by length and constants");
  }

  /** Of a packet with an id that no message of the direction has in it. */
  function noMessage(form, direction, packet, bytes, { fault, namesOf, id }) {
    const other = DIRECTIONS[1 - sideOf(direction)];
    const names = id !== undefined && form[other].some(([one]) => one === id) ? namesOf(other, id) : [];
    const none = names.length ? `no ${direction} with this id, but ${other} ${names.join(" or ")}` : "no message with this id";
    const size = bytes.length - packet.header - packet.trailer;
    const data = size < 0 || (form.delimited_by === "length" && !packet.lengths.length) ? "" : `and ${count(size)} of data `;
    return fault(300, `${data}is no message: it has ${none}`);
  }

  /** Of a packet without a message that responds to no message of the ICD. */
  function unrelated(form, packet, bytes, { fault }) {
    const { what, reason } = statement(form, { packet: packet.number, frame: bytes }) ?? { what: "response", reason: "" };
    const absence = packet.fields.some(({ role }) => role === "id") ? "no message has this id" : "without an id, it names no message";
    return fault(300, `is a ${what}${reason ? `, reason ${reason}` : ""}: ${absence}`);
  }

  /** A checksum as its bytes are sent; where they are shared with other fields, as a number. */
  function valueText(field, value) {
    if (field.shift || field.bits !== 8 * field.size) return `0x${value.toString(16).toUpperCase()}`;
    return frames.hex(bytesOf(value, field.size, field.little));
  }

  /** The fault of bytes that begin as a packet does; null if they do not. */
  function faultOfBeginning(form, bytes, title, namesOf) {
    const every = DIRECTIONS.filter((one) => begins(form, one, bytes)).map((one) => {
      const { frame, whole } = begun(form, one, bytes);
      return faultOf(form, one, frame, whole, title, namesOf);
    });
    return likeliest(every.filter(Boolean));
  }

  /** Of several explanations the one by which most of the header fits. */
  const likeliest = (every) => every.reduce((best, one) => (best && best.rank >= one.rank ? best : one), null);

  /** The directions in which a link has packets. */
  const directionsOf = (form) => DIRECTIONS.filter((direction) => packetsOf(form, direction).length);

  return { DIRECTIONS, directionsOf, decode, isMarked, removed, around, statement, hasSync, syncTexts, faultOf, faultOfBeginning, likeliest, idText };
})(typeof icdgenFrames === "undefined" ? require("./frames.js") : icdgenFrames);
if (typeof module !== "undefined") module.exports = icdgenFramed;
