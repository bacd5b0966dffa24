"""A teleoperator of two arms with several joints on each side, coupled at their tips.

    M q'' + ... = tau + J^T F        X = f(q), J = df/dq
    tau_m = -J_m^T F_P + C_m q_m     tau_s = J_s^T F_P + C_s q_s     F_P = P e + D e', e = X_m - X_s

Each joint is a body with friction and, where wanted, a cancellation on its position. What hangs
on the tip (`load`, hand, environment) is carried through the kinematics, so that full and changing
inertia and its Coriolis forces follow. Mahvash, Okamura, ICRA 2006, eq (10), figure 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from ..base.arguments import check_types, matrix_of
from ..base.errors import ModelError
from ..blocks import Body, MatrixImpedance
from ..controllers import Controller, controller
from .junctions import Junction, Kinematics, Weight, as_expression, position_symbol
from .parts import Block, Control, Linked, Moving, PortRole
from .wiring import Diagram


def joint(number: int) -> sp.Symbol:
    """Symbol of a joint's position in the coordinates of an arm; numbers from 1."""
    return sp.Symbol(f"q_{number}", real=True)


@check_types
@dataclass(frozen=True)
class Arm:
    """The joints of an arm, and the position of its tip as a function of them.

    joints: one body each
    coordinates: of the tip, expressions of `joint(1)`, ..., as many as are coupled
    cancellations: one for each joint (None: none), or () for none at all
    load: impedance of the arm itself at its tip;  pose: joint positions for linear forms
    raises ModelError: an unknown symbol in a coordinate, or a wrong number of entries
    """

    joints: tuple[Body, ...]
    coordinates: tuple[sp.Expr, ...]
    cancellations: tuple[Controller | None, ...] = ()
    load: MatrixImpedance | None = None
    pose: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        known = {joint(n + 1) for n in range(len(self.joints))}
        for expression in self.coordinates:
            if unknown := as_expression(expression, where="Arm: coordinates").free_symbols - known:
                raise ModelError(
                    f"Arm: coordinate {expression} has {min(map(str, unknown))}, joints are "
                    f"{', '.join(sorted(map(str, known)))}"
                )
        for name in ("cancellations", "pose"):
            entries = getattr(self, name)
            if entries and len(entries) != len(self.joints):
                raise ModelError(f"Arm: {len(entries)} {name} for {len(self.joints)} joints")


def tip_coordinates(jacobian: Any) -> tuple[sp.Expr, ...]:
    """Coordinates of a tip with a constant Jacobian: X = J q, J (coordinates, joints).

    jacobian: m/rad or m/m, nested lists or an array
    returns: one expression for each coordinate (m), for `Arm`; forces act on joints by J^T
    raises ModelError: no matrix of numbers
    """
    matrix = matrix_of(jacobian, "tip_coordinates: jacobian")
    symbols = [joint(n + 1) for n in range(matrix.shape[1])]
    return tuple(
        sp.Add(*(float(w) * q for w, q in zip(row, symbols, strict=True) if w)) for row in matrix
    )


def teleoperator_of_arms(
    master: Arm,
    slave: Arm,
    *,
    stiffness: Any,
    damping: Any = None,
    hand: MatrixImpedance | None = None,
    environment: MatrixImpedance | None = None,
) -> Diagram:
    """Wire two arms.

    stiffness, damping: P and D (n, n), from the difference of the tips to forces on the slave's
        tip; passive only if P is symmetric and positive semidefinite
    hand, environment: Z_H, Z_E (n, n) at the tips
    Names of signals end with side and number: q_m1 joints, X_m1 tips, F_u1 and F_d1 forces from
    outside at the tips, F_m1 and F_s1 total forces there, F_P1 the coupling, U_m1 commanded
    torques.
    raises ModelError: sizes differ
    """
    size = len(master.coordinates)
    none = np.zeros((size, size))
    matrices = {"stiffness": stiffness, "damping": none if damping is None else damping}
    matrices = {n: matrix_of(m, f"teleoperator_of_arms: {n}") for n, m in matrices.items()}
    gains = {name: np.asarray(g, dtype=float) for name, g in matrices.items()}
    if len(slave.coordinates) != size or any(g.shape != (size, size) for g in gains.values()):
        sizes = ", ".join(f"{name} {g.shape}" for name, g in gains.items())
        raise ModelError(
            f"teleoperator_of_arms: {size} coordinates of the master, {len(slave.coordinates)} of "
            f"the slave, {sizes}: expected one size"
        )
    blocks: list[Block] = []
    junctions = [Junction(f"X_e{k}", {f"X_m{k}": 1, f"X_s{k}": -1}) for k in range(1, size + 1)]
    for k in range(size):
        terms: dict[str, Weight] = {}
        for j in range(size):
            values = {name: float(g[k, j]) for name, g in gains.items()}
            if any(values.values()):
                error, force = f"X_e{j + 1}", f"F_P{k + 1}_{j + 1}"
                law = controller("spring_damper", values)
                blocks.append(Control(f"P{k + 1}_{j + 1}", law, error, force, error))
                terms[force] = 1
        junctions.append(Junction(f"F_P{k + 1}", terms))
    arm_sides = [
        # the coupling pulls the slave's tip to the master's, and the master's back to it
        _side("m", master, "F_u", -1, hand, "hand"),
        _side("s", slave, "F_d", 1, environment, "environment"),
    ]
    return Diagram(
        "teleoperator of arms",
        (*blocks, *(b for side in arm_sides for b in side.blocks)),
        (*junctions, *(j for side in arm_sides for j in side.junctions)),
        {f"{outside}{k}": "force" for outside in ("F_u", "F_d") for k in range(1, size + 1)},
        measured=tuple(m for side in arm_sides for m in side.motions),
        kinematics=tuple(k for side in arm_sides for k in side.kinematics),
        pose={n: x for side in arm_sides for n, x in side.pose.items()},
    )


@dataclass(frozen=True)
class _Side:
    blocks: tuple[Block, ...]
    junctions: tuple[Junction, ...]
    kinematics: tuple[Kinematics, ...]
    motions: tuple[str, ...]
    pose: dict[str, float]


def _side(
    side: str, arm: Arm, outside: str, sign: int, held: MatrixImpedance | None, role: PortRole
) -> _Side:
    """All parts of one side; outside: forces at its tip;  held: impedance that the tip touches."""
    numbers = range(1, len(arm.joints) + 1)
    places = range(1, len(arm.coordinates) + 1)
    motions = tuple(f"q_{side}{n}" for n in numbers)
    tips = tuple(f"X_{side}{k}" for k in places)
    named = {joint(n): position_symbol(q) for n, q in zip(numbers, motions, strict=True)}
    where = [sp.sympify(x, strict=True).xreplace(named) for x in arm.coordinates]
    blocks: list[Block] = []
    at_tip: dict[int, dict[str, Weight]] = {k: {f"{outside}{k}": 1} for k in places}
    name = "H" if role == "hand" else "E"
    touching: tuple[tuple[str, MatrixImpedance | None, PortRole], ...] = (
        (name, held, role),
        (f"L{side}", arm.load, "part"),
    )
    for letters, z, of in touching:
        if z is not None:
            forces = tuple(f"F_{letters}{k}" for k in places)
            blocks.append(Linked(f"Z_{letters}", z, tips, forces, role=of))
            for k in places:
                at_tip[k][forces[k - 1]] = 1
    junctions = [Junction(f"F_{side}{k}", at_tip[k]) for k in places]
    for n, (body, q) in enumerate(zip(arm.joints, motions, strict=True), start=1):
        arms = {k: sp.diff(x, position_symbol(q)) for k, x in zip(places, where, strict=True)}
        arms = {k: w for k, w in arms.items() if w != 0}
        torque, command = f"T_{side}{n}", f"U_{side}{n}"
        blocks.append(Moving(f"Z_{side}{n}", body, q, command, {torque: 1}, f"{outside}{n}"))
        # forces at the tip act on the joints by the transposed Jacobian: the power is the same
        commanded: dict[str, Weight] = {f"F_P{k}": sign * w for k, w in arms.items()}
        law = arm.cancellations[n - 1] if arm.cancellations else None
        if law is not None:
            blocks.append(Control(f"C_{side}{n}", law, q, f"F_C{side}{n}", q))
            commanded[f"F_C{side}{n}"] = 1
        junctions.append(Junction(torque, {f"F_{side}{k}": w for k, w in arms.items()}))
        junctions.append(Junction(command, commanded))
    pose = dict(zip(motions, arm.pose, strict=True)) if arm.pose else {}
    kinematics = tuple(Kinematics(x, e) for x, e in zip(tips, where, strict=True))
    return _Side(tuple(blocks), tuple(junctions), kinematics, motions, pose)
