"""Telemetry that procedures request on framed links."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.model import TELECOMMAND
from icdgen.icd.packets import is_requested
from icdgen.icd.responses import REPLY, declared_responses
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.framed_links import DeclaredLink, framed_links, messages_with_ids
from icdgen.icd.rules.procedures import procedures_in, steps_in
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import named
from icdgen.wording import quote


@rule("ICD195", needs_complete=True)
def telemetry_of_steps_can_be_requested(ctx: Context) -> Iterator[Fault]:
    for link in framed_links(ctx):
        messages = {message.name: message for message in ctx.messages_of(link.node)}
        telecommands = messages_with_ids(ctx, link.node, TELECOMMAND)
        commands = link.section.get("commands")
        commands = commands if isinstance(commands, Map) else unread()
        # Telemetry that responds to a telecommand comes when the telecommand is sent,
        # so nothing else needs to request it.
        replies: set[object] = set()
        for _, telecommand in telecommands:
            responses = declared_responses(commands, telecommand)
            if REPLY in responses:
                replies.add(responses[REPLY].get("message"))
        for step, name, place in _requests(ctx, link):
            message = named(messages, name)
            if message is None or name in replies:
                continue
            ids = [id for id, _ in telecommands]
            if not is_requested(link.declared, message, ids, ()):
                text = f"nothing requests {quote(message.name)}: no telecommand has it as `reply`, and no packet requests it"
                help = "add `response: {reply: ...}` to the telecommand, or `requests` to the link"
                yield Fault(step, place, text, help)


def _requests(ctx: Context, link: DeclaredLink) -> Iterator[tuple[Map, object, Place]]:
    """Yield each step that requests telemetry, with the name of the telemetry."""
    for owner in ctx.scope(link.node):
        for procedure in procedures_in(owner):
            for step, kind, *_ in steps_in(procedure.get("steps")):
                if kind in ("get", "poll"):
                    yield step, step[kind], step.at(kind)
                listed = step.get("messages")
                # The map of missing packets can take several messages. All of them are
                # requested.
                if step.get("map") == "get" and isinstance(listed, Seq):
                    yield from ((step, name, place) for name, place in listed.placed())
