"""Output of ``--check``: the files that are not current, and their first differing
lines.
"""

from __future__ import annotations

import difflib

from icdgen.generation.write import WritePlan

_FILES, _LINES = 5, 12


def short_diff(plans: list[WritePlan]) -> str:
    """Return a unified diff of the first files that differ, and the number of further
    files.
    """
    lines: list[str] = []
    for plan in plans:
        for index, name in enumerate(plan.write):
            path = plan.out / name
            if index >= _FILES:
                lines.append(f"... and {len(plan.write) - _FILES} more files differ\n")
                break
            if not path.exists():
                lines.append(f"missing: {path}\n")
                continue
            old = path.read_bytes().decode("utf-8", "replace").splitlines(keepends=True)
            new = plan.files[name].decode("utf-8").splitlines(keepends=True)
            diff = list(
                difflib.unified_diff(
                    old, new, f"{path} (on disk)", f"{path} (generated)", n=1
                )
            )
            lines += [
                line if line.endswith("\n") else line + "\n" for line in diff[:_LINES]
            ]
            if len(diff) > _LINES:
                lines.append(f"... {len(diff) - _LINES} more lines\n")
        lines += [f"stale: {plan.out / name}\n" for name in plan.remove]
    return "".join(lines)
