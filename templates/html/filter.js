"use strict";
/* The filter of a node's messages. */
(() => {
  const filter = document.getElementById("filter");
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
})();
