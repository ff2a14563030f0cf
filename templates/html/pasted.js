"use strict";
/* What a person copied -> bytes or CAN packets: the same spellings as `icdgen decode` takes. */
const icdgenPasted = ((frames) => {
  const BEFORE = /^(?:\((?<time>[\d.:\s-]+)\)\s*)?(?:[A-Za-z]+\d+\s+)?(?:[TR]X\s[-BEP ]*)?/.source;
  const ID = "(?<id>[0-9A-Fa-f]{8}|[0-9A-Fa-f]{3})";
  const PACKETS = [
    new RegExp(`${BEFORE}${ID}\\s*\\[(?<size>\\d{1,2})\\]\\s*(?<data>(?:[0-9A-Fa-f]{2}(?:\\s+|$))*|remote request)(?:'.*)?$`),
    new RegExp(`${BEFORE}${ID}#(?:#[0-9A-Fa-f])?(?<data>(?:[0-9A-Fa-f]{2}\\.?)*|R[0-8]?)(?:\\s+[TR])?$`),
    /^(?<slcan>[TR])(?<id>[0-9A-Fa-f]{8})(?<size>[0-8])(?<data>(?:[0-9A-Fa-f]{2})*)$/,
    /^(?<slcan>[tr])(?<id>[0-9A-Fa-f]{3})(?<size>[0-8])(?<data>(?:[0-9A-Fa-f]{2})*)$/,
  ];
  const STAMP = 2; // bytes of the time that an slcan adapter may append: milliseconds of the minute
  const DUMPED =
    /^(?:0x)?(?<at>[0-9A-Fa-f]{4,8})(?<mark>:?)(?<space>\s*)(?<data>(?:[0-9A-Fa-f]{2}){0,4}(?:\s{1,2}(?:[0-9A-Fa-f]{2}){1,4}(?=\s|$))*)(?<text>\s*\|.*\|?|\s{2,}.*)?$/;
  const WORDS = 7; // digits of an address of hexdump and od
  const COMMENT = /\/\*[^]*?\*\/|\/\/[^\n]*/g;
  const LIST = /[[{(]([^[\]{}()]*)[\]})][)\]}\s;]*$/;
  const NUMBER = /^(0[xX][0-9A-Fa-f]+|\d+)(?:[uU]8?)?$/;
  const LITERAL = /^(?:bytearray\()?b(["'])((?:\\[^]|(?!\1)[^\\])*\\(?:\\[^]|(?!\1)[^\\]|[^])*)\1\)?$/;
  const STRING = /(["'])([0-9A-Fa-f\s]+)\1/g;
  const ESCAPED = { n: 10, r: 13, t: 9, 0: 0, a: 7, b: 8, f: 12, v: 11, "\\": 92, "'": 39, '"': 34 };
  const BASE64 = /^(?:[A-Za-z0-9+/_-]{4})*(?:[A-Za-z0-9+/_-]{2}==|[A-Za-z0-9+/_-]{3}=)?$/;
  const MARKED = /(["'])(0[xX][0-9A-Fa-f]{1,2}|[0-9A-Fa-f]{2})\1|<([0-9A-Fa-f]{2})>|\b([0-9A-Fa-f]{2})[hH]\b/g;
  const DECIMALS = /^[0-9]{1,3}(?:[\s,;]+[0-9]{1,3})+$/;
  const LABEL =
    /^[ \t]*(?:\[[^\]\n]*\][ \t]*)?(?:(?:\d{4}-\d\d-\d\d[T ])?\d+:\d\d[\d:.,]*[ \t]+)?(?:(?:[rRtT][xX]|recv|sent|send|frame)[ \t]*[:>]?|<+|>+|<-|->)[ \t]+|^[ \t]*\d{4}-\d\d-\d\d[T ]\d+:\d\d[\d:.,]*[ \t]+/gm;
  // Date and time at the beginning of a line, before the data.
  const DATE_LABEL = /^[ \t]*\d{4}-\d\d-\d\d[T ]\d+:\d\d[\d:.,]*[ \t]+/m;

  const digits = (text) => Uint8Array.from(text.match(/[0-9A-Fa-f]{2}/g) ?? [], (pair) => parseInt(pair, 16));
  const linesOf = (text) => text.split(/\r\n|\r|\n/).map((line) => line.trim()).filter(Boolean);

  /** What was pasted: `{ data, form }`, or `{ packets }`. Throws an Error for what is no bytes at all. */
  function read(text) {
    const lines = packetsOf(text);
    if (lines) return { packets: lines };
    const dumped = dump(text);
    if (dumped) return { data: dumped, form: "a dump with addresses" };
    const literal = LITERAL.exec(text.trim());
    const unescaped = literal && unescape(literal[2]);
    if (unescaped) return { data: unescaped, form: "" };
    // Without a fraction of a second, date and time are pairs of hexadecimal digits too.
    const dated = DATE_LABEL.test(text) ? labelled(text) : null;
    if (dated) return dated;
    try {
      return { data: frames.parseHex(text), form: "" };
    } catch (error) {
      const other = ofCode(text.replace(COMMENT, " ")) ?? labelled(text) ?? marked(text) ?? decimal(text) ?? base64(text);
      if (!other) throw error;
      return other;
    }
  }

  function packetsOf(text) {
    const lines = linesOf(text);
    const found = lines.map(packet).filter(Boolean);
    return found.length && found.length === lines.length ? found : null;
  }

  function packet(line) {
    const groups = PACKETS.map((form) => form.exec(line)).find(Boolean)?.groups;
    if (!groups) return null;
    const data = /^r/i.test(groups.data) ? new Uint8Array() : digits(groups.data.replaceAll(".", ""));
    const isRemote = groups.data === "remote request" || /^r/i.test(groups.slcan ?? "");
    const size = isRemote ? 0 : Number(groups.size ?? data.length);
    if (data.length !== size && !(groups.slcan && data.length === size + STAMP)) return null;
    const time = data.length > size ? ((data[size] * 256 + data[size + 1]) / 1000).toFixed(3) : (groups.time ?? "").trim();
    return { id: parseInt(groups.id, 16), data: data.slice(0, size), extended: groups.id.length === 8, time };
  }

  function dump(text) {
    const lines = linesOf(text);
    const rows = lines.map(row).filter(Boolean);
    if (!rows.length || rows.length !== lines.length || !(rows.length > 1 || rows.every((one) => one.sure))) return null;
    const counts = [16, 8].some((base) =>
      rows.every((one, number) => {
        if (base === 8 && /[89A-Fa-f]/.test(one.at)) return false;
        const next = rows[number + 1];
        return !next || parseInt(next.at, base) - parseInt(one.at, base) === one.data.length;
      }),
    );
    return counts ? Uint8Array.from(rows.flatMap((one) => [...one.data])) : null;
  }

  function row(line) {
    const groups = DUMPED.exec(line)?.groups;
    if (!groups || (groups.data && !groups.space)) return null;
    const words = groups.data.split(/\s+/).filter(Boolean);
    const swapped = groups.at.length === WORDS && !groups.mark && words.every((word) => word.length === 4);
    const data = words.flatMap((word) => (swapped ? [...digits(word)].reverse() : [...digits(word)]));
    const sure = Boolean(groups.mark) || groups.at.length === WORDS || groups.space.length > 1;
    return { at: groups.at, data, sure: sure || (groups.text ?? "").trim().startsWith("|") };
  }

  function unescape(text) {
    const found = Array.from(text.matchAll(/\\(x[0-9A-Fa-f]{2}|[^])|([^\\])/gu), ([, escape, plain]) => {
      if (plain) return plain.codePointAt(0);
      return escape.length > 1 && escape[0] === "x" ? parseInt(escape.slice(1), 16) : (ESCAPED[escape] ?? 256);
    });
    return found.every((value) => value < 256) ? Uint8Array.from(found) : null;
  }

  /** An array or a string of a program: what stands in its brackets or quotes. */
  function ofCode(text) {
    const strings = [...text.matchAll(STRING)];
    if (strings.length === 1) return hexadecimal(strings[0][2]);
    const listed = LIST.exec(text.trim());
    if (!listed) return null;
    const words = listed[1].replace(/,\s*$/, "").split(",").map((word) => NUMBER.exec(word.trim())?.[1]);
    if (!words.every(Boolean)) return null;
    const values = words.map((word) => (/^0x/i.test(word) ? parseInt(word, 16) : parseInt(word, 10)));
    if (values.some((value) => value > 255)) return null;
    const decimal = values.some((value, number) => value > 9 && !/^0x/i.test(words[number]));
    return { data: Uint8Array.from(values), form: decimal ? "decimal numbers" : "" };
  }

  function labelled(text) {
    const bare = text.replace(LABEL, "");
    return bare === text ? null : hexadecimal(bare);
  }

  /** Each byte in quotes or angles, or followed by `h`. */
  function marked(text) {
    const bare = text.replace(MARKED, (whole, quote, quoted, angled, ended) => ` ${quoted ?? angled ?? ended} `);
    return bare === text ? null : hexadecimal(bare);
  }

  function decimal(text) {
    const values = DECIMALS.test(text.trim()) ? text.match(/[0-9]+/g).map(Number) : [];
    return values.length && Math.max(...values) < 256 ? { data: Uint8Array.from(values), form: "decimal numbers" } : null;
  }

  function base64(text) {
    const joined = text.replace(/\s+/g, "");
    const word = joined.length < 8 || joined === joined.toLowerCase() || joined === joined.toUpperCase();
    if (!BASE64.test(joined) || (word && !joined.endsWith("="))) return null;
    const plain = /[-_]/.test(joined) ? joined.replaceAll("-", "+").replaceAll("_", "/") : joined;
    return { data: Uint8Array.from(atob(plain), (character) => character.charCodeAt(0)), form: "base64" };
  }

  function hexadecimal(text) {
    try {
      return { data: frames.parseHex(text), form: "" };
    } catch {
      return null;
    }
  }

  return { read };
})(typeof icdgenFrames === "undefined" ? require("./frames.js") : icdgenFrames);
if (typeof module !== "undefined") module.exports = icdgenPasted;
