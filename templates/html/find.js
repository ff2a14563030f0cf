"use strict";
/*
 * What a search means: words, identifiers of any language, numbers, phrases such as `table 12`; exact names first, and where
 * nothing fits, what was probably meant.
 *
 * An entry of the index is kind, title, context, further words of its name, what is said about it, exact phrases, address,
 * and then its aliases.
 */
const icdgenFind = (() => {
  const RANKS = { node: 9, message: 9, enumeration: 5, protocol: 8, unit: 2.5, field: 1.5, guide: 1.2, member: 1, erratum: 0.8, note: 0.4 };
  const PAGES = new Set(["node", "message", "enumeration", "protocol", "unit", "guide"]); // a name means these rather than a part of them
  const EXACT = 1;
  const RELATED = 0.9; // another form of the word: `detumble`, `detumbling`
  const PREFIX = 0.8;
  const WITHIN = 0.4;
  const CLOSE = 0.6;
  // Words that generated code puts around names; they say nothing about which one is meant.
  const AROUND = new Set("h t id ids set get const init encode decode from to bytes length len raw physical value is min max try new struct enum class icd messages default unchecked telemetry telecommand limits misfit client send request receive fields".split(" "));

  // Words of a question that say nothing about its subject.
  const QUESTION = new Set("a an and are can do does for from have how i if in is it me mean means my of on or our send sends that the there this to use want we what when where which why with".split(" "));

  // What follows names another message, which the one that is meant repeats.
  const PART = /(?<=\w)_part_\w+$/;

  const lower = (text) => text.normalize("NFKC").toLowerCase(); // I²C is I2C
  const squashed = (text) => lower(text).replace(/[^\p{L}\p{N}]+/gu, "");

  /** Words of a text or an identifier, in small letters. */
  function wordsOf(text) {
    const apart = text.replace(/(\p{Ll}|\p{N})(\p{Lu})/gu, "$1 $2").replace(/(\p{Lu})(\p{Lu}\p{Ll})/gu, "$1 $2");
    return lower(apart).split(/[^\p{L}\p{N}%°µ]+/u).filter(Boolean);
  }

  const plainWords = (text) => lower(text).split(/[^\p{L}\p{N}%°µ]+/u).filter(Boolean);

  /** A word without its ending. */
  const stem = (word) => word.replace(/(?<=\p{L}{4})(?:ing|ed|es|e|s)$/u, "");

  /** Prepares an index: `find(text)` gives at most `most` entries, the best first; `find.sure` tells whether words were found as given. */
  function finder(rows) {
    const vocabulary = new Map();
    const idsOf = (words) => [...new Set(words)].map((word) => {
      if (!vocabulary.has(word)) vocabulary.set(word, vocabulary.size);
      return vocabulary.get(word);
    });
    const entries = rows.map(([kind, title, context, more, about, tags, url, ...aliases]) => ({
      kind, title, context, url,
      own: idsOf([...plainWords(title), ...wordsOf(more), ...aliases.flatMap(plainWords)]),
      named: new Set(idsOf(plainWords(more || title))),
      context_: idsOf(plainWords(context)),
      about: idsOf(plainWords(about)),
      names: [squashed(title), squashed(more)].filter(Boolean),
      aliases: aliases.map(squashed).filter(Boolean),
      tags: new Set(tags ? tags.toLowerCase().split("|") : []),
    }));
    const words = [...vocabulary.keys()];
    const stems = words.map(stem);

    /** How well each word of the vocabulary fits a word of the query. */
    function fits(word, guess) {
      const found = new Float64Array(words.length);
      words.forEach((one, id) => {
        if (one === word) found[id] = EXACT;
        else if (stems[id] === stem(word)) found[id] = RELATED;
        else if (one.startsWith(word)) found[id] = PREFIX;
        else if (word.length > 2 && one.includes(word)) found[id] = WITHIN;
        else if (guess) found[id] = CLOSE * likeness(word, one);
      });
      return found;
    }

    const sure = (value) => (value > WITHIN ? value : 0); // in prose a part of a word says nothing
    const best = (ids, fit) => ids.reduce((most, id) => Math.max(most, fit[id]), 0);

    /** The larger, the better; 0 if a word that matters is missing. */
    function score(entry, asked, fitting, query) {
      let points = 0;
      const covered = new Set();
      for (let at = 0; at < asked.length; at += 1) {
        const fit = fitting[at];
        const own = best(entry.own, fit);
        const value = Math.max(10 * own, 4 * best(entry.context_, fit), 3 * sure(best(entry.about, fit)));
        if (!value && !query.optional[at]) return 0;
        points += value || (query.optional[at] ? 1 : 0);
        for (const id of entry.own) if (fit[id] >= CLOSE / 2 && fit[id] !== WITHIN && fit[id] === own) covered.add(id);
      }
      points /= asked.length;
      const named = [...entry.named].filter((id) => covered.has(id)).length;
      points += (8 * named) / Math.max(entry.named.size, 1);
      if (entry.names.some((name) => name.startsWith(query.squashed))) points += 2;
      return points + exactness(entry, query) + RANKS[entry.kind] - Math.min(entry.title.length, 99) / 200;
    }

    function exactness(entry, query) {
      if (entry.tags.has(query.plain)) return 120;
      if (!query.squashed) return 0;
      if (entry.aliases.includes(query.squashed)) return 95; // below names of pages: an alias may be the name of something elsewhere
      if (entry.names.includes(query.squashed)) return PAGES.has(entry.kind) ? 100 : 2;
      return PAGES.has(entry.kind) && entry.names.some((name) => stem(name) === stem(query.squashed)) ? 90 : 0;
    }

    function find(text, most = 24) {
      const plain = text.trim().toLowerCase().replace(/\s+/g, " ");
      const identifier = /[\p{L}\p{N}](?:_|::|->|\.)[\p{L}_]|\p{Ll}\p{Lu}/u.test(text);
      const every = [...new Set(identifier ? wordsOf(text.replace(PART, "")) : plainWords(plain))].slice(0, 16);
      const subject = every.filter((word) => !QUESTION.has(word));
      find.sure = !plain;
      if (!plain) return [];
      const passes = [[every, false], ...(subject.length && subject.length < every.length ? [[subject, false]] : []), [every, true]];
      for (const [asked, guess] of passes) {
        const query = { plain, squashed: squashed(asked === every ? plain : asked.join(" ")), optional: asked.map((word) => identifier && AROUND.has(word)) };
        const fitting = asked.map((word) => fits(word, guess));
        const found = [];
        for (const entry of entries) {
          const together = guess && query.squashed.length > 5 && entry.names.some((name) => name.includes(query.squashed)) ? 60 : 0;
          const points = Math.max((asked.length && score(entry, asked, fitting, query)) || exactness(entry, query), together);
          if (points) found.push([points, entry]);
        }
        if (!found.length) continue;
        find.sure = !guess;
        return found.sort((a, b) => b[0] - a[0]).slice(0, most).map(([, entry]) => entry);
      }
      return [];
    }
    return find;
  }

  /** 1 for a word that differs by one slip of the hand, less for two; 0 for another word. A slip may swap neighbours. */
  function likeness(word, other) {
    const allowed = word.length < 4 ? 0 : word.length < 8 ? 1 : 2;
    const most = Math.min(other.length, word.length + allowed); // what was not typed to its end yet
    if (!allowed || other.length < word.length - allowed || other.length > word.length + allowed) return 0;
    let [before, row] = [[], Array.from({ length: most + 1 }, (_, at) => at)];
    let older = [];
    for (let i = 1; i <= word.length; i += 1) {
      [older, before, row] = [before, row, [i]];
      let least = i;
      for (let j = 1; j <= most; j += 1) {
        const same = word[i - 1] === other[j - 1];
        row[j] = Math.min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (same ? 0 : 1));
        if (i > 1 && j > 1 && word[i - 1] === other[j - 2] && word[i - 2] === other[j - 1]) row[j] = Math.min(row[j], older[j - 2] + 1);
        least = Math.min(least, row[j]);
      }
      if (least > allowed) return 0;
    }
    return row[most] <= allowed ? 1 - row[most] / 4 : 0;
  }

  return { finder };
})();
if (typeof module !== "undefined") module.exports = icdgenFind;
