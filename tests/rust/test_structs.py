"""Structs in Rust: types of their own in messages, errors that name the field, and no
way to a panic.
"""

from __future__ import annotations

import pytest

from tests.c.test_structs import ICD
from tests.rust import harness
from tests.rust.conftest import Subject
from tests.rust.test_panics import suspicious, symbols
from tests.rust.tools import USED, Toolchain, run, toolchains

USER = """\
use icd::demo::enums::System;
use icd::demo::{Pair, Satellite, View};
use icd::{Error, Message};

fn main() {
    let frame = [0x32, 0x64, 0x00, 1, 2, 0x12, 0xfe, 0xff, 3, 4, 0xf0, 0x00, 0x80, 5, 6, 7];
    let mut view = View::from_bytes(&frame).unwrap();
    assert_eq!(view.best.system, System::Galileo);
    assert_eq!(view.best.azimuth_deg(), 50.0);
    assert_eq!(view.pairs[0].both[0].azimuth_deg(), -1.0);
    assert_eq!(view.pairs[0].both[1].signals_v(1), Some(1.5));
    assert_eq!(view.pairs[0].both[1].signals_v(2), None);
    assert_eq!(view.to_bytes().unwrap(), frame);
    let shown = "Satellite: System Galileo, Quality 3, Azimuth 50 deg, Signals [0.25, 0.5] V";
    assert_eq!(view.best.to_string(), shown);
    assert!(view.to_string().starts_with("View: Best {System Galileo, Quality 3"));
    view.best.set_azimuth_deg(-2.0).unwrap();
    assert_eq!(view.best.azimuth, -4);
    view.pairs[0].both[1].quality = 16;
    assert_eq!(view.to_bytes(), Err(Error::Range { field: "Quality", allowed: "0 to 15" }));
    assert_eq!(View::default().pairs, [Pair::default()]);
    assert_eq!(Pair::default().version, Pair::VERSION_CONST);
    assert_eq!(Satellite::default(), View::default().best);
    let pairs = View::FIELDS[1];
    assert_eq!((pairs.name, pairs.count, pairs.fields[0].fields[2].unit), ("Pairs", 1, "deg"));
}
"""


@pytest.fixture(scope="module")
def structs(tmp_path_factory) -> Subject:
    folder = tmp_path_factory.mktemp("structs")
    (folder / "demo.yaml").write_text(ICD, encoding="utf-8")
    icd = harness.read(folder / "demo.yaml")
    return Subject(icd, harness.generate(icd, folder))


@pytest.mark.parametrize("toolchain", list(toolchains()))
def test_a_struct_is_a_value_of_its_own_wherever_it_stands(
    structs, toolchain, tmp_path
):
    tools = Toolchain(toolchain)
    (tmp_path / "user.rs").write_text(USER)
    run(
        tools.program(
            tmp_path / "user.rs", tools.library(structs.crate, *USED), tmp_path / "user"
        )
    )


@pytest.mark.parametrize("level", ["3", "z"])
def test_no_way_to_a_panic_is_left_in_structs(structs, level, tmp_path):
    assert suspicious(symbols(structs, "default", level, tmp_path)) == []


def test_sources_of_structs_are_formatted_and_clippy_has_nothing_to_say(
    structs, tmp_path
):
    Toolchain("default").formatted(structs.crate)
    Toolchain("default").linted(
        structs.crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd"
    )
