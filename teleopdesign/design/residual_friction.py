"""Friction left to the hand in slow steady motion, by the laws of friction, C and H."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp

from ..base.frozen import ByValue
from ..blocks import Body
from ..controllers import Controller
from ..diagrams import four_cases, haptic_interface
from ..effects import SIGNALS
from ..measurement.filtering import Array
from ..realise.law_along import law_along
from .quasi_static import remaining_force, slow_body

#: speeds over the recorded peak speed
SHARES = np.geomspace(0.01, 1.0, 41)


@dataclass(frozen=True, eq=False)
class ResidualFriction(ByValue):
    """Friction left at each speed, in each case of compensation.

    speeds: (n,), m/s or rad/s;  rows: case -> friction left, (n,), N or N m
    """

    speeds: Array
    rows: Mapping[str, Array]


def residual_friction(
    body: Body,
    *,
    cancellation: Controller | None,
    force_feedback: Controller,
    speeds: Array,
    position: float,
) -> ResidualFriction:
    """Residual friction of the four cases, in forward motion at one position, without a load.

    speeds: (n,), m/s or rad/s;  position: m or rad
    """
    body = slow_body(body)
    signals: dict[sp.Symbol, Array] = {
        SIGNALS["velocity"]: speeds,
        SIGNALS["direction"]: np.ones_like(speeds),
        SIGNALS["position"]: np.full_like(speeds, position),
        SIGNALS["time"]: np.zeros_like(speeds),
        SIGNALS["acting_force"]: np.zeros_like(speeds),
        SIGNALS["carried_force"]: np.zeros_like(speeds),
    }
    level, _ = law_along(body, body.level(), signals)
    device = haptic_interface(body, cancellation=cancellation, force_feedback=force_feedback)
    rows = {
        case: remaining_force(d, np.array(level), speeds)
        for case, d in four_cases(device, every=True).items()
    }
    return ResidualFriction(speeds, rows)
