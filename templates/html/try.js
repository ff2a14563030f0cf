"use strict";
/* Try it: bytes in, values out, and the other way round. Works on the plan that stands in the page. */
(() => {
  const plan = JSON.parse(document.getElementById("plan").textContent);
  const { fields, drawing, wire } = plan;
  const codec = icdgenCodec;
  const frames = icdgenFrames;
  const SVG = "http://www.w3.org/2000/svg";
  let raw = codec.fresh(plan);

  function make(name, attributes, ...children) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...children);
    return element;
  }

  // The panel

  const bytes = make("textarea", { id: "frame", rows: plan.length > 40 ? "5" : "2", spellcheck: "false", autocomplete: "off", autocapitalize: "off", "aria-describedby": "verdict" });
  const verdict = make("p", { id: "verdict", role: "status" });
  const strip = make("div", { class: "strip", "aria-hidden": "true" });
  const link = make("a", { href: "#try" }, "Link to this frame");
  const reset = make("button", { type: "button" }, "Reset");
  const sent = make("dl", { class: "sent" });
  const rows = fields.map(makeRow);
  const table = make("table", { class: "live" }, make("caption", { class: "hidden" }, "Values of the fields"));
  table.append(make("thead", {}, make("tr", {}, ...["Field", "Raw", "Value", "Unit"].map((text) => make("th", { scope: "col" }, text)))));
  table.append(make("tbody", {}, ...rows.map((row) => row.element)));
  const panel = document.getElementById("decoder");
  panel.append(
    make("label", { for: "frame" }, "Bytes, in any spelling of hexadecimal", ...(wire.framing ? [", with or without UART framing"] : []), ...(wire.crc.length ? [" and CRC"] : [])),
    bytes, verdict, strip, make("p", { class: "actions" }, reset, link), sent,
  );
  if (fields.length) panel.append(make("section", { class: "scroll", tabindex: "0", "aria-label": "Values, scrollable" }, table));

  function makeRow(field, index) {
    const key = index + 1;
    const box = make("input", { type: "text", id: `raw-${key}`, class: "n", "aria-label": `${field.name}, raw`, autocomplete: "off", spellcheck: "false" });
    const value = makeValue(field, key);
    const note = make("span", { class: "remark" });
    box.addEventListener("change", () => edit(index, box, () => parseRaw(field, box.value)));
    const element = make("tr", { class: `k${key}` }, make("th", { scope: "row" }, field.name), make("td", {}, box), make("td", {}, ...(value ? [value] : []), note), make("td", {}, field.unit ?? ""));
    if (value) value.addEventListener("change", () => edit(index, value, () => parseValue(field, value)));
    return { element, box, value, note };
  }

  function makeValue(field, key) {
    const attributes = { id: `value-${key}`, "aria-label": `${field.name}, value` };
    if (field.type === "bool") return make("input", { ...attributes, type: "checkbox" });
    if (field.type === "enum") {
      const members = plan.enums[field.enum].map(([value, name]) => make("option", { value: String(value) }, `${value} · ${name}`));
      return make("select", attributes, ...members, make("option", { value: "" }, "no member"));
    }
    if (field.scale || field.type === "float") return make("input", { ...attributes, type: "text", class: "n", autocomplete: "off", spellcheck: "false" });
    return null;
  }

  // From what was typed to raw values

  function parseRaw(field, text) {
    const word = text.trim();
    if (field.type === "bytes") return frames.parseHex(word);
    if (!/^[-\u2212]?(?:0[xX][0-9A-Fa-f]+|[0-9]+)$/.test(word)) throw new Error(`${field.name} takes an integer, decimal or 0x`);
    const negative = /^[-\u2212]/.test(word);
    const size = BigInt(negative ? word.slice(1) : word);
    return negative ? -size : size;
  }

  function parseValue(field, widget) {
    if (field.type === "bool") return widget.checked ? 1n : 0n;
    if (field.type === "enum") {
      if (widget.value === "") throw new Error(`${field.name}: give the raw value of what is no member`);
      return BigInt(widget.value);
    }
    const word = widget.value.trim().replace("\u2212", "-").toLowerCase();
    const named = { nan: NaN, inf: Infinity, infinity: Infinity, "-inf": -Infinity, "-infinity": -Infinity }[word];
    const number = named ?? (/^[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?$/.test(word) ? Number(word) : undefined);
    if (number === undefined) throw new Error(`${field.name} takes a number`);
    return field.type === "float" ? codec.floatBits(field, number) : codec.rawFromPhysical(field, number);
  }

  function edit(index, widget, parse) {
    const changed = [...raw];
    try {
      changed[index] = parse();
      codec.check(fields[index], changed[index]);
    } catch (error) {
      widget.setAttribute("aria-invalid", "true");
      say(error.message, true);
      return;
    }
    raw = changed;
    const frame = codec.encode(plan, raw);
    bytes.value = frames.hex(frame);
    show(frame, []);
  }

  // From raw values to what is shown

  function rawText(field, value) {
    if (field.type === "bytes") return frames.hex(value);
    if (field.type === "float") return `0x${value.toString(16).toUpperCase().padStart(field.bits / 4, "0")}`;
    return String(value);
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

  function floatText(field, value) {
    const number = codec.floatValue(field, value);
    if (field.bits === 64 || !Number.isFinite(number)) return Object.is(number, -0) ? "-0" : String(number);
    for (let digits = 1; digits < 10; digits += 1) {
      const text = number.toPrecision(digits);
      if (Object.is(Math.fround(Number(text)), number)) return Object.is(number, -0) ? "-0" : String(Number(text));
    }
    return String(number);
  }

  /** What there is to say about a value: its special meaning, or that it is beyond what is allowed. */
  function remark(field, value) {
    const special = field.special?.find(([one]) => BigInt(one) === value);
    if (special) return special[1];
    if (field.const !== undefined && BigInt(field.const) !== value) return `must be ${field.const}`;
    if (!field.limits || field.type === "bytes") return "";
    const below = ([n, d]) => beyond(field, value, BigInt(n), BigInt(d));
    const { min, max, above, below: under } = field.limits;
    const outside = (min && below(min) < 0) || (max && below(max) > 0) || (above && below(above) <= 0) || (under && below(under) >= 0);
    return outside ? "outside the limits" : "";
  }

  /** -1, 0 or 1: the value is less than, equal to or greater than n / d. */
  function beyond(field, value, n, d) {
    if (field.type === "float") {
      const [number, bound] = [codec.floatValue(field, value), codec.nearestDouble(n, d)];
      return number < bound ? -1 : number > bound ? 1 : 0;
    }
    const [numerator, denominator] = codec.exact(field, value) ?? [value, 1n];
    const difference = numerator * d - n * denominator;
    return difference < 0n ? -1 : difference > 0n ? 1 : 0;
  }

  function show(frame, remarks) {
    rows.forEach(({ box, value, note }, index) => {
      const [field, one] = [fields[index], raw[index]];
      box.value = rawText(field, one);
      box.removeAttribute("aria-invalid");
      note.textContent = remark(field, one);
      if (!value) return;
      value.removeAttribute("aria-invalid");
      if (field.type === "bool") value.checked = one === 1n;
      else if (field.type === "enum") value.value = [...value.options].some((o) => o.value === String(one)) ? String(one) : "";
      else if (field.type === "float") value.value = floatText(field, one);
      else value.value = decimal(...codec.exact(field, one));
    });
    const text = frames.hex(frame).replaceAll(" ", "").toLowerCase();
    link.setAttribute("href", `#try=${text}`);
    say([`${frame.length} bytes`, ...remarks].join(", "), false);
    light(frame);
    send(frame);
  }

  function say(text, wrong) {
    verdict.textContent = text;
    verdict.classList.toggle("wrong", wrong);
    bytes.toggleAttribute("aria-invalid", false);
  }

  // Bits

  const owners = new Uint16Array(plan.length * 8);
  fields.forEach((field, index) => {
    if (field.type === "bytes") owners.fill(index + 1, field.first * 8, field.first * 8 + field.bits);
    else for (const [byte, shift, bits] of field.pieces) owners.fill(index + 1, byte * 8 + 8 - shift - bits, byte * 8 + 8 - shift);
  });
  const isSet = (frame, at) => (frame[at >> 3] >> (7 - (at & 7))) & 1;

  function light(frame) {
    strip.replaceChildren(...Array.from(frame, (byte, number) => {
      const bits = Array.from({ length: 8 }, (_, bit) => {
        const at = number * 8 + bit;
        return make("i", { class: `${owners[at] ? `k${owners[at]}` : "none"}${isSet(frame, at) ? " on" : ""}` });
      });
      return make("span", { title: `byte ${number}` }, make("b", {}, frames.hex([byte])), ...bits);
    }));
    const layer = document.querySelector("svg.layout .lit");
    if (!layer) return;
    const { across, cell, left, top, row, rows: firsts } = drawing;
    const marks = [];
    firsts.forEach((first, line) => {
      if (first < 0) return;
      for (let column = 0; column < 8 * across && first * 8 + column < frame.length * 8; column += 1) {
        if (!isSet(frame, first * 8 + column)) continue;
        const [x, y] = [left + column * cell, top + line * row];
        marks.push(shape("rect", { x, y, width: cell, height: row, class: "glow" }));
        marks.push(shape("rect", { x: x + 1, y: y + row - 4.5, width: cell - 2, height: 4 }));
      }
    });
    layer.replaceChildren(...marks);
  }

  function shape(name, attributes) {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return element;
  }

  function send(frame) {
    if (!wire.framing || wire.id > 255) return;
    const lines = [["UART", frames.framed(wire, frame, false)]];
    if (wire.crc.length && wire.command) lines.push(["UART, with CRC", frames.framed(wire, frame, true)]);
    sent.replaceChildren(...lines.map(([name, all]) => make("div", {}, make("dt", {}, name), make("dd", {}, frames.hex(all)))));
  }

  // What was pasted, or came with the address

  function read() {
    if (!bytes.value.trim() && plan.length) {
      say("", false);
      return;
    }
    try {
      const { data, remarks } = icdgenPasted.messageIn(wire, plan.length, bytes.value);
      raw = codec.decode(plan, data);
      show(data, remarks);
    } catch (error) {
      empty();
      say(error.message, true);
      bytes.setAttribute("aria-invalid", "true");
    }
  }

  /** Nothing is left from before beside a frame that is not this message. */
  function empty() {
    raw = codec.fresh(plan);
    rows.forEach(({ box, value, note }) => {
      box.value = "";
      note.textContent = "";
      if (value?.type === "checkbox") value.checked = false;
      else if (value) value.value = "";
    });
    strip.replaceChildren();
    sent.replaceChildren();
    document.querySelector("svg.layout .lit")?.replaceChildren();
  }

  function fromAddress() {
    const found = /^#try=([0-9A-Fa-f]*)$/.exec(location.hash);
    if (!found) return;
    bytes.value = found[1].replace(/..(?=.)/g, "$& ").toUpperCase();
    read();
    document.getElementById("try").scrollIntoView();
  }

  bytes.addEventListener("input", read);
  reset.addEventListener("click", () => {
    raw = codec.fresh(plan);
    const frame = codec.encode(plan, raw);
    bytes.value = frames.hex(frame);
    show(frame, []);
    document.querySelector("svg.layout .lit")?.replaceChildren();
  });
  addEventListener("hashchange", fromAddress);
  reset.click();
  fromAddress();
})();
