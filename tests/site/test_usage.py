"""The code on the pages compiles and runs with the output of the backends."""

from __future__ import annotations

import subprocess
import sys

from icdgen import backends
from icdgen.backends.html import usage
from icdgen.backends.packages import Packages
from icdgen.describe import describe
from icdgen.render import Renderer
from tests.conftest import ROOT
from tests.site.conftest import program

GENERATED = ROOT / "generated"
RENDER = Renderer.of_backend(backends.get("html"))


def snippets(icd, key: str) -> list[str]:
    messages = [message for node in describe(icd).nodes for message in node.messages]
    return [snippet(message, key) for message in messages]


def snippet(message, key: str) -> str:
    """Return the code of a message in a language, with the default names of packages."""
    return next(
        snippet.text
        for snippet in usage.snippets(message, message, Packages(), RENDER)
        if snippet.key == key
    )


def indented(text: str, prefix: str = "    ") -> str:
    return "\n".join(prefix + line for line in text.splitlines())


def test_the_c_of_every_message_compiles_without_a_warning(shipped, tmp_path):
    parts = [
        "#include <stdbool.h>",
        "#define use(x) ((void)(x))",
        "void send(unsigned id, const void *data, unsigned size);",
    ]
    for number, text in enumerate(snippets(shipped, "c")):
        include, _, body = text.partition("\n")
        body = body.replace("    double ", "    volatile double ")
        parts += [include, f"void f{number}(const uint8_t *buffer, size_t length);"]
        parts += [
            f"void f{number}(const uint8_t *buffer, size_t length)\n{{\n    (void)buffer;\n    (void)length;\n{indented(body)}\n}}"
        ]
    source = tmp_path / "usage.c"
    source.write_text("\n".join(parts), "utf-8")
    flags = "-std=c99 -Wall -Wextra -Werror -Wno-unused-variable -Wno-unused-but-set-variable -fsyntax-only".split()
    done = subprocess.run(
        [program("gcc"), *flags, "-I", GENERATED / "c", source],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[:4000]


def test_the_python_of_every_message_runs(shipped, tmp_path):
    parts = ["sent = []", "def send(id, frame): sent.append((id, frame))"]
    for node in describe(shipped).nodes:
        for message in node.messages:
            parts += [
                f"buffer = bytes({message.model.length})",
                snippet(message, "python"),
            ]
    source = tmp_path / "usage.py"
    source.write_text("\n".join([*parts, "print(len(sent))"]), "utf-8")
    environment = {
        "PYTHONPATH": str(GENERATED / "python"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    done = subprocess.run(
        [sys.executable, source], capture_output=True, text=True, env=environment
    )
    commands = sum(
        m.telecommand_id is not None for node in shipped.nodes for m in node.messages
    )
    assert done.returncode == 0 and int(done.stdout) == commands, done.stderr


def test_the_rust_of_every_message_compiles(shipped, tmp_path):
    parts = [
        "#![allow(unused_variables, dead_code, non_snake_case)]",
        "fn send(_id: u8, _frame: &[u8]) {}",
    ]
    for number, text in enumerate(snippets(shipped, "rust")):
        parts.append(
            f"fn f{number}(buffer: &[u8]) -> Result<(), icd::Error> {{\n{indented(text)}\n    Ok(())\n}}"
        )
    source = tmp_path / "usage.rs"
    source.write_text("\n".join([*parts, "fn main() {}"]), "utf-8")
    library = tmp_path / "libicd.rmeta"  # no machine code: nothing is run
    rustc = program("rustc")
    for arguments in (
        [
            "--crate-type",
            "rlib",
            "--crate-name",
            "icd",
            "--emit",
            "metadata",
            "-o",
            library,
            GENERATED / "rust/src/lib.rs",
        ],
        [
            "--extern",
            f"icd={library}",
            "--emit",
            "metadata",
            "-o",
            tmp_path / "usage.rmeta",
            source,
        ],
    ):
        done = subprocess.run(
            [rustc, "--edition", "2021", *arguments], capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr[:4000]
