"use strict";
/* CAN packets -> the messages that they carry, whatever the order in which the packets of a long one come. */
const icdgenPackets = (() => {
  const WITH_DATA = ["telecommand", "reply"];
  const partOf = (can, name, id) => Math.floor(id / 2 ** can.parts[name][0]) % 2 ** can.parts[name][1];
  const kindOf = (types, number) => Object.keys(types).find((kind) => types[kind] === number);

  /** Messages as `{ kind, id, source, destination, data, time }`, of several packets the time of the last; `open` are begun and not complete, `odd` counts what is none. */
  function join(speaker, packets, lengthOf) {
    const { can } = speaker;
    const [messages, open] = [[], []];
    let odd = 0;
    for (const { id, data, time } of packets) {
      const [type, channel, source, destination] = ["type", "channel", "source", "destination"].map((name) => partOf(can, name, id));
      const kind = kindOf(can.types, type);
      const long = kindOf(can.extended_types, type);
      if (kind) {
        if (data.length > (WITH_DATA.includes(kind) ? can.data_bytes : 0)) odd += 1;
        else messages.push({ kind, id: channel, source, destination, data, time });
      } else if (long && can.extended) {
        const done = extended(can, open, { key: [type, channel, source, destination].join(), kind: long, id: channel, source, destination }, data, lengthOf);
        if (done === null) odd += 1;
        else if (done) messages.push({ ...done, time });
      } else {
        odd += 1;
      }
    }
    return { messages, open, odd };
  }

  /** The message that the packet completes; null if it can be part of none. */
  function extended(can, open, told, data, lengthOf) {
    const [bytes, at, last] = can.extended;
    if (data.length !== at + 1) return null;
    const left = data[at] - last;
    const known = lengthOf(told.kind, told.id);
    const length = known > can.data_bytes ? known : undefined;
    let joining = open.find((one) => one.key === told.key);
    let count = left + 1;
    if (length !== undefined) count = Math.ceil(length / bytes);
    else if (joining && left < joining.count) ({ count } = joining);
    if (left < 0 || left >= count) return null;
    if (!joining) open.push((joining = { ...told, count, pieces: new Map() }));
    joining.pieces.set(count - 1 - left, data.slice(0, bytes));
    if (joining.pieces.size < joining.count) return undefined;
    open.splice(open.indexOf(joining), 1);
    const all = Array.from({ length: joining.count }, (_, number) => [...joining.pieces.get(number)]).flat();
    return { ...told, data: Uint8Array.from(all.slice(0, length ?? all.length)) };
  }

  /** The packets of a message, in the order in which they are sent. */
  function split(can, kind, id, source, destination, data) {
    const identifier = (type) =>
      Object.entries({ type, channel: id, source, destination }).reduce((sum, [name, value]) => sum + value * 2 ** can.parts[name][0], 0);
    if (data.length <= (WITH_DATA.includes(kind) ? can.data_bytes : 0)) return [{ id: identifier(can.types[kind]), data: [...data] }];
    if (!can.extended || can.extended_types[kind] === undefined) return [];
    const [bytes, at, last, fill, most] = can.extended;
    const count = Math.ceil(data.length / bytes);
    if (data.length > most) return [];
    return Array.from({ length: count }, (_, number) => {
      const piece = [...data.slice(number * bytes, (number + 1) * bytes)];
      while (piece.length < Math.max(bytes, at)) piece.push(fill);
      return { id: identifier(can.extended_types[kind]), data: [...piece, last + count - 1 - number] };
    });
  }

  /** An identifier with as many digits as tools print. */
  /** The id of a CAN frame in a node whose ids have so many bits, as `wire_ids.of_can`; null if it has no such frames. */
  function idOf(id, extended, bits) {
    if (bits === 32) return extended ? id + 2 ** 31 : id;
    return bits === 11 && extended ? null : id;
  }

  const idText = (id, extended) => `0x${id.toString(16).toUpperCase().padStart(extended ? 8 : 3, "0")}`;

  return { join, split, partOf, idOf, idText };
})();
if (typeof module !== "undefined") module.exports = icdgenPackets;
