"use strict";
/* Runs before anything is shown: says that there are scripts, and takes the theme that was chosen earlier. */
document.documentElement.classList.add("js");
try {
  const chosen = localStorage.getItem("icdgen-theme");
  if (chosen === "light" || chosen === "dark") document.documentElement.dataset.theme = chosen;
} catch {
  /* a browser that keeps nothing: the system's theme holds */
}
