"""Input of the rules: the model, its lines listed once for all rules, and the faults of
the rules that ran before.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from icdgen.diagnostics import Lines
from icdgen.frozen import NamedTuple
from icdgen.icd import variable_length
from icdgen.icd.errata import AppliedErrata
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Derived, LayoutNode, Orders, Scalar, scalar_of
from icdgen.icd.located import Map
from icdgen.icd.model import (
    Enum,
    Icd,
    Message,
    Node,
    Struct,
    framed_link,
    protocol_of_all,
)
from icdgen.icd.trees import at_path, mappings
from icdgen.once import cached_property

if TYPE_CHECKING:
    from icdgen.icd.identifiers import Language

# Keys of a field that only few fields have, so that rules about them need not look at
# all fields.
RARE_KEYS = frozenset({"enum", "unit", "formula", "formula_for", "points", "outside", "const", "special", "bitfields",
    "byte_order", "bit_order", "view", "when", "display",
})  # fmt: skip

PATH_OF_BUSES = ("link", "buses")  # path of UART, I2C and CAN in a protocol section

Owner = Message | Struct


class IcdLine(NamedTuple):
    """A node of a layout, with the message or struct and the ICD node that declare it."""

    node: LayoutNode
    owner: Owner
    icd_node: Node

    @property
    def orders(self) -> Orders:
        """Byte order and bit order in effect."""
        return self.node.orders.within(
            self.owner.layout.orders.within(self.icd_node.orders)
        )


def is_overlay(node: LayoutNode) -> bool:
    """Return whether a field or an array of fields has `view: true`.

    For an array, that is an error (ICD029).
    """
    return bool(node.source.get("view", False)) and scalar_of(node) is not None


def own_fact(node: Node, *path: str) -> Any:
    """Return the value at a path of the own protocol section of a node; None if it is
    absent.
    """
    return at_path(node.source.get("protocol"), path)


def section_of(node: Node, *path: str) -> Map | None:
    """Return the mapping at a path of the own protocol section of a node; None if it is
    absent.
    """
    section = own_fact(node, *path)
    return section if isinstance(section, Map) else None


class Context:
    """Model and faults so far.

    The model must have been read from files, because rules look at `source`.
    """

    def __init__(
        self,
        icd: Icd,
        applied: Iterable[AppliedErrata] = (),
        complete: bool = True,
        languages: Sequence[Language] = (),
        texts: Mapping[str, str] | None = None,
    ) -> None:
        self.icd = icd
        self._lines = {file: Lines(text) for file, text in (texts or {}).items()}
        self.languages = languages  # whose names the rules about names check
        self.applied = tuple(applied)
        # By identity: mappings with the same content are equal, and they have no hash.
        # The file that a rule looks at and the target of an erratum are the same
        # object.
        self._accepted = {
            (code, id(owner))
            for overlay in self.applied
            for code, _, owner in overlay.accepts
        }
        self.complete = complete
        # Code and fault, of the rules that ran already.
        self.raised: list[tuple[str, Fault]] = []
        self.messages: list[tuple[Message, Node]] = [
            (message, node) for node in icd.nodes for message in node.messages
        ]
        self.structs: list[tuple[Struct, Node]] = [
            (struct, node) for node in icd.nodes for struct in node.structs
        ]
        self.enums: list[Enum] = [enum for node in icd.nodes for enum in node.enums]
        # Of lines.
        self.owners: list[tuple[Owner, Node]] = [*self.messages, *self.structs]
        # Nodes of all messages and structs, without derived values. The nodes of a
        # struct are listed once, with the struct.
        self.lines: list[IcdLine] = []
        # Lines with a scalar. For an array it is its element.
        self.fields: list[tuple[Scalar, IcdLine]] = []
        # Fields by key. Fields with the keys `unit` and `display` include derived
        # values.
        self.fields_with: dict[str, list[tuple[Scalar, IcdLine]]] = {
            key: [] for key in RARE_KEYS
        }
        derived: list[tuple[Scalar, IcdLine]] = []
        for owner, icd_node in self.owners:
            for node in owner.layout.nodes:
                line = IcdLine(node, owner, icd_node)
                # Most nodes are scalars, and large ICDs have 100,000 of them: the test
                # saves a call for each.
                scalar = node if type(node) is Scalar else scalar_of(node)
                if isinstance(node, Derived):
                    derived.append((node.scalar, line))
                    continue
                self.lines.append(line)
                if scalar is None:
                    continue
                self.fields.append((scalar, line))
                for key in RARE_KEYS.intersection(scalar.source):
                    self.fields_with[key].append((scalar, line))
        for key in ("unit", "display"):
            self.fields_with[key] += (row for row in derived if key in row[0].source)
        # id() of a layout -> its struct and the node that declares it.
        # All uses of a struct share its layout object, so that the object leads back to
        # the declaration.
        self.struct_of: dict[int, tuple[Struct, Node]] = {
            id(struct.layout): (struct, node) for struct, node in self.structs
        }
        self.declared: list[Any] | None = (
            None  # cache of `declarations.declared_identifiers`
        )
        self._scopes: dict[int, tuple[Node, ...]] = {}

    @cached_property
    def behind_variable_fields(self) -> frozenset[int]:
        """Set of the id() of mappings of fixed-size fields that are placed after a
        variable-length field (ICD121).
        """
        return frozenset(
            id(item)
            for message, _ in self.messages
            for item in variable_length.fixed_fields_after(message.source)
        )

    def scope(self, node: Node) -> tuple[Node, ...]:
        """Return the nodes that a node includes, then the node itself; each name once."""
        scope = self._scopes.get(id(node))
        if scope is None:
            included = reversed(self.icd.included(node))
            # Two files can declare a node of the same name (ICD057 reports it). The
            # first of them is the one that is included, which the reversed order
            # achieves: later entries of a dict replace earlier ones.
            by_name = {
                other.name: other for other in included if other.name != node.name
            }
            scope = (
                *(
                    other
                    for other in self.icd.nodes
                    if by_name.get(other.name) is other
                ),
                node,
            )
            self._scopes[id(node)] = scope
        return scope

    def users(self, node: Node) -> list[Node]:
        """Return the nodes that include a node, and the node itself."""
        return [
            user
            for user in self.icd.nodes
            if any(each is node for each in self.scope(user))
        ]

    def written(self, owner: Map, key: str) -> str:
        """Return a number in the spelling of its file, such as ``0x82``, and a list of
        bytes as ``0x01 0x05``.
        """
        value, place = owner[key], owner.at(key)
        if isinstance(value, list):
            return " ".join(f"0x{byte:02X}" for byte in value)
        lines = self._lines.get(place.file)
        return lines.marked(place) if lines is not None else str(value)

    def accepts(self, code: str, fault: Fault) -> bool:
        """Return whether an erratum accepts the fault."""
        return (code, id(fault.owner)) in self._accepted

    def sections(self, *path: str) -> Iterator[Map]:
        """Yield the mappings at a path of the own protocol sections of all nodes."""
        sections = (section_of(node, *path) for node in self.icd.nodes)
        return (section for section in sections if section is not None)

    def messages_of(self, node: Node) -> list[Message]:
        """Return the messages of a node and of all nodes that it includes."""
        return [message for owner in self.scope(node) for message in owner.messages]

    def home_of(self, message: Message, node: Node) -> Node:
        """Return the node that declares a message of `messages_of(node)`."""
        return next(owner for owner in self.scope(node) if owner.name == message.node)

    def broken_messages(self, node: Node) -> set[str]:
        """Return the names of invalid messages of a node and of its included nodes.

        The schema check reports each.
        """
        entries = (
            item
            for owner in self.scope(node)
            for item in mappings(owner.source.get("messages"))
        )
        names = {name for item in entries if isinstance(name := item.get("name"), str)}
        # `icdgen.icd.build` leaves invalid messages out of the model. A reference to
        # one of them must not be reported as a reference to nothing.
        return names - {message.name for message in self.messages_of(node)}

    def protocol_of(self, node: Node) -> dict[str, Any]:
        """Return the protocol facts in effect for a node.

        Facts of the node itself override facts of included nodes.
        """
        return protocol_of_all(self.scope(node))

    def fact(self, node: Node, *path: str) -> Any:
        """Return the protocol fact in effect for a node at a path; None if it is
        absent.
        """
        return at_path(self.protocol_of(node), path)

    def is_linked(self, node: Node) -> bool:
        """Return whether the protocol describes links on which each message needs an id
        and one length.

        A framed link needs neither.
        """
        protocol = self.protocol_of(node)
        return bool(protocol) and not framed_link(protocol)
