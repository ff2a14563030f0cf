"""Texts on the pages are shown and entered like in the reference codec."""

from __future__ import annotations

import json
import random

from icdgen import codec
from icdgen.icd.layout import Scalar
from tests.conftest import ROOT
from tests.site.javascript import run_script

HTML = ROOT / "templates" / "html"
LABEL = Scalar(name="Label", at=0, bits=64, type="text")
SCRIPT = f"""
const fs = require("node:fs");
const folder = {json.dumps(str(HTML))};
const source = ["codec.js", "frames.js", "values.js"].map((name) => fs.readFileSync(`${{folder}}/${{name}}`, "utf8"));
const values = new Function(source.join("\\n").replaceAll('"use strict";', "") + "; return icdgenValues;")();
const field = {{ name: "Label", type: "bytes", text: true, bits: 64, first: 0 }};
const typed = (text) => {{ try {{ return [...values.parsePhysical(field, text)]; }} catch (error) {{ return null; }} }};
const {{ raw, texts }} = argument;
const shown = raw.map((bytes) => values.physicalText(field, Uint8Array.from(bytes)));
return {{ shown, typed: texts.map(typed) }};
"""


def _typed(text: str) -> list[int] | None:
    try:
        return list(codec.raw_from_text(LABEL, text))
    except codec.CodecError:
        return None


def test_texts_are_shown_and_entered_like_in_the_reference_codec():
    source = random.Random(1)
    raw = [
        bytes(source.choice((0, 65, 97, 127, 128, 255)) for _ in range(8))
        for _ in range(300)
    ]
    letters = "aZ9 ~\x01\x7f\0\x80é位"
    texts = [
        "".join(
            source.choices(
                letters, (9, 9, 9, 9, 9, 1, 1, 1, 1, 1, 1), k=source.randint(0, 9)
            )
        )
        for _ in range(300)
    ]
    results = run_script(SCRIPT, {"raw": [list(data) for data in raw], "texts": texts})
    assert results == {
        "shown": [codec.text(data) for data in raw],
        "typed": [_typed(text) for text in texts],
    }
    assert None in results["typed"] and any(results["typed"])
