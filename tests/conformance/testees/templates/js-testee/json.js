"use strict";
/* JSON that keeps integers exact: they are read as BigInt and written from it. Objects are read as Map; what is undefined is not written. */

const NUMBER = /-?(?:0|[1-9][0-9]*)(\.[0-9]+)?([eE][-+]?[0-9]+)?/y;
const STRING = /"(?:[^"\\\u0000-\u001f]|\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4}))*"/y;
const SPACE = /[ \t\n\r]*/y;

class Reader {
  constructor(text) {
    this.text = text;
    this.at = 0;
  }

  space() {
    SPACE.lastIndex = this.at;
    this.at += SPACE.exec(this.text)[0].length;
  }

  next(character) {
    this.space();
    if (this.text[this.at] !== character) return false;
    this.at += 1;
    return true;
  }

  expect(character) {
    if (!this.next(character)) throw new SyntaxError(`no ${character} at ${this.at}`);
  }

  match(pattern) {
    pattern.lastIndex = this.at;
    const found = pattern.exec(this.text);
    if (found === null) throw new SyntaxError(`no value at ${this.at}`);
    this.at += found[0].length;
    return found;
  }

  value() {
    this.space();
    const first = this.text[this.at];
    if (first === "{") return this.object();
    if (first === "[") return this.array();
    if (first === '"') return JSON.parse(this.match(STRING)[0]);
    for (const [word, value] of [["true", true], ["false", false], ["null", null]]) {
      if (this.text.startsWith(word, this.at)) {
        this.at += word.length;
        return value;
      }
    }
    const [text, fraction, exponent] = this.match(NUMBER);
    return fraction || exponent ? Number(text) : BigInt(text);
  }

  object() {
    const found = new Map();
    this.expect("{");
    if (this.next("}")) return found;
    do {
      this.space();
      const key = JSON.parse(this.match(STRING)[0]);
      this.expect(":");
      found.set(key, this.value());
    } while (this.next(","));
    this.expect("}");
    return found;
  }

  array() {
    const found = [];
    this.expect("[");
    if (this.next("]")) return found;
    do found.push(this.value());
    while (this.next(","));
    this.expect("]");
    return found;
  }
}

/** The value of a JSON text. Throws a SyntaxError, or a RangeError where it is nested too deeply. */
function parse(text) {
  const reader = new Reader(text);
  const value = reader.value();
  reader.space();
  if (reader.at !== text.length) throw new SyntaxError(`something follows at ${reader.at}`);
  return value;
}

/** JSON of a value in which integers may be BigInt and objects are plain. */
function stringify(value) {
  if (typeof value === "bigint") return String(value);
  if (Array.isArray(value)) return `[${value.map(stringify).join(",")}]`;
  if (value === null || typeof value !== "object") return JSON.stringify(value);
  const pairs = Object.entries(value).filter(([, one]) => one !== undefined);
  return `{${pairs.map(([key, one]) => `${JSON.stringify(key)}:${stringify(one)}`).join(",")}}`;
}

module.exports = { parse, stringify };
