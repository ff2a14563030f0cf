"""A C file is prepared for the parser: comments, constants, packing and conditions."""

from __future__ import annotations

import pytest

from icdgen.importer.reading.c_text import CText, Definition


def test_only_declarations_remain_and_keep_their_places():
    text = (
        '#include "a.h"\n'
        "int f(void) { return 1; }\n"
        "  struct A { int x; };  /* end */\n"
        'const char *s = "struct B { };";\n'
        "typedef unsigned int word_t;\n"
    )
    code = CText(text)
    assert [row.strip() for row in code.code.split("\n")] == [
        *("", "", "struct A { int x; };", "", "typedef unsigned int word_t;", "")
    ]
    assert code.code.index("struct A") == text.index("struct A")
    lengths = [len(row) for row in code.code.split("\n")]
    assert lengths == [len(row) for row in text.split("\n")]
    assert [first for first, _ in code.beginnings] == [3, 5]
    assert code.beginnings[0][1].endswith("  struct A { int x; };")
    assert code.beginnings[1][1].endswith("\ntypedef unsigned int word_t;")


def test_a_declaration_ends_with_the_semicolon_behind_its_last_brace():
    text = "typedef struct { union { int a; } u; } A_t, *A_p; int x;\nenum E {a}"
    code = CText(text)
    assert code.code.split() == text.replace(" int x;", "").split()
    assert [first for first, _ in code.beginnings] == [1, 2]


def test_comments_are_noted_by_the_line_of_their_member():
    text = (
        "/** Motor\n * state. */\n"
        "struct A {\n"
        "  int a; /* speed,\n     in rpm */\n"
        "  int b; //!< load\n"
        "  // first\n"
        "  // second\n"
        "  int c; // x /* y */ z\n"
        "  /* before */ int d;\n"
        "};\n"
    )
    code = CText(text)
    assert code.comments == {
        2: "Motor state.",
        4: "speed, in rpm",
        6: "load",
        7: "first",
        8: "first second",
        9: "x /* y */ z",
        10: "before",
    }
    assert code.alone == {2, 7, 8}
    assert code.above(3) == "Motor state."
    assert [code.above(line) for line in (4, 7, 10)] == ["", "", ""]
    assert code.beside(4, 3) == "speed, in rpm"
    assert code.beside(9, 3) == "x /* y */ z"
    # Line 3 is the first line of the struct: the comment above it is of the struct.
    assert (code.beside(3, 3), code.beside(3, 2)) == ("", "Motor state.")
    assert (code.beside(8, 3), code.beside(None, 3)) == ("first", "")


def test_several_comments_of_a_line_are_one_text():
    code = CText("struct A { int a; /* x */ /* y */ };\n/* p */ // q\nint b;")
    assert code.comments == {1: "x y", 2: "p q"}


def test_a_block_comment_does_not_go_on_a_comment_above_it():
    code = CText("// a\n/* b */\n// c\n")
    assert code.comments == {1: "a", 2: "b", 3: "b c"}


def test_marks_of_comments_in_strings_and_characters_begin_no_comment():
    code = CText(
        "char a[] = \"\\\"// x\"; char q = '\"'; // y\nchar b = '/*'; /* z */\n"
    )
    assert code.comments == {1: "y", 2: "z"}


@pytest.mark.parametrize(
    ("define", "size"),
    [
        ("#define SIZE 12", "12"),
        ("  # define SIZE ( 0x1F ) ", "0x1F"),
        ("#define SIZE 8UL", "8"),
        ("#define SIZE 8 // bytes", "8"),
        ("#define SIZE 4\n#define SIZE 4", "4"),
        ("#define SIZE 4\n#define SIZE 5", "SIZE"),
        ("#define SIZE (4 + 1)", "SIZE"),
        ("#define SIZE(x) 4", "SIZE"),
        ("#define SIZE2 4", "SIZE"),
        ("#if 0\n#define SIZE 4\n#endif\n#define SIZE 5", "5"),
    ],
)
def test_constants_with_one_value_are_replaced(define, size):
    code = CText(f"{define}\nstruct A {{ char xSIZE[SIZE]; }};\n")
    assert code.code.strip() == f"struct A {{ char xSIZE[{size}]; }};"
    assert code.beginnings[0][1].strip() == f"struct A {{ char xSIZE[{size}]; }};"


STRUCT = "struct S { int x; };"


def most_of(*lines: str) -> list[int | None]:
    """Return the maximum alignment of each `struct S` in some lines."""
    text = "\n".join(STRUCT if line == "S" else line for line in lines)
    return [definition.most for definition in CText(text).definitions]


@pytest.mark.parametrize(
    ("lines", "most"),
    [
        (["S"], [None]),
        (["S", "#pragma pack(1)", "S", "#pragma pack()", "S"], [None, 1, None]),
        (["#pragma pack(push, 2)", "S", "#pragma pack(pop)", "S"], [2, None]),
        (["#pragma pack(4)", "#pragma pack(push)", "#pragma pack(1)", "S",
         "#pragma pack(pop)", "S"], [1, 4]),
        (["#pragma pack(push, a, 1)", "#pragma pack(push, b, 2)", "S",
         "#pragma pack(pop, a)", "S", "#pragma pack(pop)", "S"], [2, None, None]),
        (["#pragma pack(push, a, 1)", "#pragma pack(push, 2)",
         "#pragma pack(pop)", "S"], [1]),
        (["#pragma pack(push, 1)", "#pragma pack(push, 2)",
         "#pragma pack(pop, x)", "S"], [2]),
        (["#pragma pack(push, a, 1)", "#pragma pack(push, a, 2)",
         "#pragma pack(pop, a)", "S"], [1]),
        (["#define N 2", "# pragma  pack( N )", "S"], [2]),
        (["#pragma pack(2)", "#pragma pack(0)", "S"], [None]),
        (["#pragma pack(pop)", "S"], [None]),
        (['_Pragma("pack(1)") S'.replace(" S", ""), "S"], [1]),
        (["#pragma once", "S"], [None]),
    ],
)  # fmt: skip
def test_pragmas_limit_the_alignment_of_the_structs_below_them(lines, most):
    assert most_of(*lines) == most


@pytest.mark.parametrize(
    "packed",
    ["__attribute__((packed))", "__attribute__ ((__packed__))", "__packed", "PACKED"],
)
def test_an_attribute_packs_the_struct_at_its_keyword_or_its_brace(packed):
    own, other = Definition(None, is_packed=True), Definition(None)
    member = Definition(None, has_packed_member=True)
    for text in (
        f"struct {packed} A {{ int x; }};",
        f"struct A {{ int x; }} {packed};",
        f"typedef {packed} struct {{ int x; }} A;",
        f"{packed} struct A {{ int x; }};",
    ):
        code = CText(f"{text} struct B {{ int y; }};")
        assert code.definitions == [own, other], text
        assert packed not in code.code
    assert CText(f"struct A {{ int a {packed}; }};").definitions == [member]
    assert CText(f"struct A {{ {packed} int a; }};").definitions == [member]
    inner = CText(f"struct A {{ struct {{ int x; }} {packed} in; int y; }};")
    assert inner.definitions == [other, own]


def test_if_0_removes_code_up_to_its_else():
    text = (
        "#if 0\nstruct A { int a; };\n#else\nstruct B { int b; };\n#endif\n"
        "#  if 0 \nstruct C { int c; };\n#endif\nstruct D { int d; };\n"
    )
    code = CText(text)
    assert code.code.split() == "struct B { int b; }; struct D { int d; };".split()
    assert [first for first, _ in code.beginnings] == [4, 9]


@pytest.mark.parametrize(
    ("directives", "is_conditional"),
    [
        (("#ifdef X", "#endif"), True),
        (("#if X", "#endif"), True),
        (("#ifndef X", "#endif"), True),
        (("#if 1", "#else", "#endif"), True),
        (("#if 0", "#endif"), False),
        (("#if 0", "#elif X", "#endif"), True),
        (("#define X", "#pragma once"), False),
    ],
)
def test_a_condition_within_a_struct_makes_it_conditional(directives, is_conditional):
    inside = "\nint x;\n".join(directives)
    code = CText(f"struct A {{ int a;\n{inside}\nint b; }};\nstruct B {{ int c; }};\n")
    assert code.definitions == [
        Definition(None, is_conditional=is_conditional),
        Definition(None),
    ]
    # Around a struct, it decides about none of its parts.
    around = f"{directives[0]}X\n#endif\nstruct A {{ int a; }};\n"
    assert CText(around).definitions == [Definition(None)]
