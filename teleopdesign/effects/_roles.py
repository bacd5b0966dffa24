"""Roles of effects in the equation of a body, and their effect on energy."""

from __future__ import annotations

from typing import Literal, get_args

Role = Literal[
    "actuation",
    "structure",
    "force",
    "friction_level",
    "friction_factor",
    "friction_speed",
    "friction_shape",
    "tip_level",
    "contact",
    "contact_shape",
]
ROLES: tuple[Role, ...] = get_args(Role)
Energy = Literal["stores", "dissipates", "supplies"]
ENERGIES: tuple[Energy, ...] = get_args(Energy)
#: the order in which actuation stages act, by names of effects; other stages come last
ACTUATION_ORDER = (
    "actuator_gain",
    "torque_ripple",
    "position_dependent_gain",
    "actuator_lag",
    "actuation_delay",
    "actuator_dead_zone",
    "actuator_saturation",
)

#: roles of effects that belong to a modelled environment, and not to the body that touches it
CONTACT_ROLES = frozenset({"contact", "contact_shape"})
