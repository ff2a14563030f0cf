"use strict";
/* A frame that was pasted anywhere -> links to its message, with the frame in them. */
const icdgenFrameLinks = (() => {
  const NEEDED = ["frames.js", "packets.js", "pasted.js", "stream.js", "envelopes.js", "recognize.js", "frame-index.js"];
  const root = document.body.dataset.root;
  const OF = { request: "request for", acknowledge: "acknowledge of", refusal: "refusal of" };

  const load = () => icdgenLoad(...NEEDED);
  const isLoaded = () => typeof icdgenRecognize !== "undefined" && Boolean(globalThis.icdgenFrameIndex);

  /** `{ links, error }`: `links` have title, context and url, several if each is as likely. */
  function of(text) {
    try {
      return { links: icdgenRecognize.recognize(globalThis.icdgenFrameIndex, text).map(link), error: "" };
    } catch (error) {
      return { links: (error.readings ?? []).map(link), error: error.message, ambiguous: Boolean(error.readings) };
    }
  }

  function link(one) {
    const told = OF[one.what];
    const hex = [...one.data].map((byte) => byte.toString(16).padStart(2, "0")).join("");
    return {
      title: told ? `${told} ${one.message}` : one.message,
      context: [`${told ? "" : `${one.what} · `}${one.title}`, ...one.remarks].join(" · "),
      url: `${root}${one.url}${told ? "" : `#try=${hex}`}`,
    };
  }

  /** Whether a text looks as if bytes were meant: what is wrong with it is worth saying then. */
  const looksLikeBytes = (text) => text.trim().length > 7 && /^(?:[\s,;:{}[\]().#$\\-]|0[xX]|\\x|[0-9A-Fa-f]{2})+$/.test(text);

  return { load, isLoaded, of, looksLikeBytes };
})();
