"use strict";
/* Buttons that copy: bytes, code, vectors, identifiers; whatever carries `data-copy`, be it made later. */
(() => {
  const ICON = "M8 8V4h12v12h-4M4 8h12v12H4z";
  const SVG = "http://www.w3.org/2000/svg";

  function button(of) {
    const made = document.createElement("button");
    const icon = document.createElementNS(SVG, "svg");
    const path = document.createElementNS(SVG, "path");
    made.type = "button";
    made.className = "copy";
    made.title = "Copy";
    made.setAttribute("aria-label", "Copy");
    icon.setAttribute("viewBox", "0 0 24 24");
    path.setAttribute("d", ICON);
    icon.append(path);
    made.append(icon);
    made.addEventListener("click", async () => {
      const done = await copied(textOf(of));
      made.classList.toggle("done", done);
      setTimeout(() => made.classList.remove("done"), 1200);
    });
    return made;
  }

  function textOf(element) {
    const other = element.cloneNode(true);
    for (const one of other.querySelectorAll(".copy, .b-note")) one.remove();
    return other.textContent.trim();
  }

  async function copied(text) {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      return selected(text); /* a page from a folder may have no clipboard of its own */
    }
  }

  function selected(text) {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  }

  function equip(within) {
    for (const one of within.querySelectorAll("[data-copy]:not([data-copied])")) {
      one.setAttribute("data-copied", "");
      if (one.matches("pre")) {
        const frame = document.createElement("div");
        frame.className = "copied";
        one.replaceWith(frame);
        frame.append(one, button(one));
      } else {
        one.append(button(one));
      }
    }
  }

  equip(document);
  const decoder = document.getElementById("decoder");
  if (decoder) new MutationObserver(() => equip(decoder)).observe(decoder, { childList: true, subtree: true });
})();
