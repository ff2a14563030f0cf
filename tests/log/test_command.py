"""`icdgen log` as a command: list and convert telemetry logs."""

from __future__ import annotations

import subprocess
import sys
from random import Random

import pytest


def icdgen(*words: object) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "icdgen", "log", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def test_a_log_is_listed(write, everything, node_facts):
    path, _ = write(everything, 3, b"rest")
    result = icdgen(path)
    assert result.returncode == 0, result.stderr
    assert (
        "3 entries of" in result.stdout
        and "2020-09-13T12:26:40.000Z to 2020-09-13T12:26:42.014Z" in result.stdout
    )
    assert "note: the last 4 bytes belong to no whole entry" in result.stdout
    for slot in node_facts.mask.bits.values():
        assert slot.name in result.stdout


def test_a_file_that_cannot_be_a_log_is_refused(tmp_path, node_facts):
    header = node_facts.log_file.header_bytes
    for name, data, why in (
        (
            "README.md",
            b"telemetry of zebras, yaks and antelopes " * 100,
            "its entries have no times",
        ),
        ("random.bin", Random(1).randbytes(5000), "its entries have no times"),
        ("ones.bin", b"\xff" * (header + 5000), "its entries have no times"),
    ):
        (tmp_path / name).write_bytes(data)
        for words in ((), ("--out", tmp_path / "out.csv")):
            result = icdgen(tmp_path / name, *words)
            assert (
                result.returncode == 2
                and f"{name} is no log of cubeacp: {why}" in result.stderr
            ), result
    assert not (tmp_path / "out.csv").exists()


def test_a_log_with_a_damaged_entry_is_still_a_log(write, everything, node_facts):
    path, _ = write(everything, 5)
    data = bytearray(path.read_bytes())
    at = node_facts.log_file.header_bytes
    data[at : at + 20] = b"\xff" * 20
    path.write_bytes(data)
    result = icdgen(path)
    assert result.returncode == 1 and "damaged: bytes" in result.stdout


def test_an_implausible_log_gives_a_warning(tmp_path, write, everything, node_facts):
    path, _ = write(everything, 3)
    data, size = path.read_bytes(), node_facts.log_file.header_bytes
    entry = (len(data) - size) // 3
    path.write_bytes(data[:size] + data[-entry:] + data[size:-entry])
    path.with_name("zeros.bin").write_bytes(bytes(5000))
    assert (
        "the mask selects no frame; is this a log of cubeacp?"
        in icdgen(path.with_name("zeros.bin")).stdout
    )
    listed, converted = icdgen(path), icdgen(path, "--format", "csv")
    for output in (listed.stdout, converted.stderr):
        assert "1 bit that no frame has; is this a log of cubeacp?" in output
        assert "time jump at byte" in output
    bits = sorted(node_facts.mask.bits)[:2]
    mask = sum(
        1 << (bit ^ 7 if node_facts.mask.msb0 else bit) for bit in bits
    ).to_bytes(node_facts.mask.size, "little")
    path, _ = write(mask, 3)
    assert "is this a log" not in icdgen(path).stdout


@pytest.mark.parametrize("form", ["csv", "jsonl", "parquet"])
def test_a_log_is_converted(write, everything, form, tmp_path):
    path, _ = write(everything, 5, b"rest")
    out = tmp_path / f"out.{form}"
    result = icdgen(path, "--out", out)
    assert (result.returncode, result.stdout) == (0, "")
    assert "the last 4 bytes belong to no whole entry" in result.stderr
    assert out.stat().st_size > 1000
    assert sorted(p.name for p in tmp_path.iterdir()) == ["log.bin", out.name]


def test_a_conversion_goes_to_standard_output(write, everything):
    path, _ = write(everything, 5)
    assert len(icdgen(path, "--format", "csv", "--head", "2").stdout.splitlines()) == 3
    assert len(icdgen(path, "--format", "jsonl").stdout.splitlines()) == 5


def test_misuse_is_reported_and_leaves_no_file(write, everything, tmp_path):
    path, _ = write(everything, 5)
    short = tmp_path / "short"
    short.write_bytes(b"123")
    for words, text in (
        ((short,), "is no log: it has 3 bytes"),
        ((tmp_path / "missing",), "cannot read"),
        ((tmp_path,), "is a folder"),
        ((path, "--out", "x.doc"), "is not a known format"),
        ((path, "--format", "parquet"), "does not go to standard output"),
        ((path, "--node", "cubemag"), "describes no logs"),
        ((path, "--out", tmp_path / "no" / "x.csv"), "cannot write"),
        ((path, "--out", tmp_path / "no" / "x.parquet"), "cannot write"),
        ((path, "--head", "1"), "--head needs"),
    ):
        result = icdgen(*words)
        assert result.returncode == 2 and text in result.stderr, (words, result.stderr)
        assert "Traceback" not in result.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["log.bin", "short"]


@pytest.mark.parametrize("form", ["csv", "jsonl", "parquet"])
def test_a_conversion_that_fails_at_its_end_leaves_no_file(
    write, everything, tmp_path, form
):
    path, _ = write(everything, 5)
    out = tmp_path / f"out.{form}"
    (out / "occupied").mkdir(parents=True)
    result = icdgen(path, "--out", out)
    assert result.returncode == 2 and f"cannot write {out}" in result.stderr
    assert sorted(each.name for each in tmp_path.iterdir()) == ["log.bin", out.name]


def test_a_conversion_replaces_an_earlier_one(write, everything, tmp_path):
    path, _ = write(everything, 5)
    out = tmp_path / "out.csv"
    out.write_text("earlier")
    assert icdgen(path, "--out", out).returncode == 0
    assert len(out.read_text().splitlines()) == 6


@pytest.mark.parametrize(
    ("count", "entries", "times"),
    [
        (0, "0 entries of", ""),
        (1, "1 entry of", ", 2020-09-13T12:26:40.000Z"),
        (3, "3 entries of", ", 2020-09-13T12:26:40.000Z to 2020-09-13T12:26:42.014Z"),
    ],
)
def test_a_log_is_listed_with_its_size_its_times_and_its_mask(
    write, everything, node_facts, count, entries, times
):
    path, _ = write(everything, count)
    plan_bytes = sum(slot.length for slot in node_facts.mask.bits.values())
    result = icdgen(path)
    first, second, third, *_ = result.stdout.splitlines()
    assert first == f"{path}: log of cubeacp, {path.stat().st_size:,} bytes"
    size = (path.stat().st_size - node_facts.log_file.header_bytes) // max(count, 1)
    if count:
        assert size > plan_bytes and second == f"{entries} {size} bytes{times}"
    assert second.startswith(entries)
    assert third == f"mask {everything.hex(' ')}"
