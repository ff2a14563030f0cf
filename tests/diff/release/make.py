"""Write the reconstructed older release, made from the current ICDs: ``python -m
tests.diff.release FOLDER``.
"""

from __future__ import annotations

import re
from pathlib import Path

import yaml

from icdgen.diagnostics import Finding
from icdgen.loading import load
from tests.conftest import ROOT

FACTS = Path(__file__).with_name("reconstruction.yaml")
SHIPPED = ROOT / "icd"

_AT = re.compile(r"(?<=\{at: )( *)([0-9]+)(?=,)")
_NAME = re.compile(r"name: (?:\"([^\"]*)\"|([^,}\n]*))")
_MARK = "Reconstructed older release"
_LONGER = """\
  - id: {id}
    title: "{name}: the last bytes of the older frame are not known"
    where: {{message: {name}}}
    accept: [ICD024]
    why: Reconstructed. Only the length of the older frame is public.
    evidence: Flight software for older firmware.
    confidence: open
"""


def facts() -> dict:
    return yaml.safe_load(FACTS.read_text(encoding="utf-8"))


def make(folder: Path) -> Path:
    """Write ICDs and overlays and return the folder."""
    all_facts = facts()
    (folder / "errata").mkdir(parents=True, exist_ok=True)
    longer: dict[str, list[str]] = {}
    for path in sorted(SHIPPED.glob("*.yaml")):
        text = path.read_text(encoding="utf-8")
        head, *messages = re.split(r"(?m)^(?=  - name: )", text)
        for index, message in enumerate(messages):
            name = _first_name(message)
            if name in all_facts["lengths"] and "\n    length: " in message:
                messages[index] = _older(
                    message,
                    all_facts["lengths"][name],
                    all_facts["removed"].get(name, []),
                )
                if _described(messages[index]) < all_facts["lengths"][name]:
                    longer.setdefault(path.stem, []).append(name)
        (folder / path.name).write_text(
            f"# {_MARK}\n{head}{''.join(messages)}", encoding="utf-8"
        )
    for path in sorted((SHIPPED / "errata").glob("*.yaml")):
        overlay = yaml.safe_load(path.read_text(encoding="utf-8"))
        for number, name in enumerate(longer.get(path.stem, ()), 1):
            overlay.setdefault("entries", []).extend(
                yaml.safe_load(_LONGER.format(id=f"OLD-{number:03}", name=name))
            )
        _write(folder / "errata" / path.name, overlay)
    _settle(folder)
    return folder


def _first_name(text: str) -> str:
    match = _NAME.search(text)
    return (match[1] or match[2]).strip()


def _older(message: str, length: int, removed: list[str]) -> str:
    """Return the message without the removed fields; the fields after them move up."""
    lines, gone = [], 0
    for line in message.splitlines(keepends=True):
        if line.startswith("      - {message:") or line == "    contains:\n":
            continue  # the contained messages have moved
        if line.startswith("      - {at:"):
            if _first_name(line) in removed:
                gone += int(re.search(r"bits: ([0-9]+)", line)[1])
                continue
            line = _AT.sub(lambda m: f"{m[1]}{int(m[2]) - gone}", line)  # noqa: B023
        lines.append(line)
    return re.sub(r"(?m)^    length: [0-9]+", f"    length: {length}", "".join(lines))


def _described(message: str) -> int:
    """Return the number of bytes up to the end of the last field."""
    rows = re.findall(r"\{at: +([0-9]+), +bits: +([0-9]+)", message)
    return max((int(at) + int(bits) for at, bits in rows), default=0) // 8


def _settle(folder: Path) -> None:
    """Remove inapplicable entries from the overlays until none is left."""
    for _ in range(20):
        loaded = load([folder])
        for fault in loaded.findings:
            if fault.code == "ICD045":  # the log stores the frame with another length
                _accept(folder, fault, loaded.texts)
        faults = [
            f for f in loaded.findings if f.code in ("ICD080", "ICD081", "ICD084")
        ]
        if not faults:
            return
        for path in sorted((folder / "errata").glob("*.yaml")):
            mine = {f.place.line for f in faults if f.place.file == str(path)}
            if mine:
                _mend(path, mine)
    raise AssertionError("the overlays do not settle")


def _accept(folder: Path, fault: Finding, texts: dict[str, str]) -> None:
    line = texts[fault.place.file].splitlines()[fault.place.line - 1]
    bit = int(re.search(r"bit: ([0-9]+)", line)[1])
    entry = yaml.safe_load(
        _LONGER.format(id=f"OLD-{900 + bit}", name=_first_name(line))
    )[0]
    entry |= {
        "where": {"loggable": bit},
        "accept": ["ICD045"],
        "title": "The log holds the frame in another length",
    }
    path = folder / "errata" / Path(fault.place.file).name
    with path.open("a", encoding="utf-8") as file:
        file.write(yaml.safe_dump([entry], sort_keys=False))


def _mend(path: Path, lines: set[int]) -> None:
    """Remove entries with mistakes. If other places of the entry are valid, remove only
    the invalid ones and correct `places`.
    """
    texts = re.split(r"(?m)^(?=- |[a-z])", path.read_text(encoding="utf-8"))
    line, text_parts = 1, []
    for text in texts:
        end = line + text.count("\n")
        hits = {number - line for number in lines if line <= number < end}
        if hits and "\n  places: " in text:
            text_parts.append(
                re.sub(
                    r"(?m)^  places: ([0-9]+)$",
                    lambda m: f"  places: {int(m[1]) - 1}",
                    text,
                )
            )
        elif hits:
            text_parts.append(_without_places(text, hits))
        else:
            text_parts.append(text)
        line = end
    path.write_text("".join(text_parts), encoding="utf-8")


def _without_places(entry: str, hits: set[int]) -> str:
    """Return the entry without the places in these lines. Empty if no place is left, or
    if the mistake is outside the places.
    """
    # Split at the keys of the entry, and at the items of its list of places.
    parts = re.split(r"(?m)^(?=  (?:- |[a-z]))", entry)
    at, key, left, text_parts, used_hits = 0, "", 0, [], set()
    for part in parts:
        is_place = key == "where" and part.startswith("  - ")
        here = {hit for hit in hits if at <= hit < at + part.count("\n")}
        if here and is_place:
            used_hits |= here
        else:
            text_parts.append(part)
            left += is_place
        key = key if part.startswith("  - ") else part.split(":")[0].strip()
        at += part.count("\n")
    return "".join(text_parts) if used_hits == hits and left else ""


def _write(path: Path, overlay: dict) -> None:
    entries = overlay.pop("entries", [])
    dump = lambda value: yaml.safe_dump(  # noqa: E731
        value, sort_keys=False, allow_unicode=True, width=10_000
    )
    # The entries come last, because `_accept` appends further ones.
    end = f"entries:\n{dump(entries)}" if entries else ""
    path.write_text(f"# {_MARK}\n{dump(overlay)}{end}", encoding="utf-8")
