"use strict";
/* On every page: the theme, tabs that remember, and folded parts that open for whoever is sent there. */
(() => {
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

  // Folds

  /** What an address leads to may lie in folded parts. */
  function unfold() {
    let target = null;
    try {
      target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    } catch {
      return; /* no text that was encoded */
    }
    if (!target) return;
    const folded = [];
    for (let one = target.closest("details"); one; one = one.parentElement.closest("details")) if (!one.open) folded.push(one);
    for (const one of folded) one.open = true;
    if (folded.length) target.scrollIntoView();
  }

  addEventListener("hashchange", unfold);
  unfold();
})();
