"use strict";
/* The drawing of a frame while it is decoded: bits that are set light up, and boxes hold the values of their fields. */
const icdgenLit = (() => {
  const SVG = "http://www.w3.org/2000/svg";
  const ADVANCE = 0.6; // width of an average character, by font size
  const LINE = 13; // from one line of a name to the next

  function shape(name, attributes, text = "") {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.textContent = text;
    return element;
  }

  /** `place` is the plan of the drawing `svg`; `isSet(bit)` tells of the bits of the frame from its left; `text(key)` is a field's value. */
  function show(svg, place, bits, isSet, text) {
    const { across, cell, left, top, row, rows, first: begin = 0 } = place;
    const marks = [];
    rows.forEach((first, line) => {
      if (first < 0) return;
      for (let column = 0; column < 8 * across && first * 8 + column < bits; column += 1) {
        if (!isSet(begin * 8 + first * 8 + column)) continue;
        const [x, y] = [left + column * cell, top + line * row];
        marks.push(shape("rect", { x, y, width: cell, height: row, class: "glow" }));
        marks.push(shape("rect", { x: x + 1, y: y + row - 3, width: cell - 2, height: 2.5 }));
      }
    });
    for (const link of svg.querySelectorAll("a[data-key]")) marks.push(...value(link, text(Number(link.dataset.key))));
    svg.querySelector(".lit").replaceChildren(...marks);
    svg.classList.add("decoding");
  }

  function* value(link, text) {
    const boxes = [...link.querySelectorAll("rect")].map((one) => ["x", "y", "width", "height"].map((name) => Number(one.getAttribute(name))));
    if (!boxes.length || text === "") return;
    const [x, y, width, height] = boxes.reduce((a, b) => (b[2] * b[3] > a[2] * a[3] ? b : a));
    const name = [...link.querySelectorAll("text:not(.key)")].filter((one) => {
      const [left, top] = ["x", "y"].map((at) => Number(one.getAttribute(at)));
      return left > x && left < x + width && top > y && top <= y + height;
    });
    const labelled = name.length > 0;
    const size = width / (text.length * ADVANCE) >= 12 ? 12 : 10;
    const most = Math.floor((width - 4) / (size * ADVANCE));
    if (most < 1 || (most < 4 && text.length > most)) return;
    const shown = text.length > most ? `${text.slice(0, most - 1)}…` : text;
    makeRoom(name, y, height);
    yield shape("text", { x: x + width / 2, y: labelled ? y + height - 6 : y + height / 2 + 4, class: `value s${size}` }, shown);
  }

  /** The lines of a name move up, as many as there is room for above the value. */
  function makeRoom(lines, y, height) {
    if (!lines.length) return;
    const most = Math.max(Math.floor((height - 16) / LINE), 1);
    const up = y + 12 - Number(lines[0].getAttribute("y"));
    lines.forEach((line, number) => {
      if (up < 0) line.setAttribute("transform", `translate(0 ${up})`);
      line.classList.toggle("over", number >= most);
    });
  }

  function clear(svg) {
    for (const line of svg.querySelectorAll("a text")) line.removeAttribute("transform");
    svg.querySelector(".lit").replaceChildren();
    svg.classList.remove("decoding");
  }

  return { show, clear };
})();
