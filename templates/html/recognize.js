"use strict";
/*
 * What a frame is: node, message and direction are found, framing, ids and checksums come off, as `icdgen decode` does it.
 *
 * A reading is `{ what, message, node, title, url, id, data, checked, remarks, leftOut, time }`, `leftOut` being reports about other
 * packets of the input, `time` what candump printed or seconds of slcan, `what` telecommand, telemetry, request,
 * acknowledge, refusal, or configuration where nothing tells the direction. `message` is empty for a response without id.
 */
const icdgenRecognize = ((frames, pasted, stream, packets, framedPackets) => {
  const OF_CAN = { telecommand: "telecommand", acknowledge: "acknowledge", refusal: "refusal", request: "request", reply: "telemetry", request_refusal: "refusal" };
  const SENT = ["telecommand", "acknowledge", "refusal"];

  /** Several messages are equally likely: `readings`. */
  class Ambiguous extends Error {
    constructor(text, readings) {
      super(text);
      this.readings = readings;
    }
  }

  /** The readings of what was pasted. Throws an Error, or Ambiguous. */
  function recognize(index, text) {
    const lines = text.split(/\r\n|\r|\n/).filter((line) => line.trim());
    const apart = lineByLine(index, lines);
    if (apart.length && apart.every((one) => one.id !== null)) return apart;
    try {
      return readings(index, pasted.read(text));
    } catch (error) {
      if (apart.length) return apart;
      throw error;
    }
  }

  function lineByLine(index, lines) {
    if (lines.length < 2) return [];
    try {
      const found = lines.map((line) => pasted.read(line));
      if (found.some((one) => one.packets || one.form)) return [];
      return found.flatMap((one) => readings(index, one));
    } catch {
      return [];
    }
  }

  function readings(index, given) {
    const talking = index.speakers;
    let found;
    if (given.packets && talking.some((speaker) => speaker.can)) {
      found = onCan(index, talking.filter((speaker) => speaker.can), given.packets);
    } else {
      const data = given.packets ? Uint8Array.from(given.packets.flatMap((one) => [...one.data])) : given.data;
      found = framedMessages(index, talking, data);
      if (!found.length) found = framed(index, talking, data);
      if (!found.length) found = given.packets ? byIdentifier(index, talking, given.packets) : [bare(index, talking, data)];
    }
    return given.form ? found.map((one) => noted(one, `read as ${given.form}`)) : found;
  }

  // Framed links

  /** The messages, of the direction that leaves the least; none if there are none, or hardly by intent. */
  function framedMessages(index, talking, data) {
    const heard = talking.filter((one) => one.stream).flatMap((speaker) => framedPackets.directionsOf(speaker.stream).map((what) => heardOf(index, speaker, what, data)));
    const found = heard.filter((one) => one.read.length && (!one.lost || framedPackets.isMarked(one.speaker.stream)));
    if (!found.length) {
      const firsts = heard.filter((one) => framedPackets.isMarked(one.speaker.stream)).flatMap((one) => one.faults.slice(0, 1));
      const at = Math.min(...firsts.map((one) => one.at));
      const fault = framedPackets.likeliest(firsts.filter((one) => one.at === at));
      if (fault) throw new Error(fault.text);
      return [];
    }
    const least = Math.min(...found.map((one) => one.lost));
    const clean = found.filter((one) => one.lost === least);
    const most = Math.max(...clean.map((one) => one.read.length));
    const likeliest = clean.filter((one) => one.read.length === most);
    // Packets of the other direction at other places are no alternatives.
    const placesOf = (one) => JSON.stringify(one.read.map(({ span }) => span));
    const best = likeliest.filter((one) => one.speaker !== likeliest[0].speaker || placesOf(one) === placesOf(likeliest[0]));
    const requests = requestsOf(found);
    const choose = (span, candidates) => decided(asked(requests, span, candidates), "a packet");
    const chosen = Array.from({ length: most }, (_, at) => {
      const { span } = best[0].read[at];
      return [span, choose(span, best.flatMap((one) => one.read[at].candidates))];
    });
    let lost = least;
    const taken = new Uint8Array(data.length);
    const mark = ([at, end]) => taken.fill(1, at, end);
    const isFree = (at, end) => !taken.subarray(at, end).includes(1);
    chosen.forEach(([span]) => mark(span));
    // Packets of the other direction between them.
    for (const other of found.filter((one) => !best.includes(one) && best.some(({ speaker }) => speaker === one.speaker))) {
      for (const one of other.read) {
        if (!isFree(...one.span)) continue;
        mark(one.span);
        chosen.push([one.span, choose(one.span, one.candidates)]);
        lost -= one.span[1] - one.span[0];
      }
    }
    const left = leftOut(heard.filter(({ speaker }) => speaker === best[0].speaker), isFree);
    const [first, ...others] = chosen.sort(([a], [b]) => a[0] - b[0]).map(([, one]) => one);
    return [noted(without(first, ...left), ...framedPackets.around(lost)), ...others];
  }

  /** `[at, reading]` of the requests of telemetry, in order. */
  function requestsOf(heard) {
    const read = heard.flatMap((one) => one.read).flatMap(({ span, candidates }) => candidates.map((one) => [span[0], one]));
    return read.filter(([, { what }]) => what === "request").sort(([a], [b]) => a - b);
  }

  /** Of the messages that a packet can be those that the last request before it requests; all if it requests none of them. */
  function asked(requests, [begin], candidates) {
    const [, last] = requests.filter(([at]) => at < begin).at(-1) ?? [];
    const fitting = candidates.filter((one) => last && one.node === last.node && one.message === last.message);
    return fitting.length ? fitting : candidates;
  }

  /** Packets beside those that were read, each as the direction explains it whose header fits best. */
  function leftOut(heard, isFree) {
    const beside = heard.flatMap((one) => one.faults).filter(({ at, end }) => isFree(at, end));
    const likeliest = new Map();
    for (const one of beside) if (!(likeliest.get(one.at)?.rank >= one.rank)) likeliest.set(one.at, one);
    const found = [];
    let end = 0;
    for (const [place, fault] of [...likeliest].sort(([a], [b]) => a - b)) {
      if (place >= end) found.push(fault.text); // what seems to begin within a damaged packet is no packet of its own
      end = Math.max(end, fault.end);
    }
    return found;
  }

  const namesOf = (index, speaker) => (direction, id) =>
    numbersOf((direction === "telemetry" ? speaker.telemetry : speaker.telecommands)[id]).map((number) => index.messages[number][0]);

  /** What is wrong with bytes that begin as a packet of a link does; null if they do not. */
  function begunOf(index, talking, data) {
    const every = talking.filter((one) => one.stream).map((one) => framedPackets.faultOfBeginning(one.stream, data, one.title, namesOf(index, one)));
    return framedPackets.likeliest(every.filter(Boolean));
  }

  /** What one direction of a link makes of the bytes. */
  function heardOf(index, speaker, what, data) {
    const { events, lost: unused } = framedPackets.decode(speaker.stream, what, data);
    const [read, faults] = [[], []];
    let lost = unused;
    for (const one of events) {
      const candidates = one.is === "message" ? readingsOf(index, speaker, what, one) : [];
      if (candidates.length) {
        read.push({ candidates, span: [one.at, one.end] });
        continue;
      }
      if (one.is === "message") lost += one.end - one.at;
      const isWhole = one.event === "cut" ? one.whole : one.event !== "framing";
      const fault = framedPackets.faultOf(speaker.stream, what, one.frame, isWhole, speaker.title, namesOf(index, speaker));
      // Without a sync, noise is as likely as a packet.
      if (fault && (fault.isOfMessage || framedPackets.hasSync(speaker.stream, what))) faults.push({ ...fault, at: one.at, end: one.end });
    }
    return { speaker, lost, read, faults };
  }

  /** The readings of a packet of a link: none, one or, if only the request tells which telemetry it carries, several. */
  function readingsOf(index, speaker, what, event) {
    const { content, name } = speaker.stream.packets[event.packet];
    if (content !== "requested") return [readingOf(index, speaker, what, event)].filter(Boolean);
    const rows = speaker.stream.telemetry.filter(([, least, most, , packet]) => packet === event.packet && least <= event.data.length && event.data.length <= most);
    const found = rows.map(([id]) => readingOf(index, speaker, what, { ...event, event: "message", id })).filter(Boolean);
    return found.map((one) => ({ ...one, id: null, remarks: [`packet ${name}`] }));
  }

  /** The reading of a packet of a link; null for a message whose data are not those of the ICD. */
  function readingOf(index, speaker, what, event) {
    const form = speaker.stream;
    const checked = Boolean(form.packets[event.packet].check);
    if (event.event === "packet") return responseOf(index, speaker, event, checked);
    const note = framedPackets.removed(form, event);
    if (event.event === "request") {
      const [number] = numbersOf(speaker.telemetry[event.id]);
      return reading(index, speaker, "request", number, event.id, event.data, [note], checked);
    }
    const ids = what === "telemetry" ? speaker.telemetry : speaker.telecommands;
    const number = numberOf(index, ids[event.id], event.data);
    if (number === undefined || !fits(index, number, event.data)) return null;
    return reading(index, speaker, what, number, event.id, event.data, [note], checked);
  }

  /** The reading of a packet without a message: what it says about the message of its id; null if no message has the id. */
  function responseOf(index, speaker, event, checked) {
    const statement = framedPackets.statement(speaker.stream, event);
    if (!statement) return null;
    const { what, reason, about } = statement;
    const { name, fields } = speaker.stream.packets[event.packet];
    const remarks = [`packet ${name}`, ...(reason ? [`reason ${reason}`] : [])];
    if (!fields.some(({ role }) => role === "id")) {
      const url = `${speaker.protocol}#responses`;
      return { ...blank, what, message: "", node: speaker.node, title: speaker.title, url, id: null, checked, remarks, owner: speaker.node, key: `${what} ${url} ${reason}` };
    }
    if (!about) return null;
    const [direction, id] = about;
    const [number] = numbersOf((direction === "telemetry" ? speaker.telemetry : speaker.telecommands)[id]);
    return reading(index, speaker, what, number, event.id, new Uint8Array(), remarks, checked);
  }

  // UART

  function framed(index, talking, data) {
    const forms = new Map(talking.filter((one) => one.framing).map((one) => [JSON.stringify([one.framing, one.plain_id, one.ignores_other]), one]));
    for (const [form, first] of forms) {
      const read = stream.messages(first, data);
      if (!read) continue;
      const same = talking.filter((one) => JSON.stringify([one.framing, one.plain_id, one.ignores_other]) === form);
      const [found, wrong] = [[], []];
      for (const body of read.messages) {
        try {
          found.push(ofBody(index, same, body));
        } catch (error) {
          wrong.push(error);
        }
      }
      if (!found.length) throw wrong[0];
      return [noted(without(found[0], ...wrong.map((error) => error.message), ...read.errors), ...read.remarks), ...found.slice(1)];
    }
    return [];
  }

  function ofBody(index, talking, body) {
    const found = byId(index, talking, body);
    if (!found.length) throw whyNone(index, talking, body);
    const one = decided(found, `a frame with id ${body[0]}`);
    return { ...one, remarks: [`framing with id ${body[0]} removed`, ...one.remarks] };
  }

  // Without framing

  function bare(index, talking, data) {
    if (!data.length) throw new Error("there are no bytes");
    const fault = begunOf(index, talking, data);
    if (fault) throw new Error(fault.text);
    stream.refusePieces(talking, data);
    const plainly = talking.filter((one) => !one.stream);
    if (!plainly.length) throw noPacket(index, talking, data);
    return guessed(index, plainly, data);
  }

  /** Bytes without the framing that their node has: what they can be shows only if the message is named. */
  function noPacket(index, talking, data) {
    const syncs = talking.flatMap((one) => framedPackets.DIRECTIONS.flatMap((direction) => framedPackets.syncTexts(one.stream, direction)));
    const begin = [...new Set(syncs)].join(" or ");
    const nodes = talking.map((one) => one.title).join(", ");
    const text = `${data.length} byte${data.length === 1 ? " is" : "s are"} no packet of ${nodes}${begin ? `: packets begin with ${begin}` : ""}`;
    const candidates = eachOnce([...byId(index, talking, data), ...byLength(index, talking, data)]);
    return candidates.length ? new Ambiguous(`${text}; as data alone they can be of a message`, candidates) : new Error(text);
  }

  /** A message without framing, by its id or its length. */
  function guessed(index, talking, data) {
    const given = `${data.length} byte${data.length === 1 ? "" : "s"}`;
    const withId = byId(index, talking, data);
    const plain = byLength(index, talking, data);
    if (withId.length) {
      const one = decided(withId, `${given} beginning with the id ${withId[0].id}`);
      const others = plain.filter((other) => other.key !== one.key);
      return noted(one, `id ${one.id} removed`, ...(others.length ? [`without an id in front it could be ${named(others)}`] : []));
    }
    if (plain.length) return noted({ ...decided(plain, `${given} without an id`), id: null }, "found by its length alone");
    throw whyNone(index, talking, data);
  }

  function byId(index, talking, body) {
    return eachOnce(talking.flatMap((speaker) => [...ofSpeaker(index, speaker, body)]));
  }

  function byLength(index, talking, data) {
    const found = [];
    for (const speaker of talking) {
      for (const [what, ids] of directions(speaker)) {
        for (const id of Object.keys(ids)) {
          const number = numberOf(index, ids[id], data);
          const read = number === undefined ? null : withChecksum(index, speaker, what, Number(id), number, data);
          if (read) found.push(read);
        }
      }
    }
    return eachOnce(found);
  }

  const directions = (speaker) => [["telecommand", speaker.telecommands], ["telemetry", speaker.telemetry]];

  function* ofSpeaker(index, speaker, body) {
    const apart = takenApart(speaker, body);
    if (!apart) return;
    const [id] = apart;
    yield* withId(index, speaker, ...apart);
    const [size, idAt, errorAt, names] = speaker.acknowledge ?? [];
    if (body.length === size && speaker.telemetry[id] === undefined && speaker.telecommands[body[idAt]] !== undefined) {
      const error = body[errorAt];
      const told = `error ${error}${names[error] ? ` (${names[error]})` : ""}`;
      yield noted(reading(index, speaker, "acknowledge", speaker.telecommands[body[idAt]], body[idAt]), told);
    }
  }

  function* withId(index, speaker, id, data) {
    for (const [what, ids] of directions(speaker)) {
      const number = numberOf(index, ids[id], data);
      if (number === undefined) continue;
      const read = withChecksum(index, speaker, what, id, number, data);
      if (read) yield read;
      if (what === "telemetry" && !data.length && !fits(index, number, data)) yield reading(index, speaker, "request", number, id);
    }
  }

  /** The id that bytes begin with, and the rest; null if there are too few. */
  function takenApart(speaker, body) {
    const size = speaker.id_bytes;
    return body.length < size ? null : [body.slice(0, size).reduce((id, byte) => id * 256 + byte, 0), body.slice(size)];
  }

  const lengthOf = (index, number) => index.messages[number][2];

  /** The message of an id; of those that share it the one that the data are of, if there is one. */
  function numberOf(index, known, data) {
    if (!Array.isArray(known)) return known;
    return known.find(([number, signs]) => frames.isLike(lengthOf(index, number), index.messages[number][4], signs, data))?.[0];
  }

  const numbersOf = (known) => (Array.isArray(known) ? known.map(([number]) => number) : known === undefined ? [] : [known]);
  /** Whether a message can have these data: by their number, and by what they say of it where frames differ in length. */
  function fits(index, number, data) {
    const [length, tail] = [lengthOf(index, number), index.messages[number][4]];
    if (!tail) return data.length === length;
    const count = (data.length - tail.least) / tail.step;
    if (data.length < tail.least || data.length > length || !Number.isInteger(count)) return false;
    const told = tail.pieces.reduce((sum, [byte, shift, bits, at]) => sum + ((data[byte] >> shift) & ((1 << bits) - 1)) * 2 ** at, 0);
    return !tail.pieces.length || told === count + (tail.low ?? 0);
  }

  /** Bytes of a message, for people. */
  const lengthText = (index, number) => (index.messages[number][4] ? `${index.messages[number][4].least} to ` : "") + lengthOf(index, number);

  const blank = { data: new Uint8Array(), leftOut: [], time: "" };

  function reading(index, speaker, what, number, id, data = new Uint8Array(), remarks = [], checked = false) {
    const [message, url, , owner] = index.messages[number];
    return { ...blank, what, message, node: speaker.node, title: speaker.title, url, id, data, checked, remarks, owner, key: `${what} ${url}` };
  }

  /** The message, if the bytes are as many as it has, or the right checksum follows them. */
  function withChecksum(index, speaker, what, id, number, data) {
    const length = lengthOf(index, number);
    if (fits(index, number, data)) return reading(index, speaker, what, number, id, data);
    if (!frames.check(speaker.crc, length, id, data)?.fits) return null;
    return reading(index, speaker, what, number, id, data.slice(0, length), ["CRC is right"], true);
  }

  // CAN

  /** The message of each packet where the identifier is the id. */
  function byIdentifier(index, talking, given) {
    const [found, wrong] = [[], []];
    for (const packet of given) {
      try {
        found.push(ofIdentifier(index, talking, packet));
      } catch (error) {
        wrong.push(error);
      }
    }
    if (!found.length) throw wrong[0];
    const counts = new Map();
    for (const { message } of wrong) counts.set(message, (counts.get(message) ?? 0) + 1);
    const left = [...counts].map(([text, count]) => `${text} (${count} CAN packet${count > 1 ? "s" : ""})`);
    return [without(found[0], ...left), ...found.slice(1)];
  }

  function ofIdentifier(index, talking, { id, data, extended, time }) {
    const identifier = packets.idText(id, extended);
    const known = talking
      .map((speaker) => [speaker, packets.idOf(id, extended, speaker.id_bits)])
      .filter(([, own]) => own !== null);
    const found = eachOnce(known.flatMap(([speaker, own]) => [...withId(index, speaker, own, data)]));
    if (!found.length) throw whyNot(index, known.map(([speaker, own]) => [speaker, [own, data]]), `no message has the CAN identifier ${identifier}`);
    return noted({ ...decided(found, `a packet with the CAN identifier ${identifier}`), time }, `CAN identifier ${identifier} removed`);
  }

  function onCan(index, able, given) {
    if (!given.every((one) => one.extended)) throw new Error("a packet has an 11-bit identifier, those of the ICD have 29 bits");
    const found = able.map((speaker) => {
      const ids = (kind) => (SENT.includes(kind) ? speaker.telecommands : speaker.telemetry);
      const joined = packets.join(speaker, given, (kind, id) => index.messages[ids(kind)[id]]?.[2]);
      const known = joined.messages.filter(({ kind, id, data }) => {
        const number = ids(kind)[id];
        return number !== undefined && (!["telecommand", "reply"].includes(kind) || data.length === lengthOf(index, number));
      });
      const read = known.map(({ kind, id, source, destination, data, time }) => {
        const found = reading(index, speaker, OF_CAN[kind], ids(kind)[id], id, data, [`CAN, from address ${source} to ${destination}`]);
        return { ...found, time };
      });
      return { speaker, joined, read };
    });
    const most = Math.max(...found.map((one) => one.read.length));
    if (!most) throw whyNoCan(index, found[0], given);
    const complete = found.filter((one) => one.read.length === most);
    const chosen = Array.from({ length: most }, (_, at) => {
      const same = new Map(complete.map((one) => [one.read[at].key, one.read[at]]));
      for (const one of complete) if (one.speaker.node === one.read[at].owner) same.set(one.read[at].key, one.read[at]);
      return decided([...same.values()], `a CAN message with id ${complete[0].read[at].id}`);
    });
    const { messages, open, odd } = complete[0].joined;
    const left = messages.length + open.length + odd - most;
    return left ? [without(chosen[0], `${left} of the CAN messages are no message of the ICD, or not complete`), ...chosen.slice(1)] : chosen;
  }

  function whyNoCan(index, { speaker, joined }, given) {
    const [waiting] = joined.open;
    if (waiting && !joined.messages.length) {
      return new Error(`${waiting.count - waiting.pieces.size} of ${waiting.count} packets of the message with id ${waiting.id} are missing`);
    }
    const [told] = joined.messages;
    if (told) return whyNone(index, [speaker], Uint8Array.from([told.id, ...told.data]));
    return new Error(`the packet with identifier ${packets.idText(given[0].id, true)} is none of ${speaker.title}`);
  }

  // Choosing

  /** The most likely one: a right checksum is no accident, and who sends more than an acknowledge rarely looks like one. */
  function decided(found, of) {
    let likely = found.filter((one) => one.checked);
    if (!likely.length) likely = found.filter((one) => one.what !== "acknowledge");
    if (!likely.length) likely = found;
    if (likely.length > 1) throw new Ambiguous(`${of} can be several messages`, likely);
    const others = found.filter((one) => one.key !== likely[0].key);
    return others.length ? noted(likely[0], `it can also be ${named(others)}`) : likely[0];
  }

  /** Of the same reading by several nodes the one with a checksum, else that of the node that declares the message. */
  function eachOnce(found) {
    const best = new Map();
    const rank = (one) => 2 * Number(one.checked) + Number(one.node === one.owner);
    for (const one of found) if (!best.has(one.key) || rank(one) > rank(best.get(one.key))) best.set(one.key, one);
    return [...best.values()];
  }

  function whyNone(index, talking, body) {
    const apart = talking.map((speaker) => [speaker, takenApart(speaker, body)]).filter(([, both]) => both);
    if (!apart.length) return new Error("bytes are missing: not even the id is complete");
    const ids = new Set(apart.map(([, [id]]) => `${id} (0x${id.toString(16).toUpperCase().padStart(2, "0")})`));
    return whyNot(index, apart, `no message has the id ${[...ids].join(" or ")}`);
  }

  /** What is wrong with data of these ids; `unknown` if no message has them. */
  function whyNot(index, apart, unknown) {
    const known = new Map(
      apart.flatMap(([speaker, [id, data]]) =>
        directions(speaker).flatMap(([what, ids]) => numbersOf(ids[id]).map((number) => [`${what} ${number}`, { speaker, number, id, data }])),
      ),
    );
    if (!known.size) return new Error(unknown);
    for (const { speaker, number, id, data } of known.values()) {
      const right = frames.check(speaker.crc, lengthOf(index, number), id, data)?.right;
      if (right) return new Error(`${index.messages[number][0]}: as CRC ${frames.hex(right)} would be right, not ${frames.hex(data.slice(-right.length))}`);
    }
    const told = [...known.values()].map(({ number }) => `${index.messages[number][0]} has ${lengthText(index, number)} bytes`);
    const [{ id, data }] = known.values();
    if (known.size > 1 && [...known.values()].some(({ number }) => frames.isLike(lengthOf(index, number), index.messages[number][4], [], data))) {
      return new Error(`the ${data.length} bytes after the id ${id} have the constants of none of its messages`);
    }
    return new Error(`${told.join(" or ")}, ${data.length} given after the id ${id}`);
  }

  /** The same, with reports about other packets of the input, which cannot be decoded. */
  const without = (one, ...texts) => noted({ ...one, leftOut: [...one.leftOut, ...texts] }, ...texts.map((text) => `left out: ${text}`));
  const noted = (one, ...remarks) => ({ ...one, remarks: [...one.remarks, ...remarks] });
  /** The readings by name, the first few of them; one that has two directions once. */
  function named(found) {
    const every = [...new Set(found.map((one) => (one.what === "acknowledge" ? `an acknowledge of ${one.message}` : one.message || one.what)))];
    return every.slice(0, 3).join(", or ") + (every.length > 3 ? `, or one of ${every.length - 3} others` : "");
  }

  return { recognize, Ambiguous };
})(...(typeof icdgenFrames === "undefined" ? ["frames", "pasted", "stream", "packets", "framed"].map((name) => require(`./${name}.js`)) : [icdgenFrames, icdgenPasted, icdgenStream, icdgenPackets, icdgenFramed]));
if (typeof module !== "undefined") module.exports = icdgenRecognize;
