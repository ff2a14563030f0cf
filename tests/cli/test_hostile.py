"""Unusual or hostile use of the command line gives an error message and a status, never
a traceback.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

from tests.conftest import DEMO, ROOT


@pytest.fixture
def shell(tmp_path):
    """Return a function ``shell("icdgen check x.yaml >/dev/full")`` that runs bash in
    ``tmp_path`` and returns status, output and errors.
    """
    (tmp_path / "bin").mkdir()
    command = tmp_path / "bin" / "icdgen"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m icdgen "$@"\n')
    command.chmod(0o755)

    def run(line: str, **more: str) -> subprocess.CompletedProcess:
        path = os.pathsep.join([str(command.parent), os.environ["PATH"]])
        environment = (
            os.environ | {"PYTHONPATH": str(ROOT / "codegen"), "PATH": path} | more
        )
        # Buffered output fails later, and in more places.
        environment.pop("PYTHONUNBUFFERED", None)
        result = subprocess.run(
            ["bash", "-c", line],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=60,
        )
        assert (
            "Traceback" not in result.stderr
            and "Exception ignored" not in result.stderr
        )
        return result

    return run


class TestInput:
    @pytest.mark.parametrize(
        "command", [["check"], ["--lang", "c"], ["fmt"], ["show", "--icd"]]
    )
    def test_an_unreadable_file_is_a_finding(self, icdgen, tmp_path, command):
        (tmp_path / "loop").symlink_to("loop")
        for name in ("nowhere.yaml", "loop", "x" * 5000):
            result = icdgen(*command, name)
            assert (
                result.status == 1
                and "error[ICD001]: cannot read the file" in result.out + result.err
            )

    @pytest.mark.parametrize("command", [["check"], ["fmt"]])
    def test_reading_an_endless_device_ends(self, icdgen, command):
        result = icdgen(*command, "/dev/zero")
        assert (
            result.status == 1
            and "more than the 4,000,000 bytes" in result.out + result.err
        )

    def test_reading_an_endless_frame_ends(self, icdgen, demo):
        result = icdgen("decode", "demo", "146", "@/dev/zero", "--icd", demo)
        assert result.status == 2 and "holds more than 1,000,000 bytes" in result.err

    @pytest.mark.parametrize(
        "command", [["check"], ["fmt"], ["--lang", "c", "--out", "out"]]
    )
    def test_a_folder_without_icds_is_a_mistake(self, icdgen, tmp_path, command):
        (tmp_path / "empty").mkdir()
        result = icdgen(*command, "empty")
        text = result.out + result.err
        assert result.status in (1, 2) and (
            "no file *.yaml" in text or "empty has no ICD" in text
        )

    def test_a_folder_without_icds_does_not_empty_the_output(
        self, icdgen, demo, tmp_path
    ):
        icdgen("--lang", "c", "--out", "out", demo)
        (tmp_path / "empty").mkdir()
        assert icdgen("--lang", "c", "--out", "out", "empty").status == 1
        assert (tmp_path / "out" / "demo.h").is_file()

    @pytest.mark.parametrize(
        "arguments",
        [
            ["check", ""],
            ["--lang", "c", ""],
            ["--lang", "c", "--out", ""],
            ["show", "--icd", ""],
        ],
    )
    def test_an_empty_path_is_not_the_current_folder(self, icdgen, tmp_path, arguments):
        result = icdgen(*arguments)
        assert (
            result.status == 2
            and "the path is empty" in result.err
            and "--help" in result.err
        )
        assert list(tmp_path.iterdir()) == []

    def test_an_icd_through_a_pipe_is_read_once_and_not_cached(self, shell, demo):
        line = f"cat {demo} | icdgen --lang c --out out /dev/stdin"
        assert shell(line).returncode == 0
        other = (
            f"sed 's/Roll Angle/Pitch/' {demo} | icdgen --lang c --out out /dev/stdin"
        )
        assert shell(other).returncode == 0
        assert shell("grep -ri pitch out").stdout

    def test_a_number_of_five_thousand_digits_is_no_message(self, icdgen, demo):
        result = icdgen("decode", "demo", "9" * 5000, "00", "--icd", demo)
        assert (
            result.status == 2
            and "no message of demo has the id" in result.err
            and len(result.err) < 2000
        )

    def test_a_wrong_value_has_a_remedy(self, icdgen, demo):
        assert (
            "help: `icdgen show demo 'Set Roll'`"
            in icdgen("encode", "demo", "20", "roll=nan", "--icd", demo).err
        )
        assert (
            "help: `icdgen show demo 'Estimated Roll'`"
            in icdgen("decode", "demo", "146", "00", "--icd", demo).err
        )


class TestOutput:
    @pytest.mark.parametrize(
        "command", ["check", "show", "--lang c", "--help", "--version", "rule"]
    )
    def test_a_full_disk_is_reported(self, shell, command):
        result = shell(f"icdgen {command} >/dev/full")
        assert (
            result.returncode == 2
            and "the output cannot be written: No space left on device" in result.stderr
        )

    def test_a_full_disk_is_reported_if_nothing_is_generated(self, shell, demo):
        shell(f"icdgen --lang c {demo}")
        assert shell(f"icdgen --lang c {demo} >/dev/full").returncode == 2
        assert shell("icdgen --lang c nowhere.yaml 2>/dev/full").returncode != 0

    def test_a_closed_pipe_ends_the_command_silently(self, shell, demo):
        shell(f"icdgen --lang c {demo}")
        for command in ("show --format json", "rule", f"--lang c {demo}"):
            result = shell(f"set -o pipefail; (sleep 0.5; icdgen {command}) | true")
            assert result.returncode in (0, 141) and result.stderr == ""

    def test_closed_streams_give_no_traceback(self, shell):
        assert shell("icdgen check >&-").returncode == 0
        assert shell("icdgen show cubeacp 146 >&-").returncode == 0
        assert shell("icdgen check nowhere.yaml >&- 2>&-").returncode == 1
        assert (
            "standard input is closed"
            in shell("icdgen decode cubeacp 146 - <&-").stderr
        )

    def test_quiet_prints_nothing_if_nothing_is_generated(self, shell, demo):
        assert [shell(f"icdgen -q --lang c {demo}").stdout for _ in range(2)] == [
            "",
            "",
        ]

    def test_control_characters_in_names_are_escaped(self, icdgen, demo, tmp_path):
        encode = ["encode", "demo", "20", "\x9bx=1", "--icd", demo]
        for arguments in (
            ["rule", "\x1b[31m"],
            ["show", "\x1b[2J"],
            ["--lang", "\u202ec"],
            encode,
        ):
            err = icdgen(*arguments).err
            assert not set(err) & set("\x1b\u202e\x9b")
            assert "\\x1b" in err or "\\u202e" in err or "\\x9b" in err
        (tmp_path / "red\x1b[31m.yaml").write_text(DEMO)
        assert "\\x1b" in icdgen("fmt", "--check", "red\x1b[31m.yaml").out

    def test_any_encoding_of_the_terminal_is_supported(self, shell, demo):
        demo.write_text(DEMO.replace("Roll Angle", "Größe"), encoding="utf-8")
        line = f"icdgen decode demo 146 000000 --icd {demo} --format json | {sys.executable} -m json.tool"
        result = shell(line, PYTHONIOENCODING="ascii")
        assert result.returncode == 0 and "Gr\\u00f6\\u00dfe" in result.stdout
        for encoding in ("ascii", "latin-1", "cp1252"):
            result = shell(
                f"icdgen show demo 146 --icd {demo}", PYTHONIOENCODING=encoding
            )
            assert result.returncode == 0 and "deg" in result.stdout

    def test_a_file_name_that_is_no_text_is_supported(self, shell):
        shell("printf '%s' x > $'a\\xff.yaml'")
        for form in ("text", "json", "github", "sarif"):
            assert shell(f"icdgen check --format {form} $'a\\xff.yaml'").returncode == 1
        assert shell("icdgen fmt $'a\\xff.yaml'").returncode == 1

    def test_without_findings_there_are_no_annotations(self, icdgen, demo):
        assert icdgen("check", "--format", "github", demo).out == ""


class TestSurroundings:
    def test_a_deleted_current_folder_is_reported(self, shell):
        for command in ("check", "--lang c", "show"):
            result = shell(f"mkdir gone; cd gone; rmdir ../gone; icdgen {command}")
            assert (
                result.returncode == 2
                and "the current folder is no longer there" in result.stderr
            )

    def test_a_missing_home_is_not_created(self, shell, demo, tmp_path):
        line = f"unset ICDGEN_CACHE XDG_CACHE_HOME; HOME={tmp_path}/nobody icdgen --lang c --out out {demo}"
        assert shell(line).returncode == 0
        assert not (tmp_path / "nobody").exists()

    @pytest.mark.parametrize("place", ["/dev/null", "demo.h"])
    def test_an_unusable_cache_is_ignored(self, shell, demo, place):
        result = shell(
            f"touch demo.h; ICDGEN_CACHE={place} icdgen --lang c --out out {demo}"
        )
        assert result.returncode == 0 and "files written" in result.stdout


class TestFilesOfOthers:
    def test_a_dependency_file_replaces_no_device_no_input_and_no_output(
        self, icdgen, demo, tmp_path
    ):
        icdgen("--lang", "c", "--out", "out", demo)
        fifo = tmp_path / "fifo"
        os.mkfifo(fifo)
        for target in (fifo, demo, tmp_path / "out" / "demo.h", tmp_path / "out"):
            before = target.lstat()
            assert (
                icdgen("--lang", "c", "--out", "out", "--depfile", target, demo).status
                == 2
            )
            assert target.lstat().st_ino == before.st_ino
        assert demo.read_text() == DEMO

    def test_a_device_or_folder_in_the_place_of_an_output_is_not_replaced(
        self, icdgen, demo, tmp_path
    ):
        (tmp_path / "out").mkdir()
        os.mkfifo(tmp_path / "out" / "demo.h")
        result = icdgen("--lang", "c", "--out", "out", demo)
        assert (
            result.status == 2
            and "demo.h is in the way: it is not a file" in result.err
        )

    def test_fmt_keeps_the_mode_and_follows_links(self, icdgen, demo, tmp_path):
        demo.write_text(DEMO.replace("bits: 4,  name", "bits: 4, name"))
        demo.chmod(0o600)
        link = tmp_path / "link.yaml"
        link.symlink_to(demo)
        assert "formatted" in icdgen("fmt", link).out
        assert link.is_symlink() and demo.stat().st_mode & 0o777 == 0o600
        assert icdgen("fmt", "--check", demo).status == 0


class TestConfig:
    @pytest.mark.parametrize("text", ['out = ""', 'out = "a\\u0000b"', 'icds = [""]'])
    def test_an_empty_path_or_a_nul_is_refused(self, icdgen, tmp_path, text):
        (tmp_path / "icdgen.toml").write_text('lang = ["c"]\n' + text)
        result = icdgen()
        assert result.status == 2 and "an empty text, or a NUL character" in result.err


@pytest.mark.parametrize(
    "text",
    [
        "{{ 1 // 0 }}",
        '{% include "node.h.j2" %}',
        '{{ "\\ud800" }}',
        "{{ ''.join(3) }}",
        b"\xff",
    ],
)
def test_errors_of_a_template_are_reported(icdgen, demo, tmp_path, text):
    own = tmp_path / "mine"
    own.mkdir()
    (own / "node.h.j2").write_bytes(text if isinstance(text, bytes) else text.encode())
    result = icdgen("--lang", "c", "--out", "out", "--templates", "mine", demo)
    assert (
        result.status == 2
        and re.search(r"(node|demo)\.h", result.err)
        and "correct the template" in result.err
    )
    assert not (tmp_path / "out").exists()
