"use strict";
/* A stream of bytes with framing -> the messages in it, and what went wrong. */
const icdgenStream = (() => {
  /** `{ events: [{ event, message }], lost }`: `lost` bytes belong to no message, `open` of them are of one that has not ended. `framing` is escape, start, end and escaped. */
  function decode(speaker, bytes) {
    const [escape, start, end, doubled] = speaker.framing;
    const events = [];
    let buffer = [];
    let inside = false;
    let escaped = false;
    let run = 0; // bytes since the last decision
    let lost = 0;

    function begin() {
      lost += run - 2;
      [run, inside, escaped, buffer] = [2, true, false, []];
    }

    function outside(again) {
      lost += run - Number(again);
      [run, inside, escaped, buffer] = [Number(again), false, again, []];
    }

    for (const byte of bytes) {
      run += 1;
      if (!inside) {
        if (escaped && byte === start) begin();
        else outside(byte === escape);
      } else if (!escaped) {
        if (byte === escape && (buffer.length || !speaker.plain_id)) escaped = true;
        else buffer.push(byte);
      } else {
        escaped = false;
        if (byte === start) {
          events.push({ event: "unexpected start" });
          begin();
        } else if (byte === end) {
          events.push(buffer.length ? { event: "message", message: Uint8Array.from(buffer) } : { event: "empty" });
          if (buffer.length) run = 0;
          outside(false);
        } else if (byte === doubled) {
          buffer.push(escape);
        } else if (!speaker.ignores_other) {
          events.push({ event: "protocol error" });
          outside(byte === escape);
        }
      }
    }
    return { events, lost: lost + run, open: inside ? run : 0 };
  }

  /** `{ messages, remarks }` of the stream; null where no message begins. Throws an Error where what begins is none. */
  function messages(speaker, bytes) {
    const [escape, start] = speaker.framing;
    const begins = (at) => bytes[at] === escape && bytes[at + 1] === start;
    if (!bytes.some((_, at) => begins(at))) return null;
    const { events, lost, open } = decode(speaker, bytes);
    const found = events.filter((one) => one.event === "message").map((one) => one.message);
    if (!found.length && begins(0)) throw new Error(broken(events));
    if (!found.length) return null;
    const around = lost ? [`${lost} byte${lost === 1 ? "" : "s"} around the frame belong to none`] : [];
    const errors = events.filter((one) => one.event !== "message").map((one) => `the stream has an error: ${one.event}`);
    return { messages: found, remarks: around, errors: open > 1 ? [...errors, broken([])] : errors };
  }

  function broken(events) {
    if (events.some((one) => one.event === "protocol error")) return "the framing is broken: the escape byte is followed by neither itself nor an end of message";
    return events.length ? "the framing is empty" : "the framing begins, but the end of the message is missing";
  }

  /** Throws an Error for bytes that are a piece of a frame with framing: its first byte, or all but its beginning. */
  function refusePieces(talking, bytes) {
    for (const [escape, , end] of talking.filter((one) => one.framing).map((one) => one.framing)) {
      if (bytes.length === 1 && bytes[0] === escape) throw new Error(broken([]));
      if (bytes.length > 2 && bytes.at(-2) === escape && bytes.at(-1) === end) throw new Error("the framing ends, but the start of the message is missing");
    }
  }

  return { messages, refusePieces };
})();
if (typeof module !== "undefined") module.exports = icdgenStream;
