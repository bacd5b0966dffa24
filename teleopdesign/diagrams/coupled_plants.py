"""Plants of python-control on several axes, from forces to positions, as bodies of a diagram.

    P(s)^-1 = M s^2 + B s + K + R(s)

Each axis has a body with its share of the mass M, so that a hand may hold it there; what couples
them, B and K are one linked impedance; R, strictly proper, is analog blocks beside the commands.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix

from ..base.errors import ModelError
from ..blocks import Body, MatrixImpedance, Value
from ..controllers import from_control
from .control_parts import code_parts, controller_parts, entry_of
from .junctions import Junction
from .parts import Control, Linked, Moving
from .system_states import states_of_plant

if TYPE_CHECKING:
    import control

_S = sp.Symbol("s")
#: relative asymmetry of a mass matrix that is rounding: in mechanics a mass matrix is symmetric
_ROUNDING = 1e-9


def coupled_plant_parts(
    system: control.InputOutputSystem,
    *,
    name: str,
    motions: Sequence[str],
    commands: Sequence[str],
    drivers: Sequence[str],
) -> tuple[tuple[Moving | Linked | Control, ...], tuple[Junction, ...]]:
    """A plant from n forces (N) to n positions (m) as n bodies, and the parts that couple them.

    system: transfer functions or state space, with as many inputs as outputs. In continuous time
        the numbers are exact. In discrete time: a plant of 2 n states behind a zero-order hold,
        whose matrices in continuous time follow from a logarithm. A nonlinear system
        (`control.nlsys`) in continuous time is code, for simulations only, see `plant_parts`
    commands, drivers: signals of each axis, as in `Moving`
    Bodies have the names "name_1", "name_2" ..., the impedance "name_link", blocks "name_rest_1_2".
    raises ModelError: numbers of signals do not fit, no regular matrix, a mass that is not positive
        definite, zeros of the plant that do not decay, because their states would be doubled
    """
    from ..base import python_control as control

    size = len(motions)
    if not (system.ninputs, system.noutputs) == (size, size) == (len(commands), len(drivers)):
        raise ModelError(
            f"{name}: the plant has {system.ninputs} inputs and {system.noutputs} outputs, found "
            f"{len(commands)} commands, {len(drivers)} drivers and {size} motions"
        )
    if not isinstance(system, control.LTI):
        whole = tuple(f"{name}_force_{i + 1}" for i in range(size))
        pairs = zip(whole, commands, drivers, strict=True)
        sums = (Junction(force, {command: 1.0, driver: 1.0}) for force, command, driver in pairs)
        return code_parts(system, name, whole, motions, is_plant=True), tuple(sums)
    if isinstance(system, control.FrequencyResponseData):
        raise ModelError(
            f"{name}: a measured response of several axes has no form as bodies: fit transfer "
            "functions to it, or take one axis alone (`plant_parts`)"
        )
    if system.isdtime(strict=True):
        system = _undo_hold(system, name)
    return _bodies(system, name, motions, commands, drivers)


def _bodies(
    system: control.LTI,
    name: str,
    motions: Sequence[str],
    commands: Sequence[str],
    drivers: Sequence[str],
) -> tuple[tuple[Moving | Linked | Control, ...], tuple[Junction, ...]]:
    """Bodies, their coupling, and the rest beside their commands; continuous time."""
    from ..base.python_control import ss

    size = len(motions)
    m, b, k, rest = _split(system, name)
    if (whole := states_of_plant(system, name)) is not None:
        b, k = whole.damping, whole.stiffness
    apart = np.diag(np.diag(m))
    link = MatrixImpedance(_rows(m - apart), _rows(b), _rows(k))
    blocks: list[Moving | Linked | Control] = []
    junctions: list[Junction] = []
    forces = tuple(f"{name}_link_force_{i + 1}" for i in range(size))
    joined = bool(link.parameters)
    shared: list[str] = []
    if whole is not None:
        shared = [f"{name}_rest_force_{i + 1}" for i in range(size)]
        states = ss(*whole.rest, np.zeros((size, size)))
        laws, sums = controller_parts(
            states, name=f"{name}_rest", inputs=motions, outputs=shared, motion="", analog=True
        )
        blocks += laws
        junctions += sums
        rest = [[None] * size for _ in range(size)]
    for i in range(size):
        beside = {f"{name}_rest_{i + 1}_{j + 1}": j for j in range(size) if rest[i][j] is not None}
        command = commands[i]
        for block, j in beside.items():
            law = rest[i][j]
            assert law is not None
            made = from_control(law, name="rest")
            blocks.append(Control(block, made, motions[j], f"{block}_force", motions[j], True))
        against = [*(f"{x}_force" for x in beside), *shared[i : i + 1]]
        if against:
            command = f"{name}_command_{i + 1}"
            junctions.append(Junction(command, {commands[i]: 1.0, **dict.fromkeys(against, -1.0)}))
        body = Body("prismatic", {"inertia": Value(float(m[i, i]))})
        loads = {drivers[i]: 1.0, **({forces[i]: 1.0} if joined else {})}
        blocks.append(Moving(f"{name}_{i + 1}", body, motions[i], command, loads, drivers[i]))
    if joined:
        blocks.append(Linked(f"{name}_link", link, tuple(motions), forces))
    return tuple(blocks), tuple(junctions)


def _rows(matrix: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(float(x) for x in row) for row in matrix)


def _split(
    system: control.LTI, name: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[list[control.LTI | None]]]:
    """M, B, K, and the entries of R; None for an entry that is zero."""
    from ..base import python_control as control

    size = range(system.ninputs)
    field = sp.QQ.frac_field(_S)
    forms = [[_form(system, i, j, name) for j in size] for i in size]
    plant = DomainMatrix(
        [[field.from_sympy(form) for form in row] for row in forms],
        (len(size), len(size)),
        field,
    )
    if not plant.det():
        raise ModelError(f"{name}: the plant's matrix is singular: some forces move nothing")
    inverse = plant.inv().to_Matrix()
    parts = np.zeros((3, len(size), len(size)))
    rest: list[list[control.LTI | None]] = [[None] * len(size) for _ in size]
    for i in size:
        for j in size:
            above, below = (sp.Poly(x, _S, domain="QQ") for x in sp.fraction(inverse[i, j]))
            quotient, left = above.div(below)
            if quotient.degree() > 2:
                raise ModelError(f"{name}: forces to positions need two more poles than zeros")
            parts[:, i, j] = [float(quotient.coeff_monomial(_S**p)) for p in (2, 1, 0)]
            if not left.is_zero:
                sides = [[float(c) for c in p.all_coeffs()] for p in (left, below)]
                rest[i][j] = control.tf(*sides)
                if np.roots(sides[1]).real.max() >= 0:
                    raise ModelError(
                        f"{name}: the plant has zeros that do not decay: as a body and the rest "
                        "beside it their states would be there more than once"
                    )
    m, b, k = (_symmetric(part) for part in parts)
    if np.linalg.eigvalsh((m + m.T) / 2).min() <= 0:
        raise ModelError(
            f"{name}: P^-1 = M s^2 + .. has a mass matrix that is not positive definite: forces to "
            "positions need two more poles than zeros, and bodies a mass"
        )
    return m, b, k, rest


def _form(system: control.LTI, i: int, j: int, name: str) -> sp.Expr:
    form = from_control(entry_of(system, i, j, name), name="plant").linear_form(name, _S, sp.S(0))
    return sp.sympify(form)


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    """The matrix, made symmetric if its asymmetry is only rounding."""
    mean = (matrix + matrix.T) / 2
    return mean if np.abs(matrix - mean).max() <= _ROUNDING * np.abs(matrix).max() else matrix


def _undo_hold(system: control.LTI, name: str) -> control.StateSpace:
    """The plant in continuous time that has these samples behind a zero-order hold."""
    from scipy.linalg import logm

    from ..base import python_control as control

    sampled, n = control.ss(system), system.ninputs
    period = 0.0 if system.dt is True else float(system.dt)
    if sampled.nstates != 2 * n or period <= 0 or np.abs(sampled.D).max() > 0:
        raise ModelError(
            f"{name}: of a plant in discrete time a period, {2 * n} states and D = 0 are expected, "
            f"found {sampled.nstates} states"
        )
    whole = np.block([[sampled.A, sampled.B], [np.zeros((n, 2 * n)), np.eye(n)]])
    rates = np.asarray(logm(whole)) / period
    a, b, c = rates[: 2 * n, : 2 * n], rates[: 2 * n, 2 * n :], sampled.C
    turned = np.vstack([c, c @ a])  # states: positions and velocities
    real = np.abs(rates.imag).max() <= _ROUNDING * np.abs(rates).max()
    if not real or np.linalg.cond(turned) > 1 / _ROUNDING:
        raise ModelError(f"{name}: no plant in continuous time has these samples")
    a, b, turned = a.real, b.real, turned.real
    back = np.linalg.inv(turned)
    pushed, accelerations = turned @ b, c.real @ a @ a @ back
    if np.abs(pushed[:n]).max() * period > _ROUNDING**0.5 * np.abs(pushed).max() * period**2:
        raise ModelError(f"{name}: a force moves a position at once: it is no plant with a mass")
    nothing, same = np.zeros((n, n)), np.eye(n)
    exact = np.block([[nothing, same], [accelerations[:, :n], accelerations[:, n:]]])
    return control.ss(exact, np.vstack([nothing, pushed[n:]]), np.hstack([same, nothing]), nothing)
