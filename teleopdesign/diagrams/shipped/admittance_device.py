"""Admittance-controlled interface: the measured hand force moves a virtual body that is followed.

    Z_d X = F_h + C (X_d - X)        X_d = Y F_h        F_h = F_u - Z_H X

    F_h = (I + C Y)^-1 (Z_d + C) X: the inverse of Y where C is large

F_h is all that the hand does on the device, positive along its motion, as a sensor between both
measures it. Van der Linde, Lammertse, HapticMaster, Industrial Robot 30 (2003) 515.
"""

from __future__ import annotations

from ...blocks import Body
from ...controllers import Controller
from ..junctions import Junction
from ..parts import ANY, AnyBlock, Attached, Block, Control, Moving
from ..wiring import Diagram

_TEXTS = {
    "X": "motion of the device",
    "X_d": "motion of the virtual body",
    "X_e": "position error X_d - X",
    "F_u": "voluntary force of the user on the device",
    "F_H": "passive force of the hand on the device",
    "F_h": "force of the hand on the device, measured",
    "U": "force commanded to the device's actuator",
}


def admittance_device(
    device: Body | AnyBlock = ANY,
    *,
    admittance: Controller | AnyBlock = ANY,
    position_loop: Controller | AnyBlock = ANY,
    hand: Body | AnyBlock | None = None,
) -> Diagram:
    """Wire an admittance-controlled interface on one axis.

    device: Z_d;  hand: Z_H, passive impedance of the user's arm; absent by default
    admittance: Y, from force to position, such as `controller("virtual_admittance", ...)`
    position_loop: C, from the position error to a force, such as `proportional_derivative` or
        `lead`; it receives no velocity except that of its input
    """
    blocks: list[Block] = [
        Moving("Z_d", device, "X", "U", {"F_h": 1}, "F_u"),
        Control("Y", admittance, "F_h", "X_d"),
        Control("C", position_loop, "X_e", "U"),
    ]
    on_device = {"F_u": 1}
    if hand is not None:
        blocks.append(Attached("Z_H", hand, "X", "F_H", role="hand"))
        on_device["F_H"] = 1
    texts = {n: t for n, t in _TEXTS.items() if n != "F_H" or hand is not None}
    return Diagram(
        "admittance-controlled interface",
        tuple(blocks),
        (Junction("F_h", on_device), Junction("X_e", {"X_d": 1, "X": -1})),
        {"F_u": "force"},
        measured=("X", "F_h"),
        texts=texts,
    )


def diagram() -> Diagram:
    """The wiring with every block that it can have."""
    return admittance_device(hand=ANY)
