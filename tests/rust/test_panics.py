"""No function of the crate can panic or allocate memory.

The tests build an optimised program that uses every function, and search its symbols
for panics and allocators.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from icdgen.describe import describe
from icdgen.icd.model import Icd
from tests.conformance import odd as variable_length
from tests.rust import harness, odd
from tests.rust.conftest import Subject
from tests.rust.tools import Toolchain, run, toolchains

FAST, SMALL = "3", "z"  # levels of optimisation that users choose
HEAD = """\
#![no_std]
#![allow(non_snake_case)]
extern "C" {
    fn this_can_panic() -> !;
}
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe { this_can_panic() }
}
"""
MESSAGE = """\
#[no_mangle] pub fn decode_{name}(bytes: &[u8]) -> Result<{type}, icd::Error> {{ {type}::from_bytes(bytes) }}
#[no_mangle] pub fn encode_{name}(message: &{type}) -> impl Copy {{ message.to_bytes() }}
"""
SCALED = """\
#[no_mangle] pub fn get_{name}(message: &{type}) -> {value} {{ message.{getter}() }}
#[no_mangle] pub fn set_{name}(message: &mut {type}, to: f64) -> Result<(), icd::Error> {{ message.{setter}(to) }}
"""
READ = """\
#[no_mangle] pub fn get_{name}(message: &{type}) -> {value} {{ message.{getter}() }}
"""
READ_ELEMENT = """\
#[no_mangle] pub fn get_{name}(message: &{type}, at: usize) -> Option<f64> {{ message.{getter}(at) }}
"""
ELEMENT = """\
#[no_mangle] pub fn get_{name}(message: &{type}, at: usize) -> Option<f64> {{ message.{getter}(at) }}
#[no_mangle] pub fn set_{name}(message: &mut {type}, at: usize, to: f64) -> Result<(), icd::Error> {{ message.{setter}(at, to) }}
"""
DISPATCHER = """\
#[no_mangle] pub fn dispatch_{name}(id: {id}, bytes: &[u8]) -> Result<{type}, icd::Error> {{ {type}::from_bytes(id, bytes) }}
#[no_mangle] pub fn write_{name}(it: &{type}, to: &mut [u8]) -> Result<usize, icd::Error> {{ it.write_to(to) }}
"""
ENUM = """\
#[no_mangle] pub fn enum_{name}(raw: {raw}) -> Option<&'static str> {{ {type}::from(raw).name() }}
"""
BOXED = "#[no_mangle] pub fn boxed(bytes: &[u8]) -> alloc::boxed::Box<[u8]> { bytes.into() }\n"
WIRE = Path(__file__).parent / "wire.rs"


def everything(icd: Icd) -> Iterator[str]:
    """Yield Rust code that exports each function of the crate that users can call."""
    described = describe(icd)
    for node in described.nodes:
        for message in node.messages:
            name, type_ = (
                f"{node.name}_{message.name}",
                f"icd::{node.name}::{message.camel_name}",
            )
            yield MESSAGE.format(name=name, type=type_)
            for field in (
                field for field in message.declared_members if field.is_scaled
            ):
                getter = field.physical_name
                if field.count:
                    template = ELEMENT if field.is_settable else READ_ELEMENT
                else:
                    template = SCALED if field.is_settable else READ
                value = "Option<f64>" if field.model.conditions else "f64"
                yield template.format(
                    name=f"{name}_{getter}",
                    type=type_,
                    getter=getter,
                    setter=f"set_{getter}",
                    value=value,
                )
        for way, messages in (
            ("telecommand", node.telecommands),
            ("telemetry", node.telemetry),
        ):
            if messages:
                type_ = f"icd::{node.name}::{way.capitalize()}"
                yield DISPATCHER.format(
                    name=f"{node.name}_{way}", type=type_, id=f"u{described.id_bits}"
                )
        for enum in node.enums:
            name, type_ = (
                f"{node.name}_{enum.camel_name}",
                f"icd::{node.name}::enums::{enum.camel_name}",
            )
            yield ENUM.format(
                name=name,
                type=type_,
                raw=f"{'i' if enum.storage.signed else 'u'}{enum.storage.bits}",
            )


def symbols(
    subject, toolchain: str, level: str, folder: Path, more: str = ""
) -> set[str]:
    """Build the program for ``subject`` and return the symbols in its archive."""
    tools = Toolchain(toolchain)
    # The linker plugin generates machine code once, for the complete program.
    library = tools.library(subject.crate, level, "-C", "linker-plugin-lto")
    source = folder / "everything.rs"
    source.write_text(HEAD + "".join(everything(subject.icd)) + more)
    archive = tools.freestanding(source, library, folder / "libeverything.a", level)
    lines = run("nm", "-C", archive).splitlines()
    return {
        line.split(maxsplit=2)[-1].split(" ", 1)[-1] for line in lines if " " in line
    }


ALLOCATORS = {
    "malloc",
    "calloc",
    "realloc",
    "free",
    "__rust_alloc",
    "__rust_alloc_zeroed",
    "__rust_realloc",
    "__rust_dealloc",
}


def suspicious(names: set[str]) -> list[str]:
    """Return the symbols of functions that may panic."""
    parts = ("panic", "_fail", "unwrap")
    return sorted(name for name in names if any(part in name for part in parts))


@pytest.mark.parametrize("toolchain", list(toolchains()))
def test_shipped_messages_cannot_panic(shipped, toolchain, tmp_path):
    names = symbols(shipped, toolchain, FAST, tmp_path, WIRE.read_text())
    assert {"wire_uart_feed", "wire_client_received", "wire_download_next"} <= names
    assert sum(name.startswith("decode_") for name in names) == sum(
        len(node.messages) for node in shipped.icd.nodes
    )
    assert suspicious(names) == []


def test_odd_messages_cannot_panic(strange, tmp_path):
    assert suspicious(symbols(strange, "default", SMALL, tmp_path)) == []


@pytest.mark.parametrize("level", [FAST, SMALL])
def test_arrays_structs_and_parts_cannot_panic(stories, level, tmp_path):
    assert suspicious(symbols(stories, "default", level, tmp_path)) == []


def test_messages_of_variable_length_cannot_panic_or_allocate(
    tmp_path_factory, tmp_path
):
    icd = harness.read_unchecked(*variable_length.variable(tmp_path))
    variable = Subject(icd, harness.generate(icd, tmp_path_factory.mktemp("variable")))
    names = symbols(variable, "default", FAST, tmp_path)
    assert {
        "decode_ublox_nav_sat",
        "dispatch_open_telemetry",
        "dispatch_mux_telemetry",
    } <= names
    assert suspicious(names) == []
    assert {name.split("::")[-1] for name in names} & ALLOCATORS == set()


def test_a_program_without_an_allocator_cannot_allocate(tmp_path):
    """So a program that can be compiled without an allocator does not allocate."""
    (tmp_path / "badly.rs").write_text(f"{HEAD}extern crate alloc;\n{BOXED}")
    with pytest.raises(AssertionError, match="no global memory allocator found"):
        Toolchain("default").alone(tmp_path / "badly.rs", tmp_path / "libbadly.a")


def test_the_test_finds_a_panic(tmp_path):
    icd = harness.read_unchecked(odd.write_least(tmp_path))
    least = Subject(icd, harness.generate(icd, tmp_path))
    more = "#[no_mangle] pub fn decode_badly(bytes: &[u8]) -> u8 { bytes[0] }\n"
    assert suspicious(symbols(least, "default", SMALL, tmp_path)) == []
    names = symbols(least, "default", SMALL, tmp_path, more)
    assert "this_can_panic" in names and suspicious(names)
