"""Documents with the features of real ones, each with a profile of at most 15 lines and
the expected result.

Names, numbers and texts are invented. The features come from data sheets and protocol
descriptions of battery management, sensors, receivers and motor controllers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from tests.importer.rules.drawing import draw, heading, open_table, table, text

NODE = "profile: 1\nnode: {byte_order: little, bit_order: lsb0, id_bits: 16}\nrules:\n"
BIG = NODE.replace("little", "big")


@dataclass
class Shape:
    """``messages``: name -> id, length, and the fields as (at, bits, name) with further
    keys that the ICD must have.
    """

    draw: Callable[[Path], Path]
    profile: str
    messages: dict[str, tuple[int, int, list[tuple]]]
    # Message and field -> keys of the ICD.
    facts: dict[tuple[str, str], dict] = field(default_factory=dict)
    enums: dict[str, dict[int, str]] = field(default_factory=dict)


SHAPES: dict[str, Shape] = {}


def shape(name: str, **keys) -> Callable:
    """Register a document; the function returns its parts."""

    def register(parts: Callable) -> Callable:
        SHAPES[name] = Shape(lambda path: draw(path, parts()), **keys)
        return parts

    return register


@shape(
    "an id in a sentence",
    profile=NODE
    + r"""  - tables: {head: Byte | Name | Type}
    message: {heading: '^[\d.]+ {message}$', before: 'with the command {id} and', kind: telemetry}
    columns: {Byte: '^{byte}(?:-{last_byte})?$', Name: name, Type: type}
    width: unit
""",
    messages={
        "Motor state": (0x31, 4, [(0, 8, "Mode"), (8, 16, "Speed"), (24, 8, "Load")]),
        "Supply": (0x32, 4, [(0, 16, "Voltage"), (16, 16, "Current")]),
    },
    facts={("Supply", "Current"): {"type": "int"}},
)
def _sentence() -> list:
    return [
        heading("3.1 Motor state", 2),
        text("The host asks for this frame with the command 0x31 and waits 10 ms."),
        table(
            [
                ["Byte", "Name", "Type"],
                ["0", "Mode", "uint8"],
                ["1-2", "Speed", "uint16"],
                ["3", "Load", "uint8"],
            ]
        ),
        heading("3.2 Supply", 2),
        text("The host asks for this frame with the command 0x32 and waits 20 ms."),
        table(
            [
                ["Byte", "Name", "Type"],
                ["0-1", "Voltage", "uint16"],
                ["2-3", "Current", "int16"],
            ]
        ),
    ]


@shape(
    "data bytes as columns",
    profile=NODE
    + r"""  - tables: {head: ID | Message | Data0}
    message: {kind: telemetry, length: 8}
    columns: {ID: id, Message: message, '*': name}
    melt: '^Data{byte}$'
    each: {type: uint}
""",
    messages={
        "Power": (
            0x101,
            8,
            [
                (0, 16, "Voltage"),
                (16, 16, "Current"),
                (32, 8, "Load"),
                (40, 24, "Energy"),
            ],
        ),
        "Drive": (
            0x102,
            8,
            [
                (0, 32, "Position"),
                (32, 16, "Torque"),
                (48, 8, "Gear"),
                (56, 8, "Faults"),
            ],
        ),
    },
)
def _columns() -> list:
    rows = [
        ["ID", "Message", *(f"Data{n}" for n in range(8))],
        ["0x101", "Power", "Voltage", "", "Current", "", "Load", "Energy", "", ""],
        ["0x102", "Drive", "Position", "", "", "", "Torque", "", "Gear", "Faults"],
    ]
    spans = [(2, 1, 3, 1), (4, 1, 5, 1), (7, 1, 9, 1), (2, 2, 5, 2), (6, 2, 7, 2)]
    return [heading("5 Frames"), table(rows, spans, [40, 45] + [48] * 8)]


@shape(
    "registers with bit, name, reset and access",
    profile=BIG
    + r"""  - tables: {head: BIT | NAME | RESET | ACCESS}
    what: registers
    transpose: true
    message: {caption: '^{message} \({id}\)$', kind: configuration}
    columns: {BIT: ['^{last_bit}:{bit}$', bit], NAME: ['^{name:[A-Z]+}{part:\d+}$', name], RESET: default, ACCESS: access}
    width: unit
    each: {type: uint}
    glue: [NAME]
""",
    messages={
        "CTRL1": (
            0x04,
            1,
            [(0, 3, "GAIN"), (3, 1, "EN"), (4, 2, "MODE"), (7, 1, "SHUT")],
        ),
        "BALANCE": (0x05, 1, [(0, 5, "CELL")]),
    },
)
def _registers() -> list:
    return [
        text("Table 1: CTRL1 (0x04)"),
        table(
            [
                ["BIT", "7", "6", "5", "4", "3", "2", "1", "0"],
                ["NAME", "SHUT", "RSVD", "MODE", "", "EN", "GAIN", "", ""],
                ["RESET", "0", "0", "00", "", "1", "000", "", ""],
                ["ACCESS", "RW", "R", "RW", "", "RW", "RW", "", ""],
            ],
            [(c, r, d, r) for r in (1, 2, 3) for c, d in ((3, 4), (6, 8))],
            [50] + [40] * 8,
        ),
        text("Table 2: BALANCE (0x05)"),
        table(
            [
                ["BIT", "7", "6", "5", "4", "3", "2", "1", "0"],
                [
                    "NAME",
                    "RSVD",
                    "RSVD",
                    "RSVD",
                    "CELL5",
                    "CELL4",
                    "CELL3",
                    "CELL2",
                    "CELL1",
                ],
                ["RESET", *"00000000"],
                ["ACCESS", *["RW"] * 8],
            ],
            widths=[50] + [42] * 8,
        ),
    ]


@shape(
    "lines of bytes in a cell",
    profile=BIG
    + r"""  - tables: {head: Data Message | Data ID}
    message: {kind: telemetry, length: 8}
    columns: {Data Message: message, Data ID: id}
    ignore: [UPPER-BMS]
    keep: {UPPER-BMS: Received}
    lines:
      Note Remark:
        - '^Byte{byte}(?:~Byte{last_byte})?: ?{name} ?(?:\((?:{bias} Offset, ?)?{scale} ?{unit}\))?$'
        - '^Byte{byte}:$'
        - '^Bit{bit}(?:~Bit{last_bit})?: ?{name}$'
    width: unit
    each: {type: uint}
""",
    messages={
        "Pack": (0x90, 8, [(0, 16, "Voltage"), (32, 16, "Current"), (48, 16, "SOC")]),
        "Switches": (0x93, 8, [(0, 2, "State"), (2, 1, "Charge"), (8, 8, "Cycles")]),
    },
    facts={
        ("Pack", "Current"): {"formula": "(raw - 30000)*0.1", "unit": "A"},
        ("Pack", "Voltage"): {"formula": "raw*0.1", "unit": "V"},
    },
)
def _lines() -> list:
    pack = "Byte0~Byte1: Voltage (0.1 V)\nByte2~Byte3: Reserved\n"
    pack += "Byte4~Byte5: Current (30000 Offset, 0.1A)\nByte6~Byte7: SOC (0.1 %)"
    state = "Byte0:\nBit0~Bit1: State\nBit2: Charge\nBit3~Bit7: Spare\nByte1: Cycles\nByte2~Byte7: Reserved"
    return [
        heading("4 Communication content"),
        table(
            [
                ["Data Message", "Data ID", "UPPER-BMS", "Note Remark"],
                ["Pack", "0x90", "Send", "Reserved bytes"],
                ["", "", "Received", pack],
                ["Switches", "0x93", "Send", "Reserved bytes"],
                ["", "", "Received", state],
            ],
            [(0, 1, 0, 2), (1, 1, 1, 2), (0, 3, 0, 4), (1, 3, 1, 4)],
        ),
    ]


@shape(
    "captions below",
    profile=NODE
    + r"""  - tables: {head: Offset | Size | Field}
    message: {caption: '^{message}, id {id}$', kind: telecommand}
    columns: {Offset: byte, Size: bytes, Field: name}
    each: {type: uint}
""",
    messages={
        "Set speed": (0x11, 3, [(0, 1 * 8, "Axis"), (8, 16, "Speed")]),
        "Set gain": (0x12, 5, [(0, 8, "Axis"), (8, 32, "Gain")]),
    },
)
def _below() -> list:
    return [
        heading("6 Commands"),
        text("The following commands have parameters."),
        table([["Offset", "Size", "Field"], ["0", "1", "Axis"], ["1", "2", "Speed"]]),
        text("Table 1: Set speed, id 0x11"),
        text("Commands are acknowledged."),
        table([["Offset", "Size", "Field"], ["0", "1", "Axis"], ["1", "4", "Gain"]]),
        text("Table 2: Set gain, id 0x12"),
    ]


@shape(
    "two levels of headings",
    profile=NODE
    + r"""  - rule: reply
    tables: {head: Byte | Content, heading: 'Replies'}
    message: {heading: '^[\d.]+ {message} \({id}\)', kind: telemetry}
    columns: {Byte: '^{byte}(?:\.\.{last_byte})?$', Content: name}
    each: {type: uint}
    width: unit
  - {like: reply, tables: {heading: 'Commands'}, message: {kind: telecommand}}
""",
    messages={
        "Start": (0x21, 2, [(0, 16, "Ramp")]),
        "Status": (0x22, 3, [(0, 8, "State"), (8, 16, "Error")]),
    },
)
def _levels() -> list:
    return [
        heading("7 Commands", 1),
        heading("7.1 Start (0x21)", 2),
        table([["Byte", "Content"], ["0..1", "Ramp"]]),
        heading("8 Replies", 1),
        heading("8.1 Status (0x22)", 2),
        table([["Byte", "Content"], ["0", "State"], ["1..2", "Error"]]),
    ]


@shape(
    "offsets in a column",
    profile=NODE
    + r"""  - tables: {head: Num | Parameter | Starting position}
    message: {heading: '\({message:\w+}\) ID:{id}$', kind: telemetry}
    columns:
      Parameter: name
      Starting position: bit
      Bit length: bits
      Range: '{min:-?\d+}~{max:-?\d+}'
      Resolution: scale
      Offset: offset
      Unit: unit
    each: {type: uint}
    ignore: [Num]
""",
    messages={
        "STATE": (
            0x2F4,
            8,
            [
                (0, 16, "Voltage"),
                (16, 16, "Current"),
                (32, 8, "Temperature"),
                (40, 24, "Energy"),
            ],
        )
    },
    facts={
        ("STATE", "Current"): {
            "formula": "raw*0.1 - 400",
            "unit": "A",
            "min": -400,
            "max": 400,
        },
        ("STATE", "Temperature"): {"formula": "raw - 50", "unit": "C"},
    },
)
def _offsets() -> list:
    rows = [
        [
            "Num",
            "Parameter",
            "Starting position",
            "Bit length",
            "Range",
            "Resolution",
            "Offset",
            "Unit",
        ],
        ["1", "Voltage", "0", "16", "0~1000", "0.1", "0", "V"],
        ["2", "Current", "16", "16", "-400~400", "0.1", "-400", "A"],
        ["3", "Temperature", "32", "8", "-50~200", "1", "-50", "C"],
        ["4", "Energy", "40", "24", "0~100000", "1", "0", "J"],
    ]
    return [heading("4.1 Basic state (STATE) ID:0x02F4", 2), table(rows)]


@shape(
    "repeated groups",
    profile=NODE
    + r"""  - tables: {head: Offset (bytes) | Size (bytes) | Format | Units | Name}
    message: {caption: '^{message:\w+} {id} message', kind: telemetry}
    columns:
      Offset (bytes): ['^{stride}N \+ {byte}$', byte]
      Size (bytes): bytes
      Format: ['^{type}\[{count}\]$', type]
      Units: ['^{scale} {unit}$', unit]
      Name: ['^{group:\w+}\[N\]\.{name}$', name]
    skip: Total Payload Length
    set: [{where: {group: .}, rest: 'yes', up_to: 20}]
""",
    messages={
        "OBS": (0x4A, 5, [(0, 32, "tow"), (32, 8, "flags"), (40, 32 + 8 + 16, "obs")])
    },
    facts={
        ("OBS", "tow"): {"unit": "ms"},
        ("OBS", "obs"): {"count": "rest", "up_to": 20, "struct": "OBS obs"},
    },
)
def _groups() -> list:
    rows = [
        ["Offset (bytes)", "Size (bytes)", "Format", "Units", "Name"],
        ["0", "4", "u32", "ms", "tow"],
        ["4", "1", "u8", "", "flags"],
        ["7N + 5", "4", "u32", "0.02 m", "obs[N].P"],
        ["7N + 9", "1", "u8", "0.25 dB", "obs[N].cn0"],
        ["7N + 10", "2", "u8[2]", "", "obs[N].lock"],
        ["", "7N + 5", "", "", "Total Payload Length"],
    ]
    return [
        heading("2 Observations"),
        text("Table 2: OBS 0x004A message structure"),
        table(rows),
    ]


@shape(
    "a register map whose cells span bits",
    profile=NODE
    + r"""  - tables: {head: Addr | Name | D7}
    what: registers
    message: {kind: configuration, length: 1}
    columns: {Addr: id, Name: message, '*': ['^{name}\[{last_part}:{part}\]$', name]}
    melt: '^D{bit}$'
    each: {type: uint}
  - tables: {head: Code | Rate}
    what: enumeration
    message: {heading: '^{of:\w+} codes$'}
    columns: {Code: value, Rate: member}
    base: 2
""",
    messages={
        "CTRL": (
            0x20,
            1,
            [(0, 1, "EN"), (1, 1, "BOOT"), (3, 2, "MODE"), (5, 3, "ODR")],
        ),
        "FIFO": (0x2E, 1, [(0, 5, "WTM"), (5, 3, "FM")]),
    },
    facts={("CTRL", "ODR"): {"type": "enum", "enum": "ODR"}},
    enums={"ODR": {0: "1 Hz", 1: "7 Hz", 2: "12 Hz"}},
)
def _map() -> list:
    rows = [
        ["Addr", "Name", *(f"D{n}" for n in range(7, -1, -1))],
        ["20h", "CTRL", "ODR[2:0]", "", "", "MODE[1:0]", "", "Reserved", "BOOT", "EN"],
        ["2Eh", "FIFO", "FM[2:0]", "", "", "WTM[4:0]", "", "", "", ""],
    ]
    spans = [(2, 1, 4, 1), (5, 1, 6, 1), (2, 2, 4, 2), (5, 2, 9, 2)]
    return [
        heading("6 Register map"),
        table(rows, spans, [35, 40] + [48] * 8),
        heading("ODR codes", 2),
        table([["Code", "Rate"], ["00", "1 Hz"], ["01", "7 Hz"], ["10", "12 Hz"]]),
    ]


@shape(
    "one cell with position, size, factor and unit",
    profile=BIG
    + r"""  - tables: {head: Data content | Bytes | Mark}
    message: {before: 'read {message} with {id}$', kind: telemetry}
    columns: {Data content: name, Bytes: '^{bytes} ?BYTE(?:,unit {scale}{unit})?$', Mark: text}
    each: {type: uint}
    set: [{where: {name: ^Current$}, type: int}]
    join: [Bytes]
""",
    messages={
        "basic info": (
            0x03,
            7,
            [
                (0, 16, "Voltage"),
                (16, 16, "Current"),
                (32, 16, "Capacity"),
                (48, 8, "Cells"),
            ],
        )
    },
    facts={
        ("basic info", "Current"): {"type": "int", "formula": "raw*10", "unit": "mA"}
    },
)
def _cell() -> list:
    rows = [
        ["Data content", "Bytes", "Mark"],
        ["Voltage", "2BYTE,unit 10mV", "high byte first"],
        ["Current", "2BYTE,unit 10mA", "charging is positive"],
        ["Capacity", "2BYTE,unit 10mAh", ""],
        ["Cells", "1BYTE", "number of cells"],
    ]
    return [heading("2 Commands"), text("read basic info with 0x03"), table(rows)]


@shape(
    "headings that nobody knows and no vertical rules, captions below",
    profile=BIG
    + r"""  - tables: {head: Quantity | Where | Breadth | Coding}
    message: {caption: '^{message} \[{id}\]$', kind: telemetry}
    columns: {Quantity: name, Where: byte, Breadth: bytes, Coding: type, Per step: '^{scale} {unit}$'}
captions: [Listing]
""",
    messages={
        "Fan": (
            0x91,
            6,
            [(0, 16, "Speed of the fan"), (16, 16, "Current"), (32, 16, "Temperature")],
        ),
        "Supply": (0x92, 3, [(0, 16, "Voltage"), (16, 8, "Load")]),
    },
    facts={("Fan", "Current"): {"type": "int", "formula": "raw*10", "unit": "mA"}},
)
def _unknown() -> list:
    head = ["Quantity", "Where", "Breadth", "Coding", "Per step"]
    fan = [
        ["Speed of the fan", "0", "2", "u16", "0.5 rpm"],
        ["Current", "2", "2", "s16", "10 mA"],
        ["Temperature", "4", "2", "s16", "0.1 C"],
    ]
    supply = [["Voltage", "0", "2", "u16", "1 mV"], ["Load", "2", "1", "u8", "1 %"]]
    return [
        heading("7 Reports"), text("These are sent on request."), open_table([head, *fan]), text("Listing 1: Fan [0x91]"),
        text("And this one once a second."), open_table([head, *supply]), text("Listing 2: Supply [0x92]"),
    ]  # fmt: skip


@shape(
    "horizontal rules only, over two pages",
    profile=NODE
    + r"""  - tables: {head: Byte | Name | Type | Description}
    message: {caption: '^{message} \({id}\)$', kind: telemetry}
    columns: {Byte: byte, Name: name, Type: type, Description: text}
""",
    messages={
        "Housekeeping": (0x41, 60, [(16 * n, 16, f"Channel {n}") for n in range(30)])
    },
)
def _open() -> list:
    rows = [
        [str(2 * n), f"Channel {n}", "uint16", f"Voltage of channel {n}"]
        for n in range(30)
    ]
    head = ["Byte", "Name", "Type", "Description"]
    return [
        heading("9 Telemetry"), *[text("Prose. " * 60)] * 7, text("Table 3: Housekeeping (0x41)"),
        open_table([head, *rows], [50, 90, 60, 200]),
    ]  # fmt: skip
