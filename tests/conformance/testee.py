"""Build a testee if needed and print the command line that starts it: ``python -m
tests.conformance.testee LANG``.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path

from tests.conformance.build import BuildError, build
from tests.conformance.icds import icd_of
from tests.conformance.languages import TESTEE, all_languages


def main(arguments: list[str] | None = None) -> int:
    languages = {
        name: language
        for name, language in all_languages().items()
        if language.kind == TESTEE
    }
    parser = argparse.ArgumentParser(
        prog="python -m tests.conformance.testee", description=__doc__
    )
    parser.add_argument(
        "lang", choices=languages, metavar="LANG", help=f"one of {', '.join(languages)}"
    )
    parser.add_argument(
        "icds", nargs="*", type=Path, help="ICDs: files or folders (default: icd/)"
    )
    options = parser.parse_args(arguments)
    language = languages[options.lang]
    if language.missing():
        print(f"{options.lang} needs {', '.join(language.missing())}", file=sys.stderr)
        return 2
    try:
        print(shlex.join(build(language, icd_of(options.icds))))
    except (BuildError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
