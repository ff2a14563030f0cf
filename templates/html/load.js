"use strict";
/* Scripts of the site that a page needs only now and then: loaded once, in the order given, when they are asked for. */
const icdgenLoad = (() => {
  const root = document.body.dataset.root;
  const asked = new Map();

  function one(name) {
    const src = new URL(root + name, document.baseURI).href;
    if ([...document.scripts].some((script) => script.src === src && !asked.has(name))) return Promise.resolve();
    if (!asked.has(name)) {
      asked.set(name, new Promise((done, failed) => {
        const script = document.createElement("script");
        script.src = src;
        script.async = false;
        script.addEventListener("load", () => done());
        script.addEventListener("error", () => failed(new Error(`${name} is missing`)));
        document.head.append(script);
      }));
    }
    return asked.get(name);
  }

  return (...names) => Promise.all(names.map(one));
})();
