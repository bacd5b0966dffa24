"""Systems of python-control with several inputs and outputs, and plants, as parts of a diagram.

Derivation, Bode plots, claims, simulation and python-control all use these parts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body, Value
from ..controllers import Controller, from_control, measured_plant, opaque_laws
from ..effects import EFFECTS
from .junctions import Junction
from .parts import Control, Entry, Moving
from .system_states import states_of_plant, with_common_modes

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
    """A system of several inputs and outputs as controllers, one for each entry, and sums.

    system: transfer function or state space, continuous or discrete, or a measured response, as
        `from_control` takes them
    inputs, outputs: signals, in the order of the system's;  motion, analog: as of `Control`
    Entries that are zero are left out. Blocks are called "name_1_2", row first; signals between
    them "name_1_2_out". Entries of a state space share its states: a simulation has each state
    once, "name_state_1", as `with_shared_states` shows. Entries of transfer functions have separate
    states, as they are written; where they share a mode that does not decay, the matrix is made a
    state space with the fewest states, exactly.
    A nonlinear system (`control.nlsys`) is a block for each state, "name_state_1", and one for each
    output, "name_1": it takes part in simulations alone.
    raises ModelError: numbers of signals do not fit, an entry that `from_control` refuses, entries
        that share a mode that grows in numbers that no state space of decimals has
    """
    from ..base import python_control as control

    if (system.noutputs, system.ninputs) != (len(outputs), len(inputs)):
        raise ModelError(
            f"{name}: the system has {system.ninputs} inputs and {system.noutputs} outputs, found "
            f"{len(inputs)} and {len(outputs)} signals"
        )
    linear = control.StateSpace | control.TransferFunction | control.FrequencyResponseData
    if isinstance(system, control.InputOutputSystem) and not isinstance(system, linear):
        return code_parts(system, name, inputs, outputs, motion=motion, analog=analog), ()
    if isinstance(system, control.TransferFunction) and len(inputs) * len(outputs) > 1:
        system = with_common_modes(system, name=name)
    places = [(i, j) for i in range(len(outputs)) for j in range(len(inputs))]
    every = {(i, j): from_control(entry_of(system, i, j, name), name="entry") for i, j in places}
    forms = {p: c.linear_form(name, sp.Symbol("s"), sp.S(0), held=True) for p, c in every.items()}
    has_states = isinstance(system, control.StateSpace) and system.nstates > 0
    shared = has_states and len(places) > 1
    there = [p for p in places if forms[p] != 0]
    if has_states:  # what drives a state that no output shows, and what shows one that none drives
        rows, columns = ({p[axis] for p in there} for axis in (0, 1))
        there = [p for p in places if p in there or p[0] not in rows or p[1] not in columns]
    controls: list[Control] = []
    terms: dict[int, dict[str, float]] = {i: {} for i in range(len(outputs))}
    for i, j in there:
        entry_name = f"{name}_{i + 1}_{j + 1}"
        signal, place = f"{entry_name}_out", Entry(name, i, j, tuple(there)) if shared else None
        controls.append(Control(entry_name, every[i, j], inputs[j], signal, motion, analog, place))
        terms[i][signal] = 1
    sums = (Junction(output, terms[i]) for i, output in enumerate(outputs))
    return tuple(controls), tuple(sums)


def code_parts(
    system: control.InputOutputSystem,
    name: str,
    inputs: Sequence[str],
    outputs: Sequence[str],
    *,
    motion: str = "",
    analog: bool = True,
    is_plant: bool = False,
) -> tuple[Control, ...]:
    """Blocks of a system that is only code; each block reads all inputs and states."""
    states, laws = opaque_laws(name, system, is_plant=is_plant)
    made = [f"{name}_state_{i + 1}" for i in range(len(states))]
    signals = [f"{state}_out" for state in made]
    others = (*inputs[1:], *signals)
    blocks = [
        *zip(made, states, signals, strict=True),
        *((f"{name}_{i + 1}", law, outputs[i]) for i, law in enumerate(laws)),
    ]
    return tuple(
        Control(block, law, inputs[0], output, motion, analog, others=others)
        for block, law, output in blocks
    )


def entry_of(system: control.InputOutputSystem, row: int, column: int, name: str) -> control.LTI:
    """One entry of a system, with the numbers unchanged; row and column from 0.

    raises ModelError: neither transfer function, state space nor measured frequency response
    """
    from ..base import python_control as control

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
    system: control.InputOutputSystem,
    *,
    name: str,
    motion: str,
    command: str,
    driver: str,
    loads: Mapping[str, float] | None = None,
) -> tuple[tuple[Moving | Control, ...], tuple[Junction, ...]]:
    """A plant of python-control, from force (N) to position (m), as a body and the rest beside it.

    1/P(s) = m s^2 + b s + k + R(s): the body has inertia m and damping b; k + R, proper, is an
    analog block "name_rest" beside the command, and their sum is "name_command". The states are
    those of P, also where no force reaches one or no position shows it. For a measured response
    (`control.frd`), m is the mass at its highest frequencies, and the rest is the measured response
    less m s^2: responses and margins within its frequencies, but no proof. A nonlinear system
    (`control.nlsys`) is code, and no body: its motion is a signal that simulations compute and
    sensors read. No hand can hold it, and no law can use its velocity.

    driver: outside force on the body, as in `Moving`;  loads: other forces on it, signal -> sign
    raises ModelError: discrete time, several axes, not two more poles than zeros, m <= 0 or b < 0
    """
    from ..base import python_control as control

    forces = {driver: 1.0, **(loads or {})}
    _check_plant(system, name)
    if isinstance(system, control.FrequencyResponseData):
        inertia, beside = measured_plant(f"{name}_rest", system)
        return _with_rest(name, inertia, None, beside, (motion, command, driver), forces)
    if not isinstance(system, control.StateSpace | control.TransferFunction):
        force = f"{name}_force"
        parts = code_parts(system, name, (force,), (motion,), is_plant=True)
        return parts, (Junction(force, {command: 1.0, **forces}),)
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
    signals = motion, command, driver
    if (whole := states_of_plant(system, name)) is not None:
        states = from_control(control.ss(*whole.rest, whole.stiffness), name="rest")
        damping = float(whole.damping[0, 0])
        return _with_rest(name, inertia, damping or None, states, signals, forces)
    proper = rest + above.mul_ground(quotient.coeff_monomial(1))
    law: Controller | None = None
    if not proper.is_zero:
        sides = ([float(c) for c in part.all_coeffs()] for part in (proper, above))
        law = from_control(control.tf(*sides), name="rest")
    return _with_rest(name, inertia, damping or None, law, signals, forces)


def _with_rest(
    name: str,
    inertia: float,
    damping: float | None,
    beside: Controller | None,
    signals: tuple[str, str, str],
    forces: Mapping[str, float],
) -> tuple[tuple[Moving | Control, ...], tuple[Junction, ...]]:
    """A body, and the block that resists its motion;  signals: motion, command and driver."""
    motion, command, driver = signals
    body = Body("prismatic", {"inertia": Value(inertia)})
    if damping is not None:
        body = body.with_effect(EFFECTS["viscous"], {"damping": damping})
    if beside is None:
        return (Moving(name, body, motion, command, forces, driver),), ()
    rest, made = f"{name}_rest", f"{name}_rest_force"
    block = Control(rest, beside, motion, made, motion, True)
    whole_command = Junction(f"{name}_command", {command: 1.0, made: -1.0})
    moving = Moving(name, body, motion, whole_command.output, forces, driver)
    return (moving, block), (whole_command,)


def _check_plant(system: control.InputOutputSystem, name: str) -> None:
    """Raise ModelError unless the system has one axis and continuous time."""
    if (system.ninputs, system.noutputs) != (1, 1) or system.isdtime(strict=True):
        raise ModelError(
            f"{name}: expected a plant of one input and output in continuous time: see "
            "`coupled_plant_parts` for others"
        )
