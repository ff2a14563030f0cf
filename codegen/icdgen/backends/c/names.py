"""The C names of messages and enumerations.

All names at file scope begin with the name of the declaring node, once.
"""

from __future__ import annotations

import re
from typing import Any

from icdgen.describe import EnumDescription, MessageDescription, NodeDescription
from icdgen.describe.description import Composite
from icdgen.describe.enums import MemberDescription

_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic stdbit
    stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype
    alloca endian features pthread sched strings unistd
    """.split()
"""Headers of the language and of the system. A compiler could find the header of a node
with such a name in their place.
"""

RESERVED = frozenset(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    alignas alignof bool constexpr false nullptr static_assert thread_local true typeof typeof_unqual noreturn
    and and_eq asm bitand bitor catch char8_t char16_t char32_t class co_await co_return co_yield compl concept
    consteval constinit const_cast decltype delete dynamic_cast explicit export friend mutable namespace new noexcept
    not not_eq operator or or_eq private protected public reinterpret_cast requires static_cast template this throw
    try typeid typename using virtual wchar_t xor xor_eq
    int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t intptr_t uintptr_t intmax_t uintmax_t
    int_least8_t int_least16_t int_least32_t int_least64_t uint_least8_t uint_least16_t uint_least32_t
    uint_least64_t int_fast8_t int_fast16_t int_fast32_t int_fast64_t uint_fast8_t uint_fast16_t uint_fast32_t
    uint_fast64_t size_t ptrdiff_t max_align_t nullptr_t
    complex imaginary offsetof errno assert stdin stdout stderr setjmp
    unix linux i386 mips sparc
    """.split()
) | {f"{name}.h" for name in _HEADERS}
"""Words that can't be identifiers in C99 to C23 or C++11 to C++20, or that the usual
headers and compilers define.

Member names are lower case, and every other name begins with the node's, so upper-case
macros can't be met.
"""


def stem(part: Composite[Any] | EnumDescription) -> str:
    """Return the beginning of the names of the functions and of the type:
    ``demo_estimated_roll``. A name that begins with that of the node keeps it once:
    ``demo_state`` for ``DemoState``.
    """
    prefix = f"{part.node.name}_"
    return part.name if part.name.startswith(prefix) else prefix + part.name


def enumerator(enum: EnumDescription, member: MemberDescription) -> str:
    """Return the name of an enumerator: ``DEMO_MODE_IDLE``."""
    return f"{stem(enum)}_{member.name}".upper()


def element_reader(message: MessageDescription, name: str) -> str:
    """Return the name of the function that reads an element of an array of structs.

    ``name``: of the array, as in `icdgen.describe.arrays`.
    """
    return f"{stem(message)}_read_{name}"


def element_writer(message: MessageDescription, name: str) -> str:
    """Return the name of the function that writes an element of an array of structs."""
    return f"{stem(message)}_write_{name}"


def received_element_reader(message: MessageDescription, name: str) -> str:
    """Return the name of the function that reads an element from a frame that is not
    decoded.
    """
    return f"{stem(message)}_{name}_at"


def has(composite: Composite[Any], name: str) -> str:
    """Return the name of the function that returns whether a field is present:
    ``demo_wheel_has_rate``.
    """
    return f"{stem(composite)}_has_{name}"


def constant(message: Composite[Any], name: str) -> str:
    """Return the name of a macro of a message or struct:
    ``DEMO_RESET_MAGIC_NUMBER_CONST``, ``DEMO_RESET_ID``.
    """
    return f"{stem(message)}_{name}".upper()


def enumerator_of(direction: str, message: MessageDescription) -> str:
    """Return the enumerator of a message whose direction has shared ids:
    ``DEMO_TELEMETRY_IS_STATUS``.
    """
    return f"{direction}_is_{message.name}".upper()


def selector(
    node: NodeDescription, direction: str, message: MessageDescription, id_name: str
) -> str:
    """Return the constant that selects a message in ``demo_telemetry_t``: that of its
    id, or an enumerator if messages share ids.
    """
    if node.shares_ids(direction):
        return enumerator_of(f"{node.name}_{direction}", message)
    return constant(message, id_name)


def getter(composite: Composite[Any], name: str) -> str:
    """Return the name of the function that returns a value, by the name of the value in
    snake case: ``demo_status_rate_deg_per_s``.
    """
    return f"{stem(composite)}_{name}"


def setter(composite: Composite[Any], name: str) -> str:
    """Return the name of the function that sets a physical value:
    ``demo_status_set_rate_deg_per_s``.
    """
    return f"{stem(composite)}_set_{name}"


def client_verbs(node: NodeDescription, direction: str) -> tuple[str, ...]:
    """Return the actions of a client of the node with a message; each is a function.

    Only a client of a link with packets can ask and put.
    """
    if direction == "telemetry":
        return "request", "receive"
    return ("send",) if node.has_client else ("send", "ask", "put")


def client_function(node: str, verb: str, message: MessageDescription) -> str:
    """Return the name of the client's function for a message: ``demo_send_reset``."""
    return f"{node}_{verb}_{message.name}"


def part_name(part: MessageDescription) -> str:
    """Return the end of the name of the function for a contained message."""
    return f"part_{part.name}"


PROCEDURE_PARAMETERS = {
    "procedure": "icd_procedure_t *",
    "bus": "icd_bus_t ",
    "block_size": "uint32_t ",
    "buffer": "uint8_t *",
    "buffer_size": "size_t ",
    "bitmap": "uint8_t *",
    "bitmap_size": "size_t ",
    "on_block": "icd_block_fn *",
    "on_entry": "icd_entry_fn *",
    "context": "void *",
    "numbers": "",  # local variables
    "memory": "",
}
"""Names in the functions of procedures, which no input can have, and types."""


def procedure(node: NodeDescription, name: str, end: str = "") -> str:
    """Return the name of the function that initializes a procedure, ``demo_download``;
    with an ``end`` that of an output, ``demo_download_size``.
    """
    return "_".join(filter(None, (node.name, name, end)))


def checksum_word(name: str) -> str:
    """Return the name of a checksum as a part of an identifier."""
    return re.sub(r"\W", "_", name).lower()


def checksum_function(node: NodeDescription, name: str) -> str:
    """``demo_crc16_checksum``: the function that returns the algorithm of a checksum."""
    return f"{node.name}_{checksum_word(name)}_checksum"


def procedure_size(node: NodeDescription, name: str, end: str) -> str:
    """Return the name of the size of a buffer: ``DEMO_DOWNLOAD_BLOCK_BYTES``."""
    return procedure(node, name, end).upper()


def input_parameters(name: str, is_bytes: bool) -> tuple[str, ...]:
    """Return the parameters for an input of a procedure."""
    return (name, f"{name}_size") if is_bytes else (name,)
