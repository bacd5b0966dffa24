"""Diagrams that ship with the package, by the name that commands know them by."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..frozen import Catalogue
from .haptic_interface import haptic_interface
from .parts import ANY
from .teleoperator import teleoperator
from .wiring import Diagram
from .world_haptics_2005 import world_haptics_2005


def _haptic_interface() -> Diagram:
    return haptic_interface(hand=ANY, cancellation=ANY, force_feedback=ANY, position_loop=ANY)


def _world_haptics_2005() -> Diagram:
    return world_haptics_2005(position_loop=True)


def _teleoperator() -> Diagram:
    return teleoperator(hand=ANY, environment=ANY, master_cancellation=ANY, slave_cancellation=ANY)


#: name -> what makes the diagram
SHIPPED: Mapping[str, Callable[[], Diagram]] = Catalogue(
    {
        "haptic-interface": _haptic_interface,
        "teleoperator": _teleoperator,
        "world-haptics-2005": _world_haptics_2005,
    },
    "diagram",
)


def shipped(name: str) -> Diagram:
    """The shipped diagram of that name; ModelError with the nearest one."""
    return SHIPPED[name]()
