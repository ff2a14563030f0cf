"use strict";
/* The box of the first page: whatever frame is pasted leads to its message. */
(() => {
  const box = document.getElementById("paste");
  const found = document.getElementById("pasted");
  const go = document.getElementById("paste-go");
  let links = [];

  function show() {
    const text = box.value;
    const result = text.trim() ? icdgenFrameLinks.of(text) : { links: [], error: "" };
    ({ links } = result);
    const note = document.createElement("p");
    note.className = links.length ? "note" : "wrong";
    note.textContent = result.error ? (links.length ? `${result.error}: which one is it?` : result.error) : "";
    const list = document.createElement("ul");
    list.append(...links.slice(0, 40).map(item));
    found.replaceChildren(...(note.textContent ? [note] : []), ...(links.length ? [list] : []));
    box.setAttribute("aria-invalid", String(Boolean(result.error) && !links.length));
    return result;
  }

  function item(link) {
    const line = document.createElement("li");
    const anchor = document.createElement("a");
    const about = document.createElement("span");
    anchor.href = link.url;
    anchor.textContent = link.title;
    about.className = "of";
    about.textContent = link.context;
    line.append(anchor, " ", about);
    return line;
  }

  function open() {
    const { error } = show();
    if (links.length && !error) location.assign(links[0].url);
  }

  const ready = (then) => icdgenFrameLinks.load().then(then);
  box.addEventListener("input", () => ready(show));
  box.addEventListener("paste", () => setTimeout(() => ready(open)));
  box.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || event.shiftKey) return;
    event.preventDefault();
    ready(open);
  });
  go.addEventListener("click", () => ready(open));
})();
