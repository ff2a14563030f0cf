"""ICDs whose texts are markup, scripts, template code or very long. The site must show
them as plain text.
"""

from __future__ import annotations

import json
from pathlib import Path

MARKUP = '<script>document.title="broken"</script><img src=x onerror=alert(1)>'
TEMPLATE = "{{ 7*7 }} {% raw %} {# #} ${alert(1)} `x`"
QUOTES = (
    "\"'></a></table></svg></textarea></title> --> ]]> </script> &lt; \\ \u2028 \u202e"
)
ENDLESS = "endless " + "x" * 9_990


def write(folder: Path) -> Path:
    """Write the ICD into the folder and return the folder."""
    folder.mkdir()
    (folder / "hostile.yaml").write_text(json.dumps(ICD), encoding="utf-8")
    (folder / "empty.yaml").write_text(json.dumps(EMPTY), encoding="utf-8")
    return folder


ICD = {
    "icdgen": 1,
    "node": {
        "name": "hostile", "title": MARKUP, "summary": QUOTES, "byte_order": "big", "bit_order": "msb0",
        "source": {"document": MARKUP, "version": QUOTES},
    },
    "units": [{"symbol": "<b>", "identifier": "b", "quantity": MARKUP, "summary": QUOTES}],
    "enums": [
        {"name": MARKUP, "identifier": "first enum", "summary": TEMPLATE, "members": [
            {"value": 0, "name": QUOTES, "identifier": "quotes", "summary": MARKUP},
            {"value": 1, "name": TEMPLATE, "identifier": "template"},
            {"value": 18446744073709551615, "name": "last"},
        ]},
    ],
    "messages": [
        {
            "name": MARKUP, "identifier": "index", "id": 1, "kind": "telemetry", "length": 33, "group": QUOTES, "summary": TEMPLATE,
            "fields": [
                {"at": 3, "bits": 64, "name": MARKUP, "identifier": "con", "type": "enum", "enum": MARKUP, "summary": QUOTES},
                {"at": 67, "bits": 13, "name": QUOTES, "identifier": "quotes", "type": "int", "unit": "<b>", "formula": "raw*5/9"},
                {
                    "at": 80, "bits": 8, "name": TEMPLATE, "identifier": "jinja", "type": "uint",
                    "special": [{"value": 3, "meaning": MARKUP}],
                },
                {"at": 88, "bits": 64, "name": ENDLESS, "identifier": "endless", "type": "float"},
                {"at": 152, "bits": 32, "name": "__proto__", "type": "float"},
                {"at": 184, "bits": 16, "name": "constructor", "type": "bytes"},
                {"at": 200, "bits": 64, "name": ENDLESS[:-4] + "text", "identifier": "label", "type": "text"},
            ],
        },
        {"name": "aux", "identifier": "aux message", "id": 7, "kind": "telecommand", "length": 0, "summary": MARKUP},
        {
            "name": ENDLESS, "identifier": "endless " + "y" * 300, "set_id": 60, "get_id": 61, "kind": "configuration",
            "length": 4096, "fields": [{"at": 0, "bits": 32768, "name": "A whole page", "type": "bytes"}],
        },
    ],
    "missing": [{"kind": "telemetry", "id": 9, "name": MARKUP, "why": QUOTES}],
}  # fmt: skip

EMPTY = {
    "icdgen": 1,
    "node": {
        "name": "empty",
        "title": "Nothing",
        "byte_order": "little",
        "bit_order": "lsb0",
    },
}
