"""Scalars: the integer that stores the raw value, the physical value, limits, and bits
of the frame.

`ScalarDescription` combines a place of the ICD (`icdgen.icd.places`) with the decisions
of `storage`, `steps`, `arithmetic` and `bounds`. `FieldDescription` adds arrays and
structs to it.
"""

from __future__ import annotations

from icdgen.describe import steps
from icdgen.describe.arithmetic import ScaleArithmetic, arithmetic_of
from icdgen.describe.bounds import Bound, bounds_of_limits
from icdgen.describe.comments import accepted_values_text
from icdgen.describe.enums import EnumDescription
from icdgen.describe.integer_scale import IntegerScale, integer_scale
from icdgen.describe.named import NamedPart
from icdgen.describe.storage import Storage, storage_of
from icdgen.icd.curve import Curve
from icdgen.icd.layout import Orders
from icdgen.icd.pieces import Piece, pieces_at
from icdgen.icd.places import NodePlace
from icdgen.once import cached_property


class ScalarDescription(NamedPart[NodePlace]):
    """Scalar at its place, or the element of an array of scalars."""

    storage: Storage
    """Integer that stores the raw value: for a float its bits, for an enumeration that
    of its type.

    Not used for bytes.
    """
    steps: steps.Steps | None
    """Steps of the physical value in whole numbers; None without a scale."""
    curve: Curve | None
    """Calibration of the physical value in doubles, a polynomial or a lookup table;
    None without one.
    """
    physical_name: str
    """``estimated_roll_angle_deg``"""
    declared_name: str
    """Name in generated code: for an element that of its array, for a member of a
    struct that in the struct.
    """

    def __init__(
        self,
        place: NodePlace,
        enum: EnumDescription | None,
        vocabulary: tuple[str, ...],
        owner: str,
        node_orders: Orders,
    ) -> None:
        super().__init__(place, place.node, vocabulary, owner)
        self.enum, self.node_orders = enum, node_orders
        self.storage = (
            enum.storage
            if enum is not None
            else storage_of(place.bits, place.is_signed)
        )
        self.steps, self.curve = steps.steps_of_scale(place), place.curve
        # Derived values have no raw value, only a physical one.
        if place.derived is not None and place.unit is not None:
            self.name = f"{self.name}_{place.unit.identifier}"
        self.declared_name = self.name
        # Names carry the unit, so that code with a wrong unit is visible where it is
        # written.
        end = place.unit.identifier if place.unit else "physical"
        self.physical_name = f"{self.declared_name}_{'text' if self.is_text else end}"

    @cached_property
    def arithmetic(self) -> ScaleArithmetic | None:
        """Arithmetic of its scale; None without a scale."""
        return None if self.steps is None else arithmetic_of(self.steps, self.storage)

    @property
    def integer_scale(self) -> IntegerScale | None:
        """Physical value in whole thousandths or millionths of the unit; None if these
        are not exact.
        """
        return None if self.steps is None else integer_scale(self.steps)

    @property
    def is_narrow(self) -> bool:
        """Whether `storage` can store raw values that do not fit the field."""
        # A flag needs no test: its type has only two values.
        return self.model.bits != self.storage.bits and self.model.type in (
            "uint",
            "int",
            "enum",
        )

    @property
    def allowed_text(self) -> str:
        """Values that can be set, in words, for messages about other values."""
        return accepted_values_text(self.model, self.is_narrow)

    @property
    def initial_raw(self) -> int:
        """Raw value in a new message as a number; 0 for bytes and structs."""
        value = self.model.initial_value
        return 0 if isinstance(value, bytes) else value

    @property
    def initial_physical(self) -> float:
        """Physical value in a new message; 0 without a scale or calibration."""
        if self.curve is not None:
            return self.curve.double(self.initial_raw)
        return self.steps.double(self.initial_raw) if self.steps is not None else 0.0

    @property
    def orders(self) -> Orders:
        """Byte order and bit order in effect."""
        return self.model.orders_in_effect(self.node_orders)

    @property
    def byte_order(self) -> str:
        """Byte order in effect: ``little`` or ``big``."""
        return self.orders.byte

    @property
    def order(self) -> str:
        """Byte order in effect, as names of functions have it: ``le`` or ``be``."""
        return "le" if self.byte_order == "little" else "be"

    @property
    def is_word(self) -> bool:
        """Whether it is a whole byte, or a word of 2, 4 or 8 whole bytes that is loaded
        and stored at once.
        """
        place = self.model
        return (
            not place.is_bytes and place.at % 8 == 0 and place.bits in (8, 16, 32, 64)
        )

    @property
    def is_plain_word(self) -> bool:
        """Whether it is a word that has the same bits in the frame and in memory, apart
        from the order of its bytes.
        """
        return self.is_word and self.model.bits == self.storage.bits

    @property
    def is_copied(self) -> bool:
        """Whether it can be copied between frame and memory: bytes, or a word whose
        bytes are swapped at most.
        """
        return self.model.is_bytes or self.is_plain_word

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Runs of bits in bytes of the frame that make up a number; empty for derived
        values.
        """
        if self.model.derived:
            return ()
        return pieces_at(
            self.model.at, self.model.bits, self.orders.byte, self.orders.bit
        )

    @property
    def is_text(self) -> bool:
        """Whether its bytes are characters.

        Its physical value is a text in every language.
        """
        return self.model.type == "text"

    @property
    def size(self) -> int:
        """Number of bytes or characters of a byte string or text."""
        return self.model.bits // 8

    @cached_property
    def has_physical(self) -> bool:
        """Whether it has a physical value other than the raw value, and accessors for
        it.
        """
        return self.is_text or self.is_scaled

    @property
    def is_scaled(self) -> bool:
        """Whether the physical value is a number that is computed from the raw value."""
        return self.steps is not None or self.curve is not None

    @property
    def is_settable(self) -> bool:
        """Whether it can be set by a physical value."""
        return not self.model.is_read_only and self.model.is_invertible

    @cached_property
    def bounds(self) -> tuple[Bound, ...]:
        """Limits, one by one."""
        return bounds_of_limits(self.model.limits)
