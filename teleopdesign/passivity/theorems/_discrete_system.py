"""A discrete system of python-control as the rational function of z that theorems take."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ...controllers import from_control
from ...errors import ModelError

#: relative; a period is written in decimals, 1e-3 for 0.001
_ROUNDING = 1e-9


def discrete_transfer_function(controller: Any, *, sample_time: float, z: sp.Symbol) -> Any:
    """The transfer function of a system from python-control; anything else as it is.

    Exact in the numbers as they came.  raises ModelError: continuous time, another period, several
    inputs or outputs, or a mode that the transfer function does not show
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
