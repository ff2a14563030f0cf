"use strict";
/* Raw values as text, text as raw values, and what there is to say about a value. */
const icdgenValues = ((codec, frames) => {
  function parseRaw(field, text) {
    const word = text.trim();
    if (field.type === "bytes") return frames.parseHex(word);
    if (!/^[-\u2212]?(?:0[xX][0-9A-Fa-f]+|0[bB][01]+|[0-9]+)$/.test(word)) throw new Error(`${field.name} takes an integer: decimal, 0x or 0b`);
    const negative = /^[-\u2212]/.test(word);
    const size = BigInt(negative ? word.slice(1) : word);
    return negative ? -size : size;
  }

  function parsePhysical(field, text) {
    if (field.text) return codec.rawFromText(field, text);
    const word = text.trim().replace("\u2212", "-").toLowerCase();
    const named = { nan: NaN, inf: Infinity, infinity: Infinity, "-inf": -Infinity, "-infinity": -Infinity }[word];
    const number = named ?? (/^[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?$/.test(word) ? Number(word) : undefined);
    if (number === undefined) throw new Error(`${field.name} takes a number`);
    return field.type === "float" && !field.curve ? codec.floatBits(field, number) : codec.rawFromPhysical(field, number);
  }

  function rawText(field, value) {
    if (field.derived) return "";
    if (field.type === "bytes") return frames.hex(value);
    if (field.type === "float") return `0x${value.toString(16).toUpperCase().padStart(field.bits / 4, "0")}`;
    if (field.base) return inBase(value, ...field.base);
    return String(value);
  }

  /** A raw value that is displayed as a bit pattern. */
  function inBase(value, prefix, base, width) {
    return prefix + value.toString(base).toUpperCase().padStart(width, "0");
  }

  /** The physical value of a field that has one. */
  function physicalText(field, value) {
    if (field.text) return codec.text(value);
    if (field.curve) return rounded(field, codec.physical(field, value));
    if (field.type === "float") return isRounded(field) ? rounded(field, codec.floatValue(field, value)) : floatText(field, value);
    const exact = codec.exact(field, value);
    return isRounded(field) ? rounded(field, codec.nearestDouble(...exact)) : decimal(...exact);
  }

  function isRounded(field) {
    return field.decimals !== undefined || field.digits !== undefined;
  }

  /** What people want to see of a value: its name, its physical value with unit, or the raw one. */
  function shortText(field, value, enums) {
    if (field.type === "enum") return codec.memberName(enums[field.enum], value) ?? `${rawText(field, value)}?`;
    if (field.text) return codec.text(value);
    if (field.type === "float" || field.scale || field.curve) return `${physicalText(field, value)}${field.unit ? ` ${field.unit}` : ""}`;
    return `${rawText(field, value)}${field.unit ? ` ${field.unit}` : ""}`;
  }

  /** The exact decimal, if it ends soon enough, else the nearest double. */
  function decimal(numerator, denominator) {
    let places = 0;
    for (; places < 24 && (10n ** BigInt(places)) % denominator !== 0n; places += 1);
    if ((10n ** BigInt(places)) % denominator !== 0n) return String(codec.nearestDouble(numerator, denominator));
    const scaled = (numerator * 10n ** BigInt(places)) / denominator;
    const digits = String(scaled < 0n ? -scaled : scaled).padStart(places + 1, "0");
    const text = places ? `${digits.slice(0, -places)}.${digits.slice(-places)}` : digits;
    return scaled < 0n ? `-${text}` : text;
  }

  /** A number with as many decimals or significant digits as the plan says. */
  function rounded(field, number) {
    if (!Number.isFinite(number)) return String(number);
    if (field.digits !== undefined) return numberText(Number(number.toPrecision(field.digits)));
    if (Math.abs(number) >= 1e15) return numberText(number); // a double has no further digits
    const text = number.toFixed(field.decimals);
    const short = text.includes(".") && !field.fixed ? text.replace(/\.?0+$/, "") : text;
    return /[1-9]/.test(short) ? short : short.replace("-", "");
  }

  function numberText(number) {
    return Object.is(number, -0) ? "-0" : String(number);
  }

  function floatText(field, value) {
    const number = codec.floatValue(field, value);
    if (field.bits === 64 || number === 0 || !Number.isFinite(number)) return numberText(number);
    for (let digits = 1; digits < 10; digits += 1) {
      const text = number.toPrecision(digits);
      if (Object.is(Math.fround(Number(text)), number)) return String(Number(text));
    }
    return String(number);
  }

  /** What there is to say about a value, as `{ text, wrong }`: its special meaning, or that the message may not hold it. */
  function remark(field, value, enums) {
    const special = field.special?.find(([one]) => isSame(field, BigInt(one), value));
    if (special) return { text: special[1], wrong: false };
    if (field.const !== undefined && BigInt(field.const) !== value) return { text: `must be ${field.const}`, wrong: true };
    if (field.type === "enum" && codec.memberName(enums[field.enum], value) === undefined) return { text: "no such member", wrong: true };
    return { text: isOutside(field, value) ? "outside the limits" : "", wrong: isOutside(field, value) };
  }

  /** Whether two raw values are one: of floats all NaNs are, and both zeros. */
  function isSame(field, one, other) {
    if (field.type !== "float") return one === other;
    const [a, b] = [codec.floatValue(field, one), codec.floatValue(field, other)];
    return a === b || (Number.isNaN(a) && Number.isNaN(b));
  }

  function isOutside(field, value) {
    if (!field.limits || field.type === "bytes") return false;
    const than = ([n, d]) => beyond(field, value, BigInt(n), BigInt(d));
    const { min, max, above, below } = field.limits;
    return Boolean((min && than(min) < 0) || (max && than(max) > 0) || (above && than(above) <= 0) || (below && than(below) >= 0));
  }

  /** -1, 0 or 1: the value is less than, equal to or greater than n / d. */
  function beyond(field, value, n, d) {
    if (field.type === "float" || field.curve) {
      const number = field.curve ? codec.physical(field, value) : codec.floatValue(field, value);
      const bound = codec.nearestDouble(n, d);
      return number < bound ? -1 : number > bound ? 1 : 0;
    }
    const [numerator, denominator] = codec.exact(field, value) ?? [value, 1n];
    const difference = numerator * d - n * denominator;
    return difference < 0n ? -1 : difference > 0n ? 1 : 0;
  }

  return { parseRaw, parsePhysical, rawText, physicalText, shortText, remark };
})(icdgenCodec, icdgenFrames);
