"""Rules read C structs in headers and documents as tables. Their layout is that of gcc."""

from __future__ import annotations

import random
import subprocess

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer import profile, run, sources
from icdgen.importer.document import SourceTable
from icdgen.importer.reading import c_structs
from tests.importer.rules.drawing import draw, heading, text
from tests.importer.rules.test_rules import NODE, fields

HEADER = """/* The link of the motor. */
#ifndef MOTOR_H
#define MOTOR_H
#include <stdint.h>
#define CHANNELS 3  // of the converter

enum mode { IDLE, RUN = 4, FAULT };
typedef struct { int16_t x, y; } __attribute__((packed)) vector_t;

/** State of the motor, id 0x21 */
typedef struct __attribute__((packed)) {
    uint8_t mode : 3;          /**< what it does */
    uint8_t : 1;
    uint8_t fault : 4;
    uint16_t speed;            // rpm
    int32_t position[CHANNELS];
    char name[8];
    vector_t field[2];
    float current;             /* "A; not mA" */
} motor_state_t;

void motor_send(const motor_state_t *state);
static inline int motor_twice(int a) { return 2 * a; }
#endif
"""
RULES = (
    NODE
    + r"""types: {char: {type: text}}
rules:
  - tables: {head: Byte | Bit | Bits | Type | Name, before: id 0x}
    message: {caption: '^{message}_t$', before: ['id {id}$', '^sizeof {length}$'], kind: telemetry}
    columns: {Byte: byte, Bit: bit, Bits: bits, Type: type, Name: name, Count: count, Members: members, Comment: text}
  - {what: ignore, tables: {head: '~.'}}
"""
)
FIELDS = [
    (0, 3, "mode"), (4, 4, "fault"), (8, 16, "speed"), (24, 32, "position"), (120, 64, "name"), (184, 16, "field[0].x"),
    (200, 16, "field[0].y"), (216, 16, "field[1].x"), (232, 16, "field[1].y"), (248, 32, "current"),
]  # fmt: skip


def test_a_rule_reads_the_structs_of_a_header(tmp_path):
    (tmp_path / "motor.h").write_text(HEADER, encoding="utf-8")
    (tmp_path / "rules.yaml").write_text(RULES, encoding="utf-8")
    result, trees = run.run(
        tmp_path / "motor.h", profile.load(tmp_path / "rules.yaml"), prose=True
    )
    assert [t.message for t in result.import_findings if t.severity == "error"] == []
    (message,) = trees["motor"]["messages"]
    assert (message["name"], message["id"], message["length"]) == (
        "motor_state",
        0x21,
        35,
    )
    assert fields(trees["motor"]) == FIELDS
    by_name = {field["name"]: field for field in message["fields"]}
    assert (
        by_name["position"]["count"],
        by_name["position"]["type"],
        by_name["name"]["type"],
    ) == (3, "int", "text")
    assert (
        by_name["current"]["type"],
        by_name["speed"]["summary"],
        by_name["current"]["summary"],
    ) == (
        "float",
        "rpm",
        '"A; not mA"',
    )


def test_a_rule_reads_the_structs_that_a_document_prints(tmp_path):
    lines = [
        "typedef __packed struct",
        "{",
        "  uint8_t robot_id;",
        "  uint16_t level : 5;",
        "  uint16_t rest : 11;",
        "  float speed;",
        "} robot_t;",
    ]
    draw(
        tmp_path / "motor.pdf",
        [
            heading("4.1 Robot (0x0201)", 2),
            *(text(line) for line in lines),
            text("The end."),
        ],
    )
    rules = (
        NODE
        + r"""rules:
  - tables: {head: Byte | Bit}
    message: {heading: '^[\d.]+ {message} \({id}\)$', kind: telemetry}
    columns: {Byte: byte, Bit: bit, Bits: bits, Type: type, Name: name, Count: count, Members: members, Comment: text}
"""
    )
    (tmp_path / "rules.yaml").write_text(rules, encoding="utf-8")
    result, trees = run.run(
        tmp_path / "motor.pdf", profile.load(tmp_path / "rules.yaml"), jobs=1
    )
    assert [t.message for t in result.import_findings if t.severity == "error"] == []
    assert fields(trees["motor"]) == [
        (0, 8, "robot_id"),
        (8, 5, "level"),
        (13, 11, "rest"),
        (24, 32, "speed"),
    ]


def test_numbers_of_c_have_its_notations():
    blocks, _ = c_structs.read_structs(
        "enum e { A = 010, B = 0x1Ful, C = 0, D = 12u };"
    )
    (table,) = (block for block in blocks if isinstance(block, SourceTable))
    values = [row.cells[0].text for row in table.rows]
    assert values == ["Value", "8", "31", "0", "12"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("struct a { uint8_t *p; };", "struct `a`: `p` is a pointer"),
        (
            "struct a { long n; };",
            "the size of the type `long` depends on the compiler",
        ),
        ("struct a { union { int i; float f; } u; };", "struct `a`: `u` is a union"),
        ("struct a { uint8_t n; uint8_t data[]; };", "`data` has no size"),
        ("struct a { uint8_t n; uint8_t data[0]; };", "`data` has 0 elements"),
        ("struct a { uint8_t n[2 - 3]; };", "`n` has -1 elements"),
        ("struct a { struct b { int8_t x; } b[100]; };", "`b` has 100 elements"),
        ("struct a { uint8_t n : 9; };", "`n` has 9 bits"),
        ("struct a { uint8_t n : -1; };", "`n` has -1 bits"),
        ("struct a { uint8_t n : 0; };", "`n` has 0 bits"),
        ("struct a { float n : 3; };", "`n` has 3 bits"),
        ("struct a { char n : 3; };", "the sign of `n` depends on the compiler"),
        ("struct a { enum b n; };", "enum `b` is not declared"),
        ("enum a { A = sizeof(int), B };", "is not a constant that can be computed"),
        ("struct a { struct a n; };", "struct `a` contains itself"),
        ("struct a { uint8_t n; _Alignas(8) uint8_t m; };", "alignment of its own"),
        (
            "struct a { uint8_t n; uint32_t m __attribute__((packed)); };",
            "one of its members has the attribute `packed`",
        ),
        (
            "struct a {\n#ifdef BIG\nuint32_t n;\n#else\nuint8_t n;\n#endif\n};",
            "struct `a`: the preprocessor decides about its members",
        ),
        (
            "#if BIG\n#define N 3\n#else\n#define N 4\n#endif\nstruct a { uint8_t n[N]; };",
            "is not a constant that can be computed",
        ),
        ("union a { int32_t n; uint8_t bytes[4]; };", "union `a`: it is a union"),
        (f"struct a {{ uint8_t n[{'9' * 5000}]; }};", "is not a constant"),
        ("struct a { uint8_t n['x']; };", "is not a constant that can be computed"),
        ("struct a { uint8_t n[1 << -1]; };", "a shift by -1"),
        ("struct a { uint8_t n[1 << 4000000000]; };", "a shift by 4000000000"),
    ],
)
def test_an_unsupported_struct_is_an_error(tmp_path, text, message):
    (tmp_path / "a.h").write_text(text, encoding="utf-8")
    document, _ = sources.read(tmp_path / "a.h", profile.load())
    errors = [t for t in document.import_findings if t.severity == "error"]
    assert len(errors) == 1 and message in errors[0].message and errors[0].help


def structs_of(text: str) -> dict[str, list[list[str]]]:
    """Return the rows of each table without its heading, by caption."""
    return {
        block.caption: [[cell.text for cell in row.cells] for row in block.rows[1:]]
        for block in c_structs.read_structs(text)[0]
        if isinstance(block, SourceTable)
    }


@pytest.mark.parametrize(
    ("pragmas", "offset"),
    [
        ("#pragma pack(2)", 2),
        ("#pragma pack(push, 2)", 2),
        ("#define PACKING 2\n#pragma pack(PACKING)", 2),
        ("#pragma pack(1)\n#pragma pack(push, 2)\n#pragma pack(pop)", 1),
        ("#pragma pack(2)\n#pragma pack(push)\n#pragma pack(1)\n#pragma pack(pop)", 2),
        ("#pragma pack(push, motor, 2)", 2),
        (
            "#pragma pack(push, motor, 1)\n#pragma pack(push, 2)\n#pragma pack(pop, motor)",
            4,
        ),
        ("#pragma pack(1)\n#pragma pack()", 4),
        ('_Pragma("pack(2)")', 2),
        ("#pragma pack(pop)", 4),
        ("// #pragma pack(1)", 4),
        ("#if 0\n#pragma pack(1)\n#endif", 4),
    ],
)
def test_pragmas_set_the_alignment_of_the_members_after_them(pragmas, offset):
    text = f"{pragmas}\nstruct a {{ uint8_t n; uint32_t m; }};"
    ((_, (byte, *_)),) = structs_of(text).values()
    assert byte == str(offset)


def test_an_attribute_packs_only_its_own_struct():
    text = """
        struct PACKED a { uint8_t n; struct { uint8_t n; uint32_t m; } in; };
        struct b { uint8_t n; struct { uint8_t n; uint32_t m; } PACKED in; uint32_t m; };
        struct PACKED c { uint8_t n; uint32_t m; }; struct d { uint8_t n; uint32_t m; };
    """
    places = {name: [row[0] for row in rows] for name, rows in structs_of(text).items()}
    assert places == {
        "a": ["0", "1", "5"],
        "b": ["0", "1", "2", "8"],
        "c": ["0", "1"],
        "d": ["0", "4"],
    }


def test_a_field_of_an_enumeration_has_its_names_and_its_sign():
    text = """
        enum mode { IDLE, RUN = 4 };
        typedef enum { LOW = -1, HIGH } level_t;
        enum __attribute__((packed)) small { LAST = 255 };
        struct __attribute__((packed)) a {
            enum mode mode : 3; level_t level : 2; enum mode : 3; level_t whole; enum small small;
            enum { NO, YES = 1 << 1 | 1 } flag; enum mode modes[YES];
        };
    """
    rows = [row[2:7] for row in structs_of(text)["a"]]
    assert rows == [
        ["3", "uint", "mode", "", "0: IDLE; 4: RUN"],
        ["2", "int", "level", "", "-1: LOW; 0: HIGH"],
        ["32", "int32", "whole", "", "-1: LOW; 0: HIGH"],
        ["8", "uint8", "small", "", "255: LAST"],
        ["32", "uint32", "flag", "", "0: NO; 3: YES"],
        ["32", "uint32", "modes", "3", "0: IDLE; 4: RUN"],
    ]


def test_code_that_is_not_compiled_is_not_read():
    text = """
        #if 0
        struct old { uint8_t n;
        #ifdef X
        };
        #endif
        #else
        struct a { uint8_t n; _Static_assert(1, "; }"); };
        #endif
    """
    assert list(structs_of(text)) == ["a"]


def test_a_comment_belongs_to_the_member_on_its_line():
    text = """struct a {
        /* V */ uint8_t n; // voltage
        uint8_t m;
        /* of it */ /* all */
        uint8_t k;
        uint8_t j; /* A */ /* current */
    };"""
    comments = [row[7] for row in structs_of(text)["a"]]
    assert comments == ["V voltage", "", "of it all", "A current"]
    ((row,),) = structs_of("/* of the struct */\nstruct a { uint8_t n; };").values()
    assert row[7] == ""


def test_a_struct_is_read_whatever_is_declared_with_it():
    text = (
        "struct a { uint8_t n; } table[3]; typedef struct b { uint8_t m; } *b_p, b_t;"
    )
    assert [row[0][4] for row in structs_of(text).values()] == ["n", "m", "m"]


def test_an_array_can_have_a_name_as_a_type():
    text = """typedef uint8_t mac_t[6]; typedef mac_t macs_t[2];
        struct a { mac_t own; mac_t others[3]; macs_t pair; };"""
    assert [(row[0], row[5]) for row in structs_of(text)["a"]] == [
        ("0", "6"),
        ("6", "18"),
        ("24", "12"),
    ]


def test_structs_in_structs_do_not_exhaust_the_memory():
    text = "struct a0 { uint8_t n; };" + "".join(
        f"struct a{level} {{ struct a{level - 1} n[64]; }};" for level in range(1, 9)
    )
    _, findings = c_structs.read_structs(text)
    assert len(findings) == 6 and "a struct may have 4096" in findings[0].help


def test_padding_is_a_warning_and_an_invalid_header_a_finding(tmp_path):
    (tmp_path / "a.h").write_text(
        "struct a { uint8_t n; uint32_t m; uint16_t k; };", encoding="utf-8"
    )
    document, (table,) = sources.read(tmp_path / "a.h", profile.load())
    assert (
        "padding stands in front of `m` (3 bytes), at the end (2 bytes)"
        in document.import_findings[0].message
    )
    assert table.before == ["sizeof 12"]
    (tmp_path / "a.h").write_text("\nstruct a {\n  unknown_t x;\n};", encoding="utf-8")
    with pytest.raises(Findings) as caught:
        sources.read(tmp_path / "a.h", profile.load())
    assert caught.value.findings[0].place.line == 2


ENUMS = """enum few { A, B = 3 }; enum many { C = -2, D = 5 };
enum __attribute__((packed)) small { E = 255 };
"""


def random_struct(random: random.Random) -> str:
    """Draw a struct of random members, packed or not."""
    types = [
        "uint8_t",
        "int8_t",
        "uint16_t",
        "int16_t",
        "uint32_t",
        "uint64_t",
        "float",
        "double",
    ]
    members = []
    for index in range(random.randint(1, 9)):
        kind = random.choice(types)
        if random.random() < 0.5 and kind.startswith("uint"):
            bits = int(kind[4:-2])
            members.append(f"{kind} m{index} : {random.randint(1, bits)};")
            if random.random() < 0.15:
                members.append(f"{kind} : {random.choice([0, 1, 3])};")
        else:
            members.append(f"{kind} m{index}{random.choice(['', '', '[3]'])};")
        if random.random() < 0.1:
            kind = random.choice(["enum few", "enum many", "enum small"])
            size = "" if kind == "enum small" else random.choice(["", ": 5", "[2]"])
            members.append(f"{kind} e{index} {size};")
        if random.random() < 0.1:
            inner = random.choice(["", "__attribute__((packed)) "])
            members.append(f"struct {inner}{{ uint8_t a; {kind} b; }} s{index};")
    pack = random.choice(["", f"\n#pragma pack({random.choice([1, 2, 4, 8])})\n"])
    packed = random.choice(["", "__attribute__((packed)) "])
    return (
        f"{ENUMS}{pack}struct {packed}made {{ {' '.join(members)} }};\n#pragma pack()\n"
    )


@pytest.mark.needs("gcc")
def test_the_layout_is_that_of_gcc(tmp_path):
    structs = [random_struct(random.Random(seed)) for seed in range(120)]
    code = ["#include <stdint.h>", "#include <stdio.h>", "#include <string.h>", ENUMS]
    for index, struct in enumerate(structs):
        declaration = struct.removeprefix(ENUMS)
        code.append(declaration.replace("made {", f"made{index} {{"))
    code.append("int main(void) {")
    expected = []
    for index, struct in enumerate(structs):
        (table,) = [
            block
            for block in c_structs.read_structs(struct)[0]
            if hasattr(block, "rows") and block.caption == "made"
        ]
        rows = [[cell.text for cell in row.cells] for row in table.rows[1:]]
        (size,) = [
            block.text
            for block in c_structs.read_structs(struct)[0]
            if not hasattr(block, "rows")
        ]
        code.append(
            f"{{ static union {{ struct made{index} s; uint8_t b[sizeof(struct made{index})]; }} u;"
        )
        code.append('printf("sizeof %zu\\n", sizeof u.s);')
        expected.append(size)
        for byte, bit, bits, kind, name, count, _, _ in rows:
            first = 8 * int(byte) + int(bit or 0)
            size_in_bits = int(bits) * int(count or 1)
            value = (
                "1"
                if "float" in kind or count
                else f"({kind.rstrip('0123456789')}64_t)-1"
            )
            code.append("memset(&u, 0, sizeof u);")
            code.append(
                f"memset(&u.s.{name}, 255, sizeof u.s.{name});"
                if not bit
                else f"u.s.{name} = {value};"
            )
            code.append(
                'for (size_t i = 0; i < 8 * sizeof u; i++) if (u.b[i / 8] >> i % 8 & 1) printf("%zu ", i); printf("\\n");'
            )
            expected.append(" ".join(map(str, range(first, first + size_in_bits))))
        code.append("}")
    code.append("return 0; }")
    (tmp_path / "a.c").write_text("\n".join(code), encoding="utf-8")
    subprocess.run(["gcc", "-w", "-o", "a", "a.c"], cwd=tmp_path, check=True)
    got = subprocess.run(
        [tmp_path / "a"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert [line.strip() for line in got] == expected
