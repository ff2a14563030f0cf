"""Write the declared protocol facts into the JSON Schema of ICDs and into the types of
`runtime/`.

python -m scripts.protocol_facts
"""

from __future__ import annotations

from pathlib import Path

from scripts.protocol_types import c, python, rust, schema

ROOT = Path(__file__).parent.parent
MAKERS = {
    "codegen/icdgen/icd/schema.json": schema.written,
    "runtime/python/icdgen_runtime/wire/link.py": python.written,
    "runtime/python/icdgen_runtime/wire/packet_formats.py": python.written,
    **{
        f"runtime/c/wire/{name}.h": c.written
        for name in ("forms", "procedure_forms", "link")
    },
    **{
        f"runtime/rust/src/wire/link/{name}.rs": rust.written
        for name in ("mod", "can", "logs")
    },
}


def out_of_date() -> dict[Path, str]:
    """Return the outdated files with their new text."""
    current_texts = {
        ROOT / path: make((ROOT / path).read_text(encoding="utf-8"))
        for path, make in MAKERS.items()
    }
    return {
        path: text
        for path, text in current_texts.items()
        if text != path.read_text(encoding="utf-8")
    }


def main() -> None:
    for path, text in out_of_date().items():
        path.write_text(text, encoding="utf-8")
        print(f"written: {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
