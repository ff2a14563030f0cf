"use strict";
/* A frame that was pasted anywhere -> links to its message, with the frame in them. */
const icdgenFrameLinks = (() => {
  const NEEDED = ["frames.js", "packets.js", "pasted.js", "stream.js", "framed.js", "recognize.js", "frame-index.js"];
  const root = document.body.dataset.root;
  const OF = { request: "request for", acknowledge: "acknowledge of", refusal: "refusal of" };

  const load = () => icdgenLoad(...NEEDED);
  const isLoaded = () => typeof icdgenRecognize !== "undefined" && Boolean(globalThis.icdgenFrameIndex);

  /**
   * `{ links, error, leftOut }`: `links` have title, context and url, one a frame; several of one frame if each is as
   * likely, with an error. `leftOut` are reports about frames that cannot be decoded.
   */
  function of(text) {
    try {
      const found = icdgenRecognize.recognize(globalThis.icdgenFrameIndex, text);
      return { links: found.map(link), error: "", leftOut: found.flatMap((one) => one.leftOut) };
    } catch (error) {
      return { links: (error.readings ?? []).map(link), error: error.message, leftOut: [] };
    }
  }

  function link(one) {
    const told = OF[one.what];
    const title = told && !one.message ? one.what : told ? `${told} ${one.message}` : one.message;
    const hex = [...one.data].map((byte) => byte.toString(16).padStart(2, "0")).join("");
    return {
      title,
      context: [...(one.time ? [one.time] : []), `${told ? "" : `${one.what} · `}${one.title}`, ...one.remarks.filter((text) => !text.startsWith("left out: "))].join(" · "),
      url: `${root}${one.url}${told ? "" : `#try=${hex}`}`,
    };
  }

  /** Whether a text looks as if bytes were meant: what is wrong with it is worth saying then. */
  const looksLikeBytes = (text) => text.trim().length > 7 && /^(?:[\s,;:{}[\]().#$\\-]|0[xX]|\\x|[0-9A-Fa-f]{2})+$/.test(text);

  return { load, isLoaded, of, looksLikeBytes };
})();
