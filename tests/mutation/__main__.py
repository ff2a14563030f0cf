"""``python -m tests.mutation``: changes one number of the ICDs at a time and runs the
unchanged vectors on the changed code.

Prints these numbers for each language and kind of change: the mutants; the mutants that
the rules reject (and how many of these the vectors kill, if code can be generated from
them nevertheless); the mutants that the vectors kill; the mutants that provably have
the same meaning as the unchanged ICD; and the survivors. The exit status is 0 if there
are no survivors.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from pathlib import Path

from tests.conformance.icds import COMMITTED, icd_of, read_vectors, vectors_of
from tests.mutation.measure import LANGUAGES, Score, measure
from tests.mutation.mutants import mutants

HEAD = ("mutants", "refused", "and killed", "not killed", "killed", "same", "survived")


def table(scores: dict[str, Score], refused: dict[str, int]) -> str:
    """Return a block for each language, with a line for each kind of change."""
    lines = [f"{'language':10}{'change':12}" + "".join(f"{word:>12}" for word in HEAD)]
    for name, score in scores.items():
        kinds = list(
            dict.fromkeys([*refused, *score.killed, *score.same, *score.survived])
        )
        rows = []
        for kind in kinds:
            ends = (score.killed[kind], score.same[kind], len(score.survived[kind]))
            rows.append(
                (
                    refused.get(kind, 0) + sum(ends),
                    refused.get(kind, 0),
                    score.rejected_and_killed[kind],
                    score.rejected_and_survived[kind],
                    *ends,
                )
            )
        rows.append(tuple(map(sum, zip(*rows, strict=True))))
        for kind, row in zip([*kinds, "all"], rows, strict=True):
            lines.append(
                f"{name:10}{kind:12}" + "".join(f"{number:12,}" for number in row)
            )
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.mutation", description=__doc__
    )
    parser.add_argument(
        "--lang",
        default="c,python,rust",
        help=f"of {', '.join(LANGUAGES)} (default: %(default)s)",
    )
    parser.add_argument(
        "--sample", type=int, help="so many mutants, chosen by --seed (default: all)"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", help="only this kind of change")
    parser.add_argument(
        "--table",
        type=Path,
        help="a file that holds the table so far, for it takes the better part of an hour",
    )
    parser.add_argument(
        "icds", nargs="*", type=Path, help="ICDs: files or folders (default: icd/)"
    )
    options = parser.parse_args(arguments)
    names = options.lang.split(",")
    for name in names:
        if name not in LANGUAGES:
            parser.error(f"unknown language {name}")
        if LANGUAGES[name].missing():
            parser.error(f"{name} needs {', '.join(LANGUAGES[name].missing())}")
    icd = icd_of(options.icds)
    files = (
        read_vectors(COMMITTED)
        if COMMITTED.is_dir() and not options.icds
        else vectors_of(icd)
    )
    chosen = [mutant for mutant in mutants(icd) if options.kind in (None, mutant.kind)]
    if options.sample is not None:
        chosen = random.Random(options.seed).sample(
            chosen, min(options.sample, len(chosen))
        )
    start = time.perf_counter()
    scores: dict[str, Score] = {}
    refused: dict[str, int] = {}
    for done, scores, refused in measure(
        icd, files, chosen, [LANGUAGES[name] for name in names]
    ):
        print(f"{done:,} of {len(chosen):,} mutants", file=sys.stderr, flush=True)
        if options.table:
            options.table.write_text(report(scores, refused))
    print(report(scores, refused), end="")
    print(f"{len(chosen):,} mutants in {time.perf_counter() - start:.0f} s")
    return (
        1
        if any(
            score.crashed or any(score.survived.values()) for score in scores.values()
        )
        else 0
    )


def report(scores: dict[str, Score], refused: dict[str, int]) -> str:
    """Return a line for each survivor and each crash of a testee, and the table."""
    lines = []
    for name, score in scores.items():
        for kind, changes in score.survived.items():
            lines += [f"{name}: survivor: {kind}: {text}" for text in changes]
        lines += [f"{name}: the testee died of {text}" for text in score.crashed]
    return "\n".join([*lines, table(scores, refused)]) + "\n"


if __name__ == "__main__":
    sys.exit(main())
