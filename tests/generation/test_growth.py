"""The work of a command depends on the declarations, not on the number of elements of
arrays.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from icdgen import backends
from icdgen.loading import load
from icdgen.render import Renderer
from icdgen.show.machine import to_json
from icdgen.show.people import to_text
from icdgen.site import make_site

ICD = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: little, bit_order: lsb0}}
structs:
  - name: Signal
    length: 2
    fields:
      - {{at: 0, bits: 12, name: Level, type: int, unit: C, formula: raw*0.5}}
  - name: Satellite
    length: 12
    fields:
      - {{at: 0, bits: 3, name: System, type: uint}}
      - {{at: 8, name: Signals, struct: Signal, count: 5}}
messages:
  - name: Satellites
    id: 1
    kind: {kind}
    length: 3
    fields:
      - {{at: 0, bits: 16, name: Number, type: uint}}
      - {{at: 24, name: Satellites, struct: Satellite, count: Number, up_to: {most}}}
"""


def calls(work: Callable[[], object]) -> int:
    """Return the number of function calls, which every run repeats exactly."""
    number = 0

    def count(_frame, event: str, _argument) -> None:
        nonlocal number
        number += event in ("call", "c_call")

    gc.collect()
    gc.disable()  # a collection calls finalizers, and what hypothesis registers with it
    sys.setprofile(count)
    try:
        work()
    finally:
        sys.setprofile(None)
        gc.enable()
    return number


def show(path: Path) -> None:
    icd = load([path], languages=[]).icd
    to_json(icd)
    to_text(icd)
    to_text(icd, ["demo", "Satellites"])


def generate(lang: str, path: Path) -> None:
    backend = backends.get(lang)
    list(backend.files(load([path], languages=[lang]).icd, Renderer(lang)))


COMMANDS = {
    "show": show,
    "check": lambda path: load([path]),
    **{
        lang: lambda path, lang=lang: generate(lang, path)
        for lang in ("c", "python", "rust")
    },
    "site": lambda path: make_site([path]),
}


@pytest.mark.parametrize("kind", ["telemetry", "telecommand"])
@pytest.mark.parametrize("command", COMMANDS)
def test_an_array_of_more_elements_takes_no_more_work(command, kind, tmp_path):
    numbers = []
    for most in (64, 1024):
        path = tmp_path / f"up_to_{most}.yaml"
        path.write_text(ICD.format(most=most, kind=kind), encoding="utf-8")
        COMMANDS[command](path)  # fill the caches that all runs share
        numbers.append(calls(lambda path=path: COMMANDS[command](path)))
    assert numbers[-1] < 1.02 * numbers[-2], numbers


KINDS = {
    "plain": "{{at: {at}, bits: 8, name: Own {n}, type: uint}}",
    "overlay": (
        "{{at: {at}, bits: 8, name: Own {n}, type: uint}}\n"
        "      - {{at: {at}, bits: 4, name: Part {n}, type: uint, view: true}}"
    ),
    "optional": "{{at: {at}, bits: 8, name: Own {n}, type: uint, when: {{Kind: {n}}}}}",
}


@pytest.mark.parametrize("kind", KINDS)
def test_check_takes_work_in_proportion_to_the_fields_of_a_message(kind, tmp_path):
    def work_for(count: int) -> int:
        lines = [KINDS[kind].format(at=8 * n, n=n) for n in range(1, count + 1)]
        first = "{at: 0, bits: 8, name: Kind, type: uint}"
        fields = "".join(f"      - {line}\n" for line in (first, *lines))
        head = ICD.partition("structs:")[0].format()
        message = f"  - name: State\n    id: 1\n    kind: telemetry\n    length: {count + 1}\n"
        path = tmp_path / f"{count}.yaml"
        path.write_text(f"{head}messages:\n{message}    fields:\n{fields}")
        return calls(lambda: load([path]))

    work_for(2)  # fill caches before counting
    few, many = work_for(50), work_for(200)
    assert many < 4.4 * few, (few, many)
