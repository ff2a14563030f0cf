"use strict";
// The page of the workbench. The server holds document and profile; every change is sent to it and everything is drawn anew.

const byId = (id) => document.getElementById(id);
const WHAT = ["message", "registers", "list", "index", "enumeration", "lookup", "bits", "loggable", "ignore"];
const NOT_USED = "not used";
const SEPARATOR = "||"; // between patterns: in a regular expression it would mean nothing
const MOST_BYTES = 32; // drawn of a message; the others can be unfolded
const SOURCES = ["caption", "heading", "before", "row"];
const OF_MESSAGE = ["name", "id", "kind", "length", "of", "enumeration", ...SOURCES]; // controls for keys of `message`
let state = null; // what /api/state says
let table = null; // the table that is shown
let number = 1;
let chosen = null; // index of the rule that is edited, if it is not the last one of the table
let checked = null; // findings of `icdgen check` for the files that were saved last

function element(name, keys = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(keys)) {
    if (key in made && key !== "list") made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

async function ask(path) {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(await answer.text());
  return answer.json();
}

let pressed = Promise.resolve(); // until the pointer is released

// A button that is drawn anew between press and release would not be clicked.
document.addEventListener("pointerdown", () => {
  pressed = new Promise((resolve) => {
    const released = () => setTimeout(resolve); // after the click
    for (const name of ["pointerup", "pointercancel"]) document.addEventListener(name, released, { once: true, capture: true });
  });
}, { capture: true });

let last = Promise.resolve(); // changes are sent one after the other, in the order in which they were made

function send(path, data) {
  last = last.catch(() => null).then(() => sendNow(path, data));
  return last;
}

async function sendNow(path, data) {
  const answer = await fetch(path, { method: "POST", headers: { "X-Icdgen": "1" }, body: JSON.stringify(typeof data === "function" ? data() : data) });
  if (!answer.ok) throw new Error(await answer.text());
  const got = await answer.json();
  await pressed;
  drawRefused(got.refused || []);
  if (got.refused) return null;
  state = got.state;
  await show(number);
  return got.done;
}

// --- the rule of the table that is shown

const ruleIndex = () => (table.rules.includes(chosen) ? chosen : table.rules.at(-1) ?? null);
const rule = () => (ruleIndex() === null ? null : state.rules[ruleIndex()].keys);

function merged(keys) {
  if (!keys.like) return keys;
  const base = state.rules.map((one) => one.keys).find((one) => one.rule === keys.like);
  if (!base) return keys;
  const below = merged(base);
  const made = { ...below, ...keys };
  for (const key of ["tables", "message", "columns", "each", "map"]) if (below[key] && keys[key]) made[key] = { ...below[key], ...keys[key] };
  return made;
}

// The edit is made when the changes before it were answered, so that none is lost.
function change(edit) {
  const index = ruleIndex(); // now: until then, another rule may be shown
  return send("/api/rule", () => {
    const keys = structuredClone(state.rules[index].keys);
    edit(keys);
    for (const key of ["message", "columns", "each"]) if (keys[key] && !Object.keys(keys[key]).length) delete keys[key];
    for (const key of ["ignore", "join"]) if (keys[key] && !keys[key].length) delete keys[key];
    return { index, rule: keys };
  });
}

function put(keys, key, value) {
  if (value === "" || value === false || value === null || (Array.isArray(value) && !value.length)) delete keys[key];
  else keys[key] = value;
}

const head = () => table.titles.map((title) => (title ? (title.startsWith("~") ? `~^\\${title}` : title.replaceAll(" | ", " ")) : "*")).join(" | ");
function patterns(text) {
  const parts = text.split(SEPARATOR).map((part) => part.trim()).filter(Boolean);
  return parts.length > 1 ? parts : parts[0] || "";
}

// `kind: TC = telecommand, TM = telemetry; type: CHAR = text`: role, then words and their meanings
function wordsOf(text) {
  const entries = text.split(";").map((part) => part.split(/:(.*)/s).map((side) => side.trim())).filter(([role, words]) => role && words);
  const pairs = (words) => words.split(",").map((pair) => pair.split("=").map((side) => side.trim())).filter(([word, meaning]) => word && meaning);
  const made = Object.fromEntries(entries.map(([role, words]) => [role, Object.fromEntries(pairs(words))]));
  return Object.keys(made).length ? made : null;
}

// Columns whose headings are numbers become rows: their cells need a role, and the headings none.
function melt(keys, text) {
  put(keys, "melt", text);
  keys.columns = { ...(keys.columns || {}) };
  if (!text) { delete keys.columns["*"]; return; }
  keys.columns["*"] ||= "name";
  try {
    const heading = new RegExp(text.replace(/\{[a-z_]+(:[^{}]*)?\}/g, (role, own) => (own ? `(?:${own.slice(1)})` : "[0-9]+")), "i");
    keys.ignore = (keys.ignore || []).filter((title) => !heading.test(title));
  } catch { /* the server reports a pattern that is wrong */ }
}

const shown = (value) => (Array.isArray(value) ? value.join(` ${SEPARATOR} `) : value === undefined ? "" : String(value));
const number_or_text = (text) => (/^[0-9]+$/.test(text) ? Number(text) : text);

// --- drawing

async function show(wanted, rule = wanted === number ? chosen : null) {
  number = wanted;
  chosen = rule;
  if (number > state.tables.length) number = state.tables.length;
  table = await ask(`/api/table/${number}`);
  const focus = document.activeElement && document.activeElement.dataset ? document.activeElement.dataset.key : null;
  drawHeader(); drawTables(); drawPicture(); drawAround(); drawRule(); drawGrid(); drawResult();
  if (focus) document.querySelector(`[data-key="${CSS.escape(focus)}"]`)?.focus();
}

function drawHeader() {
  byId("document").textContent = state.document;
  const node = byId("node").elements;
  node.byte_order.value = state.node.byte_order || "";
  node.bit_order.value = state.node.bit_order || "";
  fill(node.id_bits, state.node.id_bits || "");
  byId("undo").disabled = !state.can_undo;
  byId("redo").disabled = !state.can_redo;
  document.title = `${state.is_saved ? "" : "• "}${state.document} – icdgen workbench`;
  document.querySelector("main").classList.toggle("textual", !state.has_pictures);
}

function drawTables() {
  byId("tables").replaceChildren(...state.tables.map((one) => {
    const last = one.rules.length ? state.rules[one.rules.at(-1)].keys : null;
    const isInvalid = state.errors.some((error) => one.rules.includes(error.rule));
    const kind = last === null ? "unread" : one.errors || isInvalid ? "wrong" : last.what === "ignore" ? "ignored" : "good";
    const sign = { unread: "?", wrong: "✗", ignored: "–", good: "✓" }[kind];
    const said = { unread: "no rule", wrong: isInvalid ? "rule not valid" : count(one.errors, "error"), ignored: "ignored", good: one.fields ? count(one.fields, "field") : last && last.what }[kind];
    const names = one.messages.filter((text) => text !== "?");
    const name = names.length > 2 ? `${names[0]} ... ${names[names.length - 1]}` : names.join(", ") || one.name;
    const button = element("button", { type: "button", title: `${one.title}: ${said}` },
      element("span", { className: "state", "aria-hidden": "true" }, sign), `${one.number} ${name} (${said})`);
    button.dataset.key = `table-${one.number}`;
    if (one.number === number) button.setAttribute("aria-current", "true");
    button.onclick = () => show(one.number);
    return element("li", { className: kind }, button);
  }));
}

function count(number, noun) {
  return `${number} ${noun}${number === 1 ? "" : "s"}`;
}

function drawPicture() {
  if (!state.has_pictures) return;
  const pages = [...new Set(table.boxes.map((box) => box[0]))];
  byId("picture").replaceChildren(element("h2", {}, pages.length ? `Page ${pages.join(", ")}` : "Page"), ...pages.map((page) => {
    const image = element("img", { src: `/picture/${page}`, alt: `page ${page}` });
    const around = element("div", { className: "page" }, image);
    image.onload = () => {
      const scale = 72 / 100;
      const outline = (of, box) => {
        const button = element("button", { type: "button", title: `table ${of}`, "aria-label": `show table ${of}` });
        const part = (value, whole) => `${(100 * value) / (whole * scale)}%`;
        button.style.left = part(box[1], image.naturalWidth); button.style.top = part(box[2], image.naturalHeight);
        button.style.width = part(box[3] - box[1], image.naturalWidth); button.style.height = part(box[4] - box[2], image.naturalHeight);
        if (of === number) button.setAttribute("aria-current", "true");
        button.onclick = () => show(of);
        around.append(button);
      };
      for (const one of state.tables) for (const box of one.boxes) if (box[0] === page) outline(one.number, box);
    };
    return around;
  }));
}

function drawAround() {
  byId("title").textContent = `${table.title}${table.page ? `, page ${table.page}` : ""}`;
  const texts = [["caption", table.caption], ...table.headings.map((text) => ["heading", text]), ...table.before.slice(-6).map((text) => ["before", text])];
  byId("around").replaceChildren(...texts.filter(([, text]) => text).flatMap(([name, text]) => [element("dt", {}, name), element("dd", {}, text)]));
  byId("previous").disabled = number <= 1;
  byId("next").disabled = number >= state.tables.length;
  byId("make").hidden = byId("ignore").hidden = ruleIndex() !== null;
  byId("remove").hidden = ruleIndex() === null;
  byId("another").hidden = ruleIndex() === null || merged(state.rules[table.rules.at(-1)].keys).what === "ignore";
  byId("rules").hidden = table.rules.length < 2;
  byId("rules").replaceChildren(...table.rules.map((index) => {
    const button = element("button", { type: "button", onclick: () => show(number, index) }, `${nameOfRule(index)}: ${merged(state.rules[index].keys).what || "message"}`);
    button.setAttribute("aria-pressed", String(index === ruleIndex()));
    button.dataset.key = `rule-${index}`;
    return button;
  }));
}

function nameOfRule(index) {
  const name = state.rules[index].keys.rule;
  return `Rule ${index + 1}${name ? ` (${name})` : ""}`;
}

// What a person is typing in is not overwritten by the answer to the change before.
function fill(input, value) {
  if (input !== document.activeElement) input.value = value;
}

function drawRule() {
  const form = byId("rule");
  form.hidden = ruleIndex() === null;
  if (form.hidden) return;
  const keys = merged(rule());
  const input = (name) => form.elements.namedItem(name); // `elements.length` is their number
  const of = state.tables.filter((one) => one.rules.includes(ruleIndex())).length;
  byId("legend").textContent = `${nameOfRule(ruleIndex())}, for ${count(of, "table")}`;
  if (!input("what").options.length) input("what").append(...WHAT.map((what) => element("option", {}, what)));
  fill(input("what"), keys.what || "message");
  fill(input("tables"), Object.entries(keys.tables || {}).map(([key, value]) => `${key}: ${value}`).join("; "));
  fill(input("type"), (keys.each || {}).type || "");
  input("width").checked = keys.width === "unit";
  input("transpose").checked = Boolean(keys.transpose);
  fill(input("join"), (keys.join || []).join(", "));
  fill(input("skip"), keys.skip || "");
  fill(input("origin"), keys.origin || "");
  fill(input("map"), Object.entries(keys.map || {}).map(([role, words]) => `${role}: ${Object.entries(words).map((pair) => pair.join(" = ")).join(", ")}`).join("; "));
  fill(input("melt"), keys.melt || "");
  fill(input("cells"), shown((keys.columns || {})["*"]));
  for (const key of OF_MESSAGE) fill(input(key), shown((keys.message || {})[key]));
  fill(byId("yaml"), state.rules[ruleIndex()].text);
  offer(input, keys.what || "message");
}

// Controls of roles that this kind of rule does not use are hidden, unless they have a value that is to be removed.
function offer(input, what) {
  const roles = state.roles_of[what]; // none: the rule ignores its tables
  const reads = ["type", "width", "transpose", "join", "skip", "map", "melt", "cells", "origin", ...SOURCES];
  const isOffered = (name) => (reads.includes(name) ? Boolean(roles) : Boolean(roles) && roles.includes(name === "name" ? "message" : name));
  for (const name of [...OF_MESSAGE, ...reads.filter((name) => !SOURCES.includes(name))]) {
    const control = input(name);
    control.closest("label").hidden = !(isOffered(name) || (control.type === "checkbox" ? control.checked : control.value));
  }
  byId("roles").replaceChildren(element("option", { value: NOT_USED }),
    ...(roles || []).map((role) => element("option", { value: role, label: `${role}: ${state.roles[role]}` })));
}

let drawn = ""; // which grid is shown: its cells are drawn anew only if it is another one

function drawGrid() {
  const wanted = JSON.stringify([number, table.head, ruleIndex()]);
  if (wanted === drawn) {
    for (const input of byId("grid").querySelectorAll("input")) fill(input, roleOf(input.dataset.title));
    return;
  }
  drawn = wanted;
  const rows = table.rows.map((cells, index) => {
    const isHead = index === table.head && ruleIndex() !== null;
    let column = 0;
    const made = cells.map(([text, columns, span]) => {
      const cell = element(index === table.head ? "th" : "td", { colSpan: columns, rowSpan: span }, text);
      if (isHead) cell.append(element("span", { className: "role" }, roleControl(text.replace(/\s+/g, " ").trim() || String(column + 1))));
      column += columns;
      return cell;
    });
    return element("tr", { className: index < table.head ? "above" : "" }, ...made);
  });
  byId("grid").replaceChildren(element("table", {}, element("tbody", {}, ...rows)));
}

function columnOf(title) {
  const columns = merged(rule()).columns || {};
  return Object.keys(columns).find((name) => name.replace(/\?$/, "").toLowerCase() === title.toLowerCase()) || title;
}

function roleOf(title) {
  const keys = merged(rule());
  return (keys.ignore || []).includes(title) ? NOT_USED : shown((keys.columns || {})[columnOf(title)]);
}

function roleControl(title) {
  const input = element("input", { "aria-label": `Role of ${title}`, list: "roles", size: 4, spellcheck: false, placeholder: "role or pattern",
    title: "a role, a pattern such as ^{byte}-{last_byte}$, several separated by ||, or: not used", value: roleOf(title) });
  input.dataset.title = title;
  input.onchange = () => {
    const given = patterns(input.value); // now: the answer to the change before may fill the control
    const key = columnOf(title);
    change((own) => {
      own.columns = { ...(own.columns || {}) };
      own.ignore = (own.ignore || merged(own).ignore || []).filter((name) => name !== title);
      delete own.columns[key];
      if (given === NOT_USED) own.ignore.push(title);
      else if (given !== "") own.columns[key] = given;
    });
  };
  return input;
}

function drawErrors() {
  const said = "Rules that are not valid; their last valid form is applied to the tables:";
  byId("errors").replaceChildren(...(state.errors.length ? [element("p", { className: "error" }, said), element("ul", {}, ...state.errors.map(drawError))] : []));
}

function drawError(error) {
  const owner = state.tables.find((one) => one.rules.includes(error.rule));
  const item = element("li", { className: "error" }, `${nameOfRule(error.rule)}: ${error.message}`, element("i", {}, error.help));
  if (owner) item.append(element("button", { type: "button", onclick: () => show(owner.number, error.rule) }, `table ${owner.number}`));
  return item;
}

function drawRefused(refused) {
  byId("refused").replaceChildren(...(refused.length ? [element("p", { className: "error" }, "Not accepted, and nothing is changed:"),
    element("ul", {}, ...refused.map((one) => element("li", { className: "error" }, `${one.line ? `line ${one.line}: ` : ""}${one.message}`, element("i", {}, one.help))))] : []));
}

// The findings of `icdgen check` are about the saved files, so that they stay until the next save.
function drawChecked() {
  if (checked === null) return;
  const counts = ["error", "warning", "note"].map((severity) => [checked.filter((one) => one.severity === severity).length, severity]);
  const figures = counts.filter(([times]) => times).map(([times, severity]) => count(times, severity)).join(", ");
  byId("checked").replaceChildren(element("h3", {}, `icdgen check of the saved ICD: ${figures || "no findings"}`), element("ul", {}, ...checked.map((one) =>
    element("li", { className: one.severity }, `${one.severity} ${one.code}: ${one.message}`, element("i", {}, `${one.file}:${one.line}`), element("i", {}, one.help)))));
}

function drawResult() {
  drawErrors();
  drawChecked();
  byId("messages").replaceChildren(...table.messages.flatMap(drawMessage));
  const errors = state.findings.filter((one) => one.severity === "error").length;
  const warnings = state.findings.filter((one) => one.severity === "warning").length;
  byId("count").textContent = `Findings of the document: ${count(errors, "error")}, ${count(warnings, "warning")}`;
  const own = table.findings.map((one) => [one, null]);
  const others = state.findings.filter((one) => one.table !== number && one.severity !== "note").slice(0, 60).map((one) => [one, one.table]);
  byId("findings").replaceChildren(...[...own, ...others].map(([one, where]) => {
    const item = element("li", { className: one.severity }, `${one.severity} ${one.code}: ${one.message}`, element("i", {}, one.help));
    if (where !== null) item.append(element("button", { type: "button", onclick: () => show(where) }, `table ${where}`));
    return item;
  }));
}

function drawMessage(message) {
  const given = Object.entries(message.given).map(([role, text]) => `${role} ${text}`).join(", ");
  const made = [element("h3", {}, `${message.given.message || message.what}: ${given}`)];
  if (message.pairs.length) made.push(element("table", {}, ...message.pairs.map(([value, name]) => element("tr", {}, element("td", {}, String(value)), element("td", {}, name)))));
  if (!message.fields.length) return made;
  const row = (name, ...cells) => element("tr", {}, ...cells.map((cell) => element(name, {}, String(cell ?? ""))));
  const typeOf = (one) => (one.enumeration ? `${one.type} ${one.enumeration}` : one.type);
  made.push(...drawBits(message.fields), element("table", { className: "fields" }, row("th", "at", "bits", "name", "type", "repeated", "unit", "formula"),
    ...message.fields.map((one) => row("td", one.at, one.bits, one.name, typeOf(one), repetition(one.repeated), one.unit, one.formula))));
  return made;
}

// `Channel: 8 times, every 11 bytes`
function repetition(repeated) {
  if (!repeated) return "";
  const distance = repeated.stride % 8 ? count(repeated.stride, "bit") : count(repeated.stride / 8, "byte");
  const times = /^[0-9]+$/.test(repeated.count) ? count(repeated.count, "time") : `count ${repeated.count || "not stated"}`;
  return `${repeated.group ? `${repeated.group}: ` : ""}${times}${repeated.stride ? `, every ${distance}` : ""}`;
}

let isUnfolded = false; // whether all bytes of messages are drawn

function drawBits(fields) {
  const times = (one) => (one.repeated?.group && Number(one.repeated.count)) || 1; // the size of an array has all its elements
  const total = Math.ceil(Math.max(...fields.map((one) => one.at + (one.size || 8) + (times(one) > 1 ? (times(one) - 1) * one.repeated.stride : 0))) / 8);
  const covers = (one, at) => one.at <= at && (times(one) > 1 ? (at - one.at) % one.repeated.stride < one.size && (at - one.at) / one.repeated.stride < times(one) : at < one.at + one.size);
  const isLsb = (state.node.bit_order || "lsb0") === "lsb0";
  const drawn = (begin, end) => {
    const made = [];
    for (let byte = begin; byte < end; byte += 1) {
      made.push(element("span", { className: "byte" }, String(byte)));
      const owner = (place) => fields.findIndex((one) => covers(one, byte * 8 + (isLsb ? 7 - place : place)));
      for (let place = 0; place < 8;) {
        const first = owner(place);
        let width = 1;
        while (place + width < 8 && owner(place + width) === first) width += 1;
        const cell = element("span", { className: first < 0 ? "free" : "", title: first < 0 ? "no field" : fields[first].name }, first < 0 ? "" : fields[first].name);
        cell.style.gridColumn = `span ${width}`;
        made.push(cell);
        place += width;
      }
    }
    return element("div", { className: "bits", role: "img", "aria-label": `layout of the bits of bytes ${begin} to ${end - 1}` }, ...made);
  };
  if (total <= MOST_BYTES) return [drawn(0, total)];
  const rest = element("details", { open: isUnfolded }, element("summary", {}, `Bytes ${MOST_BYTES} to ${total - 1}`));
  const unfold = () => { if (rest.childElementCount === 1) rest.append(drawn(MOST_BYTES, total)); };
  if (isUnfolded) unfold();
  rest.ontoggle = () => { isUnfolded = rest.open; if (isUnfolded) unfold(); };
  return [drawn(0, MOST_BYTES), rest];
}

// --- actions

byId("previous").onclick = () => show(number - 1);
byId("next").onclick = () => show(number + 1);
// A rule to complete: columns whose headings are roles have them, the others are not used.
function start(tables, behind) {
  const titles = table.titles.filter(Boolean);
  const isRole = (title) => ["name", "type", "unit"].includes(title.toLowerCase());
  const keys = { tables, columns: Object.fromEntries(titles.filter(isRole).map((title) => [title, title.toLowerCase()])), ignore: titles.filter((title) => !isRole(title)) };
  return send("/api/rule", { index: null, rule: keys, behind }).then(async (index) => {
    await show(number, index);
    byId("rule").elements.namedItem("what").focus();
  });
}

byId("make").onclick = () => start({ head: head() }, null);
byId("another").onclick = () => start(merged(state.rules[table.rules.at(-1)].keys).tables, table.rules.at(-1));
byId("ignore").onclick = () => send("/api/rule", { index: null, rule: { tables: { head: head() }, what: "ignore" } });
byId("remove").onclick = () => send("/api/rule", { index: ruleIndex(), rule: null });
byId("apply").onclick = () => send("/api/rule-text", { index: ruleIndex(), text: byId("yaml").value });
for (const action of ["undo", "redo"]) byId(action).onclick = () => { document.activeElement?.blur?.(); send(`/api/${action}`, null); };
byId("read").onclick = async () => {
  const before = state.tables.length;
  byId("saved").textContent = "Reading the document ...";
  byId("read").disabled = true;
  try {
    await send("/api/read", null);
    byId("saved").textContent = `The document was read: ${count(state.tables.length, "table")}, ${before} before`;
  } finally {
    byId("read").disabled = false;
  }
};
async function save(overwrite) {
  const done = await send("/api/save", { overwrite });
  if (!done) return;
  byId("conflict").hidden = !done.conflict;
  byId("conflict-text").textContent = done.conflict || "";
  if (done.conflict) { byId("saved").textContent = ""; return; }
  checked = done.files.length > 1 ? done.check : null;
  byId("checked").replaceChildren();
  drawChecked();
  const figure = `icdgen check: ${done.check.length ? count(done.check.length, "finding") : "no findings"}`;
  const rest = done.is_complete ? "" : "; the errors below are left";
  byId("saved").textContent = `${done.files.join("; ")}; ${done.files.length > 1 ? figure : "no ICD yet"}${rest}`;
}

async function reload() {
  document.activeElement?.blur?.();
  await send("/api/reload", null);
  if (byId("refused").childElementCount) return;
  byId("conflict").hidden = true;
  byId("saved").textContent = "The profile was read from its file; Undo restores the one of this page";
}

byId("save").onclick = () => save(false);
byId("overwrite").onclick = () => save(true);
byId("reload").onclick = byId("take-file").onclick = reload;
byId("node").onchange = () => {
  const inputs = byId("node").elements;
  const node = { ...state.node };
  for (const key of ["byte_order", "bit_order"]) put(node, key, inputs[key].value);
  put(node, "id_bits", number_or_text(inputs.id_bits.value.trim()));
  send("/api/node", node);
};
byId("node").onsubmit = byId("rule").onsubmit = (event) => event.preventDefault();
byId("rule").onchange = (event) => {
  const input = event.target;
  const name = input.name;
  const text = input.type === "checkbox" ? input.checked : input.value.trim();
  if (!name) return;
  change((keys) => {
    if (name === "tables") keys.tables = Object.fromEntries(text.split(";").map((part) => part.split(/:(.*)/s).map((one) => one.trim())).filter(([key, value]) => key && value).map(([key, value]) => [key, key === "nth" ? Number(value) : value]));
    else if (name === "type") { keys.each = { ...(keys.each || {}) }; put(keys.each, "type", text); }
    else if (name === "width") put(keys, "width", text ? "unit" : "");
    else if (name === "join") put(keys, "join", text.split(",").map((one) => one.trim()).filter(Boolean));
    else if (name === "map") put(keys, "map", wordsOf(text));
    else if (name === "melt") melt(keys, text);
    else if (name === "cells") { keys.columns = { ...(keys.columns || {}) }; put(keys.columns, "*", patterns(text)); }
    else if (name === "origin") put(keys, "origin", number_or_text(text));
    else if (["what", "transpose", "skip"].includes(name)) put(keys, name, text === "message" ? "" : text);
    else { keys.message = { ...(keys.message || {}) }; put(keys.message, name, SOURCES.includes(name) ? patterns(text) : text); }
    if (keys.what === "ignore") for (const key of ["columns", "message", "each", "ignore", "width", "join", "lines", "melt", "map", "set"]) delete keys[key];
  });
};
window.onbeforeunload = (event) => { if (state && !state.is_saved) event.preventDefault(); };
document.onkeydown = (event) => {
  const isText = document.activeElement?.matches?.("textarea, input:not([type=checkbox])"); // there, Ctrl+Z takes back typing
  const action = { z: event.shiftKey ? "redo" : "undo", y: "redo" }[event.key.toLowerCase()];
  if ((event.ctrlKey || event.metaKey) && action && !isText) { event.preventDefault(); if (!byId(action).disabled) byId(action).click(); }
  if ((event.ctrlKey || event.metaKey) && event.key === "s") { event.preventDefault(); document.activeElement?.blur?.(); byId("save").click(); }
};

(async () => {
  state = await ask("/api/state");
  if (state.tables.length) await show(1);
  else byId("title").textContent = "No table was found in the document.";
})();
