"use strict";
/* The field at the head of every page: finds names, ids, identifiers, and takes frames. */
(() => {
  const root = document.body.dataset.root;
  const input = document.getElementById("search");
  const list = document.getElementById("results");
  let find = null;
  let chosen = -1;
  let whole = ""; // what was pasted, where the field cannot hold its lines

  function load() {
    const index = icdgenLoad("find.js", "search-index.js").then(() => {
      find ??= icdgenFind.finder(globalThis.icdgenSearchIndex);
    });
    Promise.all([index, icdgenFrameLinks.load()]).then(() => {
      if (document.activeElement === input) show();
    });
  }

  function show() {
    if (!find || !icdgenFrameLinks.isLoaded()) return;
    const typed = input.value.trim();
    const text = whole && typed === whole.trim().replace(/\s+/g, " ") ? whole : typed;
    const found = find(text).map((entry) => ({ ...entry, what: entry.kind, url: root + entry.url }));
    const { sure } = find;
    const pasted = typed.length > 3 ? icdgenFrameLinks.of(text) : { links: [], error: "", leftOut: [] };
    const frames = pasted.links.slice(0, 12).map((link) => ({ ...link, what: "frame" }));
    const shown = frames.length ? (sure && found.length ? [...found, ...frames] : frames) : found;
    chosen = shown.length ? 0 : -1;
    list.replaceChildren(...shown.map(option));
    const wrong = !frames.length && pasted.error && icdgenFrameLinks.looksLikeBytes(text) ? `No frame: ${pasted.error}` : "";
    if (pasted.links.length > frames.length) list.append(nothing(`${pasted.links.length - frames.length} more: the box of the first page lists all`));
    for (const one of pasted.leftOut) list.append(nothing(`Not decoded: ${one}`));
    if (wrong || (!shown.length && typed)) list.append(nothing(wrong || "Nothing of that name"));
    open(list.childElementCount > 0);
    mark();
  }

  function nothing(text) {
    const item = document.createElement("li");
    item.className = "nothing";
    item.role = "option";
    item.ariaDisabled = "true";
    item.textContent = text;
    return item;
  }

  function option(entry, number) {
    const item = document.createElement("li");
    const link = document.createElement("a");
    item.id = `result-${number}`;
    item.role = "option";
    link.href = entry.url;
    link.tabIndex = -1;
    for (const [name, text] of [["what", entry.what], ["title", entry.title], ["context", entry.context]]) {
      const span = document.createElement("span");
      span.className = name;
      span.textContent = text;
      link.append(span);
    }
    item.append(link);
    item.addEventListener("pointermove", () => {
      if (chosen === number) return;
      chosen = number;
      mark();
    });
    return item;
  }

  function mark() {
    [...list.children].forEach((item, number) => item.setAttribute("aria-selected", String(number === chosen)));
    if (chosen < 0) {
      input.removeAttribute("aria-activedescendant");
      return;
    }
    input.setAttribute("aria-activedescendant", `result-${chosen}`);
    list.children[chosen].scrollIntoView({ block: "nearest" });
  }

  function open(yes) {
    list.hidden = !yes;
    input.setAttribute("aria-expanded", String(yes));
  }

  input.addEventListener("focus", load);
  input.addEventListener("input", () => (find ? show() : load()));
  input.addEventListener("paste", (event) => {
    const text = event.clipboardData?.getData("text/plain") ?? "";
    if (!/[\r\n]/.test(text.trim())) return;
    event.preventDefault();
    whole = text;
    input.value = text.trim().replace(/\s+/g, " ");
    input.dispatchEvent(new Event("input"));
  });
  input.addEventListener("keydown", (event) => {
    const count = list.querySelectorAll("a").length;
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      if (!count) return;
      event.preventDefault();
      open(true);
      chosen = (chosen + (event.key === "ArrowDown" ? 1 : count - 1)) % count;
      mark();
    } else if (event.key === "Enter") {
      const link = list.children[chosen]?.querySelector("a");
      if (link && !list.hidden) {
        event.preventDefault();
        open(false);
        link.click();
      }
    } else if (event.key === "Escape") {
      open(false);
    }
  });
  document.addEventListener("click", (event) => {
    if (!event.target.closest(".search") || event.target.closest("#results a")) open(false);
  });
  input.closest(".search").addEventListener("focusout", (event) => {
    if (event.relatedTarget && !event.relatedTarget.closest(".search")) open(false);
  });
  document.addEventListener("keydown", (event) => {
    const typing = event.target.closest?.("input, textarea, select, [contenteditable]");
    if ((event.key === "/" && !typing && !event.ctrlKey && !event.metaKey && !event.altKey) || (event.key === "k" && (event.ctrlKey || event.metaKey))) {
      event.preventDefault();
      input.focus();
      input.select();
    }
  });
})();
