"""Build the client of `tests.sim.harness` from the generated C.

``python -m tests.c.sim_client FOLDER`` builds it in a folder and prints its path.
"""

from __future__ import annotations

import sys
from pathlib import Path

import jinja2

from icdgen.backends.c.names import stem
from icdgen.describe import MessageDescription, describe
from icdgen.icd.model import CONFIGURATION, Icd
from icdgen.protocol import facts
from tests.c import harness
from tests.conformance import ROOT

NODE = "cubeacp"


def source(icd: Icd, node_name: str = NODE) -> str:
    """Return the source of the client."""
    node = icd.node(node_name)
    protocol = facts.of(icd, node)
    descriptions = describe(icd).node(node).all_messages
    plans = {message.model.name: message for message in descriptions}
    telecommands = [plans[m.name] for m in protocol.telecommands.values()]
    starters = [
        other.name
        for other in icd.nodes
        if other.protocol.get("program_start", {}).get("application") == node.name
    ]
    boot = icd.node(starters[0])
    name = boot.protocol["program_start"]["message"]
    boot_messages = describe(icd).node(boot).all_messages
    start = next(message for message in boot_messages if message.model.name == name)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(harness.HERE),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.globals["stem"] = stem
    return environment.get_template("sim_client.c.j2").render(
        node=node.name,
        telemetry=[plans[m.name] for m in protocol.telemetry.values()],
        settings=[
            (plan, _ones(plan))
            for plan in telecommands
            if plan.model.kind == CONFIGURATION
        ],
        others=sorted(
            (plan for plan in telecommands if plan.model.kind != CONFIGURATION),
            key=lambda plan: plan.model.expects_reset,
        ),
        log=plans[icd.protocol_of(node)["unsolicited_log"]["configured_by"]["message"]],
        last=plans[protocol.polled.name],
        last_id=next(
            m.name
            for m in plans[protocol.polled.name].fields
            if m.model.name == "Last TC ID"
        ),
        identification=plans[protocol.identification.message.name],
        restarted=starters[0],
        start=stem(start).upper(),
        running=icd.protocol_of(boot)["procedures"]["program_copy"]["effect"]["to"][0],
    )


def _ones(plan: MessageDescription) -> list[str]:
    """Return the members that the client sets to 1; all of them can store it."""
    return [
        m.name
        for m in plan.fields
        if m.model.type in ("uint", "int", "bool") and m.model.const is None
    ]


def build(folder: Path) -> Path:
    """Build the program with all warnings and with sanitizers."""
    headers = harness.generate(harness.shipped(), folder)
    main = folder / "sim_client.c"
    main.write_text(source(harness.shipped()), encoding="utf-8")
    flags = (
        "-std=c99",
        "-D_POSIX_C_SOURCE=200809L",
        "-O1",
        *harness.WARNINGS,
        *harness.SANITIZERS,
    )
    places = (f"-I{headers}", f"-I{harness.HERE}", f"-I{ROOT / 'examples'}")
    return harness.compile(main, *flags, *places, output=folder / "sim_client")


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    print(build(target))
