"""Nothing in the crate can panic, and nothing allocates: an optimised program of all of
it holds no code that does.
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

FAST, SMALL = "3", "z"  # what users build for
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
    """A function for each function of the crate that a user can call."""
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
                one, templates = (
                    field.physical_name,
                    ((ELEMENT, READ_ELEMENT) if field.count else (SCALED, READ)),
                )
                template = templates[not field.is_settable]
                value = "Option<f64>" if field.model.conditions else "f64"
                yield template.format(
                    name=f"{name}_{one}",
                    type=type_,
                    getter=one,
                    setter=f"set_{one}",
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
    """What the linker sees of the program."""
    tools = Toolchain(toolchain)
    # Machine code is made once, of all of it, at the end.
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


def suspicious(found: set[str]) -> list[str]:
    return sorted(
        one for one in found if "panic" in one or "_fail" in one or "unwrap" in one
    )


@pytest.mark.parametrize("toolchain", list(toolchains()))
def test_no_way_to_a_panic_is_left(shipped, toolchain, tmp_path):
    found = symbols(shipped, toolchain, FAST, tmp_path, WIRE.read_text())
    assert {"wire_uart_feed", "wire_client_received", "wire_download_next"} <= found
    assert sum(one.startswith("decode_") for one in found) == sum(
        len(node.messages) for node in shipped.icd.nodes
    )
    assert suspicious(found) == []


def test_no_way_to_a_panic_is_left_in_odd_messages(strange, tmp_path):
    assert suspicious(symbols(strange, "default", SMALL, tmp_path)) == []


@pytest.mark.parametrize("level", [FAST, SMALL])
def test_no_way_to_a_panic_is_left_in_arrays_structs_and_parts(
    stories, level, tmp_path
):
    assert suspicious(symbols(stories, "default", level, tmp_path)) == []


def test_messages_of_variable_length_neither_panic_nor_allocate(
    tmp_path_factory, tmp_path
):
    icd = harness.read(*variable_length.variable(tmp_path))
    variable = Subject(icd, harness.generate(icd, tmp_path_factory.mktemp("variable")))
    found = symbols(variable, "default", FAST, tmp_path)
    assert {
        "decode_ublox_nav_sat",
        "dispatch_open_telemetry",
        "dispatch_mux_telemetry",
    } <= found
    assert suspicious(found) == []
    assert {one.split("::")[-1] for one in found} & ALLOCATORS == set()


def test_a_program_without_an_allocator_cannot_allocate(tmp_path):
    """So that all of it could be compiled says that nothing of it does."""
    (tmp_path / "badly.rs").write_text(f"{HEAD}extern crate alloc;\n{BOXED}")
    with pytest.raises(AssertionError, match="no global memory allocator found"):
        Toolchain("default").alone(tmp_path / "badly.rs", tmp_path / "libbadly.a")


def test_a_panic_would_be_seen(tmp_path):
    icd = harness.read(odd.write_least(tmp_path))
    least = Subject(icd, harness.generate(icd, tmp_path))
    more = "#[no_mangle] pub fn decode_badly(bytes: &[u8]) -> u8 { bytes[0] }\n"
    assert suspicious(symbols(least, "default", SMALL, tmp_path)) == []
    found = symbols(least, "default", SMALL, tmp_path, more)
    assert "this_can_panic" in found and suspicious(found)
