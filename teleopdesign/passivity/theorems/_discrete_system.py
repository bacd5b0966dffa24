"""Discrete systems of python-control as rational functions of z, for the theorems."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ...base.errors import ModelError
from ...controllers import from_control

#: relative difference of two periods that counts as rounding of decimals
_ROUNDING = 1e-9


def discrete_transfer_function(controller: Any, *, sample_time: float, z: sp.Symbol) -> Any:
    """The transfer function in z of a system of python-control; any other object unchanged.

    The numbers of the system are kept exactly.

    controller: the system;  sample_time: period that the system must have, s;  z: symbol of z
    raises ModelError: continuous time, another period, several inputs or outputs, or a mode that
        the transfer function does not show
    """
    if not (hasattr(controller, "dt") and hasattr(controller, "nstates")):
        return controller
    if not controller.isdtime(strict=True):
        raise ModelError(
            "controller: found a system in continuous time, expected one in discrete time: "
            "`control.sample_system` makes one"
        )
    if controller.dt is not True and abs(controller.dt - sample_time) > _ROUNDING * sample_time:
        raise ModelError(
            f"controller: is sampled every {controller.dt * 1e3:g} ms, the body every "
            f"{sample_time * 1e3:g} ms: sample both alike"
        )
    (stage,) = from_control(controller, name="controller").stages
    if stage.law.shift is None:
        raise ModelError("controller: expected a transfer function or a state space")
    law = sp.cancel(stage.law.shift(stage.values, z))
    if sp.degree(sp.fraction(law)[1], z) < len(stage.law.states):
        raise ModelError(
            "controller: has a mode that its transfer function does not show, and which may grow: "
            "give its least form (`control.minreal`)"
        )
    return law
