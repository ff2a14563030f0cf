"""Arrays in Rust: `[T; N]`, accessors that take the index of an element, and no way to
a panic.
"""

from __future__ import annotations

import pytest

from tests.rust import harness
from tests.rust.conftest import Subject
from tests.rust.test_panics import suspicious, symbols
from tests.rust.tools import USED, Toolchain, run, toolchains

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: -3, name: Active}]}
messages:
  - name: Heat
    id: 1
    kind: telemetry
    length: 9
    fields:
      - {at: 0, bits: 16, count: 3, name: Temperatures, type: int, unit: C, formula: raw*0.01}
      - {at: 48, bits: 12, count: 2, name: Levels, type: uint}
  - name: Everything
    id: 2
    kind: telemetry
    length: 80
    fields:
      - {at: 0, bits: 8, count: 40, name: Octets, type: uint}
      - {at: 320, bits: 8, count: 2, name: Modes, type: enum, enum: Mode}
      - {at: 336, bits: 4, count: 2, name: Narrow Modes, type: enum, enum: Mode}
      - {at: 344, bits: 1, count: 8, name: Flags, type: bool}
      - {at: 352, bits: 32, count: 2, name: Floats, type: float, byte_order: big}
      - {at: 416, bits: 64, count: 2, name: Longs, type: uint, formula: raw*0.1}
      - {at: 544, bits: 12, count: 8, name: Levels, type: int, byte_order: big, bit_order: msb0, formula: raw/3}
  - name: Versions
    id: 3
    kind: telemetry
    length: 12
    fields:
      - {at: 0, bits: 64, name: Software, type: text}
      - {at: 64, bits: 32, name: Serial, type: bytes}
      - {at: 96, bits: 32, name: Extension, type: text, count: rest, up_to: 3}
"""

USER = """\
use icd::demo::{Everything, Heat, Versions};

fn main() {
    let frame = [0x64, 0x00, 0xfa, 0x00, 0xd4, 0xfe, 0x01, 0xf0, 0xff];
    let mut heat = Heat::from_bytes(&frame).unwrap();
    assert_eq!(heat.temperatures, [100, 250, -300]);
    assert_eq!(heat.levels, [1, 4095]);
    assert_eq!(heat.to_bytes().unwrap(), frame);
    assert_eq!(heat.temperatures_c(2), Some(-3.0));
    assert_eq!(heat.temperatures_c(3), None);
    assert_eq!(heat.temperatures_c(usize::MAX), None);
    let error = heat.set_temperatures_c(3, 1.0).unwrap_err();
    assert_eq!(error.to_string(), "`Temperatures` takes an index of its elements");
    let error = heat.set_temperatures_c(0, 1000.0).unwrap_err();
    assert_eq!(error.to_string(), "`Temperatures` takes -327.68 to 327.67 C");
    assert_eq!(heat.temperatures, [100, 250, -300]);
    heat.set_temperatures_c(1, 2.0).unwrap();
    assert_eq!(heat.temperatures, [100, 200, -300]);
    heat.levels[1] = 4096;
    assert_eq!(heat.to_bytes(), Err(icd::Error::Range { field: "Levels", allowed: "0 to 4095" }));
    assert_eq!(Everything::default().octets, [0; 40]);
    let bytes: Vec<u8> = (0..80).collect();
    assert_eq!(Everything::from_bytes(&bytes).unwrap().to_bytes().unwrap(), *bytes);
    let frame = b"1.0 (B)\\0\\x01\\x02\\x03\\xffGPS\\0\\xb0C\\0\\0";
    let versions = Versions::from_bytes(frame).unwrap();
    let shown = r#"Versions: Software "1.0 (B)", Serial [1, 2, 3, 255], Extension ["GPS", [176, 67, 0, 0]], "#;
    assert!(versions.to_string().starts_with(shown), "{versions}");
    assert!(Versions::default().to_string().contains("Extension [], "));
}
"""


@pytest.fixture(scope="module")
def arrays(tmp_path_factory) -> Subject:
    folder = tmp_path_factory.mktemp("arrays")
    (folder / "demo.yaml").write_text(ICD, encoding="utf-8")
    icd = harness.read(folder / "demo.yaml")
    return Subject(icd, harness.generate(icd, folder))


@pytest.mark.parametrize("toolchain", list(toolchains()))
def test_elements_are_values_and_an_index_is_held_to_the_count(
    arrays, toolchain, tmp_path
):
    tools = Toolchain(toolchain)
    (tmp_path / "user.rs").write_text(USER)
    run(
        tools.program(
            tmp_path / "user.rs", tools.library(arrays.crate, *USED), tmp_path / "user"
        )
    )


@pytest.mark.parametrize("level", ["3", "z"])
def test_no_way_to_a_panic_is_left_in_arrays(arrays, level, tmp_path):
    assert suspicious(symbols(arrays, "default", level, tmp_path)) == []


def test_sources_of_arrays_are_formatted_and_clippy_has_nothing_to_say(
    arrays, tmp_path
):
    Toolchain("default").formatted(arrays.crate)
    Toolchain("default").linted(
        arrays.crate, tmp_path, "--crate-type", "lib", "--crate-name", "icd"
    )
