"use strict";
/* On every page: theme, tabs that remember, the filter of a node's messages, and the search. */
(() => {
  const root = document.body.dataset.root;

  function remembered(key) {
    try {
      return localStorage.getItem(key);
    } catch {
      return null;
    }
  }

  function remember(key, value) {
    try {
      localStorage.setItem(key, value);
    } catch {
      /* it holds for this page, then */
    }
  }

  // Theme

  document.getElementById("theme").addEventListener("click", () => {
    const html = document.documentElement;
    const dark = html.dataset.theme ? html.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    html.dataset.theme = dark ? "light" : "dark";
    remember("icdgen-theme", html.dataset.theme);
  });

  // Tabs

  const language = remembered("icdgen-language");
  for (const tab of document.querySelectorAll('.tabs input[type="radio"]')) {
    if (tab.value === language) tab.checked = true;
    tab.addEventListener("change", () => remember("icdgen-language", tab.value));
  }

  // Filter

  const filter = document.getElementById("filter");
  if (filter) {
    const rows = [...document.querySelectorAll("#message-table tbody tr")];
    const words = rows.map((row) => `${row.textContent} ${row.dataset.ids}`.toLowerCase());
    const apply = () => {
      const { text, kind, group, bytes, mask } = filter.elements;
      const wanted = text.value.toLowerCase().split(/\s+/).filter(Boolean);
      const fits = numbers(bytes);
      const logged = mask && numbers(mask);
      let shown = 0;
      rows.forEach((row, index) => {
        const { kind: k, group: g, length: n, mask: m } = row.dataset;
        row.hidden = !(
          (!kind.value || k === kind.value) && (!group?.value || g === group.value) && (!fits || fits(Number(n))) &&
          (!logged || m.split(" ").filter(Boolean).some((bit) => logged(Number(bit)))) && wanted.every((word) => matches(row, words[index], word))
        );
        shown += row.hidden ? 0 : 1;
      });
      document.getElementById("matches").textContent = shown === rows.length ? `${shown} messages` : `${shown} of ${rows.length}`;
    };
    filter.addEventListener("input", apply);
    filter.addEventListener("submit", (event) => event.preventDefault());
    apply();
  }

  /** A number is an id, decimal or 0x; everything else is part of the row's text. */
  function matches(row, text, word) {
    if (/^(0x[0-9a-f]+|[0-9]+)$/.test(word) && row.dataset.ids.split(" ").includes(String(Number(word)))) return true;
    return text.includes(word);
  }

  /** What `6`, `1-8`, `>20`, `<=4` or `any` accept; null for nothing, and for what cannot be read, which is marked. */
  function numbers(box) {
    const word = box.value.replace(/\s+/g, "").toLowerCase();
    const found = /^(?:(\d+)[-–…](\d+)|(<=?|>=?)?(\d+))$/.exec(word);
    box.setAttribute("aria-invalid", String(!found && word !== "" && word !== "any"));
    if (word === "any") return () => true;
    if (!found) return null;
    if (found[1]) return (n) => n >= Number(found[1]) && n <= Number(found[2]);
    const bound = Number(found[4]);
    return { "<": (n) => n < bound, "<=": (n) => n <= bound, ">": (n) => n > bound, ">=": (n) => n >= bound }[found[3]] ?? ((n) => n === bound);
  }

  // Search

  const input = document.getElementById("search");
  const list = document.getElementById("results");
  const RANKS = { node: 0, message: 1, enumeration: 2, field: 3, unit: 4, member: 5, erratum: 6, note: 7 };
  const MOST = 24;
  let index = null;
  let chosen = -1;

  function load() {
    if (index || document.getElementById("search-index")) return;
    const script = document.createElement("script");
    script.id = "search-index";
    script.src = `${root}search-index.js`;
    script.addEventListener("load", () => {
      index = globalThis.icdgenSearchIndex.map(([kind, title, context, more, url]) => {
        const name = title.toLowerCase();
        return { kind, title, context, url, name, tokens: more ? more.toLowerCase().split(" ") : [], all: `${name} ${context.toLowerCase()} ${more.toLowerCase()}` };
      });
      if (document.activeElement === input) show();
    });
    document.head.append(script);
  }

  /** The smaller, the better; null if a word is missing. */
  function score(entry, query, words) {
    if (!words.every((word) => entry.all.includes(word))) return null;
    let points = RANKS[entry.kind];
    if (entry.tokens.includes(query)) points -= entry.kind === "field" ? 5 : 60;
    else if (entry.name === query) points -= 50;
    else if (entry.name.startsWith(query)) points -= 30;
    else if (words.every((word) => entry.name.includes(word))) points -= entry.name.includes(` ${query}`) ? 20 : 10;
    return points + Math.min(entry.name.length, 99) / 100;
  }

  function find(text) {
    const query = text.trim().toLowerCase().replace(/\s+/g, " ");
    if (!query) return [];
    const words = query.split(" ");
    const found = [];
    for (const entry of index) {
      const points = score(entry, query, words);
      if (points !== null) found.push([points, entry]);
    }
    return found.sort((a, b) => a[0] - b[0]).slice(0, MOST).map(([, entry]) => entry);
  }

  function show() {
    if (!index) return;
    const found = find(input.value);
    chosen = found.length ? 0 : -1;
    list.replaceChildren(...found.map(option));
    if (!found.length && input.value.trim()) {
      const nothing = document.createElement("li");
      nothing.className = "nothing";
      nothing.role = "option";
      nothing.ariaDisabled = "true";
      nothing.textContent = "Nothing of that name";
      list.append(nothing);
    }
    open(list.childElementCount > 0);
    mark();
  }

  function option(entry, number) {
    const item = document.createElement("li");
    const link = document.createElement("a");
    item.id = `result-${number}`;
    item.role = "option";
    link.href = root + entry.url;
    link.tabIndex = -1;
    for (const [name, text] of [["what", entry.kind], ["title", entry.title], ["context", entry.context]]) {
      const span = document.createElement("span");
      span.className = name;
      span.textContent = text;
      link.append(span);
    }
    item.append(link);
    item.addEventListener("pointermove", () => {
      if (chosen !== number) {
        chosen = number;
        mark();
      }
    });
    return item;
  }

  function mark() {
    [...list.children].forEach((item, number) => item.setAttribute("aria-selected", String(number === chosen)));
    if (chosen >= 0) {
      input.setAttribute("aria-activedescendant", `result-${chosen}`);
      list.children[chosen].scrollIntoView({ block: "nearest" });
    } else {
      input.removeAttribute("aria-activedescendant");
    }
  }

  function open(yes) {
    list.hidden = !yes;
    input.setAttribute("aria-expanded", String(yes));
  }

  input.addEventListener("focus", load);
  input.addEventListener("input", () => (index ? show() : load()));
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
