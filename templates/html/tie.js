"use strict";
/* Drawing and table are tied together: a field that is pointed at, focused or linked to in one lights up in the other. */
(() => {
  let lit = [];
  let pointed = null;
  const fieldOf = (element) => element?.closest?.(".message [data-key]") ?? null;

  /** Every element of the same field in the same message. */
  function tied(element) {
    return element ? [...element.closest(".message").querySelectorAll(`[data-key="${element.dataset.key}"]`)] : [];
  }

  function light() {
    for (const one of lit) one.classList.remove("tied");
    lit = [pointed, document.activeElement, document.querySelector(":target")].flatMap((one) => tied(fieldOf(one)));
    for (const one of lit) one.classList.add("tied");
  }

  function point(element) {
    if (element === pointed) return;
    pointed = element;
    light();
  }

  document.addEventListener("pointerover", (event) => point(fieldOf(event.target)));
  document.documentElement.addEventListener("pointerleave", () => point(null));
  for (const name of ["focusin", "focusout"]) document.addEventListener(name, () => queueMicrotask(light));
  for (const name of ["hashchange", "load"]) addEventListener(name, light); // only then there is a target
})();
