"""Run golden vectors and random frames through every language.

Run ``python -m tests.conformance.run --lang c,python,rust``. Ends with status 0 if
every answer equals that of the reference codec, else 1.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from icdgen import codec
from icdgen.icd.frames import frame_fields
from icdgen.icd.model import Icd
from icdgen.vectors import patterns
from icdgen.vectors.make import frame_vector
from icdgen.vectors.write import raw_json
from tests.conformance import robust
from tests.conformance.build import BuildError, build
from tests.conformance.cases import (
    Case,
    MessageCases,
    member_names,
    node_cases,
    shared_names,
)
from tests.conformance.compare import difference
from tests.conformance.driver import Answering, InProcess, Testee
from tests.conformance.icds import COMMITTED, icd_of, read_vectors, vectors_of
from tests.conformance.languages import REFERENCE, SELFTEST, Language, all_languages
from tests.conformance.reference import Reference

SHOWN = 20  # differences printed of each language


@dataclass
class Result:
    """Result of one language."""

    name: str
    messages: int = 0
    vectors: int = 0
    frames: int = 0
    requests: int = 0
    seconds: float = 0.0
    differences: int = 0
    shown: list[str] = field(default_factory=list)

    def differs(self, text: str) -> None:
        self.differences += 1
        if len(self.shown) < SHOWN:
            self.shown.append(text)


@dataclass
class Batch:
    """Requests that belong together, ready to be sent to every language."""

    lines: list[bytes]
    answers: list[dict]
    about: list[str]
    messages: int = 0
    vectors: int = 0
    frames: int = 0


def batches(
    icd: Icd, files: dict[str, dict], frames: int, seed: int
) -> Iterator[Batch]:
    """Yield all requests to each testee."""
    enums = member_names(files)
    yield _bad_lines()
    for node in icd.nodes:
        data = files[node.name]
        yield from _batch(f"node {node.name}", node_cases(data))
        spoken = [*icd.included(node), node]
        for declaring in spoken:
            for message in files[declaring.name]["messages"]:
                cases = MessageCases(
                    node.name, message, enums, data["never_set"], shared_names(data)
                )
                label = f"{node.name} {message['name']!r}"
                count = len(message["vectors"])
                for batch in _batch(label, cases.all()):
                    batch.messages, batch.vectors, count = 1, count, 0
                    yield batch
        own = {message["name"]: message for message in data["messages"]}
        for message in node.messages:
            if frames:
                cases = MessageCases(
                    node.name,
                    own[message.name],
                    enums,
                    data["never_set"],
                    shared_names(data),
                )
                yield from _random(icd, message, cases, frames, seed)
        if data["messages"]:
            yield from _robust(data, enums)


def _batch(label: str, cases: Iterator[Case]) -> Iterator[Batch]:
    batch_cases = list(cases)
    if batch_cases:
        yield Batch(
            [robust.line(c.request) for c in batch_cases],
            [c.answer for c in batch_cases],
            [f"{label}: {c.about}" for c in batch_cases],
        )


def _random(
    icd: Icd, message, cases: MessageCases, frames: int, seed: int
) -> Iterator[Batch]:
    source = random.Random(f"{seed}/{message.node}/{message.name}")
    node, left = icd.node(message.node), frames
    fields = frame_fields(message.layout, node.orders)
    fields_by_name = {field.name: field for field in fields}
    parts = message.layout.parts
    while left:
        count = min(left, 500)
        left -= count
        vector_cases: list[Case] = []
        for _ in range(count):
            frame = source.randbytes(message.length)
            optional = [field for field in fields if field.conditions]
            if parts:
                frame = patterns.cut(
                    message,
                    node,
                    frame,
                    source.randint(parts[-1].fewest, parts[-1].most),
                )
            elif optional and source.random() < 0.7:
                field = source.choice(optional)
                values = {
                    fields_by_name[condition.field]: source.choice(condition.values)
                    for condition in field.conditions
                }
                frame = codec.with_numbers(frame, values)
            row = frame_vector(node, message, "random frame", frame)
            vector = {
                "why": "random frame", "bytes": row.frame.hex(), "encoded": row.encoded.hex(),
                "raw": [raw_json(f, row.raw.get(f.name)) for f in fields],
                "doubles": [row.doubles.get(f.name) for f in fields if f.has_formula],
                "texts": list(row.texts.values()),
            }  # fmt: skip
            vector_cases += cases.frame(vector)
        for batch in _batch(f"{node.name} {message.name!r}", iter(vector_cases)):
            batch.frames = count
            yield batch


def _bad_lines() -> Batch:
    lines = list(robust.bad_lines())
    answers: list[dict] = [{"ok": False, "error": "request"}] * len(lines)
    return Batch(lines, answers, [f"bad line {line[:60]!r}" for line in lines])


def _robust(data: dict, enums: dict) -> Iterator[Batch]:
    lines, answers, about = [], [], []
    largest = max(data["messages"], key=lambda m: len({f["type"] for f in m["fields"]}))
    cases = MessageCases(
        data["node"], largest, enums, data["never_set"], shared_names(data)
    )
    for request, answer in robust.bad_requests(cases):
        lines.append(robust.line(request))
        answers.append(answer)
        about.append(f"bad request {robust.line(request)[:200]!r}")
    yield Batch(lines, answers, about)


def run(
    languages: list[Language],
    icd: Icd,
    files: dict[str, dict],
    frames: int = 0,
    seed: int = 1,
    folder: Path | None = None,
) -> list[Result]:
    """Build and run every language. Raises `BuildError`."""
    return run_batches(languages, icd, batches(icd, files, frames, seed), folder)


def run_batches(
    languages: list[Language],
    icd: Icd,
    batches: Iterable[Batch],
    folder: Path | None = None,
) -> list[Result]:
    """Build and run every language with prepared batches. Raises `BuildError`."""
    results: list[Result] = []
    testees: list[tuple[Result, Answering]] = []
    for language in languages:
        if language.kind == SELFTEST:
            results.append(selftest(language, build(language, icd, folder)))
            continue
        reference = language.kind == REFERENCE
        testee = (
            InProcess(Reference(icd).answer)
            if reference
            else Testee(build(language, icd, folder))
        )
        results.append(Result(language.name))
        testees.append((results[-1], testee))
    for batch in batches if testees else ():
        for result, testee in testees:
            drive(testee, batch, result)
    for result, testee in testees:
        status = testee.close()
        if status:
            result.differs(
                f"the testee ended with status {status}: {testee.complaint()}"
            )
    return results


def drive(testee: Answering, batch: Batch, result: Result) -> None:
    """Send a batch and record every difference."""
    start = time.perf_counter()
    replies = testee.ask(batch.lines)
    result.seconds += time.perf_counter() - start
    for line, expected, about, reply in zip(
        batch.lines, batch.answers, batch.about, replies, strict=True
    ):
        problem = difference(expected, reply)
        if problem:
            result.differs(
                f"{about}\n    sent {line[:300].decode('ascii', 'replace')}\n    {problem}"
            )
            if reply is None:
                result.shown.append(testee.complaint())
                break
    result.messages += batch.messages
    result.vectors += batch.vectors
    result.frames += batch.frames
    result.requests += len(batch.lines)


def selftest(language: Language, command: list[str]) -> Result:
    """Run a self-test, whose last line is JSON: messages, vectors, checks, failures."""
    result, start = Result(language.name), time.perf_counter()
    done = subprocess.run(
        command, capture_output=True, text=True, errors="replace", timeout=600
    )
    result.seconds = time.perf_counter() - start
    try:
        counts = json.loads(done.stdout.strip().splitlines()[-1])
        result.messages, result.vectors, result.requests = (
            counts["messages"],
            counts["vectors"],
            counts["checks"],
        )
        result.differences = counts["failures"]
    except (ValueError, IndexError, KeyError):
        result.differs(
            f"the self-test did not end as it should (status {done.returncode})"
        )
    if done.returncode and not result.differences:
        result.differs(f"status {done.returncode}")
    if result.differences:
        result.shown.append((done.stdout + done.stderr)[-4000:])
    return result


def table(results: list[Result]) -> str:
    """Return a table of the results with one line per language."""
    head = (
        "language",
        "messages",
        "vectors",
        "random frames",
        "requests",
        "differences",
        "seconds",
    )
    rows = [
        (
            r.name,
            f"{r.messages:,}",
            f"{r.vectors:,}",
            f"{r.frames:,}",
            f"{r.requests:,}",
            f"{r.differences:,}",
            f"{r.seconds:.1f}",
        )
        for r in results
    ]
    widths = [
        max(len(row[column]) for row in (head, *rows)) for column in range(len(head))
    ]
    lines = []
    for first, *cells in (head, *rows):
        numbers = (
            text.rjust(width) for text, width in zip(cells, widths[1:], strict=True)
        )
        lines.append("  ".join((first.ljust(widths[0]), *numbers)))
    return "\n".join(lines)


def selected_languages(
    parser: argparse.ArgumentParser, option: str, languages: dict[str, Language]
) -> list[Language]:
    """Return the languages of ``--lang``. Ends the program if one does not exist or its
    tools are not installed.
    """
    names = option.split(",")
    unknown = [name for name in names if name not in languages]
    if unknown:
        parser.error(f"unknown language {unknown[0]}; there are {', '.join(languages)}")
    missing = {tool for name in names for tool in languages[name].missing()}
    if missing:
        parser.error(f"not installed: {', '.join(sorted(missing))}")
    return [languages[name] for name in names]


def print_results(results: list[Result]) -> int:
    """Print the results and return the exit status."""
    for result in results:
        for text in result.shown:
            print(f"{result.name}: {text}")
    print(table(results))
    return 1 if any(result.differences for result in results) else 0


def main(arguments: list[str] | None = None) -> int:
    languages = all_languages()
    parser = argparse.ArgumentParser(
        prog="python -m tests.conformance.run", description=__doc__
    )
    parser.add_argument(
        "--lang",
        default="c,python,rust",
        help=f"comma-separated, of {', '.join(languages)} (default: %(default)s)",
    )
    parser.add_argument(
        "--frames",
        type=int,
        default=20,
        help="random frames a message (default: %(default)s)",
    )
    parser.add_argument(
        "--seed",
        type=int,
        default=1,
        help="of the random frames (default: %(default)s)",
    )
    parser.add_argument(
        "--vectors",
        type=Path,
        help="folder of the vector files (default: generated/vectors, else made now)",
    )
    parser.add_argument(
        "icds", nargs="*", type=Path, help="ICDs: files or folders (default: icd/)"
    )
    options = parser.parse_args(arguments)
    selected = selected_languages(parser, options.lang, languages)
    try:
        icd = icd_of(options.icds)
        committed = options.vectors or (
            COMMITTED if COMMITTED.is_dir() and not options.icds else None
        )
        files = read_vectors(committed) if committed else vectors_of(icd)
        absent = [node.name for node in icd.nodes if node.name not in files]
        if absent:
            raise ValueError(f"{committed} has no vectors of {absent[0]}")
        results = run(selected, icd, files, options.frames, options.seed)
    except (BuildError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    return print_results(results)


if __name__ == "__main__":
    sys.exit(main())
