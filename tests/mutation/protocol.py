"""``python -m tests.mutation.protocol``: changes one number of a protocol section at a
time and asks the unchanged vectors.

A mutant is a node that includes the real one and has nothing of its own but the changed
protocol section, so that several are nodes of one build. Ends with status 0 if each is
refused by ``icdgen check``, is noticed by a vector in every language, or has the very
same facts, from which all code is made.
"""

from __future__ import annotations

import argparse
import copy
import json
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

from icdgen.icd.model import Icd, Message, Node, protocol_of_all
from icdgen.loading import load
from icdgen.protocol import facts
from tests.conformance.build import build
from tests.conformance.compare import difference
from tests.conformance.driver import Answering, InProcess, Testee
from tests.conformance.icds import SHIPPED, icd_of
from tests.conformance.reference import Reference
from tests.conformance.robust import line
from tests.conformance.wire import VECTORS
from tests.mutation.measure import LANGUAGES

REFERENCE = "reference"
OUTCOMES = ("refused", "killed", "same", "survived")
TOGETHER = 40  # mutants of one build
AT_ONCE = 50  # cases that are asked of a mutant before its answers are looked at


@dataclass(frozen=True)
class Mutant:
    """The protocol section of the node ``owner``, with another value at ``path``."""

    owner: str
    path: tuple[str | int, ...]
    value: int | bool

    def __str__(self) -> str:
        return f"{self.owner}: {'.'.join(map(str, self.path))} = {self.value}"

    def changed(self, section: dict[str, Any]) -> dict[str, Any]:
        """A copy of the section with the value in its place."""
        made = copy.deepcopy(section)
        holder: Any = made
        for step in self.path[:-1]:
            holder = holder[step]
        holder[self.path[-1]] = self.value
        return made


def mutants(icd: Icd) -> Iterator[Mutant]:
    """Every number one more and one less, every truth value the other way round;
    reasons of assumptions are words.
    """
    for node in icd.nodes:
        for path, value in _leaves(node.protocol):
            if isinstance(value, bool):
                yield Mutant(node.name, path, not value)
            elif isinstance(value, int):
                yield from (
                    Mutant(node.name, path, value + by)
                    for by in (1, -1)
                    if value + by >= 0
                )


def _leaves(
    value: object, path: tuple[str | int, ...] = ()
) -> Iterator[tuple[tuple[str | int, ...], object]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _leaves(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _leaves(item, (*path, index))
    else:
        yield path, value


class Judge:
    """What `icdgen check` says of a mutant: the ICDs are written anew, errata applied."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.trees = {
            node.name: _plain(node.source)
            for node in load([SHIPPED], check=False).icd.nodes
        }
        for name in self.trees:
            self._write(name, self.trees[name])
        self.known = self._errors()

    def refuses(self, mutant: Mutant) -> bool:
        """Whether it has an error that the unchanged ICDs have not."""
        tree = self.trees[mutant.owner]
        self._write(
            mutant.owner, {**tree, "protocol": mutant.changed(tree["protocol"])}
        )
        try:
            return bool(self._errors() - self.known)
        finally:
            self._write(mutant.owner, tree)

    def _write(self, name: str, tree: dict[str, Any]) -> None:
        (self.folder / f"{name}.yaml").write_text(
            json.dumps(tree), encoding="utf-8"
        )  # which is YAML

    def _errors(self) -> set[tuple[str, str]]:
        found = load([self.folder]).findings
        return {(one.code, one.message) for one in found if one.severity == "error"}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list) else value


def grown(
    icd: Icd, chosen: list[Mutant]
) -> tuple[Icd, list[tuple[Mutant, Node, Node]]]:
    """The ICDs with a node for each mutant and each real node that has the changed
    section; with the real one beside it.
    """
    added = []
    for number, mutant in enumerate(chosen):
        for node in icd.nodes:
            if mutant.owner not in (
                node.name,
                *(one.name for one in icd.included(node)),
            ):
                continue
            own = icd.node(mutant.owner).protocol
            merged = protocol_of_all(
                (
                    replace(one, protocol=mutant.changed(own))
                    if one.name == mutant.owner
                    else one
                )
                for one in (*icd.included(node), node)
            )
            name = f"mutant{number}{node.name}"
            merged = _renamed(merged, node.name, name)
            thin = replace(
                node,
                name=name,
                protocol=merged,
                includes=(node.name,),
                messages=(),
                enums=(),
            )
            added.append((mutant, node, thin))
    return Icd((*icd.nodes, *(thin for _, _, thin in added))), added


def _renamed(value: Any, old: str, new: str) -> Any:
    """The section as the mutant's own: where it names its node, it names the mutant."""
    if isinstance(value, dict):
        return {key: _renamed(item, old, new) for key, item in value.items()}
    if isinstance(value, list):
        return [_renamed(item, old, new) for item in value]
    return new if value == old else value


def measure(
    icd: Icd, chosen: list[Mutant], languages: list[str], folder: Path
) -> dict[Mutant, dict[str, str]]:
    """What became of each mutant in each language."""
    judge = Judge(folder)
    sound = [mutant for mutant in chosen if not judge.refuses(mutant)]
    found: dict[Mutant, dict[str, str]] = {
        m: dict.fromkeys(languages, "refused") for m in chosen
    }
    whole, added = grown(icd, sound)
    cases = {
        node["node"]: node["cases"]
        for node in json.loads(VECTORS.read_text(encoding="utf-8"))["nodes"]
    }
    for language in languages:
        testee: Answering
        testee = (
            InProcess(Reference(whole).answer)
            if language == REFERENCE
            else Testee(build(LANGUAGES[language], whole))
        )
        for mutant in sound:
            found[mutant][language] = "survived"
        for mutant, node, thin in added:
            if found[mutant][language] != "killed" and _kills(
                testee, cases.get(node.name, []), thin.name
            ):
                found[mutant][language] = "killed"
        testee.close()
    for mutant in sound:
        if all(
            _facts(whole, thin) == _facts(whole, node)
            for one, node, thin in added
            if one is mutant
        ):
            found[mutant] = {
                name: "same" if end == "survived" else end
                for name, end in found[mutant].items()
            }
    return found


def _facts(icd: Icd, node: Node) -> object:
    """The facts that code is made from, but for the node that they are of, and for
    remarks.
    """
    return _values(replace(facts.of(icd, node), node=icd.nodes[0], assumptions=()))


def _values(known: Any) -> object:
    """Facts as values that can be compared; nodes and messages are themselves."""
    if is_dataclass(known) and not isinstance(known, Node | Message):
        return {one.name: _values(getattr(known, one.name)) for one in fields(known)}
    if isinstance(known, dict):
        return {key: _values(value) for key, value in known.items()}
    return [_values(value) for value in known] if isinstance(known, tuple) else known


def _kills(testee: Answering, cases: list[dict[str, Any]], name: str) -> bool:
    """Whether any case of the real node is answered otherwise by the mutant."""
    cases = random.Random(1).sample(cases, len(cases))
    for start in range(0, len(cases), AT_ONCE):
        some = cases[start : start + AT_ONCE]
        answers = testee.ask([line({**case["request"], "node": name}) for case in some])
        for case, answer in zip(some, answers, strict=True):
            if answer is None or difference(case["answer"], answer):
                return True
    return False


def table(found: dict[Mutant, dict[str, str]], languages: list[str]) -> str:
    """A line a language, then what is the same and what survived."""
    lines = [
        f"{'language':12}{'mutants':>10}" + "".join(f"{word:>10}" for word in OUTCOMES)
    ]
    for language in languages:
        ends = Counter(one[language] for one in found.values())
        lines.append(
            f"{language:12}{len(found):10,}"
            + "".join(f"{ends[word]:10,}" for word in OUTCOMES)
        )
    for word in OUTCOMES[2:]:
        for mutant, ends in found.items():
            where = [name for name in languages if ends[name] == word]
            if where:
                lines.append(
                    f"{word}: {mutant}"
                    + ("" if len(where) == len(languages) else f" ({', '.join(where)})")
                )
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.mutation.protocol", description=__doc__
    )
    parser.add_argument(
        "--lang",
        default="reference,c,python,rust",
        help="comma-separated (default: %(default)s)",
    )
    parser.add_argument("--sample", type=int, help="so many mutants, chosen at random")
    options = parser.parse_args(arguments)
    icd, languages = icd_of(), options.lang.split(",")
    chosen = list(mutants(icd))
    if options.sample is not None:
        chosen = random.Random(0).sample(chosen, min(options.sample, len(chosen)))
    with tempfile.TemporaryDirectory() as folder:
        found: dict[Mutant, dict[str, str]] = {}
        for start in range(0, len(chosen), TOGETHER):
            found |= measure(
                icd, chosen[start : start + TOGETHER], languages, Path(folder)
            )
    print(table(found, languages))
    return int(any("survived" in ends.values() for ends in found.values()))


if __name__ == "__main__":
    sys.exit(main())
