"""Run the golden vectors of framing through every language.

Run ``python -m tests.conformance.wire --lang c,python,rust``. Ends with status 0 if
every answer equals that of the vectors, else 1.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path

from icdgen.icd.model import Icd
from icdgen.vectors import protocol
from tests.conformance import robust
from tests.conformance.build import BuildError, build
from tests.conformance.driver import Answering, InProcess, Testee
from tests.conformance.icds import COMMITTED, icd_of
from tests.conformance.languages import REFERENCE, SELFTEST, Language, all_languages
from tests.conformance.reference import Reference
from tests.conformance.run import (
    Batch,
    Result,
    drive,
    print_results,
    selected_languages,
)

VECTORS = COMMITTED / "protocol.json"


def vectors_of(icd: Icd) -> dict:
    """Generate the content of the protocol's vector file."""
    return json.loads(protocol.protocol_vectors_text(icd) or '{"nodes": []}')


def batches(files: dict) -> Iterator[Batch]:
    """Yield all requests to each testee: the cases of a node, and requests that must be
    refused.
    """
    for node in files["nodes"]:
        cases = node["cases"]
        about = [
            f"{node['node']} {case['request']['op']}: {case['why']}" for case in cases
        ]
        lines = [robust.line(case["request"]) for case in cases]
        yield Batch(lines, [case["answer"] for case in cases], about, 1, len(cases))
        bad = list(refused(cases))
        answers: list[dict] = [{"ok": False, "error": "request"}] * len(bad)
        yield Batch(
            [robust.line(request) for request in bad],
            answers,
            [f"bad request {request}" for request in bad],
        )
    if files["nodes"]:
        nobody = {**files["nodes"][0]["cases"][0]["request"], "node": "nobody"}
        yield Batch(
            [robust.line(nobody)],
            [{"ok": False, "error": "unknown-node"}],
            ["a node that does not exist"],
        )


def refused(cases: list[dict]) -> Iterator[dict]:
    """Yield the first request of each operation, with each key missing or of another
    type.
    """
    optional = {
        "address",
        "senders",
        "end",
        "limit",
        "crc",
        "node",
        "settings",
        "block",
        "size",
        "all",
        "values",
    }
    seen = set()
    for case in cases:
        request = case["request"]
        if request["op"] in seen or not case["answer"]["ok"]:
            continue
        seen.add(request["op"])
        for key in request:
            if key != "op":
                yield {
                    **request,
                    key: [None] if key == "settings" else {"no": "such value"},
                }
                if key not in optional and (request["op"], key) not in (
                    ("dos_time", "value"),
                    ("procedure", "bus"),
                    ("procedure", "bytes"),
                ):
                    yield {k: v for k, v in request.items() if k != key}
        if isinstance(request.get("bytes"), str):
            yield {**request, "bytes": request["bytes"] + "0"}


def run(
    languages: list[Language], icd: Icd, files: dict, folder: Path | None = None
) -> list[Result]:
    """Build and run every language. Raises `BuildError`."""
    results, testees = [], []
    for language in languages:
        reference = language.kind == REFERENCE
        testee: Answering = (
            InProcess(Reference(icd).answer)
            if reference
            else Testee(build(language, icd, folder))
        )
        results.append(Result(language.name))
        testees.append(testee)
    for batch in batches(files):
        for result, testee in zip(results, testees, strict=True):
            drive(testee, batch, result)
    for result, testee in zip(results, testees, strict=True):
        status = testee.close()
        if status:
            result.differs(
                f"the testee ended with status {status}: {testee.complaint()}"
            )
    return results


def main(arguments: list[str] | None = None) -> int:
    languages = {
        name: language
        for name, language in all_languages().items()
        if language.kind != SELFTEST
    }
    parser = argparse.ArgumentParser(
        prog="python -m tests.conformance.wire", description=__doc__
    )
    parser.add_argument(
        "--lang",
        default="c,python,rust",
        help=f"comma-separated, of {', '.join(languages)} (default: %(default)s)",
    )
    parser.add_argument(
        "icds", nargs="*", type=Path, help="ICDs: files or folders (default: icd/)"
    )
    options = parser.parse_args(arguments)
    selected = selected_languages(parser, options.lang, languages)
    try:
        icd = icd_of(options.icds)
        committed = VECTORS.is_file() and not options.icds
        files = (
            json.loads(VECTORS.read_text(encoding="utf-8"))
            if committed
            else vectors_of(icd)
        )
        results = run(selected, icd, files)
    except (BuildError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    return print_results(results)


if __name__ == "__main__":
    sys.exit(main())
