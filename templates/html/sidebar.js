"use strict";
/* Groups of the sidebar that are folded: what is in them is the same on all pages of a node, and comes when they are unfolded. */
(() => {
  const contents = document.querySelector("[data-contents]")?.dataset.contents;

  function item([text, url]) {
    const [line, link] = ["li", "a"].map((tag) => document.createElement(tag));
    link.href = url;
    link.textContent = text;
    line.append(link);
    return line;
  }

  for (const group of document.querySelectorAll("#sidebar [data-group]")) {
    group.addEventListener("toggle", async () => {
      await icdgenLoad(contents);
      group.querySelector("ul").replaceChildren(...globalThis.icdgenContents[group.dataset.group].map(item));
    }, { once: true });
  }
})();
