"""The symbol table of Rust has every name that the crate declares, in its scope."""

from __future__ import annotations

from icdgen import backends
from icdgen.backends.rust.symbols import procedure_type
from tests.icd.files import loaded

ICD = """\
enums:
  - {name: Mode, members: [{value: 0, name: Unknown}, {value: 1, name: Unlisted}]}
structs:
  - {name: Point, length: 1, fields: [{at: 0, bits: 8, name: X, type: uint, const: 3}]}
messages:
  - name: Status
    id: 0
    kind: telemetry
    length: 4
    fields:
      - {at: 0, bits: 8, name: Type, type: enum, enum: Mode}
      - {at: 8, bits: 8, name: Rate, type: uint, unit: V, formula: raw*0.5, max: 9}
      - {at: 16, bits: 8, name: Late, type: uint, when: {Type: 1}}
      - {at: 24, bits: 8, name: High, type: uint, view: true, formula: raw*0.25}
      - {at: 24, bits: 8, name: Low, type: uint}
  - name: Path
    id: 255
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: Count, type: uint}
      - {at: 8, name: Points, struct: Point, count: Count, up_to: 3}
"""


def names(folder, text=ICD):
    """Return the names in each scope, without those that every crate has."""
    result = loaded(folder, text)
    scopes: dict[str, list[str]] = {}
    for identifier in backends.get("rust").identifiers(result.icd):
        scopes.setdefault(identifier.scope, []).append(identifier.text)
    return scopes


SCOPES = {
    "variants of demo::Telemetry": "Status",
    "variants of demo::Telecommand": "Path",
    "types of demo": "Result Error Default Coded Scale Telemetry Telecommand Node"
    " Point Status Path",
    "enumerations of demo": "Option From Enumeration Mode",
    "methods of demo::Point": "fit rows default",
    "constants of demo::Point": "NAME FIELDS X_CONST",
    "fields of demo::Point": "x",
    "fields of demo::Status": "r#type rate late low",
    "methods of demo::Status": "from_bytes from_array to_bytes default"
    " rate_v set_rate_v rate_v_f32 rate_mv set_rate_mv has_late"
    " high high_physical high_physical_f32 high_milli",
    "constants of demo::Status": "NAME LENGTH ID SET_ID GET_ID RATE_V_MAX",
    "fields of demo::Path": "count points",
    "methods of demo::Path": "from_bytes from_array to_bytes default from_longest size"
    " read_points write_points points",
    "constants of demo::Path": "NAME LENGTH ID SET_ID GET_ID",
}


def test_each_name_of_a_small_icd_is_in_its_scope(tmp_path):
    scopes = names(tmp_path)
    assert {scope: " ".join(scopes[scope]) for scope in SCOPES} == SCOPES
    crate, modules = scopes["modules of the crate"], scopes["modules of demo"]
    assert {"support", "std", "wire", "lib", "main", "bin", "nul", "demo"} <= {*crate}
    assert modules[:3] == ["enums", "procedures", "u8"]
    assert modules[-3:] == ["point", "status", "path"] and "nul" in modules
    assert scopes.keys() == {
        *SCOPES,
        "modules of the crate",
        "modules of demo",
        "variants of demo::Mode",
    }


def test_the_sizes_of_elements_with_arrays_have_a_method(tmp_path):
    text = ICD.replace(
        "at: 8, name: Points, struct: Point, count: Count, up_to: 3}",
        "at: 8, bits: 8, name: Levels, type: uint, count: Count, up_to: 3}\n"
        "      - {at: 8, after: Levels, bits: 16, name: Ends, type: uint, count: rest,"
        " up_to: 2}",
    )
    methods = names(tmp_path, text)["methods of demo::Path"]
    assert methods[4:] == ["from_longest", "size", "inner", "levels", "ends"]


def test_unknown_values_have_the_first_variant_that_is_free(tmp_path):
    assert names(tmp_path)["variants of demo::Mode"] == [
        "Unnamed",
        "Unknown",
        "Unlisted",
    ]


def test_the_type_of_a_procedure_is_in_camel_case():
    assert procedure_type("copy_all") == "CopyAll"


PROCEDURES = """\
protocol:
  link:
    framing: {by: length}
    header: [{bits: 8, role: sync, value: [0x5A]}, {bits: 8, role: id}, {bits: 8, role: length}]
  procedures:
    copy_all:
      limits: {time_s: 600, requests: 100}
      outputs: {new_state: state.State}
      steps: [{send: Copy}, {get: State, as: state}]
messages:
  - {name: Copy, id: 1, kind: telecommand, length: 0}
  - {name: Get State, id: 2, kind: telecommand, length: 0, response: {reply: State}}
  - {name: State, id: 129, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: State, type: uint}]}
"""


def test_a_procedure_has_a_type_constants_and_outputs(tmp_path):
    scopes = names(tmp_path, PROCEDURES)
    assert scopes["procedures of demo"] == [
        "ALL",
        "CopyAll",
        "COPY_ALL",
        "COPY_ALL_MEMORY",
    ]
    assert scopes["methods of demo::CopyAll"] == ["new", "new_state"]
