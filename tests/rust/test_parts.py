"""Parts of composite messages in Rust: `From` gives them as the messages that are
repeated.
"""

from __future__ import annotations

import pytest

from icdgen.describe import MessageDescription, describe
from icdgen.icd.model import Icd
from tests.conformance import composites
from tests.rust import harness
from tests.rust.conftest import Subject
from tests.rust.test_panics import suspicious, symbols
from tests.rust.tools import USED, Toolchain, run, toolchains


@pytest.fixture(scope="module")
def odd(tmp_path_factory) -> Subject:
    folder = tmp_path_factory.mktemp("parts")
    icd = harness.read(composites.write(folder / "icd"))
    return Subject(icd, harness.generate(icd, folder))


def path(message: MessageDescription) -> str:
    return f"icd::{message.node.name}::{message.camel_name}"


def program(icd: Icd) -> str:
    description, checks = describe(icd), []
    for case in composites.cases(icd):
        lines = [
            f"let message = {path(description.message(case.message))}::from_bytes(&{list(case.frame)}).unwrap();"
        ]
        for one in case.parts:
            part, count = (
                path(description.message(one.part)),
                sum(other.part is one.part for other in case.parts),
            )
            given = (
                f"<[{part}; {count}]>::from(&message)[{one.index}]"
                if count > 1
                else f"{part}::from(&message)"
            )
            lines.append(f"assert_eq!({given}.to_bytes().unwrap(), {list(one.frame)});")
        checks.append("    {\n        " + "\n        ".join(lines) + "\n    }\n")
    assert len(checks) > 3
    return "fn main() {\n" + "".join(checks) + "}\n"


@pytest.mark.parametrize("toolchain", list(toolchains()))
@pytest.mark.parametrize("which", ["odd", "shipped"])
def test_parts_are_what_the_reference_reads_there(request, which, toolchain, tmp_path):
    subject, tools = request.getfixturevalue(which), Toolchain(toolchain)
    (tmp_path / "user.rs").write_text(program(subject.icd))
    run(
        tools.program(
            tmp_path / "user.rs",
            Toolchain(toolchain).library(subject.crate, *USED),
            tmp_path / "user",
        )
    )


@pytest.mark.parametrize("level", ["3", "z"])
def test_no_way_to_a_panic_is_left_in_parts(odd, level, tmp_path):
    assert suspicious(symbols(odd, "default", level, tmp_path)) == []


def test_sources_with_parts_are_tidy(odd, tmp_path):
    Toolchain("default").formatted(odd.crate)
    Toolchain("default").linted(
        odd.crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd"
    )
    Toolchain("default").documented(odd.crate, tmp_path)
