"""Rules of the checksums of links with roles of fields (ICD173), and of all that a
receiver must know before it knows the message (ICD174).

`link: checksums` declares a checksum. A field with the role `checksum` sends it and says
with `covers` over which bytes it is computed; steps of procedures can compare it.
`frame_checksums.md` has the pages of these rules, `framed_links` the other fields.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import Message, Node
from icdgen.icd.packets import declared_packets
from icdgen.icd.procedures import nested_steps
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.framed_links import (
    DIRECTIONS,
    DeclaredLink,
    LinkPacket,
    declared_links,
    framed_links,
    messages_with_ids,
)
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import line_of, of_wide_value
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import at_path
from icdgen.wording import count, listing, quote

# Word for the data of the message in `covers`, beside the roles and names of fields.
DATA = "data"
# Kinds of checksums whose algorithm fixes the width -> this width in bits.
WIDTH_OF_KIND = {"fletcher": 16, "fletcher_255": 16, "xor": 8}


@rule("ICD173")
def checksums_can_be_computed(ctx: Context) -> Iterator[Fault]:
    """Report checksums that a field names and nobody declares, or the reverse, and
    parameters that contradict each other.
    """
    for link in declared_links(ctx):
        # `names` includes the checksums of included files. It has no source positions,
        # because it is a merged copy. `link.checksums` has the positions of the
        # checksums that this node declares itself.
        names = ctx.fact(link.node, "link", "checksums")
        names = names if isinstance(names, Mapping) else {}
        for packet, part, field in _checksum_fields(link):
            name = field.get("checksum", "")
            checksum = link.checksums.get(name)
            if name not in names:
                yield _undeclared_checksum(field, name, names)
            elif isinstance(checksum, Map) and _has_usable_types(checksum):
                yield from _check_width_of_field(field, checksum)
                if "framing" in link.section:
                    yield from _check_covers(packet, part, field)
        for name, checksum in link.checksums.items():
            if _has_usable_types(checksum):
                yield from _check_parameters(checksum)
                yield from _check_seeds(ctx, link, checksum)
            if ctx.complete and name not in _used_checksums(ctx, link.node):
                message = f"no field of a packet has the checksum {quote(name)}"
                help = f"add a field `role: checksum, checksum: {name}`, or remove {quote(name)} here"
                yield Fault.at_key(link.checksums, name, message, help)


def _checksum_fields(link: DeclaredLink) -> Iterator[tuple[LinkPacket, str, Map]]:
    """Yield (first packet with it, "header" or "trailer", field) for each checksum
    field.
    """
    seen: set[int] = set()
    for packet in link.packets:
        for part, field in packet.fields_by_part:
            if field["role"] == "checksum" and id(field) not in seen:
                seen.add(id(field))
                yield packet, part, field


def _has_usable_types(checksum: object) -> bool:
    """Return whether these rules can compute with the values of a checksum.

    Otherwise the schema check reports it.
    """
    if not isinstance(checksum, Map) or not isinstance(checksum.get("kind"), str):
        return False
    width = checksum.get("width")
    return type(width) is int and 0 < width <= 32


def _undeclared_checksum(
    field: Map, name: str, names: Mapping[object, object]
) -> Fault:
    message = f"no checksum is called {quote(name)}"
    if not name:
        message = "the field names no checksum"
    existing = listing(f"`{key}`" for key in names) if names else "there are none"
    help = f"name one of `checksums` in `checksum:`: {existing}"
    return Fault.at(field, "role", message, help)


def _used_checksums(ctx: Context, node: Node) -> set[str]:
    """Return the names of the checksums in packets and procedures of a node, and of the
    nodes that include it.
    """
    used: set[str] = set()
    for user in ctx.users(node):
        protocol = ctx.protocol_of(user)
        link = protocol.get("link")
        for packet in declared_packets(link).all if isinstance(link, Mapping) else ():
            fields = packet.fields_of_role("checksum")
            used.update(str(field.get("checksum")) for field in fields)
        procedures = protocol.get("procedures")
        if not isinstance(procedures, Mapping):
            continue
        for procedure in procedures.values():
            for step in nested_steps(at_path(procedure, ["steps"])):
                name = at_path(step, ("verify", "checksum"))
                if isinstance(name, str):
                    used.add(name)
    return used


def _check_width_of_field(field: Map, checksum: Map) -> Iterator[Fault]:
    """Report a field that is wider or narrower than its checksum."""
    width: int = checksum["width"]
    # `_check_parameters` reports a width that the kind does not permit.
    if width != WIDTH_OF_KIND.get(checksum["kind"], width) or width == field["bits"]:
        return
    message = f"the checksum has {width} bits, its field {field['bits']}"
    place = line_of(checksum.at("width"), field.at("bits"))
    help = f"correct `bits` of the field, or `width` ({place})"
    yield Fault.at(field, "bits", message, help)


def _check_parameters(checksum: Map) -> Iterator[Fault]:
    """Report parameters that do not suit the kind or the width of a checksum."""
    kind, width = checksum["kind"], checksum["width"]
    required = WIDTH_OF_KIND.get(kind)
    if required and width != required:
        message = f"a checksum of kind `{kind}` has {required} bits, not {width}"
        help = f"write `width: {required}`, or correct `kind`"
        yield Fault.at(checksum, "width", message, help, str(required))
        width = required  # the values below are checked against the right width
    for key in ("polynomial", "init", "xor_out", "empty", "check"):
        value = checksum.get(key)
        if isinstance(value, int) and value >> width > 0:
            message = f"`{key}` does not fit {count(width, 'bit')}"
            remedy = of_wide_value(key, value, width)
            yield Fault.at(checksum, key, message, *remedy)
    if kind != "crc":
        for key in ("polynomial", "reflect_in", "reflect_out", "empty"):
            if key in checksum:
                message = (
                    f"`{key}` applies to a CRC, not to a checksum of kind `{kind}`"
                )
                help = "remove it, or correct `kind`"
                yield Fault.at_key(checksum, key, message, help)


def _check_seeds(ctx: Context, link: DeclaredLink, checksum: Map) -> Iterator[Fault]:
    """Report messages without one of `seeds`, and seeds without a message.

    A seed is the start value of the checksum for a message.
    """
    seeds = checksum.get("seeds")
    if not isinstance(seeds, Map):
        return
    names = [message.name for message in ctx.messages_of(link.node)]
    broken = ctx.broken_messages(link.node)
    for name in seeds:
        if name not in names and name not in broken:
            remedy = suggestion(name, names, "correct the name")
            message = f"there is no message {quote(name)}"
            yield Fault.at_key(seeds, name, message, *remedy)
    without_seed = [name for name in names if name not in seeds]
    if without_seed:
        message = f"{quote(without_seed[0])} has no seed"
        if len(without_seed) > 1:
            others = len(without_seed) - 1
            verb = "has" if others == 1 else "have"
            message += f", nor {verb} {count(others, 'other')}"
        help = "give every message a seed, or remove `seeds`"
        yield Fault.at_key(checksum, "seeds", message, help)


def _check_covers(packet: LinkPacket, part: str, field: Map) -> Iterator[Fault]:
    """Report a `covers` that is missing or wrong.

    The range is contiguous. It contains the data, begins at a whole byte and does not
    contain the checksum itself. ``part`` is the part of the checksum field.
    """
    covers = field.get("covers")
    if not isinstance(covers, Map):
        message = "nothing says what the checksum covers"
        help = "add `covers: {from: ..., to: ...}`"
        yield Fault.at(field, "checksum", message, help)
        return
    if not all(isinstance(covers.get(key), str) for key in ("from", "to")):
        return  # the schema check reports it
    bounds: dict[str, Map | None] = {"from": None, "to": None}  # None: the data
    for key, part_of_key in (("from", "header"), ("to", "trailer")):
        role = covers[key]
        if role == DATA:
            continue
        matches = [
            (part_of_match, match)
            for part_of_match, match in packet.fields_by_part
            if role in (match.get("name"), match["role"])
        ]
        if not matches:
            message = f"no field{packet.of_packet} has the role or name `{role}`"
            help = "name the role of a field of the frame, or `data`"
            yield Fault.at(covers, key, message, help)
            return
        # A role can occur in both parts.
        in_part = [match for place, match in matches if place == part_of_key]
        if not in_part:
            message = f"a checksum covers the data, but `{key}: {role}` names a field of the {matches[0][0]}"
            help = "`from` names a field of the header or `data`, `to` one of the trailer or `data`"
            yield Fault.at(covers, key, message, help)
            return
        # Of several fields of a role, all are covered.
        bounds[key] = in_part[0] if key == "from" else in_part[-1]
    first, last = bounds["from"], bounds["to"]
    if first and first["at"] % 8:
        help = "begin with a field at a whole byte"
        yield Fault.at(covers, "from", "it begins within a byte", help)
    # A checksum in the header must end before the first covered byte, one in the
    # trailer begin after the last.
    if part == "header":
        key = "from"
        end_of_checksum = field["at"] + field["bits"]
        covers_itself = first is not None and end_of_checksum > first["at"] // 8 * 8
    else:
        key = "to"
        end_of_range = last["at"] + last["bits"] if last else 0
        covers_itself = field["at"] // 8 < (end_of_range + 7) // 8
    if covers_itself:
        message = "the checksum covers itself"
        help = (
            "correct `covers`, so that it ends before the checksum or begins after it"
        )
        yield Fault.at(covers, key, message, help)


@rule("ICD174")
def messages_of_one_id_are_framed_alike(ctx: Context) -> Iterator[Fault]:
    """Report messages that share an id and differ in packet, seed or `may_end_early`.

    A receiver can distinguish them only by their data, after it has checked and removed
    the framing.
    """
    for link in framed_links(ctx):
        all_seeds = [at_path(each, ["seeds"]) for each in link.checksums.values()]
        for direction in DIRECTIONS:
            first_of_id: dict[int, Message] = {}
            for id, message in messages_with_ids(ctx, link.node, direction):
                first = first_of_id.setdefault(id, message)
                packet, packet_of_first = (
                    link.declared.packets_of_message(each.name, direction)[:1]
                    for each in (message, first)
                )
                # ICD184 reports a message that is in no packet.
                if packet and packet_of_first and packet != packet_of_first:
                    text = f"{quote(message.name)} is sent in another packet than {quote(first.name)}, which has the same id"
                    help = "list both in one packet, or give them different ids"
                    yield Fault.at(message.source, "name", text, help)
                if bool(message.may_end_early) != bool(first.may_end_early):
                    early = message if message.may_end_early else first
                    text = f"zeros of {quote(early.name)} may be omitted, but not the zeros of another message with its id"
                    help = "add `may_end_early` to both, or to neither"
                    yield Fault.at(early.source, "may_end_early", text, help)
                for seeds in all_seeds:
                    # ICD173 reports a message without a seed.
                    if not isinstance(seeds, Map) or not (
                        message.name in seeds and first.name in seeds
                    ):
                        continue
                    if seeds[message.name] != seeds[first.name]:
                        text = f"{quote(message.name)} has a seed different from that of {quote(first.name)}, which has the same id"
                        help = "give both the same seed, or other ids"
                        yield Fault.at(seeds, message.name, text, help)
