"use strict";
/* The filter of errata and notes: by words, node, message and confidence. */
(() => {
  const filter = document.getElementById("errata-filter");
  const entries = [...document.querySelectorAll("details.erratum")];
  const words = entries.map((one) => one.textContent.toLowerCase());
  const folds = [...document.querySelectorAll("details.fold")];
  const before = folds.map((one) => one.open);
  let active = false;

  function apply() {
    const { text, node, message, confidence } = filter.elements;
    const wanted = text.value.toLowerCase().split(/\s+/).filter(Boolean);
    const name = message.value.trim().toLowerCase();
    const was = active;
    active = Boolean(wanted.length || node.value || name || confidence.value);
    entries.forEach((one, at) => {
      const { node: owner, confidence: level, messages } = one.dataset;
      one.hidden = !(
        (!node.value || owner === node.value) && (!confidence.value || level === confidence.value) &&
        (!name || messages.toLowerCase().split("|").some((title) => title.includes(name))) && wanted.every((word) => words[at].includes(word))
      );
    });
    folds.forEach((fold, at) => {
      const some = fold.querySelector("details.erratum:not([hidden])") !== null;
      fold.hidden = !some;
      if (active) fold.open = some;
      else if (was) fold.open = before[at];
    });
    for (const section of document.querySelectorAll("main > section")) section.hidden = !section.querySelector("details.fold:not([hidden])");
    const shown = entries.filter((one) => !one.hidden).length;
    document.getElementById("matches").textContent = shown === entries.length ? `${shown} entries` : `${shown} of ${entries.length}`;
  }

  filter.addEventListener("input", apply);
  filter.addEventListener("submit", (event) => event.preventDefault());
  const asked = new URLSearchParams(location.search);
  for (const [key, value] of asked) if (filter.elements[key]) filter.elements[key].value = value;
  apply();
})();
