"""Determines which lines of the vector files fail on changed ICDs.

The reference implementation answers each request of a line, as in the conformance run.
The code is independent of the trace: lines are looked up in the text, and the expected
answers are computed by the code of the conformance run.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from functools import cache

from icdgen.icd.model import Icd
from tests.conformance.cases import (
    DIRECTIONS,
    Case,
    MessageCases,
    enum_cases,
    member_names,
    node_cases,
    node_itself,
    shared_ids,
    shared_names,
)
from tests.conformance.compare import difference
from tests.conformance.reference import Reference
from tests.conformance.robust import line


class Vectors:
    """The vectors of a set of ICDs; ``texts`` are the files by node."""

    def __init__(self, texts: dict[str, str]) -> None:
        self.files = {node: json.loads(text) for node, text in texts.items()}
        self.lines = {node: text.split("\n") for node, text in texts.items()}
        self.names = member_names(self.files)

    @cache  # noqa: B019
    def of_message(self, node: str, name: str) -> list[tuple[int, list[Case]]]:
        """Return each line about a message, with the cases that it demands."""
        return list(self._of_message(node, name))

    def first_message(self, node: str) -> int:
        """Return the line in which the messages begin."""
        return self.lines[node].index('"messages": [') + 1

    def messages_at(self, node: str, numbers: set[int]) -> list[str]:
        """Return the messages to which the lines belong."""
        names: dict[str, None] = {}
        name = ""
        for number, text in enumerate(self.lines[node], 1):
            if (
                text.startswith('{"name":')
                and ',"kind":' in text
                and '"type":' not in text
            ):
                name = json.loads(text.rstrip(",") + "}")["name"]
            if number in numbers and name:
                names[name] = None
        return list(names)

    def _of_message(self, node: str, name: str) -> Iterator[tuple[int, list[Case]]]:
        data = self.files[node]
        message = next(
            candidate for candidate in data["messages"] if candidate["name"] == name
        )
        cases = MessageCases(
            node, message, self.names, data["never_set"], shared_names(data)
        )
        constants = cases.constants()
        of_fields = ("default", "special", "limits")
        at = self._after(node, 0, {"name": name, "kind": message["kind"]}, ",")
        yield (
            at,
            [
                constants._replace(
                    answer={**constants.answer, **dict.fromkeys(of_fields, ...)}
                )
            ],
        )
        for field in message["fields"]:
            at = self._after(node, at, field)
            own = [
                *cases.values_out_of_range(field),
                *(cases.settings(field) if "set" in field else ()),
            ]
            yield at, [_only(constants, field["name"]), *own]
        at = self._after(node, at, {"refused_lengths": message["refused_lengths"]}, "")
        yield at, list(cases.refused_lengths())
        # All routes of a message are tested with its first vector.
        for number, vector in enumerate(message["vectors"]):
            at = self._after(node, at, vector)
            yield at, [*cases.frame(vector), *(cases.routes() if number == 0 else ())]

    def of_node(self, node: str) -> Iterator[tuple[int, list[Case]]]:
        """Yield each line about the node itself, its ids and its enumerations."""
        data = self.files[node]
        for key in ("node_type", "interface_version"):
            if key in data:
                case = node_itself(data)
                yield (
                    self._after(node, 0, {key: data[key]}, ""),
                    [case._replace(answer={"ok": True, key: data[key], ...: ...})],
                )
        for direction in DIRECTIONS:
            at = self._after(node, 0, {direction: data["ids"][direction]}, "")
            alone = {key: value for key, value in data.items() if key != "shared_ids"}
            yield (
                at,
                [
                    case
                    for case in node_cases(alone)
                    if case.request.get("kind") == direction
                ],
            )
        for row in data.get("shared_ids", ()):
            yield (
                self._after(node, 0, row),
                list(shared_ids({**data, "shared_ids": [row]})),
            )
        for enum in data["enums"]:
            yield (
                self._after(node, 0, enum),
                [
                    case
                    for case in enum_cases(data)
                    if case.request["enum"] == enum["name"]
                ],
            )

    def _after(self, node: str, line: int, value: dict, end: str = "}") -> int:
        """Return the number of the next line that begins with the value.

        If ``end`` is empty, the line begins with the only key of the value.
        """
        if end:
            text = _compact(value).removesuffix("}") + end
        else:
            ((key, item),) = value.items()
            text = f'"{key}": {_compact(item)}'
        return next(
            n
            for n, text_of_line in enumerate(self.lines[node][line:], line + 1)
            if text_of_line.startswith(text)
        )


def _compact(value: object) -> str:
    return json.dumps(value, separators=(",", ":"))


def _only(constants: Case, name: str) -> Case:
    """Return the demands of the constants on one field."""
    answer = {"ok": True, ...: ...}
    for key in ("default", "special", "limits"):
        demanded = constants.answer[key]
        own = {
            k: v for k, v in getattr(demanded, "value", demanded).items() if k == name
        }
        if own:
            answer[key] = {**own, ...: ...}
    return constants._replace(answer=answer)


class VectorCheck:
    """Runs vectors on other ICDs."""

    def __init__(self, vectors: Vectors, icd: Icd) -> None:
        self.vectors, self.reference = vectors, Reference(icd)

    def failing(self, lines: Iterable[tuple[int, list[Case]]]) -> set[int]:
        """Return the lines with at least one failing case."""
        return {number for number, cases in lines if any(map(self._fails, cases))}

    def _fails(self, case: Case) -> bool:
        answer = self.reference.answer(line(case.request))
        return difference(case.answer, json.dumps(answer).encode()) is not None
