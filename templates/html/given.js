"use strict";
/* What was pasted on the page of a message -> its data: id, framing and checksum come off, as `icdgen decode NODE MESSAGE` does it. */
const icdgenGiven = ((frames, packets, pasted, stream, framedPackets) => {
  /** Data of the message in whatever was pasted, and remarks. Throws an Error where it cannot be this message. */
  function messageIn(wire, length, text) {
    const given = pasted.read(text);
    if (given.packets) return carried(wire, length, given.packets);
    const { data, remarks } = unwrap(wire, length, given.data);
    return { data, remarks: given.form ? [...remarks, `read as ${given.form}`] : remarks };
  }

  /** The data in bytes, and remarks about what was around it; bytes that do not fit as they are. Throws an Error, too. */
  function unwrap(wire, length, bytes) {
    const begun = wire.stream && framedPackets.faultOfBeginning(wire.stream, bytes, "this node", namesIn(wire));
    if (hasLength(wire, length, bytes)) {
      const sure = surelyFramed(wire, length, bytes);
      if (!sure && begun?.isCertain) throw new Error(begun.text);
      return sure ?? { data: bytes, remarks: begun ? [`the data begin like a packet: ${begun.text}`] : [] };
    }
    const taken = wire.stream && ofFramed(wire, length, bytes);
    if (taken) return taken;
    if (begun) throw new Error(begun.text);
    const read = wire.framing && stream.messages(wire, bytes);
    return read ? ofStream(wire, length, read) : bare(wire, length, bytes);
  }

  /** Whether bytes are as many as the message has; where frames differ, as some of them have. */
  function hasLength(wire, length, { length: given }) {
    const [least, step] = wire.lengths ?? [length, 1];
    return given >= least && given <= length && (given - least) % step === 0;
  }

  /** Where frames differ in length one in its packet can be as long as another without: a checksum tells. */
  function surelyFramed(wire, length, bytes) {
    if (!wire.lengths || !wire.stream || !isChecked(wire)) return null;
    try {
      return ofFramed(wire, length, bytes);
    } catch {
      return null;
    }
  }

  /** The first message of this kind in its packet; null if there is none. Throws an Error where one is damaged, another one's, or has no data. */
  function ofFramed(wire, length, bytes) {
    const form = wire.stream;
    const able = (what) => form[what].length || (what === "telecommand" && form.request?.ids.length);
    const heard = framedPackets.directionsOf(form).filter(able).map((what) => ({ what, ...framedPackets.decode(form, what, bytes) }));
    const isMine = (what, { event, id, data }) => event === "message" && idIn(wire, what) === id && hasLength(wire, length, data);
    const usable = heard.filter(({ what, events, lost }) => events.some((event) => isMine(what, event)) && (!lost || framedPackets.isMarked(form)));
    const best = usable.sort((one, other) => one.lost - other.lost)[0];
    if (best) {
      const [first, ...others] = best.events.filter((event) => isMine(best.what, event));
      const left = others.length ? [`${others.length} other frame${others.length === 1 ? "" : "s"} left out`] : [];
      return { data: first.data, remarks: [framedPackets.removed(form, first), ...left, ...framedPackets.around(best.lost)] };
    }
    if (!framedPackets.isMarked(form)) return null;
    const events = heard.flatMap(({ what, events: own }) => own.map((event) => ({ ...event, what })));
    const damaged = events.find(({ event }) => event === "checksum");
    if (damaged) {
      const faults = framedPackets.DIRECTIONS.map((what) => framedPackets.faultOf(form, what, damaged.frame, true, "this node", namesIn(wire)));
      throw new Error(framedPackets.likeliest(faults.filter(Boolean)).text);
    }
    const dataless = events.find(({ event }) => event === "request" || event === "packet");
    if (dataless) {
      const { name } = form.packets[dataless.packet];
      throw new Error(dataless.event === "request" ? "a request of this message, which carries no data" : `a packet ${name}, which carries no message`);
    }
    const other = events.find(({ event, is, id, what }) => (event === "message" ? id !== idIn(wire, what) : event === "unknown_id" && is === "proven"));
    if (other) throw new Error(`in a packet with id ${framedPackets.idText(form, other.id)}, which is another message's`);
    return null;
  }

  /** Whether the packets of the message have a checksum. */
  const isChecked = (wire) =>
    framedPackets.DIRECTIONS.every((what) => wire.stream[what].every(([id, , , , packet]) => id !== idIn(wire, what) || wire.stream.packets[packet].check));

  /** What a packet of an id of a direction is called: other messages are not known here. */
  const namesIn = (wire) => (direction, id) => (idIn(wire, direction) === id ? ["this message"] : []);

  /** The id of the message in a direction; null if it is not sent in it. */
  const idIn = (wire, direction) => (direction === "telemetry" ? wire.telemetry : wire.command ? wire.id : null);

  function ofStream(wire, length, { messages, remarks, errors }) {
    const mine = messages.filter(([id]) => wire.ids.includes(id));
    if (!mine.length) throw new Error(`framed with id ${messages[0][0]}, which is another message's`);
    const found = mine.map((body) => [body[0], body.slice(1)]).map(([id, data]) => ({ id, data, ...fitting(wire, length, id, data) }));
    const best = found.find((one) => one.fits) ?? found[0];
    if (!best.fits && length && !best.data.length) throw new Error(`framed with id ${best.id} alone: a request, which carries no data`);
    if (!best.fits) notChecked(wire, length, best.id, best.data);
    const left = messages.length - 1;
    const others = left ? [`${left} other frame${left === 1 ? "" : "s"} left out`] : [];
    return { data: best.fits ?? best.data, remarks: [`framing with id ${best.id} removed`, ...(best.remarks ?? []), ...others, ...remarks, ...errors] };
  }

  function bare(wire, length, bytes) {
    const size = wire.id_bytes || 1;
    const id = bytes.slice(0, size).reduce((sum, byte) => sum * 256 + byte, 0); // its most significant byte comes first
    const within = bytes.length >= size && wire.ids.includes(id) ? fitting(wire, length, id, bytes.slice(size)) : null;
    const plain = fitting(wire, length, wire.id, bytes);
    if (plain) return { data: plain.fits, remarks: plain.remarks };
    if (within) return { data: within.fits, remarks: [`id ${id} removed`, ...within.remarks] };
    notChecked(wire, length, wire.id, bytes);
    return { data: bytes, remarks: [] };
  }

  /** The data, if they are as many as the message has, or the right checksum follows them; else null. */
  function fitting(wire, length, id, data) {
    if (hasLength(wire, length, data)) return { fits: data, remarks: [] };
    const right = wire.crc.some((facts) => frames.check(facts, length, id, data)?.fits);
    return right ? { fits: data.slice(0, length), remarks: ["CRC is right"] } : null;
  }

  /** Throws an Error where a checksum follows the data, and is wrong. */
  function notChecked(wire, length, id, data) {
    const right = frames.check(wire.crc[0], length, id, data)?.right;
    if (!right) return;
    const many = right.length === 1 ? "one byte" : `${right.length} bytes`;
    throw new Error(`${many} too many: as CRC it would have to be ${frames.hex(right)}, not ${frames.hex(data.slice(length))}`);
  }

  /** The data of the message that CAN packets carry, and remarks. Throws an Error where they are of another one. */
  function carried(wire, length, given) {
    const { can } = wire;
    if (!can) return identified(wire, given);
    const idOf = (one) => packets.partOf(can, "channel", one.id);
    const mine = given.filter((one) => one.extended && wire.ids.includes(idOf(one)));
    if (!mine.length) throw new Error(`CAN packets of id ${idOf(given[0])}, which is another message's`);
    const { messages, open } = packets.join({ can }, mine, () => length);
    const found = messages.find((one) => ["telecommand", "reply"].includes(one.kind));
    if (found) return { data: found.data, remarks: [`data of CAN packets with id ${found.id}`, ...timed(found)] };
    if (open.length) throw new Error(`${open[0].count - open[0].pieces.size} of ${open[0].count} packets are missing`);
    throw new Error(`CAN packets with id ${idOf(mine[0])} that carry no data`);
  }

  /** The data of the first packet whose identifier is the id. Throws an Error if there is none. */
  function identified(wire, given) {
    const own = given.find((one) => wire.ids.includes(packets.idOf(one.id, one.extended, wire.id_bits)));
    const { id, extended } = own ?? given[0];
    const others = given.filter((one) => one !== own).length;
    const left = others ? [`${others} other CAN packet${others === 1 ? "" : "s"} left out`] : [];
    if (!own) throw new Error(`CAN identifier ${packets.idText(id, extended)}, which is not this message's`);
    return { data: own.data, remarks: [`CAN identifier ${packets.idText(id, extended)} removed`, ...timed(own), ...left] };
  }

  /** When a packet was received, as candump printed it. */
  const timed = ({ time }) => (time ? [`time ${time}`] : []);

  return { unwrap, messageIn };
})(...(typeof icdgenFrames === "undefined" ? ["frames", "packets", "pasted", "stream", "framed"].map((name) => require(`./${name}.js`)) : [icdgenFrames, icdgenPackets, icdgenPasted, icdgenStream, icdgenFramed]));
if (typeof module !== "undefined") module.exports = icdgenGiven;
