"""Systems of python-control with several inputs and outputs, and plants, as parts of a diagram.

Every form follows from these parts: derivation, Bode plots, claims, simulation, python-control.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import sympy as sp

from ..blocks import Body, Value
from ..controllers import from_control
from ..effects import EFFECTS
from ..errors import ModelError
from .parts import Control, Junction, Moving

if TYPE_CHECKING:
    import control


def controller_parts(
    system: control.InputOutputSystem,
    *,
    name: str,
    inputs: Sequence[str],
    outputs: Sequence[str],
    motion: str,
    analog: bool = False,
) -> tuple[tuple[Control, ...], tuple[Junction, ...]]:
    """A linear system of several inputs and outputs as controllers, one for each entry, and sums.

    system: transfer function or state space, continuous or discrete, or a measured response, as
        `from_control` takes them
    inputs, outputs: signals, in the order of the system's;  motion, analog: as of `Control`
    Entries that are zero are left out. Blocks are called "name_1_2", row first; signals between
    them "name_1_2_out". Each entry has separate states: modes that entries of a state space
    share are there once for each.
    raises ModelError: numbers of signals do not fit, an entry that `from_control` refuses
    """
    if (system.noutputs, system.ninputs) != (len(outputs), len(inputs)):
        raise ModelError(
            f"{name}: the system has {system.ninputs} inputs and {system.noutputs} outputs, found "
            f"{len(inputs)} and {len(outputs)} signals"
        )
    controls: list[Control] = []
    sums: list[Junction] = []
    for i, output in enumerate(outputs):
        terms: dict[str, float] = {}
        for j, source in enumerate(inputs):
            entry_name = f"{name}_{i + 1}_{j + 1}"
            made = from_control(entry_of(system, i, j, name), name="entry")
            form = made.linear_form(entry_name, sp.Symbol("s"), sp.S(0), held=True)
            if form == 0:
                continue
            controls.append(Control(entry_name, made, source, f"{entry_name}_out", motion, analog))
            terms[f"{entry_name}_out"] = 1.0
        sums.append(Junction(output, terms))
    return tuple(controls), tuple(sums)


def entry_of(system: control.InputOutputSystem, row: int, column: int, name: str) -> control.LTI:
    """One entry of a system, row and column from 0, in the numbers as they came."""
    import control

    if isinstance(system, control.TransferFunction):
        return control.tf(system.num[row][column], system.den[row][column], system.dt)
    if isinstance(system, control.FrequencyResponseData):
        return control.frd(system.frdata[row, column], system.frequency)
    if not isinstance(system, control.StateSpace):
        raise ModelError(
            f"{name}: expected a transfer function, a state space or a measured frequency response"
        )
    b, c, d = system.B[:, [column]], system.C[[row]], system.D[[row]][:, [column]]
    return control.ss(system.A, b, c, d, system.dt)


def plant_parts(
    system: control.LTI,
    *,
    name: str,
    motion: str,
    command: str,
    driver: str,
    loads: Mapping[str, float] | None = None,
) -> tuple[tuple[Moving | Control, ...], tuple[Junction, ...]]:
    """A plant of python-control, from force (N) to position (m), as a body with the rest beside it.

    1/P(s) = m s^2 + b s + k + R(s): the body has inertia m and damping b; k + R, proper, is an
    analog block "name_rest" beside the command, their sum "name_command". Exact in the numbers as
    they came, with the states of P.
    driver: outside force on it, as of `Moving`;  loads: other forces on it, signal -> sign
    raises ModelError: discrete time, several axes, a measured response, not two more poles than
        zeros, m <= 0 or b < 0
    """
    import control

    _check_plant(system, name)
    s = sp.Symbol("s")
    # exact: python-control's conversion of matrices leaves zeros far out
    form = from_control(system, name="plant").linear_form(name, s, sp.S(0))
    above, below = (sp.Poly(part, s, domain="QQ") for part in sp.fraction(sp.sympify(form)))
    if above.is_zero or below.degree() - above.degree() != 2:
        raise ModelError(
            f"{name}: a plant from force to position has two more poles than zeros, found "
            f"{below.degree()} and {max(above.degree(), 0)}"
        )
    quotient, rest = sp.div(below, above)
    inertia, damping = (float(quotient.coeff_monomial(s**k)) for k in (2, 1))
    if inertia <= 0 or damping < 0:
        raise ModelError(
            f"{name}: 1/P = m s^2 + b s + .. has m = {inertia:g} kg, b = {damping:g} N s/m: a body "
            "has inertia > 0 and damping >= 0"
        )
    body = Body("prismatic", {"inertia": Value(inertia)})
    if damping:
        body = body.with_effect(EFFECTS["viscous"], {"damping": damping})
    forces = {driver: 1.0, **(loads or {})}
    proper = rest + above.mul_ground(quotient.coeff_monomial(1))
    if proper.is_zero:
        return (Moving(name, body, motion, command, forces, driver),), ()
    sides = ([float(c) for c in part.all_coeffs()] for part in (proper, above))
    rest_name = f"{name}_rest"
    block = Control(
        rest_name,
        from_control(control.tf(*sides), name="rest"),
        motion,
        rest_name + "_force",
        motion,
        True,
    )
    whole_command = Junction(f"{name}_command", {command: 1.0, rest_name + "_force": -1.0})
    return (Moving(name, body, motion, whole_command.output, forces, driver), block), (
        whole_command,
    )


def _check_plant(system: control.LTI, name: str) -> None:
    """ModelError unless it is a rational system of one axis in continuous time."""
    import control

    if (system.ninputs, system.noutputs) != (1, 1) or system.isdtime(strict=True):
        raise ModelError(
            f"{name}: expected a plant of one input and output in continuous time: see "
            "`coupled_plant_parts` for others"
        )
    if not isinstance(system, control.TransferFunction | control.StateSpace):
        raise ModelError(
            f"{name}: expected a transfer function or a state space: fit one to what was measured"
        )
