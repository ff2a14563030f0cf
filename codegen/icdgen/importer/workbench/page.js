"use strict";
// The page of the workbench. The server holds document and profile; every change is sent to it and everything is drawn anew.

const byId = (id) => document.getElementById(id);
const WHAT = ["message", "registers", "list", "index", "enumeration", "lookup", "bits", "loggable", "ignore"];
const NOT_USED = "not used";
const SEPARATOR = "||"; // between patterns: in a regular expression it would mean nothing
const SOURCES = ["caption", "heading", "before", "row"];
let state = null; // what /api/state says
let table = null; // the table that is shown
let number = 1;

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

let last = Promise.resolve(); // changes are sent one after the other, in the order in which they were made

function send(path, data) {
  last = last.catch(() => null).then(() => sendNow(path, data));
  return last;
}

async function sendNow(path, data) {
  const answer = await fetch(path, { method: "POST", headers: { "X-Icdgen": "1" }, body: JSON.stringify(typeof data === "function" ? data() : data) });
  if (!answer.ok) throw new Error(await answer.text());
  const got = await answer.json();
  if (got.refused) {
    state.errors = got.refused;
    drawErrors();
    return null;
  }
  state = got.state;
  await show(number);
  return got.done;
}

// --- the rule of the table that is shown

const ruleIndex = () => (table.rules.length ? table.rules[table.rules.length - 1] : null);
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
  return send("/api/rule", () => {
    const keys = structuredClone(rule());
    edit(keys);
    for (const key of ["message", "columns", "each"]) if (keys[key] && !Object.keys(keys[key]).length) delete keys[key];
    for (const key of ["ignore", "join"]) if (keys[key] && !keys[key].length) delete keys[key];
    return { index: ruleIndex(), rule: keys };
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

async function show(wanted) {
  number = wanted;
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
    const last = one.rules.length ? state.rules[one.rules[one.rules.length - 1]].keys : null;
    const kind = last === null ? "unread" : one.errors ? "wrong" : last.what === "ignore" ? "ignored" : "good";
    const sign = { unread: "?", wrong: "✗", ignored: "–", good: "✓" }[kind];
    const said = { unread: "no rule", wrong: count(one.errors, "error"), ignored: "ignored", good: one.fields ? count(one.fields, "field") : last && last.what }[kind];
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
  byId("legend").textContent = `Rule for ${count(of, "table")}`;
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
  for (const key of ["name", "id", "kind", "length", "of", ...SOURCES]) fill(input(key), shown((keys.message || {})[key]));
  fill(byId("yaml"), state.rules[ruleIndex()].text);
}

let drawn = ""; // which grid is shown: its cells are drawn anew only if it is another one

function drawGrid() {
  const wanted = JSON.stringify([number, table.head, ruleIndex() !== null]);
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
      if (isHead) cell.append(roleControl(text.replace(/\s+/g, " ").trim() || String(column + 1)));
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
  const input = element("input", { "aria-label": `Role of ${title}`, list: "roles", size: 12, spellcheck: false, placeholder: "role or pattern",
    title: "a role, a pattern such as ^{byte}-{last_byte}$, several separated by ||, or: not used", value: roleOf(title) });
  input.dataset.title = title;
  input.onchange = () => {
    const given = patterns(input.value); // now: the answer to the change before may fill the control
    change((own) => {
      const key = columnOf(title);
      own.columns = { ...(own.columns || {}) };
      own.ignore = (own.ignore || merged(rule()).ignore || []).filter((name) => name !== title);
      delete own.columns[key];
      if (given === NOT_USED) own.ignore.push(title);
      else if (given !== "") own.columns[key] = given;
    });
  };
  return input;
}

function drawErrors() {
  byId("errors").replaceChildren(...(state.errors.length ? [element("p", { className: "error" }, "The profile is not right, and not applied:"),
    element("ul", {}, ...state.errors.map((one) => element("li", { className: "error" }, `${one.line ? `line ${one.line}: ` : ""}${one.message}: ${one.help}`)))] : []));
}

function drawResult() {
  drawErrors();
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
  made.push(drawBits(message.fields), element("table", { className: "fields" }, row("th", "at", "bits", "name", "type", "unit", "formula"),
    ...message.fields.map((one) => row("td", one.at, one.count ? `${one.count} x ${one.bits}` : one.bits, one.name, one.type, one.unit, one.formula))));
  return made;
}

function drawBits(fields) {
  const end = Math.min(Math.ceil(Math.max(...fields.map((one) => one.at + (one.size || 8))) / 8), 32);
  const made = [];
  for (let byte = 0; byte < end; byte += 1) {
    made.push(element("span", { className: "byte" }, String(byte)));
    const isLsb = (state.node.bit_order || "lsb0") === "lsb0";
    for (let place = 0; place < 8;) {
      const bit = (at) => byte * 8 + (isLsb ? 7 - at : at);
      const owner = (at) => fields.findIndex((one) => one.at <= bit(at) && bit(at) < one.at + one.size);
      const first = owner(place);
      let width = 1;
      while (place + width < 8 && owner(place + width) === first) width += 1;
      const cell = element("span", { className: first < 0 ? "free" : "", title: first < 0 ? "no field" : fields[first].name }, first < 0 ? "" : fields[first].name);
      cell.style.gridColumn = `span ${width}`;
      made.push(cell);
      place += width;
    }
  }
  return element("div", { className: "bits", role: "img", "aria-label": "layout of the bits" }, ...made);
}

// --- actions

byId("previous").onclick = () => show(number - 1);
byId("next").onclick = () => show(number + 1);
byId("make").onclick = () => send("/api/rule", { index: null, rule: { tables: { head: head() }, columns: Object.fromEntries(
  table.titles.filter((title) => ["name", "type", "unit"].includes(title.toLowerCase())).map((title) => [title, title.toLowerCase()])),
  ignore: table.titles.filter((title) => title && !["name", "type", "unit"].includes(title.toLowerCase())) } }).then(() => byId("rule").elements.namedItem("what").focus());
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
byId("save").onclick = async () => {
  const done = await send("/api/save", null);
  if (!done) return;
  const checked = `icdgen check: ${done.check.length ? count(done.check.length, "finding") : "no findings"}`;
  const rest = done.is_complete ? "" : "; the errors below are left";
  byId("saved").textContent = `${done.files.join("; ")}; ${done.files.length > 1 ? checked : "no ICD yet"}${rest}`;
};
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
  byId("roles").replaceChildren(element("option", { value: NOT_USED }),
    ...Object.entries(state.roles).map(([role, meaning]) => element("option", { value: role, label: `${role}: ${meaning}` })));
  if (state.tables.length) await show(1);
  else byId("title").textContent = "No table was found in the document.";
})();
