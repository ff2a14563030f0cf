"""``python -m tests.devices``: a table of what the format holds of other protocols, and
of how the values agree.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from icdgen.loading import load
from tests.conformance.build import build
from tests.conformance.driver import Testee
from tests.conformance.languages import all_languages
from tests.devices.agree import Agreement, compare
from tests.devices.held import Held, held
from tests.devices.protocols import PROTOCOLS

AT_ONCE = 400  # messages that are compiled together


@dataclass
class Row:
    """One protocol."""

    total: int = 0
    causes: Counter[str] = field(default_factory=Counter)
    nodes: list[Held] = field(default_factory=list)
    by_language: dict[str, Agreement] = field(default_factory=dict)

    @property
    def held(self) -> int:
        return sum(len(node.messages) for node in self.nodes)

    @property
    def unread(self) -> Counter[str]:
        """What stands in the library's tables and is not counted, for the library
        itself reads no frame of it.
        """
        return Counter(
            one.unread
            for node in self.nodes
            for one in node.definitions.messages
            if one.unread
        )

    @property
    def raw_only(self) -> Counter[str]:
        """Of what is held, why some physical values are not."""
        return Counter(
            one.raw_only for node in self.nodes for one in node.messages if one.raw_only
        )


def measure(
    name: str,
    languages: list[str],
    folder: Path,
    frames: int = 20,
    seed: int = 1,
    sample: int | None = None,
    nodes: int | None = None,
) -> Row:  # fmt: skip
    """What the format holds of a protocol, and how it agrees with the library; of
    ``nodes`` nodes, ``sample`` messages of each.

    Raises `BuildError`, and `ImportError` where the library is not installed.
    """
    row, taken = Row(by_language={language: Agreement() for language in languages}), []
    for definitions in islice(PROTOCOLS[name].load(), nodes):
        if sample is not None and len(definitions.messages) > sample:
            definitions.messages = random.Random(seed).sample(
                definitions.messages, sample
            )
        one = held(definitions, folder)
        row.total += sum(not one.unread for one in definitions.messages)
        row.causes.update(one.causes.values())
        row.nodes.append(one)
        if one.messages:
            taken.append(one)
        if sum(len(node.messages) for node in taken) >= AT_ONCE:
            _compare(taken, row, frames, seed, folder)
            taken = []
    _compare(taken, row, frames, seed, folder)
    return row


def _compare(nodes: list[Held], row: Row, frames: int, seed: int, folder: Path) -> None:
    if not nodes or not row.by_language:
        return
    files = [folder / f"{node.definitions.name}.yaml" for node in nodes]
    icd = load(files).icd
    for language, agreement in row.by_language.items():
        testee = Testee(
            build(all_languages()[language], icd, folder / "build"), timeout=600
        )
        for node in nodes:
            compare(
                node.definitions.name, node.messages, testee, frames, seed, agreement
            )
        testee.close()


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.devices", description=__doc__
    )
    parser.add_argument(
        "protocols",
        nargs="*",
        default=list(PROTOCOLS),
        help=f"of {', '.join(PROTOCOLS)} (default: all)",
    )
    parser.add_argument(
        "--lang",
        default="c,python",
        help="comma-separated, empty for none (default: %(default)s)",
    )
    parser.add_argument(
        "--frames", type=int, default=20, help="of each message (default: %(default)s)"
    )
    parser.add_argument(
        "--sample",
        type=int,
        help="so many messages of each node, at random (default: all)",
    )
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    languages = [name for name in options.lang.split(",") if name]
    differences = 0
    for name in options.protocols:
        with tempfile.TemporaryDirectory() as folder:
            row = measure(
                name,
                languages,
                Path(folder),
                options.frames,
                options.seed,
                options.sample,
            )
        print(
            f"{name} ({PROTOCOLS[name].library}): {row.held} of {row.total} messages held"
        )
        for cause, count in row.causes.most_common():
            print(f"    {count:5} {cause}")
        for cause, count in row.unread.most_common():
            print(f"    {count:5} not counted: {cause}")
        for cause, count in row.raw_only.most_common():
            print(f"    {count:5} held, some values only raw: {cause}")
        for language, one in row.by_language.items():
            differences += len(one.differences)
            print(f"  {language}: {one}")
            print(
                "".join(f"    {text}\n" for text in one.differences[:10]),
                end="",
                flush=True,
            )
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
