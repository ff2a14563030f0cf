"use strict";
/* The calculator of checksums. */
(() => {
  const box = document.getElementById("crc-bytes");
  if (!box) return;
  const plan = JSON.parse(document.getElementById("crc-plan").textContent);
  const shown = document.getElementById("crc-values");
  const wrong = document.getElementById("crc-wrong");

  function row(name, text) {
    const [line, term, value] = ["div", "dt", "dd"].map((tag) => document.createElement(tag));
    term.textContent = name;
    value.textContent = text;
    value.className = "n";
    line.append(term, value);
    return line;
  }

  function show() {
    let bytes;
    try {
      bytes = icdgenFrames.parseHex(box.value);
    } catch (error) {
      shown.replaceChildren();
      wrong.textContent = error.message;
      return;
    }
    wrong.textContent = "";
    shown.replaceChildren(...plan.map((facts) => row(facts.name, `0x${icdgenFrames.sum(facts, bytes).toString(16).toUpperCase().padStart(Math.ceil(facts.width / 4), "0")}`)));
  }

  box.addEventListener("input", show);
  show();
})();
