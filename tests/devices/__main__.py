"""``python -m tests.devices``: how many messages of other protocols icdgen supports,
and whether their values agree with the protocol's library.
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
from tests.devices.protocols import PROTOCOLS
from tests.devices.supported import SupportedNode, supported_messages

AT_ONCE = 400  # messages that are compiled together


@dataclass
class Row:
    """Counts of one protocol: its messages, their support and the agreement in each
    language.
    """

    total: int = 0
    causes: Counter[str] = field(default_factory=Counter)
    nodes: list[SupportedNode] = field(default_factory=list)
    by_language: dict[str, Agreement] = field(default_factory=dict)

    @property
    def supported(self) -> int:
        return sum(len(node.messages) for node in self.nodes)

    @property
    def unread(self) -> Counter[str]:
        """Messages that the library itself never decodes, by cause. They are not
        counted.
        """
        return Counter(
            message.unread
            for node in self.nodes
            for message in node.definitions.messages
            if message.unread
        )

    @property
    def raw_only(self) -> Counter[str]:
        """Supported messages of which some physical values are not supported, by cause."""
        return Counter(
            message.raw_only
            for node in self.nodes
            for message in node.messages
            if message.raw_only
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
    """Convert the messages of a protocol and compare their values with the library's.

    Only the first ``nodes`` nodes, and ``sample`` random messages of each. Raises
    `BuildError`, and `ImportError` if the library is not installed.
    """
    row, batch = Row(by_language={language: Agreement() for language in languages}), []
    for definitions in islice(PROTOCOLS[name].load(), nodes):
        if sample is not None and len(definitions.messages) > sample:
            definitions.messages = random.Random(seed).sample(
                definitions.messages, sample
            )
        node = supported_messages(definitions, folder)
        row.total += sum(not message.unread for message in definitions.messages)
        row.causes.update(node.causes.values())
        row.nodes.append(node)
        if node.messages:
            batch.append(node)
        if sum(len(node.messages) for node in batch) >= AT_ONCE:
            _compare(batch, row, frames, seed, folder)
            batch = []
    _compare(batch, row, frames, seed, folder)
    return row


def _compare(
    nodes: list[SupportedNode], row: Row, frames: int, seed: int, folder: Path
) -> None:
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
            f"{name} ({PROTOCOLS[name].library}): {row.supported} of {row.total} messages supported"
        )
        for cause, count in row.causes.most_common():
            print(f"    {count:5} {cause}")
        for cause, count in row.unread.most_common():
            print(f"    {count:5} not counted: {cause}")
        for cause, count in row.raw_only.most_common():
            print(f"    {count:5} supported, some values only raw: {cause}")
        for language, agreement in row.by_language.items():
            differences += len(agreement.differences)
            print(f"  {language}: {agreement}")
            print(
                "".join(f"    {text}\n" for text in agreement.differences[:10]),
                end="",
                flush=True,
            )
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
