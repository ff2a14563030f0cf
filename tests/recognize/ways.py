"""Forms of the same frame: attitude angles of -12.34, 0.1 and 0 degrees, telemetry 146
of CubeACP.
"""

from __future__ import annotations

DATA = bytes.fromhex("2efb0a000000")

# Forms of bare data, which need the name of the message.
BARE = {
    "words": "2efb 0a00 0000",
    "pairs": "2E FB 0A 00 00 00",
    "joined": "2efb0a000000",
    "0x and commas": "0x2e, 0xfb, 0x0a, 0x00, 0x00, 0x00",
    "0x with one digit": "0x2e 0xfb 0xa 0x0 0x0 0x0",
    "0x once": "0x2efb0a000000",
    "colons": "2E:FB:0A:00:00:00",
    "dashes": "2e-fb-0a-00-00-00",
    "escapes": r"\x2e\xfb\x0a\x00\x00\x00",
    "dollars": "$2e $fb $0a $00 $00 $00",
    "braces": "{0x2e, 0xfb, 0x0a, 0x00, 0x00, 0x00}",
    "array of C": "uint8_t frame[6] = {0x2E, 0xFB, 0x0A, 0, 0, 0};",
    "array of C with comments": "static const uint8_t f[] = { 0x2EU, 0xFBU, /* pitch */ 0x0A, 0, // end\n 0, 0 };",
    "array of Rust": "let frame = [0x2eu8, 0xfb, 0x0a, 0, 0, 0];",
    "decimal list": "[46, 251, 10, 0, 0, 0]",
    "bytes of a list": "bytes([46, 251, 10, 0, 0, 0])",
    "Uint8Array": "new Uint8Array([46, 251, 10, 0, 0, 0])",
    "fromhex": 'bytes.fromhex("2efb0a000000")',
    "macro of Rust": 'hex!("2efb0a000000")',
    "repr of Python": r"b'.\xfb\n\x00\x00\x00'",
    "bytearray": r"bytearray(b'.\xfb\n\x00\x00\x00')",
    "list of strings": "['2e', 'fb', '0a', '00', '00', '00']",
    "list of hex()": "['0x2e', '0xfb', '0xa', '0x0', '0x0', '0x0']",
    "angles": "<2E><FB><0A><00><00><00>",
    "h after each": "2Eh FBh 0Ah 00h 00h 00h",
    "decimal words": "46 251 10 0 0 0",
    "base64": "LvsKAAAA",
    "xxd": "00000000: 2efb 0a00 0000                           ......",
    "xxd before 2016": "0000000: 2efb 0a00 0000                           ......",
    "hexdump -C": "00000000  2e fb 0a 00 00 00                                 |......|\n00000006",
    "hexdump": "0000000 fb2e 000a 0000\n0000006",
    "od": "0000000 2e fb 0a 00 00 00\n0000006",
    "packet analyser": "0000   2e fb 0a 00 00 00   ......",
    "on lines": "2e fb\n0a 00\n00 00\n",
    "after a label": "RX: 2E FB 0A 00 00 00",
    "after a time": "[12:00:01.5] RX: 2E FB 0A 00 00 00",
    "after a date": "2025-01-01 12:00:01.123 2E FB 0A 00 00 00",
    "after a date without fraction": "2025-01-01 12:00:01 2E FB 0A 00 00 00",
    "after a date and a label": "2025-01-01T12:00:01.5 recv: 2E FB 0A 00 00 00",
    "after an arrow": "<< 2E FB 0A 00 00 00",
}

# Forms with the id of the message.
WHOLE = {
    "UART": "1F 7F 92 2E FB 0A 00 00 00 1F FF",
    "UART, after noise": "00 FF 1F 7F 92 2E FB 0A 00 00 00 1F FF",
    "UART, dumped": "00000000: 1f7f 922e fb0a 0000 001f ff              ...........",
    "UART, base64": "H3+SLvsKAAAAH/8=",
    "UART, array of C": "{0x1F, 0x7F, 0x92, 0x2E, 0xFB, 0x0A, 0x00, 0x00, 0x00, 0x1F, 0xFF}",
    "id and data": "92 2E FB 0A 00 00 00",
    "candump": "  can0  05920201   [6]  2E FB 0A 00 00 00",
    "candump with time": " (000.000000)  can0  05920201   [6]  2E FB 0A 00 00 00   '......'",
    "log of candump": "(1436509052.249713) vcan0 05920201#2EFB0A000000",
    "cansend": "05920201#2EFB0A000000",
    "cansend, CAN FD": "05920201##12EFB0A000000",
    "slcan": "T0592020162EFB0A000000",
    "slcan with time": "T0592020162EFB0A0000001234",
}
