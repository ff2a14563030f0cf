"""The conformance run itself: it agrees with the reference, and it does notice what is
wrong.
"""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from icdgen import codec
from tests.conformance import ROOT, odd, physical
from tests.conformance.build import BuildError, build
from tests.conformance.compare import difference
from tests.conformance.driver import InProcess, Testee
from tests.conformance.icds import icd_of, vectors_of
from tests.conformance.languages import REFERENCE, Language, all_languages
from tests.conformance.reference import Reference
from tests.conformance.run import Batch, Result, batches, drive, run, table


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    return icd_of([odd.write(tmp_path_factory.mktemp("icd"))])


@pytest.fixture(scope="module")
def files(icd):
    return vectors_of(icd)


@pytest.fixture(scope="module")
def asked(icd, files) -> list[Batch]:
    return list(batches(icd, files, 2, 1))


def score(answer, asked) -> Result:
    """What the run finds in a testee that answers like this."""
    result = Result("any")
    for batch in asked:
        drive(InProcess(answer), batch, result)
    return result


def is_found_out(answer, asked) -> bool:
    """Whether the run finds something; it goes no further then."""
    result = Result("any")
    for batch in asked:
        drive(InProcess(answer), batch, result)
        if result.differences:
            return True
    return False


def test_the_reference_answers_every_request_as_it_must(icd, asked):
    result = score(Reference(icd).answer, asked)
    assert result.differences == 0, result.shown
    assert result.messages >= sum(len(node.messages) for node in icd.nodes)
    assert result.vectors > 100 and result.requests > 3000


@pytest.mark.parametrize(
    "change",
    [
        lambda a: (
            a.get("raw", {}).update({"Flag": int(a["raw"]["Flag"])})
            if "Flag" in a.get("raw", {})
            else None
        ),
        lambda a: (
            a.get("raw", {}).update({"Eleven": a["raw"]["Eleven"] ^ 1})
            if "Eleven" in a.get("raw", {})
            else None
        ),
        lambda a: a.update(bytes=a["bytes"].upper()) if "bytes" in a else None,
        lambda a: a["physical"].clear() if "raw" in a else None,
        lambda a: a.update(expected=a["expected"] + 1) if "expected" in a else None,
        lambda a: a.update(field="") if a.get("error") == "range" else None,
        lambda a: a.update(extra=1) if a["ok"] else None,
        lambda a: a.update(error="request") if a.get("error") == "unknown-id" else None,
        lambda a: a.update(name=None) if "name" in a else None,
        lambda a: a.update(ids=a["ids"][::-1]) if len(a.get("ids", ())) == 2 else None,
        lambda a: (
            a.get("special", {}).update({"Ninth": [255]}) if a.get("special") else None
        ),
        lambda a: a.get("limits", {}).clear(),
        lambda a: a.update(node_type=4) if a.get("node_type") == 3 else None,
    ],
)
def test_a_testee_that_is_wrong_in_one_point_is_found_out(icd, asked, change):
    reference = Reference(icd)

    def answer(line: bytes) -> dict:
        made = reference.answer(line)
        change(made)
        return made

    assert is_found_out(answer, asked)


def test_a_setter_that_truncates_is_found_out(icd, asked, monkeypatch):
    nearest = codec.raw_from_physical

    def truncating(field, value):
        return (
            int(field.scale.raw(codec.Fraction(value)))
            if field.scale
            else nearest(field, value)
        )

    monkeypatch.setattr(codec, "raw_from_physical", truncating)
    assert is_found_out(Reference(icd).answer, asked)


def test_a_physical_value_computed_by_multiplication_is_found_out(
    tmp_path, demo, monkeypatch
):
    icd = icd_of([demo])
    field = icd.nodes[0].messages[0].fields[0]
    total, notes = physical.Total("any"), []
    (chunk,) = physical.chunks(field, 0, 16)
    monkeypatch.setattr(codec, "physical_double", lambda field, raw: raw * 0.01)
    physical.sweep(
        InProcess(Reference(icd).answer),
        total,
        icd.nodes[0].messages[0],
        field,
        chunk,
        notes,
    )
    assert total.values == 65536
    assert total.differences > 1000


def test_comparing_is_strict_about_types_and_silent_about_details():
    assert difference({"ok": True, "x": 1}, b'{"ok": true, "x": 1}') is None
    assert difference({"ok": True, "x": 1}, b'{"ok": true, "x": true}')
    assert difference({"ok": True, "x": 1}, b'{"ok": true, "x": 1.0}')
    assert difference({"ok": True, "x": 1}, b'{"ok": true}')
    assert (
        difference({"ok": True, "x": {"y": 1}}, b'{"ok": true, "x": {"y": 2}}')
        == "x.y: 2, expected 1"
    )
    assert (
        difference(
            {"ok": False, "error": "range"},
            b'{"ok": false, "error": "range", "detail": "any"}',
        )
        is None
    )
    assert (
        difference({"ok": True}, b"{")
        and difference({"ok": True}, b"[]")
        and difference({"ok": True}, None)
    )


def test_a_testee_that_dies_is_noticed_and_started_again():
    program = "import sys\nfor line in sys.stdin:\n  print(line.strip(), flush=True)\n  if 'die' in line: sys.exit('gone')"
    testee = Testee([sys.executable, "-c", program])
    assert testee.ask([b"1", b"die", b"2", b"3"]) == [b"1", b"die", None, None]
    assert testee.complaint().strip() == "gone"
    assert testee.ask([b"4"]) == [b"4"]
    assert testee.close() == 0


def test_a_testee_that_falls_silent_does_not_hang_the_run():
    testee = Testee([sys.executable, "-c", "import time; time.sleep(60)"], timeout=0.5)
    assert testee.ask([b"1"]) == [None]
    testee.close()


def test_code_that_does_not_build_is_an_error_with_the_compilers_words(icd, tmp_path):
    def fail(source, out):
        from tests.conformance.build import execute

        execute(sys.executable, "-c", "raise SystemExit('no such header')")

    with pytest.raises(BuildError, match="no such header"):
        build(Language("any", ("c",), (), fail), icd, tmp_path)


def test_what_was_built_from_the_same_source_is_not_built_again(icd, tmp_path):
    built = []

    def note(source, out):
        built.append((source / "c" / "icdgen.h").is_file())
        return ["true"]

    for _ in range(2):
        assert build(Language("any", ("c",), (), note, front=False), icd, tmp_path) == [
            "true"
        ]
    assert built == [True]


def test_the_command_prints_what_starts_a_testee(demo, tmp_path, monkeypatch):
    monkeypatch.setenv("ICDGEN_BUILD", str(tmp_path / "build"))
    made = subprocess.run(
        [sys.executable, "-m", "tests.conformance.testee", "python", str(demo)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert made.returncode == 0, made.stderr
    request = {
        "op": "decode",
        "node": "demo",
        "kind": "telemetry",
        "id": 146,
        "bytes": "2efb01",
    }
    answer = subprocess.run(
        made.stdout,
        shell=True,
        input=json.dumps(request) + "\n",
        capture_output=True,
        text=True,
    )
    assert json.loads(answer.stdout) == {
        "ok": True, "raw": {"Roll Angle": -1234, "Mode": 1}, "physical": {"Roll Angle": "c028ae147ae147ae"}, "bytes": "2efb01",
    }  # fmt: skip


def test_languages_are_found_by_their_modules():
    names = set(all_languages())
    assert {
        "c",
        "c-clang",
        "c-s390x",
        "c-cortex-m",
        "c-cortex-m-no-double",
        "python",
        "rust",
        "rust-debug",
    } <= names
    assert all_languages()["reference"].kind == REFERENCE


def test_the_table_has_a_line_for_each_language(demo):
    icd = icd_of([demo])
    results = run([all_languages()["reference"]], icd, vectors_of(icd))
    assert table(results).splitlines()[1].split()[:3] == [
        "reference",
        f"{results[0].messages:,}",
        f"{results[0].vectors:,}",
    ]
