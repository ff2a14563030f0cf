"use strict";
/* Try it: bytes in, values out, and the other way round. Works on the plan that stands in the page. */
(() => {
  const codec = icdgenCodec;
  const plan = codec.expanded(JSON.parse(document.getElementById("plan").textContent));
  const { fields, drawings, wire } = plan;
  const sections = plan.sections ?? sectionsOfElements();
  const frames = icdgenFrames;
  const values = icdgenValues;
  const FEW_FLAGS = 6; // of so many flags on end a grid is made
  let raw = codec.fresh(plan);
  let shown = null; // the frame whose values are shown
  let size = 0; // bytes of the longest frame up to the last element of its open end

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
  const rows = new Map(); // by the index of the field, once its section was opened
  const panel = document.getElementById("decoder");
  panel.append(
    make("label", { for: "frame" }, "Bytes, in any spelling of hexadecimal", ...(wire.framing ? [", with or without UART framing"] : []), ...(wire.can ? [", or lines of candump"] : []), ...(wire.crc.length ? [", with or without CRC"] : [])),
    bytes, verdict, strip, make("p", { class: "actions" }, reset, link), sent,
  );
  const folds = sections.map(makeSection);
  panel.append(...folds);

  /** A section for each element of the arrays that the page shows once, and for the fields between them. */
  function sectionsOfElements() {
    const groups = [];
    fields.forEach(({ section = "" }, index) => {
      if (groups.at(-1)?.section !== section) groups.push({ section, keys: [] });
      groups.at(-1).keys.push(index + 1);
    });
    return groups.map(({ section, keys }) => {
      const own = keys.map((key) => fields[key - 1]);
      const bytes = own.flatMap(({ first, bits, pieces = [] }) => (first === undefined ? pieces.map(([byte]) => byte) : [first, first + bits / 8 - 1]));
      const [from, to] = [Math.min(...bytes), Math.max(...bytes)];
      const place = !bytes.length ? [] : from === to ? [`byte ${from}`] : [`bytes ${from} to ${to}`];
      const other = bytes.length ? "Fields" : own[0].implied ? "Count" : "Derived values";
      const about = [...place, `${keys.length.toLocaleString("en")} field${keys.length === 1 ? "" : "s"}`];
      return { title: [section || other, ...about].join(", "), keys, open: !section };
    });
  }

  /** Folded, if there are several sections; what a fold holds is made when it is opened first. */
  function makeSection({ title, keys, open }) {
    if (sections.length === 1) return make("div", {}, ...makeParts(keys));
    const fold = make("details", { class: "fold" }, make("summary", {}, title));
    fold.addEventListener("toggle", () => fill(), { once: true });
    const fill = () => fold.childElementCount > 1 || fold.append(...makeParts(keys));
    if (open) fill();
    fold.open = open;
    return fold;
  }

  /** Tables of values and grids of flags, in the order of the fields. */
  function makeParts(keys) {
    const groups = [];
    for (const key of keys) {
      const flag = fields[key - 1].type === "bool";
      if (groups.at(-1)?.flag === flag) groups.at(-1).keys.push(key);
      else groups.push({ flag, keys: [key] });
    }
    const parts = [];
    for (const group of groups) {
      const grid = group.flag && group.keys.length >= FEW_FLAGS;
      if (!grid && parts.at(-1)?.grid === false) parts.at(-1).keys.push(...group.keys);
      else parts.push({ grid, keys: [...group.keys] });
    }
    return parts.map(({ grid, keys: some }) => (grid ? makeGrid(some) : makeTable(some)));
  }

  /** The number by which drawing and table know a field: that of the first element for all elements. */
  function tieOf(key) {
    return fields[key - 1].leader ?? key;
  }

  function rowOf(key) {
    if (!rows.has(key - 1)) {
      rows.set(key - 1, makeRow(fields[key - 1], key - 1));
      if (shown) fillRow(key - 1);
    }
    return rows.get(key - 1);
  }

  function makeTable(keys) {
    const table = make("table", { class: "live" }, make("caption", { class: "hidden" }, "Values of the fields"));
    table.append(make("thead", {}, make("tr", {}, ...["Field", "Raw", "Value", "Unit"].map((text) => make("th", { scope: "col" }, text)))));
    table.append(make("tbody", {}, ...keys.map((key) => rowOf(key).element())));
    return table;
  }

  function makeGrid(keys) {
    return make("ul", { class: "flag-grid", "aria-label": "Flags" }, ...keys.map((key) => {
      const { value, note } = rowOf(key);
      return make("li", { "data-key": tieOf(key) }, make("label", {}, value, ` ${fields[key - 1].name}`), note);
    }));
  }

  function makeRow(field, index) {
    const key = index + 1;
    const box = make("input", { type: "text", id: `raw-${key}`, class: "n", "aria-label": `${field.name}, raw`, autocomplete: "off", spellcheck: "false" });
    const value = makeValue(field, key);
    const note = make("span", { class: "remark" });
    if (field.view) [box, value].filter(Boolean).forEach((widget) => widget.setAttribute("disabled", ""));
    box.addEventListener("change", () => edit(index, box, () => values.parseRaw(field, box.value)));
    if (value) value.addEventListener("change", () => edit(index, value, () => parseValue(field, value)));
    const element = () => make("tr", { "data-key": tieOf(key) }, make("th", { scope: "row" }, field.name), make("td", {}, box), make("td", {}, ...(value ? [value] : []), note), make("td", {}, field.unit ?? ""));
    return { element, box, value, note };
  }

  function makeValue(field, key) {
    const attributes = { id: `value-${key}`, "aria-label": `${field.name}, value` };
    if (field.type === "bool") return make("input", { ...attributes, type: "checkbox" });
    if (field.type === "enum") {
      const members = plan.enums[field.enum].map(([value, name, last]) => make("option", { value: String(value) }, `${value}${last === undefined ? "" : ` to ${last}`} · ${name}`));
      return make("select", attributes, ...members, make("option", { value: "" }, "no member"));
    }
    if (field.scale || field.curve || field.text || field.type === "float") return make("input", { ...attributes, ...(field.oneWay ? { readonly: "" } : {}), type: "text", class: "n", autocomplete: "off", spellcheck: "false" });
    return null;
  }

  // From what was typed to raw values

  function parseValue(field, widget) {
    if (field.type === "bool") return widget.checked ? 1n : 0n;
    if (field.type !== "enum") return values.parsePhysical(field, widget.value);
    if (widget.value === "") throw new Error(`${field.name}: give the raw value of what is no member`);
    return BigInt(widget.value);
  }

  function edit(index, widget, parse) {
    const changed = [...raw];
    let frame;
    try {
      changed[index] = parse();
      if (plan.tail) makeRoom(index, changed);
      if (plan.conditional) settle(index, changed);
      codec.check(fields[index], changed[index]);
      frame = codec.encode(plan, changed);
    } catch (error) {
      widget.setAttribute("aria-invalid", "true");
      say(error.message, true);
      return;
    }
    raw = codec.decode(plan, frame); // views follow
    bytes.value = frames.hex(frame);
    show(frame, []);
  }

  /** Where fields are not always there: what was typed is there, and what is there now has a value. */
  function settle(index, changed) {
    if (!codec.isThere(plan, fields[index], changed)) throw new Error(`${fields[index].name} is not there beside these values`);
    fields.forEach((field, at) => {
      if (changed[at] === null && codec.isThere(plan, field, changed)) changed[at] = BigInt(field.const ?? 0);
    });
  }

  /** Where frames differ in length: what was typed is in the frame, and open bytes or text are as long as typed. */
  function makeRoom(index, changed) {
    const { counter, least, step } = plan.tail;
    const [field, at] = [fields[index], fields.findIndex((one) => one.name === counter)];
    if (field.isOpen) {
      const filled = field.text && changed[index].length === field.bits / 8; // with NUL, by what was typed as text
      const typed = changed[index].subarray(0, filled ? codec.text(changed[index]).length : changed[index].length);
      changed[index] = new Uint8Array(Math.max(field.bits / 8, typed.length));
      changed[index].set(typed);
      changed[at] = BigInt(Math.max(0, typed.length - codec.plusOf(plan)));
    } else if (!field.view && !codec.isIn(plan, field, codec.sizeOf(plan, raw))) {
      const first = field.type === "bytes" ? field.first : Math.min(...field.pieces.map(([byte]) => byte));
      changed[at] = BigInt(Math.max(0, Math.floor((first - least) / step) + 1 - codec.plusOf(plan)));
    }
  }

  // From raw values to what is shown

  function show(frame, remarks) {
    shown = frame;
    size = codec.sizeOf(plan, raw);
    for (const index of rows.keys()) fillRow(index);
    const wrong = fields.flatMap((field, index) => {
      const one = shownOf(field, raw[index]);
      const remark = one === null ? {} : values.remark(field, one, plan.enums);
      return remark.wrong ? [`${field.name}: ${remark.text}`] : [];
    });
    const text = frames.hex(frame).replaceAll(" ", "").toLowerCase();
    link.setAttribute("href", `#try=${text}`);
    const more = wrong.length > 3 ? [`${wrong.length - 3} more fields are wrong`] : [];
    say([`${frame.length} bytes`, ...remarks, ...wrong.slice(0, 3), ...more].join(", "), wrong.length > 0);
    fold();
    light(frame);
    send(frame);
  }

  function fillRow(index) {
    const { box, value, note } = rows.get(index);
    const field = fields[index];
    const one = shownOf(field, raw[index]);
    box.removeAttribute("aria-invalid");
    if (one === null) {
      clear(rows.get(index));
      note.textContent = "not in the frame";
      note.classList.remove("wrong");
      return;
    }
    box.value = values.rawText(field, one);
    const remark = values.remark(field, one, plan.enums);
    note.textContent = remark.text;
    note.classList.toggle("wrong", remark.wrong);
    if (!value) return;
    value.removeAttribute("aria-invalid");
    if (field.type === "bool") value.checked = one === 1n;
    else if (field.type === "enum") value.value = [...value.options].some((o) => o.value === String(one)) ? String(one) : "";
    else value.value = values.physicalText(field, one);
  }

  /** Of arrays the elements that are in the frame have a fold, and one more, with which the frame can be made longer. */
  function fold() {
    if (plan.sections) return;
    let before = true;
    sections.forEach(({ keys }, number) => {
      const there = keys.some((key) => shownOf(fields[key - 1], raw[key - 1]) !== null);
      folds[number].hidden = !there && !before;
      before = there;
    });
  }

  /** The value of a field as the frame holds it: bytes that are cut off are as many as there are; null for what is not there. */
  function shownOf(field, one) {
    if (!plan.tail || field.implied || one === null) return one;
    if (field.isOpen) return one.subarray(0, size - field.first);
    return codec.isIn(plan, field, size) ? one : null;
  }

  function say(text, wrong, ...links) {
    verdict.replaceChildren(text, ...links.flatMap((one) => [" ", one]));
    verdict.classList.toggle("wrong", wrong);
    bytes.toggleAttribute("aria-invalid", false);
  }

  // Bits

  const owners = new Uint16Array(plan.length * 8);
  fields.forEach((field, index) => {
    if (field.view) return;
    if (field.type === "bytes") owners.fill(index + 1, field.first * 8, field.first * 8 + field.bits);
    else for (const [byte, shift, bits] of field.pieces) {
      for (let at = byte * 8 + 8 - shift - bits; at < byte * 8 + 8 - shift; at += 1) owners[at] ||= index + 1; // of alternatives the first
    }
  });

  function light(frame) {
    const places = plan.inner ? codec.places(plan, raw) : Array.from(frame.keys());
    const longest = new Uint8Array(plan.length); // drawings show the longest frame
    places.forEach((place, number) => (longest[place] = frame[number]));
    const isSet = (at) => (longest[at >> 3] >> (7 - (at & 7))) & 1;
    strip.replaceChildren(...Array.from(frame, (byte, number) => {
      const bits = Array.from({ length: 8 }, (_, bit) => {
        const at = places[number] * 8 + bit;
        return make("i", { ...(owners[at] ? { "data-key": tieOf(owners[at]) } : {}), ...(isSet(at) ? { class: "on" } : {}) });
      });
      return make("span", { title: `byte ${number}` }, make("b", {}, frames.hex([byte])), ...bits);
    }));
    const text = (key) => {
      const one = shownOf(fields[key - 1], raw[key - 1]);
      return one === null ? "" : values.shortText(fields[key - 1], one, plan.enums);
    };
    pictures().forEach((svg, number) => icdgenLit.show(svg, drawings[number], plan.length * 8, isSet, text));
  }

  const pictures = () => [...document.querySelectorAll("svg.layout")];

  // On the wire

  function send(frame) {
    const lines = [];
    if (wire.framing && wire.id <= 255) {
      lines.push(["UART", frames.hex(frames.framed(wire, frame, false))]);
      if (wire.crc.length && wire.command) lines.push(["UART, with CRC", frames.hex(frames.framed(wire, frame, true))]);
    }
    if (wire.can) {
      const { node } = wire.can;
      if (wire.command) lines.push(...candump("CAN, sent", icdgenPackets.split(wire.can, "telecommand", wire.id, 0, node, frame)));
      if (wire.telemetry !== null) lines.push(...candump("CAN, answer", icdgenPackets.split(wire.can, "reply", wire.telemetry, node, 0, frame)));
    }
    sent.replaceChildren(...lines.map(([name, text]) => make("div", {}, make("dt", {}, name), make("dd", { "data-copy": "" }, text))));
  }

  /** The packets as `candump -L` and `cansend` have them: identifier#data. */
  function candump(name, packets) {
    if (!packets.length) return [];
    const lines = packets.map(({ id, data }) => `${id.toString(16).toUpperCase().padStart(8, "0")}#${frames.hex(data).replaceAll(" ", "")}`);
    return [[`${name}, id 0x${lines[0].split("#")[0]}`, lines.join("\n")]];
  }

  // What was pasted, or came with the address

  function read() {
    if (!bytes.value.trim() && (plan.tail?.least ?? plan.length)) {
      empty();
      say("", false);
      return;
    }
    try {
      const { data, remarks } = icdgenGiven.messageIn(wire, plan.length, bytes.value);
      raw = codec.decode(plan, data);
      show(data, remarks);
    } catch (error) {
      empty();
      say(error.message, true);
      bytes.setAttribute("aria-invalid", "true");
      suggest(bytes.value, error.message);
    }
  }

  /** Where the frame is another message's, the way there. */
  async function suggest(text, message) {
    await icdgenFrameLinks.load();
    const { links } = icdgenFrameLinks.of(text);
    if (bytes.value !== text || !links.length) return;
    say(`${message}. It can be`, true, ...links.slice(0, 4).map((one) => make("a", { href: one.url, title: one.context }, one.title)));
    bytes.setAttribute("aria-invalid", "true");
  }

  /** Nothing is left from before beside a frame that is not this message. */
  function empty() {
    raw = codec.fresh(plan);
    shown = null;
    rows.forEach(clear);
    strip.replaceChildren();
    sent.replaceChildren();
    link.setAttribute("href", "#try");
    pictures().forEach(icdgenLit.clear);
  }

  function clear({ box, value, note }) {
    box.value = "";
    note.textContent = "";
    if (value?.type === "checkbox") value.checked = false;
    else if (value) value.value = "";
  }

  function fromAddress() {
    const found = /^#try=([0-9A-Fa-f]*)$/.exec(location.hash);
    if (!found) return;
    bytes.value = found[1].replace(/..(?=.)/g, "$& ").toUpperCase();
    read();
    document.getElementById("try").scrollIntoView();
  }

  for (const one of document.querySelectorAll(".frames dd")) {
    one.replaceChildren(make("a", { href: `#try=${one.textContent.replaceAll(" ", "").toLowerCase()}` }, one.textContent));
  }
  bytes.addEventListener("input", read);
  reset.addEventListener("click", () => {
    raw = codec.fresh(plan);
    const frame = codec.encode(plan, raw);
    bytes.value = frames.hex(frame);
    show(frame, []);
    pictures().forEach(icdgenLit.clear);
  });
  addEventListener("hashchange", fromAddress);
  reset.click();
  fromAddress();
})();
