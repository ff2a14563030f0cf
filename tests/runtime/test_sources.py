"""The runtimes are plain source: compilers, linters, type checkers and formatters
accept them unchanged.
"""

from __future__ import annotations

import sys

import pytest

from tests.conftest import ROOT
from tests.rust.tools import STD, Toolchain, run, toolchains

C, PYTHON, RUST = (ROOT / "runtime" / name for name in ("c", "python", "rust"))
SELFTEST = ROOT / "runtime" / "c-selftest"
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only")


@pytest.mark.parametrize(
    "command",
    [
        ("black", "--check", "--quiet", "."),
        ("ruff", "check", "--no-cache", "."),
        ("mypy", "--strict", "--cache-dir={}", "."),
    ],
    ids=lambda command: command[0],
)
def test_python_is_formatted_linted_and_typed(command, tmp_path):
    run(sys.executable, "-m", *(word.format(tmp_path) for word in command), cwd=PYTHON)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_every_c_file_stands_alone_and_compiles_without_a_warning(compiler, tmp_path):
    headers = sorted((*C.rglob("*.[ch]"), *SELFTEST.glob("*.h")))
    assert len(headers) > 40
    for header in headers:
        for language, standard in (("c", "c99"), ("c++", "c++11")):
            program = tmp_path / f"{header.stem}_{header.suffix[1:]}.{language}"
            program.write_text(
                f'#include "{header}"\n#include "{header}"\ntypedef int something;\n'
            )
            # A single file lacks functions of the other files.
            shared = ("-DICDGEN_SHARED",) if header.parent.name == "wire" else ()
            run(
                compiler,
                f"-std={standard}",
                *STRICT,
                *shared,
                "-I",
                C,
                "-x",
                language,
                program,
            )


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_the_c_self_test_compiles_without_a_warning(compiler):
    run(compiler, "-std=c99", *STRICT, "-I", C, SELFTEST / "icdgen_selftest.c")


@pytest.mark.needs("clang-format")
def test_c_is_as_clang_format_lays_it_out():
    run(
        "clang-format",
        "--dry-run",
        "-Werror",
        *sorted((*C.rglob("*.[ch]"), *SELFTEST.iterdir())),
    )


@pytest.mark.parametrize("options", [(), STD], ids=["core", "std"])
@pytest.mark.parametrize("name", list(toolchains()))
def test_rust_is_formatted_linted_and_documented(name, options, tmp_path):
    toolchain, main = Toolchain(name), RUST / "src" / "lib.rs"
    toolchain.formatted(main)
    toolchain.linted(
        main,
        tmp_path,
        "--crate-type",
        "lib",
        "--crate-name",
        "icdgen_runtime",
        *options,
    )
    toolchain.documented(main, tmp_path, *options)


def test_no_template_is_left_in_them():
    files = [
        path
        for folder in (C, PYTHON, RUST)
        for path in folder.rglob("*.*")
        if path.suffix in (".h", ".py", ".rs")
    ]
    assert len(files) > 70
    assert [
        path
        for path in files
        if any(mark in path.read_text("utf-8") for mark in ("{{ ", "{% ", "{# "))
    ] == []
