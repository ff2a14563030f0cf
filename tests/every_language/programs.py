"""Compile the claims of all stories to one program for each compiler, and run them.

A program prints each fact before it checks it, and fails at the first claim that is
false. The last line of its output is then the fact.
"""

from __future__ import annotations

import json
import subprocess
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from textwrap import indent

from icdgen.icd.model import Icd
from tests.c import harness as c
from tests.every_language.story import Claim, Story
from tests.python import packages
from tests.rust import harness as rust
from tests.rust.tools import USED, Toolchain

Run = Callable[[Story], None]
"""Function that checks the claims of a story and fails with the first false fact."""

C_HEAD = """\
#include <stdio.h>

#define CHECK(condition) \\
    do { \\
        if (!(condition)) { \\
            fprintf(stderr, "%s\\n", #condition); \\
            return 1; \\
        } \\
    } while (0)
"""


def write_icds(stories: tuple[Story, ...], folder: Path) -> Icd:
    """Write the ICDs of all stories, and load them as one ICD."""
    folder.mkdir()
    for story in stories:
        for node, text in {story.node: story.icd, **story.included}.items():
            (folder / f"{node}.yaml").write_text(text, encoding="utf-8")
    return packages.read(folder)


def in_c(compiler: str, stories: tuple[Story, ...], folder: Path) -> Run:
    """Build a program with a C compiler, with sanitizers and all warnings.

    ``compiler`` is ``gcc``, ``clang`` or ``g++``.
    """
    headers = c.generate(write_icds(stories, folder / "icd"), folder / "c")
    text = "".join(f'#include "{story.node}.h"\n' for story in stories) + C_HEAD
    calls = ""
    for story, number, claim in _numbered(stories, "c"):
        name = f"{story.node}_claim_{number}"
        text += f"\nstatic int {name}(void)\n{{\n"
        text += indent(story.c + claim.c, "    ") + "    return 0;\n}\n"
        calls += (
            f'    if (strcmp(argv[1], "{story.node}") == 0) {{\n'
            f'        puts("{claim.fact}");\n        fflush(stdout);\n'
            f"        if ({name}() != 0) {{\n            return 1;\n        }}\n    }}\n"
        )
    text += "\nint main(int argc, char **argv)\n{\n    (void)argc;\n"
    is_cpp = compiler == "g++"
    source = headers / ("claims.cpp" if is_cpp else "claims.c")
    source.write_text(text + calls + "    return 0;\n}\n", encoding="utf-8")
    # Claims compare doubles that must be equal to the last bit.
    warnings = [option for option in c.WARNINGS if option != "-Wfloat-equal"]
    program = c.compile(
        source,
        "-std=c++17" if is_cpp else "-std=c99",
        *warnings,
        *c.SANITIZERS,
        f"-I{headers}",
        compiler=compiler,
        output=folder / "claims",
    )
    return lambda story: _run(program, story)


def in_rust(toolchain: str, stories: tuple[Story, ...], folder: Path) -> Run:
    """Build a program with a toolchain of `tests.rust.tools`."""
    icd = write_icds(stories, folder / "icd")
    crate = rust.generate(icd, folder)
    text, calls = "", ""
    for story, number, claim in _numbered(stories, "rust"):
        name = f"{story.node}_claim_{number}"
        text += f"#[allow(unused)]\nfn {name}() {{\n"
        text += indent(story.rust + claim.rust, "    ") + "}\n"
        calls += (
            f'    if story == "{story.node}" {{\n'
            f'        println!("{{}}", {json.dumps(claim.fact)});\n        {name}();\n    }}\n'
        )
    head = "fn main() {\n    let story = std::env::args().nth(1).unwrap();\n"
    (folder / "claims.rs").write_text(text + head + calls + "}\n", encoding="utf-8")
    tools = Toolchain(toolchain)
    library = tools.library(crate, *USED)
    program = tools.program(folder / "claims.rs", library, folder / "claims")
    return lambda story: _run(program, story)


def in_python(stories: tuple[Story, ...], folder: Path) -> Run:
    """Generate the package and import it into this process."""
    icd = write_icds(stories, folder / "icd")
    package = packages.write(icd, folder, "story_messages")

    def run(story: Story) -> None:
        for claim in story.claims:
            names: dict[str, object] = {"package": package.module()}
            exec(f"from {package.name}.{story.node} import *", names)
            try:
                exec(story.python + claim.python, names)
            except Exception as error:
                last = traceback.extract_tb(error.__traceback__)[-1]
                code = (story.python + claim.python).splitlines()
                line = code[last.lineno - 1] if last.filename == "<string>" else last
                raise AssertionError(f"{claim.fact}\n{line}\n{error!r}") from error

    return run


def _numbered(
    stories: tuple[Story, ...], language: str
) -> Iterator[tuple[Story, int, Claim]]:
    """Yield the claims that have statements in ``language``."""
    for story in stories:
        for number, claim in enumerate(story.claims):
            if getattr(claim, language):
                yield story, number, claim


def _run(program: Path, story: Story) -> None:
    done = subprocess.run([program, story.node], capture_output=True, text=True)
    facts = done.stdout.splitlines()
    assert facts, f"no claim of {story.node} was checked\n{done.stderr[:2000]}"
    assert done.returncode == 0, f"{facts[-1]}\n{done.stderr[:2000]}"
