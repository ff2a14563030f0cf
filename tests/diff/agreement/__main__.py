"""``python -m tests.diff.agreement``: does the generated code agree with the diff about
what changed on the wire?

Each edit changes a message of the shipped ICDs. Code is generated from the edited ICD,
and the vectors of the unchanged one are run on it. Where the diff finds no change of
the wire, every vector must pass as far as it is about bytes; where it finds one, at
least one must fail; where it finds words only, every vector must pass. Ends with status
0 if that is so.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from tests.conformance.icds import icd_of
from tests.diff.agreement.measure import measure
from tests.diff.agreement.pieces import cases
from tests.mutation.measure import LANGUAGES


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.diff.agreement", description=__doc__
    )
    parser.add_argument("--edits", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lang", default="python", choices=LANGUAGES)
    options = parser.parse_args(arguments)
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        score = measure(
            cases(icd_of(), options.edits, options.seed),
            LANGUAGES[options.lang],
            Path(folder),
        )
    for text in score.wrong:
        print(text)
    print(
        f"{len(score.by_edit)} kinds of edits, {sum(score.by_edit.values())} edits, code in {options.lang}:"
    )
    print(
        f"  a change of the wire: {score.wire}; no change of the wire: {score.no_wire}, words only {score.unchanged}"
    )
    print(f"  disagreements: {len(score.wrong)}")
    print(f"{time.perf_counter() - start:.0f} s")
    return 1 if score.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
