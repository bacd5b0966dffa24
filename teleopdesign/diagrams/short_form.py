"""Kinds of diagram whose wiring the package knows, so that a file states only the blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from ..base.errors import ModelError
from ..blocks import Body, MatrixImpedance
from ..controllers import Controller
from .parts import AnyBlock, Control
from .shipped.haptic_interface import haptic_interface
from .shipped.teleoperator import teleoperator
from .wiring import Diagram

Content = Body | MatrixImpedance | Controller | AnyBlock


@dataclass(frozen=True)
class ShortForm:
    """The function that wires a kind of diagram, and its argument for each block.

    has_analog: whether a file can state which controllers no computer samples
    """

    make: Callable[..., Diagram]
    bodies: Mapping[str, str]
    controls: Mapping[str, str]
    has_analog: bool = False

    def wire(self, blocks: Mapping[str, Content], analog: tuple[str, ...]) -> Diagram:
        """The diagram with these blocks; analog: controllers that no computer samples."""
        arguments = {**self.bodies, **self.controls}
        by_argument: dict[str, Any] = {arguments[name]: block for name, block in blocks.items()}
        return self.make(**by_argument, **({"analog": analog} if self.has_analog else {}))


KINDS: Mapping[str, ShortForm] = MappingProxyType(
    {
        "haptic interface": ShortForm(
            haptic_interface,
            MappingProxyType({"Z_M": "device", "Z_H": "hand"}),
            MappingProxyType({"C": "cancellation", "H": "force_feedback", "K": "position_loop"}),
            has_analog=True,
        ),
        "teleoperator": ShortForm(
            teleoperator,
            MappingProxyType(
                {"Z_m": "master", "Z_s": "slave", "Z_H": "hand", "Z_E": "environment"}
            ),
            MappingProxyType(
                {"P": "coupling", "C_m": "master_cancellation", "C_s": "slave_cancellation"}
            ),
        ),
    }
)


def kind_of(diagram: Diagram) -> str | None:
    """The kind that wires the blocks of a diagram to this diagram; None if there is none."""
    contents: dict[str, Content] = {
        b.name: b.controller if isinstance(b, Control) else b.body for b in diagram.blocks
    }
    analog = tuple(b.name for b in diagram.controls if b.analog)
    for kind, form in KINDS.items():
        controls = {b.name for b in diagram.controls}
        known = controls <= set(form.controls) and set(contents) - controls <= set(form.bodies)
        if known and _wires(form, contents, analog, diagram):
            return kind
    return None


def _wires(
    form: ShortForm, contents: Mapping[str, Content], analog: tuple[str, ...], diagram: Diagram
) -> bool:
    """Whether the form makes this diagram of these blocks.

    Blocks with the names of a kind need not fit it: a hand of several axes, or other units.
    """
    try:
        return form.wire(contents, analog) == diagram
    except ModelError:
        return False
