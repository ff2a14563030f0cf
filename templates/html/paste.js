"use strict";
/* The box of the first page: whatever frame is pasted leads to its message; several are listed. */
(() => {
  const box = document.getElementById("paste");
  const found = document.getElementById("pasted");
  const go = document.getElementById("paste-go");
  const MOST = 200; // links that are listed
  let links = [];

  function show() {
    const text = box.value;
    const result = text.trim() ? icdgenFrameLinks.of(text) : { links: [], error: "", leftOut: [] };
    ({ links } = result);
    const notes = [];
    if (result.error) notes.push(links.length ? note(`${result.error}: which one is it?`) : wrong(result.error));
    else if (links.length > 1) notes.push(note(`${links.length} frames:`));
    const list = document.createElement("ul");
    list.append(...links.slice(0, MOST).map(item));
    const after = result.leftOut.map((one) => wrong(`Not decoded: ${one}`));
    if (links.length > MOST) after.unshift(note(`${links.length - MOST} more are not listed; \`icdgen decode\` shows all`));
    found.replaceChildren(...notes, ...(links.length ? [list] : []), ...after);
    box.setAttribute("aria-invalid", String(Boolean(result.error) && !links.length));
    return result;
  }

  const note = (text) => paragraph("note", text);
  const wrong = (text) => paragraph("wrong", text);

  function paragraph(kind, text) {
    const element = document.createElement("p");
    element.className = kind;
    element.textContent = text;
    return element;
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
    const { error, leftOut } = show();
    if (links.length === 1 && !error && !leftOut.length) location.assign(links[0].url);
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
