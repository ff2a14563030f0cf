"""What a field is by itself: the integer that holds it, its physical value, limits and the bits of the frame."""

from __future__ import annotations

from icdgen import layout
from icdgen.describe import steps
from icdgen.describe.arithmetic import Arithmetic, arithmetic_of
from icdgen.describe.bounds import Bound, bounds
from icdgen.describe.comments import takes_text, words
from icdgen.describe.enums import EnumDescription
from icdgen.describe.integer_scale import IntegerScale, integer_scale, part_of_unit
from icdgen.describe.named import Named
from icdgen.describe.storage import Storage, storage_of
from icdgen.icd.curve import Curve
from icdgen.icd.layout import Orders
from icdgen.icd.places import NodePlace
from icdgen.once import cached_property


class ScalarDescription(Named[NodePlace]):
    """A scalar at its place, or what stands in an array."""

    storage: Storage
    """The integer that holds the raw value (the bits of a float); of an enumeration, that of its type. None of bytes."""
    steps: steps.Steps | None
    """How the physical value is computed in whole numbers; None where that is the raw value, or there is a curve."""
    curve: Curve | None
    """How it is computed in doubles."""
    physical_name: str
    """``estimated_roll_angle_deg``"""
    declared_name: str
    """The name that is declared for it: of an element, that of its array; of a field of a struct, that in the struct."""

    def __init__(
        self,
        place: NodePlace,
        enum: EnumDescription | None,
        vocabulary: tuple[str, ...],
        owner: str,
        node_orders: Orders,
    ) -> None:
        super().__init__(place, vocabulary, owner)
        self.enum, self.node_orders = enum, node_orders
        self.storage = enum.storage if enum is not None else storage_of(place.bits, place.is_signed)
        self.steps, self.curve = steps.steps(place), place.curve
        if place.derived is not None and place.unit is not None:  # it is a physical value, and has no raw one
            self.name = f"{self.name}_{place.unit.identifier}"
        self.declared_name = self.name
        unit = "text" if self.is_text else place.unit.identifier if place.unit else "physical"
        self.physical_name = f"{self.declared_name}_{unit}"

    @property
    def arithmetic(self) -> Arithmetic | None:
        """How its scale is computed; None if it has none."""
        return None if self.steps is None else arithmetic_of(self.steps, self.storage)

    @property
    def integer_scale(self) -> IntegerScale | None:
        """Its physical value in whole thousandths or millionths of the unit; None if these are not exact."""
        return None if self.steps is None else integer_scale(self.steps)

    @property
    def is_narrow(self) -> bool:
        """Whether `storage` holds raw values that the field can't."""
        return self.model.bits != self.storage.bits and self.model.type in ("uint", "int", "enum")

    @property
    def allowed_text(self) -> str:
        """What it takes, in words, for who gave it something else."""
        return takes_text(self.model, self.is_narrow)

    @property
    def initial_raw(self) -> int:
        """The raw value in a new message as a number; 0 of bytes and of a struct."""
        value = self.model.initial_value
        return 0 if isinstance(value, bytes) else value

    @property
    def initial_physical(self) -> float:
        """The physical value in a new message; 0 without a scale."""
        if self.curve is not None:
            return self.curve.double(self.initial_raw)
        return self.steps.double(self.initial_raw) if self.steps is not None else 0.0

    @property
    def orders(self) -> Orders:
        """Byte order and bit order in effect."""
        return self.model.orders_in_effect(self.node_orders)

    @property
    def byte_order(self) -> str:
        """``little`` or ``big``: its own, its message's or its node's."""
        return self.orders.byte

    @property
    def order(self) -> str:
        """``le`` or ``be``: the same in short."""
        return "le" if self.byte_order == "little" else "be"

    @property
    def is_word(self) -> bool:
        """Whether it is a byte, or a word of 2, 4 or 8 whole bytes that is loaded and stored as one."""
        one = self.model
        return not one.is_bytes and one.at % 8 == 0 and one.bits in (8, 16, 32, 64)

    @property
    def is_plain_word(self) -> bool:
        """Whether it is a word that lies in the frame as in memory, but for the order of its bytes."""
        return self.is_word and self.model.bits == self.storage.bits

    @property
    def is_copied(self) -> bool:
        """Whether its bytes, or those of each element, lie in the frame as in memory, but for the order of bytes in a word."""
        return self.model.is_bytes or self.is_plain_word

    @property
    def pieces(self) -> tuple[layout.Piece, ...]:
        """The runs of bits of the frame that make up a number."""
        if self.model.derived:
            return ()
        return layout.pieces_at(self.model.at, self.model.bits, self.orders.byte, self.orders.bit)

    @property
    def is_text(self) -> bool:
        """Whether its bytes are characters: its physical value is a text, which every language gives and takes."""
        return self.model.type == "text"

    def integer_name(self, per: int) -> str:
        """``estimated_roll_angle_mdeg``: its physical value in whole parts of the unit."""
        return f"{self.declared_name}_{part_of_unit(self.model, per)[0]}"

    def integer_title(self, per: int) -> str:
        """``Estimated Roll Angle in thousandths of deg``"""
        return f"{words(self.model.name)} in {words(part_of_unit(self.model, per)[1])}"

    def integer_comment(self, scale: IntegerScale) -> str:
        """What it is, and its range."""
        return f"{self.integer_title(scale.per)}, exact: {scale.low} to {scale.high}."

    @property
    def size(self) -> int:
        """How many bytes or characters a field of these has."""
        return self.model.bits // 8

    @property
    def has_physical(self) -> bool:
        """Whether there are accessors of a physical value that is not the raw one."""
        return self.is_text or self.is_scaled

    @property
    def is_scaled(self) -> bool:
        """Whether the physical value is a number that is computed from the raw one."""
        return self.steps is not None or self.curve is not None

    @property
    def is_settable(self) -> bool:
        """Whether a physical value sets it."""
        return not self.model.view and self.model.is_invertible

    @cached_property
    def bounds(self) -> tuple[Bound, ...]:
        """The limits, one by one."""
        return bounds(self.model.limits)
