"""DBC files that cantools refuses are repaired statement by statement, and each repair
is reported with its line.
"""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.definitions import dbc
from icdgen.definitions.accounting import Account
from icdgen.definitions.model import Definitions
from tests.limits import assert_limits


def rows(definitions):
    return [
        (finding.code, finding.severity, finding.spot.line, finding.message)
        for finding in definitions.import_findings
    ]


def repaired(text, *errors):
    """Return the text that `load` finally accepts, and the findings.

    ``errors`` are the messages with which it refuses the first texts.
    """
    left, definitions = list(errors), Definitions("a.dbc")

    def load(text):
        if left:
            raise ValueError(left.pop(0))
        return text

    return dbc.mended(text, load, definitions), rows(definitions)


def test_a_complete_text_is_not_changed():
    text = 'VERSION ""\nBO_ 5 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] "" X\nBU_: X;\n'
    assert repaired(text) == (text, [])


def test_ids_above_11_bits_are_extended_and_reported_once():
    def is_standard(id):
        text, findings = repaired(f"BO_ {id} A: 8 X\n")
        if findings:
            assert text == f"BO_ {id | 1 << 31} A: 8 X\n"
            message = f"the id {id:#x} has more than the 11 bits of a standard frame"
            assert findings == [("IMP076", "warning", 1, message)]
        return text == f"BO_ {id} A: 8 X\n"

    assert_limits(is_standard, most=0x7FF)
    extended = (1 << 31) + 4096
    statements = 'BO_ {0} A: 8 X\nVAL_ {0} S 1 "a";\nCM_ SG_ {0} S "c";\nBA_ "P" BO_ {0} 4096;\nSIG_VALTYPE_ {0} S : 1;\n'
    text, findings = repaired("\n" + statements.format(4096))
    assert text == "\n" + statements.format(extended)
    assert [finding[2] for finding in findings] == [2]
    assert repaired(statements.format(extended)) == (statements.format(extended), [])


def test_a_message_whose_id_exceeds_29_bits_is_left_out_with_its_signals():
    def is_kept(id):
        start = f"BU_: X;\nBO_ {id + (1 << 31)} A: 8 X\n SG_ S;\n SG_ T;\n"
        text, findings = repaired(start + "BO_ 5 B: 8 X\n")
        if findings:
            assert text == "BU_: X;\n\n\n\nBO_ 5 B: 8 X\n"
            number = hex(id + (1 << 31))
            message = (
                f"message `A` is not imported: its id is {number}, which no frame has"
            )
            assert findings == [("IMP070", "error", 2, message)]
        return text == start + "BO_ 5 B: 8 X\n"

    assert_limits(is_kept, most=(1 << 29) - 1)
    # The pseudo message of signals without a message stays.
    nothing = f"BO_ {0xC0000000} VECTOR__INDEPENDENT_SIG_MSG: 0 X\n"
    assert repaired(nothing) == (nothing, [])


def test_the_line_of_a_syntax_error_is_left_out_and_lines_keep_their_numbers():
    text = "BU_: X;\nCM_ odd odd;\nBO_ 5 A: 8 X\n SG_ S;\nBO_ 6 B: 8 X\n"
    assert repaired(text, "Invalid syntax at line 2, column 5: x") == (
        text.replace("CM_ odd odd;", ""),
        [("IMP075", "error", 2, "`CM_ odd odd;` is not understood")],
    )
    assert repaired(text, "Invalid syntax at line 3, column 5: x") == (
        "BU_: X;\nCM_ odd odd;\n\n\nBO_ 6 B: 8 X\n",
        [
            (
                "IMP075",
                "error",
                3,
                "`BO_ 5 A: 8 X` is not understood, nor are the 1 signals below it",
            )
        ],
    )


def test_an_error_at_the_start_of_a_statement_is_that_of_the_one_before():
    text = "BU_: X;\n\n  BO_ 6 B: 8 X\n"
    error = "Invalid syntax at line 3, column 3: x"
    assert repaired(text, error) == (
        "\n\n  BO_ 6 B: 8 X\n",
        [("IMP075", "error", 1, "`BU_: X;` is not understood")],
    )
    at_the_end = "Invalid syntax at line 4, column 1: x"
    assert repaired(text, at_the_end) == (
        "BU_: X;\n\n\n",
        [("IMP075", "error", 3, "`BO_ 6 B: 8 X` is not understood")],
    )


@pytest.mark.parametrize(("length", "is_whole"), [(80, True), (81, False)])
def test_a_statement_is_shown_with_80_characters(length, is_whole):
    row = "x" * length
    _, ((_, _, _, message),) = repaired(
        f"{row};\n"[1:], "Invalid syntax at line 1, column 9:"
    )
    shown = row[1:] + ";" if is_whole else "x" * 77 + "..."
    assert message == f"`{shown}` is not understood"


def test_values_of_missing_signals_are_left_out():
    text = (
        'BU_: X;\nVAL_ 5 S 1 "a; b"\n 2 "c";\nSIG_VALTYPE_ 6 T : 1;\nVAL_ 5 ST 1 "a";\n'
    )
    error = 'No such signal:\nVAL_ 5 S"\nSIG_VALTYPE_ 6 T'
    assert repaired(text, error) == (
        'BU_: X;\n\n\n\nVAL_ 5 ST 1 "a";\n',
        [
            ("IMP076", "warning", 2, "`VAL_` names `S` of message 5, which has no such signal"),
            ("IMP076", "warning", 4, "`SIG_VALTYPE_` names `T` of message 6, which has no such signal"),
        ],
    )  # fmt: skip


def test_a_file_has_at_most_50_faults():
    def is_accepted(faults):
        definitions = Definitions("a.dbc")
        left = [f"Invalid syntax at line {at + 1}, column 9: x" for at in range(faults)]

        def load(text):
            if left:
                raise ValueError(left.pop(0))
            return text

        try:
            dbc.mended("odd odd odd;\n" * faults, load, definitions)
        except (ValueError, AttributeError):
            return False
        return len(rows(definitions)) == faults

    assert_limits(is_accepted, most=50)


def test_messages_are_read_one_by_one_if_no_repair_helps():
    shared, a, b = 'VERSION ""\n', "BO_ 5 A: 8 X\nSG_ S;\n", "BO_ 6 B: 8 X\nSG_ T;\n"
    of_a, of_b = 'CM_ SG_ 5 S "c";\n', 'VAL_ 6 T 1 "a";\n'
    parts, definitions = [], Definitions("a.dbc")

    def load(text):
        parts.append(text)
        if "BO_ 6" in text:
            raise ValueError("it is\nodd")
        return SimpleNamespace(messages=["A"])

    database = dbc.mended(shared + a + b + of_a + of_b, load, definitions)
    assert database.messages == ["A"] and definitions.total == 1
    assert parts[-2:] == [shared + a + of_a, shared + b + of_b]
    message = "message `B` is not imported: it is odd"
    assert rows(definitions) == [("IMP070", "error", 4, message)]


def test_a_text_that_ends_within_a_statement_is_reported():
    text = "BU_: X;\nBO_ 5 A"
    message = "the file ends within line 2: `BO_ 5 A`"
    assert repaired(text) == (text, [("IMP075", "warning", 2, message)])
    for complete in ("BU_: X;", "BU_: X; \t", "BU_: X\n", "BU_: X\n  ", ""):
        assert repaired(complete) == (complete, [])


def unused(text, reported=()):
    account, definitions = Account(), Definitions("a.dbc")
    dbc.account_for(text, account, reported)
    account.report(definitions)
    return [
        (line, message.replace(" is not used", ""))
        for _, _, line, message in rows(definitions)
    ]


def test_statements_without_a_use_are_reported_with_their_first_line():
    text = (
        'VERSION "7"\n'
        'BA_ "GenMsgCycleTime" BO_ 5 10;\n'
        'BA_ "Other" SG_ 5 S 1;\n'
        'BA_ "Whole" 1;\n'
        'CM_ "EV_ 1";\n'
        'CM_ BU_ X "c";\nCM_ SG_ 5 S "c";\n'
        'EV_ E: 0 [0|1] "" 0 1 X;\nEV_ F: 0 [0|1] "" 0 1 X;\n'
    )
    assert unused(text) == [
        (1, "`VERSION`"),
        (3, "`Other` of `BA_` (`SG_ 5 S`)"),
        (4, "`Whole` of `BA_`"),
        (5, "`text of the network` of `CM_`"),
        (6, "`BU_` of `CM_`"),
        (8, "`EV_` (2 times)"),
    ]
    assert unused(text, {1, 3, 8})[-1] == (9, "`EV_`")
    assert unused('VERSION ""\nBU_: X\nNS_:\nBS_:\n') == []


def long(short, name="", attribute="SystemSignalLongSymbol", **more):
    hidden = {f"{attribute} of a DBC": SimpleNamespace(value=name)} if name else {}
    return SimpleNamespace(name=short, dbc=SimpleNamespace(attributes=hidden), **more)


def test_long_names_replace_short_ones_unless_they_are_taken():
    text = 'BA_ "SystemSignalLongSymbol" SG_ 5 S "Long";'
    hidden = dbc.with_short_names(text)
    assert hidden == text.replace('Symbol"', 'Symbol of a DBC"')
    signals = [
        long("M", "Mode", multiplexer_signal=None),
        long("S", "Speed of it", multiplexer_signal="M"),
        long("T", "U", multiplexer_signal="gone"),
        long("U", "Mode", multiplexer_signal=None),
        long("V", multiplexer_signal=None),
    ]
    calls = []
    message = long("A", "Alpha", "SystemMessageLongSymbol", signals=signals,
                   refresh=lambda strict: calls.append(strict))  # fmt: skip
    other = long("B", "Alpha", "SystemMessageLongSymbol", signals=[],
                 refresh=lambda strict: calls.append(strict))  # fmt: skip
    dbc.give_long_names([message, other])
    assert [signal.name for signal in signals] == ["Mode", "Speed of it", "T", "U", "V"]
    multiplexers = [signal.multiplexer_signal for signal in signals]
    assert multiplexers == [None, "Mode", "gone", None, None]
    assert (message.name, other.name, calls) == ("Alpha", "B", [False, False])
