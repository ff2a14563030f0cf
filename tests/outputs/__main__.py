"""``python -m tests.outputs REVISION``: compares everything that icdgen generates with
the output of another revision.

Both revisions get the ICDs of the working tree: shipped, examples, documents, odd and
random ones. All languages, the site, `show`, `check`, the reports about wrong ICDs and
the reports of the diff are compared. The exit status is 0 if nothing differs.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.outputs.inputs import ROOT, commands

DRIVER = Path(__file__).parent / "driver.py"


def run(
    sources: Path, listed: Path, work: Path, jobs: int
) -> dict[str, dict[str, str]]:
    """Run all commands with the icdgen in a checkout.

    Return digests by command and output.
    """
    paths = os.pathsep.join(
        str(sources / part) for part in ("codegen", "runtime/python")
    )
    # Outputs must not depend on the terminal or on the order of sets.
    environment = os.environ | {
        "PYTHONPATH": paths,
        "PYTHONHASHSEED": "0",
        "COLUMNS": "120",
        "TERM": "dumb",
    }
    results = [work / f"{sources.name}-{part}.json" for part in range(jobs)]
    running = [
        subprocess.Popen(
            [
                sys.executable,
                str(DRIVER),
                str(listed),
                str(result),
                str(part),
                str(jobs),
            ],
            cwd=ROOT,
            env=environment,
        )
        for part, result in enumerate(results)
    ]
    if any(process.wait() for process in running):
        raise SystemExit("the driver failed: see above")
    return {
        name: digests
        for result in results
        for name, digests in json.loads(result.read_text("utf-8")).items()
    }


def differences(
    before: dict[str, dict[str, str]], after: dict[str, dict[str, str]]
) -> list[str]:
    """Describe the commands whose outputs differ, one per line, with the names of some
    outputs.
    """
    lines = []
    for command in sorted(before.keys() | after.keys()):
        old, new = before.get(command, {}), after.get(command, {})
        changed = [
            output
            for output in sorted(old.keys() | new.keys())
            if old.get(output) != new.get(output)
        ]
        if changed:
            shown = ", ".join(_described(output, old, new) for output in changed[:5])
            lines.append(
                f"{command}: {len(changed)} of {len(old)} outputs differ: {shown}"
            )
    return lines


def _described(output: str, old: dict[str, str], new: dict[str, str]) -> str:
    """Name an output; add whether only one of the revisions has it."""
    if output not in old:
        return f"{output} (new)"
    return f"{output} (gone)" if output not in new else output


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "revision", help="revision to compare with, or a file that --record wrote"
    )
    parser.add_argument(
        "--record",
        action="store_true",
        help="only write the digests of the working tree into the file",
    )
    parser.add_argument(
        "--random", type=int, default=40, help="number of random ICDs (default: 40)"
    )
    parser.add_argument(
        "--jobs",
        type=int,
        default=os.cpu_count(),
        help="processes (default: one per core)",
    )
    parser.add_argument(
        "--only", default="", help="only commands whose name contains this text"
    )
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        chosen_commands = [
            command
            for command in commands(chosen.random)
            if chosen.only in command.name
        ]
        listed = work / "commands.json"
        listed.write_text(json.dumps(chosen_commands), "utf-8")
        current = run(ROOT, listed, work, chosen.jobs)
        if chosen.record:
            Path(chosen.revision).write_text(json.dumps(current), "utf-8")
            print(
                f"{sum(map(len, current.values())):,} outputs of {len(current):,} commands recorded"
            )
            return
        if Path(chosen.revision).is_file():
            recorded = json.loads(Path(chosen.revision).read_text("utf-8"))
            before = {name: recorded[name] for name in recorded if chosen.only in name}
        else:
            checkout = work / "before"
            subprocess.run(
                [
                    "git",
                    "worktree",
                    "add",
                    "--quiet",
                    "--detach",
                    checkout,
                    chosen.revision,
                ],
                cwd=ROOT,
                check=True,
            )
            try:
                before = run(checkout, listed, work, chosen.jobs)
            finally:
                subprocess.run(
                    ["git", "worktree", "remove", "--force", checkout],
                    cwd=ROOT,
                    check=True,
                )
    lines = differences(before, current)
    print(*lines[:200], sep="\n")
    print(
        f"{sum(map(len, current.values())):,} outputs of {len(current):,} commands compared: {len(lines):,} differences"
    )
    sys.exit(bool(lines))


if __name__ == "__main__":
    main()
