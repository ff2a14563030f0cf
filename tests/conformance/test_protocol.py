"""The conformance run agrees with the reference codec, and it detects testees with
errors.
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
def reference_batches(icd, files) -> list[Batch]:
    return list(batches(icd, files, 2, 1))


def score(answer, reference_batches) -> Result:
    """Return the result of a run of a testee that answers with this function."""
    result = Result("any")
    for batch in reference_batches:
        drive(InProcess(answer), batch, result)
    return result


def is_error_detected(answer, reference_batches) -> bool:
    """Return whether the run detects a difference. It stops at the first one."""
    result = Result("any")
    for batch in reference_batches:
        drive(InProcess(answer), batch, result)
        if result.differences:
            return True
    return False


def test_the_reference_passes_its_own_run(icd, reference_batches):
    result = score(Reference(icd).answer, reference_batches)
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
def test_the_run_detects_a_testee_with_a_single_error(icd, reference_batches, change):
    reference = Reference(icd)

    def answer(line: bytes) -> dict:
        changed = reference.answer(line)
        change(changed)
        return changed

    assert is_error_detected(answer, reference_batches)


def test_the_run_detects_a_setter_that_truncates(icd, reference_batches, monkeypatch):
    nearest = codec.raw_from_physical

    def truncating(field, value):
        return (
            int(field.scale.raw(codec.Fraction(value)))
            if field.scale
            else nearest(field, value)
        )

    monkeypatch.setattr(codec, "raw_from_physical", truncating)
    assert is_error_detected(Reference(icd).answer, reference_batches)


def test_the_run_detects_a_physical_value_computed_by_multiplication(
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


def test_a_comparison_checks_types_and_ignores_details():
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


def test_a_testee_that_dies_is_restarted():
    program = "import sys\nfor line in sys.stdin:\n  print(line.strip(), flush=True)\n  if 'die' in line: sys.exit('gone')"
    testee = Testee([sys.executable, "-c", program])
    assert testee.ask([b"1", b"die", b"2", b"3"]) == [b"1", b"die", None, None]
    assert testee.complaint().strip() == "gone"
    assert testee.ask([b"4"]) == [b"4"]
    assert testee.close() == 0


def test_a_testee_that_stops_answering_does_not_hang_the_run():
    testee = Testee([sys.executable, "-c", "import time; time.sleep(60)"], timeout=0.5)
    assert testee.ask([b"1"]) == [None]
    testee.close()


def test_a_failed_build_is_an_error_with_the_output_of_the_compiler(icd, tmp_path):
    def fail(source, out):
        from tests.conformance.build import execute

        execute(sys.executable, "-c", "raise SystemExit('no such header')")

    with pytest.raises(BuildError, match="no such header"):
        build(Language("any", ("c",), (), fail), icd, tmp_path)


def test_a_build_from_the_same_source_comes_from_the_cache(icd, tmp_path):
    built = []

    def note(source, out):
        built.append((source / "c" / "icdgen.h").is_file())
        return ["true"]

    for _ in range(2):
        assert build(Language("any", ("c",), (), note, front=False), icd, tmp_path) == [
            "true"
        ]
    assert built == [True]


def test_the_command_prints_the_command_line_of_a_testee(demo, tmp_path, monkeypatch):
    monkeypatch.setenv("ICDGEN_BUILD", str(tmp_path / "build"))
    result = subprocess.run(
        [sys.executable, "-m", "tests.conformance.testee", "python", str(demo)],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert result.returncode == 0, result.stderr
    request = {
        "op": "decode",
        "node": "demo",
        "kind": "telemetry",
        "id": 146,
        "bytes": "2efb01",
    }
    answer = subprocess.run(
        result.stdout,
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
