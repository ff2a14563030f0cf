"""``python -m tests.mutation.protocol``: changes one number of a protocol section at a
time and runs the unchanged vectors.

A mutant is a node that includes the original node and has only the changed protocol
section, so that one build has several mutants. The exit status is 0 if each mutant is
rejected by ``icdgen check``, is detected by a vector in every language, or has exactly
the same facts, from which all code is generated.
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
AT_ONCE = 50  # number of cases after which the answers of a mutant are compared


@dataclass(frozen=True)
class Mutant:
    """The protocol section of the node ``owner``, with another value at ``path``."""

    owner: str
    path: tuple[str | int, ...]
    value: int | bool

    def __str__(self) -> str:
        return f"{self.owner}: {'.'.join(map(str, self.path))} = {self.value}"

    def changed(self, section: dict[str, Any]) -> dict[str, Any]:
        """Return a copy of the section with the changed value."""
        changed = copy.deepcopy(section)
        holder: Any = changed
        for step in self.path[:-1]:
            holder = holder[step]
        holder[self.path[-1]] = self.value
        return changed


def mutants(icd: Icd) -> Iterator[Mutant]:
    """Yield a mutant for every number plus and minus one, and for every inverted truth
    value.
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


class Checker:
    """Runs `icdgen check` on a mutant.

    The ICDs are written to a folder of their own, with errata applied.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.trees = {
            node.name: _plain(node.source)
            for node in load([SHIPPED], check=False).icd.nodes
        }
        for name in self.trees:
            self._write(name, self.trees[name])
        self.known_errors = self._errors()

    def refuses(self, mutant: Mutant) -> bool:
        """Return whether the mutant has an error that the unchanged ICDs do not have."""
        tree = self.trees[mutant.owner]
        self._write(
            mutant.owner, {**tree, "protocol": mutant.changed(tree["protocol"])}
        )
        try:
            return bool(self._errors() - self.known_errors)
        finally:
            self._write(mutant.owner, tree)

    def _write(self, name: str, tree: dict[str, Any]) -> None:
        (self.folder / f"{name}.yaml").write_text(
            json.dumps(tree), encoding="utf-8"
        )  # which is YAML

    def _errors(self) -> set[tuple[str, str]]:
        findings = load([self.folder]).findings
        return {
            (finding.code, finding.message)
            for finding in findings
            if finding.severity == "error"
        }


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list) else value


def with_mutants(
    icd: Icd, chosen: list[Mutant]
) -> tuple[Icd, list[tuple[Mutant, Node, Node]]]:
    """Return the ICDs with a node for each mutant and each node that has the changed
    section.

    The list has each mutant with its original node and its own node.
    """
    added = []
    for number, mutant in enumerate(chosen):
        for node in icd.nodes:
            if mutant.owner not in (
                node.name,
                *(included.name for included in icd.included(node)),
            ):
                continue
            own = icd.node(mutant.owner).protocol
            merged = protocol_of_all(
                (
                    replace(part, protocol=mutant.changed(own))
                    if part.name == mutant.owner
                    else part
                )
                for part in (*icd.included(node), node)
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
    """Return the section of the mutant: the name of the original node is replaced by
    its own.
    """
    if isinstance(value, dict):
        return {key: _renamed(item, old, new) for key, item in value.items()}
    if isinstance(value, list):
        return [_renamed(item, old, new) for item in value]
    return new if value == old else value


def measure(
    icd: Icd, chosen: list[Mutant], languages: list[str], folder: Path
) -> dict[Mutant, dict[str, str]]:
    """Return the result of each mutant in each language."""
    checker = Checker(folder)
    sound = [mutant for mutant in chosen if not checker.refuses(mutant)]
    results: dict[Mutant, dict[str, str]] = {
        m: dict.fromkeys(languages, "refused") for m in chosen
    }
    extended, added = with_mutants(icd, sound)
    cases = {
        node["node"]: node["cases"]
        for node in json.loads(VECTORS.read_text(encoding="utf-8"))["nodes"]
    }
    for language in languages:
        testee: Answering
        testee = (
            InProcess(Reference(extended).answer)
            if language == REFERENCE
            else Testee(build(LANGUAGES[language], extended))
        )
        for mutant in sound:
            results[mutant][language] = "survived"
        for mutant, node, thin in added:
            if results[mutant][language] != "killed" and _kills(
                testee, cases.get(node.name, []), thin.name
            ):
                results[mutant][language] = "killed"
        testee.close()
    for mutant in sound:
        if all(
            _facts(extended, thin) == _facts(extended, node)
            for owner, node, thin in added
            if owner is mutant
        ):
            results[mutant] = {
                name: "same" if end == "survived" else end
                for name, end in results[mutant].items()
            }
    return results


def _facts(icd: Icd, node: Node) -> object:
    """Return the facts from which code is generated, without the node and the
    assumptions.
    """
    return _values(replace(facts.of(icd, node), node=icd.nodes[0], assumptions=()))


def _values(fact: Any) -> object:
    """Return facts as values that can be compared; nodes and messages are not
    converted.
    """
    if is_dataclass(fact) and not isinstance(fact, Node | Message):
        return {
            field.name: _values(getattr(fact, field.name)) for field in fields(fact)
        }
    if isinstance(fact, dict):
        return {key: _values(value) for key, value in fact.items()}
    return [_values(value) for value in fact] if isinstance(fact, tuple) else fact


def _kills(testee: Answering, cases: list[dict[str, Any]], name: str) -> bool:
    """Return whether the mutant answers any case of the original node differently."""
    # In random order, a failing case is found after fewer cases.
    cases = random.Random(1).sample(cases, len(cases))
    for start in range(0, len(cases), AT_ONCE):
        batch = cases[start : start + AT_ONCE]
        answers = testee.ask(
            [line({**case["request"], "node": name}) for case in batch]
        )
        for case, answer in zip(batch, answers, strict=True):
            if answer is None or difference(case["answer"], answer):
                return True
    return False


def table(results: dict[Mutant, dict[str, str]], languages: list[str]) -> str:
    """Return a line for each language, then the mutants with the same meaning and the
    survivors.
    """
    lines = [
        f"{'language':12}{'mutants':>10}" + "".join(f"{word:>10}" for word in OUTCOMES)
    ]
    for language in languages:
        ends = Counter(by_language[language] for by_language in results.values())
        lines.append(
            f"{language:12}{len(results):10,}"
            + "".join(f"{ends[word]:10,}" for word in OUTCOMES)
        )
    for word in OUTCOMES[2:]:
        for mutant, ends in results.items():
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
        results: dict[Mutant, dict[str, str]] = {}
        for start in range(0, len(chosen), TOGETHER):
            results |= measure(
                icd, chosen[start : start + TOGETHER], languages, Path(folder)
            )
    print(table(results, languages))
    return int(any("survived" in ends.values() for ends in results.values()))


if __name__ == "__main__":
    sys.exit(main())
